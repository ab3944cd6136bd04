//! Altitudes by hand in the profile.

use super::{SQUARE, Window};
use egui::vec2;
use egui_kittest::kittest::Queryable;
use flight_plan::{Altitude, AltitudeReference, Value, transform};

fn altitude(window: &Window, leg: &str) -> Option<Altitude> {
    window.plan().leg(&leg.into()).unwrap().leg.altitude.clone()
}

#[test]
fn altitude_is_dragged_in_the_profile_in_one_step() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let places = |window: &Window| {
        let plan = window.plan();
        transform::places(&plan, plan.leg(&"side2".into()).unwrap().leg)
    };
    let (before, there) = (window.plan(), places(&window));
    assert_eq!(altitude(&window, "side2"), None, "it has its stage's");
    let mark = window.centre("Altitude of side2");
    window.drag(mark, vec2(0.0, -25.0));
    let Some(Altitude { metres: Value::Constant(metres), reference }) = altitude(&window, "side2") else {
        panic!("no altitude of its own")
    };
    assert!(metres > 155.0 && metres % 5.0 == 0.0, "{metres}");
    assert_eq!(reference, AltitudeReference::Home, "as it was measured");
    assert_eq!(places(&window), there);
    assert_eq!(window.selected(), "side2");
    window.until_analysed();
    let [raised, other] = ["side2", "side3"].map(|leg| window.centre(&format!("Altitude of {leg}")).y);
    assert!(raised < other - 3.0, "the mark is at the new altitude: {raised} {other}");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

/// It selected the leg and left the cursor where that was.
#[test]
fn a_click_on_a_mark_brings_the_cursor_there() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = window.plan();
    for leg in ["side3", "side1"] {
        window.click(&format!("Altitude of {leg}"));
        assert_eq!(window.selected(), leg);
        let forecast = &window.app().analysis().forecast;
        let passage = forecast.passages.iter().find(|passage| passage.leg.as_str() == leg).unwrap();
        let end_s = forecast.points[passage.end - 1].time_s;
        assert_eq!(window.app().view().cursor_s, Some(end_s), "{leg}");
        // no double click
        window.steps(40);
    }
    assert_eq!(window.plan(), before);
}

#[test]
fn altitude_that_is_a_formula_is_not_dragged() {
    let formula = r#"<TF id="side2" fix="B" altitude="= high" altitudeReference="home"/>"#;
    let plan = SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, formula);
    let variable =
        r#"<variables><variable name="high" type="number" unit="m" initial="150"/></variables><mainPlan"#;
    let mut window = Window::open(&plan.replacen("<mainPlan", variable, 1));
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    let before = window.plan();
    let mark = window.centre("Altitude of side2");
    window.drag(mark, vec2(0.0, -25.0));
    assert_eq!(window.plan(), before);
    assert!(window.app().view().notice.as_ref().is_some_and(|why| why.contains("formula")));
}

/// At the size that the window opens with.
#[test]
fn what_an_altitude_counts_from_can_be_read() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side1");
    let choice = window.harness.get_by_role_and_label(egui::accesskit::Role::ComboBox, "Above").rect();
    assert!(choice.width() > 70.0 && choice.right() < 1280.0, "{choice}");
    assert!(window.paints("home"));
}
