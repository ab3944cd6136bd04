//! What is done on the way, on the map.

use super::{SQUARE, Window};

/// Nobody sees in a path that a camera is started on it.
#[test]
fn what_is_done_on_the_way_has_a_mark_and_words_on_the_leg_that_is_selected() {
    let acting = r#"<TF id="side2" fix="B"><action on="start"><videoStart/></action><action on="end"><videoStop/></action>
        <action on="end"><wait seconds="30"/></action></TF>"#;
    let plan = SQUARE.replacen(r#"<TF id="side2" fix="B"/>"#, acting, 1);
    let mut window = Window::open(&plan);
    window.until_analysed();
    assert!(!window.paints("video on"));
    window.select_row(("TF side2", 0));
    window.steps(3);
    assert!(window.paints("video on") && window.paints("video off, wait 30 s"));
    window.select_row(("TF side3", 0));
    window.steps(3);
    assert!(!window.paints("video on"), "of what is looked at alone");
}
