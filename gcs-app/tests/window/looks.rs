//! What the window looks like, compared with pictures that are kept.

use super::*;

#[test]
fn plan_that_was_opened() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.steps(30);
    window.picture("plan");
}
