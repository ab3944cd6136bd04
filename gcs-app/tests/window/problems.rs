//! What is wrong with a plan, as people read and find it.

use super::{SQUARE, Window};
use egui::vec2;
use egui_kittest::kittest::Queryable;
use gcs_app::command::Selection;

const LANDING: &str = r#"<stage id="land" type="land" runway="R05"/>"#;
/// Across the way of `side2`; it has no limits of altitude.
const ZONE: &str =
    r#"<zones><keepOut id="quarry" lat="36.3241" lon="-84.1567" radius="60"/></zones><mainPlan"#;

fn opened(text: &str) -> Window {
    let mut window = Window::open(text);
    window.until_analysed();
    window
}

/// The heights on the screen of the problems with these texts.
fn tops(window: &Window, texts: [&str; 2]) -> [f32; 2] {
    texts.map(|text| window.harness.query_all_by_label_contains(text).next().unwrap().rect().top())
}

#[test]
fn a_flight_that_ends_in_the_air_is_no_green_plan() {
    let window = opened(&SQUARE.replacen(LANDING, "", 1));
    assert!(window.shows("⚠ This plan can be flown, 2 warnings") && !window.shows("✔ This plan"));
    let [landing, glide] = tops(&window, ["the flight does not end on the ground", "out of glide"]);
    assert!(landing < glide, "how the flight ends stands first");
}

#[test]
fn errors_stand_first_and_say_what_helps() {
    let mut window = opened(&SQUARE.replacen("<mainPlan", ZONE, 1));
    assert!(window.shows("✖ This plan can't be flown, "));
    let [error, warning] = tops(&window, ["goes into the zone", "out of glide"]);
    assert!(error < warning);
    assert!(!window.shows("or change its altitude"), "the zone has no limits");
    // its leg is pointed out as long as the pointer is on it
    let at = window.harness.query_all_by_label_contains("goes into the zone").next().unwrap().rect().center();
    window.harness.hover_at(at);
    window.steps(3);
    assert!(window.app().view().pointed.is_some());
    window.click_at(at);
    assert!(matches!(window.app().view().selection, Some(Selection::Leg(_))));
    window.harness.hover_at(window.centre("Map"));
    window.steps(3);
    assert_eq!(window.app().view().pointed, None);
}

#[test]
fn a_problem_is_shown_with_all_of_its_text() {
    let window = opened(&SQUARE.replacen(LANDING, "", 1));
    let rect = window.harness.query_all_by_label_contains("out of glide").next().unwrap().rect();
    assert!(rect.height() > 60.0, "{rect:?}");
}

#[test]
fn the_button_in_a_problem_is_not_the_problem() {
    let steep = SQUARE.replacen(
        r#"<TF id="side2" fix="B"/>"#,
        r#"<TF id="side2" fix="B" altitude="1900" altitudeReference="home"/>"#,
        1,
    );
    let mut window = opened(&steep);
    let before = window.app().view().selection.clone();
    let fix = window.harness.get_all_by_label("Fix").next().unwrap().rect().center();
    window.click_at(fix + vec2(1.0, 0.0));
    assert_ne!(window.plan(), flight_plan::read(steep).plan);
    assert_eq!(window.app().view().selection, before);
    let altitude = window.plan().leg(&"side2".into()).unwrap().leg.altitude.clone().unwrap();
    assert_eq!(altitude.reference.name(), "home");
}
