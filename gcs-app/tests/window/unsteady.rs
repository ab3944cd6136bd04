//! A hand that trembles moves nothing, and what is clicked twice is shown with all it has.

use super::Window;
use super::pasting::window;
use egui::{Pos2, vec2};

impl Window {
    /// Presses for longer than a click takes, trembles by two points, and lets go.
    pub fn press_unsteadily(&mut self, at: Pos2) {
        self.harness.hover_at(at);
        self.harness.drag_at(at);
        for frame in 0..90 {
            self.harness.hover_at(at + vec2(2.0 * (frame % 2) as f32, 2.0 * (frame % 3) as f32 - 2.0));
            self.steps(1);
        }
        self.harness.drop_at(at + vec2(2.0, -2.0));
        self.steps(3);
    }

    fn double_click_at(&mut self, at: Pos2) {
        self.tap_at(at);
        self.tap_at(at);
        self.steps(3);
    }
}

#[test]
fn a_press_that_trembles_moves_nothing_and_selects() {
    for grip in ["Fix A", "New leg before side3"] {
        let mut window = window();
        let before = window.plan();
        let at = window.centre(grip);
        window.press_unsteadily(at);
        assert!(window.plan() == before && !window.is_enabled("Undo"), "{grip}");
        window.drag(at, vec2(30.0, 20.0));
        assert!(window.plan() != before, "{grip}: past a few points it is dragged");
        window.click("Undo");
        assert_eq!(window.plan(), before, "{grip}: in one step");
    }
}

#[test]
fn who_has_closed_the_inspector_opens_it_by_a_double_click() {
    let mut window = window();
    window.click("Hide Inspector");
    let at = window.centre("Fix B");
    window.click_at(at);
    assert!(!window.shows("Hide Inspector"), "a click only selects");
    window.steps(60);
    window.double_click_at(at);
    assert!(window.shows("Hide Inspector") && window.shows("Identifier"));
    window.click("Hide Inspector");
    let beside = window.centre("Map") + vec2(90.0, 60.0);
    window.steps(60);
    window.double_click_at(beside);
    assert!(window.selected().is_empty() && !window.shows("Hide Inspector"), "there is nothing");
}
