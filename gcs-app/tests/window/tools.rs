//! Map tools, used as a person uses them.

use super::{SQUARE, Window};
use egui::{Key, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::{Area, LegKind, Place};

const SELECT: &str = "Select and move (V)";
const MEASURE: &str = "Measure (M)";

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// What the chip of the tool says.
fn status(window: &Window) -> Option<String> {
    use egui_kittest::kittest::NodeT;
    let chip = window.harness.query_all_by_label_contains("Measure: ").next()?;
    chip.accesskit_node().value().or(chip.accesskit_node().label())
}

#[test]
fn two_clicks_measure_and_the_ends_can_be_dragged() {
    let mut window = window();
    window.click(MEASURE);
    assert!(window.shows("Measure: click two places"));
    let from = window.centre("Map") + vec2(-60.0, 120.0);
    window.click_at(from);
    window.harness.hover_at(from + vec2(100.0, 0.0));
    window.steps(2);
    assert!(
        window.shows("090° true"),
        "the pointer is the other end until there is one: {:?}",
        status(&window)
    );
    window.click_at(from + vec2(0.0, -150.0));
    let first = status(&window).unwrap();
    assert!(first.contains("000° true"), "{first}");
    let end = window.centre("Measure to here");
    window.drag(end, vec2(150.0, 150.0));
    let second = status(&window).unwrap();
    assert!(second.contains("090° true"), "{second}");
    // as far as before on the screen; the map's sphere differs from the ellipsoid by less than a percent
    assert!((length_m(&first) / length_m(&second) - 1.0).abs() < 0.01, "{first}, {second}");
    assert!(!window.is_enabled("Undo"), "measuring changes nothing");
}

#[test]
fn corners_make_a_scan_that_can_be_flown() {
    let mut window = window();
    window.click("TF side2");
    window.click("Draw an area to scan (A)");
    let at = window.centre("Map") + vec2(20.0, 20.0);
    let corners = [vec2(0.0, 0.0), vec2(120.0, 0.0), vec2(200.0, 10.0), vec2(120.0, 100.0), vec2(0.0, 100.0)];
    for (n, corner) in corners.into_iter().enumerate() {
        window.click_at(at + corner);
        if n == 2 {
            // that one was a mistake
            window.harness.key_press(Key::Backspace);
            window.steps(2);
        }
    }
    assert!(!window.is_enabled("Undo"), "nothing is in the plan yet");
    assert!(window.shows("closes it"));
    window.click_at(at + vec2(3.0, 2.0));
    assert!(window.shows("SCAN scan1"));
    let plan = window.app().document().plan().clone();
    let LegKind::Scan(scan) = &plan.leg(&"scan1".into()).unwrap().leg.kind else { panic!("no scan") };
    let Area::Polygon { corners, .. } = &scan.area else { panic!("no polygon") };
    assert_eq!(corners.len(), 4);
    window.until_analysed();
    let errors = window.app().analysis().problems.iter().filter(|p| p.is_error()).count();
    assert!(errors == 0 && window.app().analysis().forecast.length_m() > 5000.0);
    window.click("Undo");
    assert!(!window.shows("SCAN scan1"));
}

#[test]
fn click_on_a_fix_goes_to_the_fix() {
    let mut window = window();
    window.click("TF side4");
    let fix = window.centre("Fix A");
    window.click("Draw legs (T)");
    window.click_at(fix + vec2(4.0, -3.0));
    let plan = window.app().document().plan().clone();
    let LegKind::Tf(to) = &plan.leg(&"leg1".into()).unwrap().leg.kind else { panic!("no track") };
    assert_eq!(to.place, Place::Fix("A".into()));
}

#[test]
fn each_click_adds_a_leg_and_backspace_takes_it_back() {
    let mut window = window();
    let ids = |window: &Window| -> Vec<String> {
        let stage = window.app().document().plan().stage(&"circuit".into()).unwrap();
        stage.legs.iter().map(|leg| leg.id.to_string()).collect()
    };
    let before = ids(&window);
    window.click("TF side2");
    window.click("Draw legs (T)");
    assert!(window.shows("Draw legs behind side2"));
    let at = window.centre("Map");
    window.click_at(at + vec2(40.0, 90.0));
    window.harness.hover_at(at + vec2(40.0, 160.0));
    window.steps(2);
    assert!(window.shows("Next leg: ") && window.shows("180°"));
    window.click_at(at + vec2(-30.0, 120.0));
    assert_eq!(ids(&window), ["side1", "side2", "leg1", "leg2", "side3", "side4"]);
    assert!(window.shows("TF leg2"));
    window.harness.key_press(Key::Backspace);
    window.steps(2);
    assert_eq!(ids(&window), ["side1", "side2", "leg1", "side3", "side4"]);
    window.harness.key_press(Key::Enter);
    window.steps(2);
    assert!(!window.shows("Next leg"), "the chain has ended, the tool is still there");
    window.harness.key_press(Key::Escape);
    window.steps(2);
    assert!(!window.shows("Draw legs behind"));
    for _ in 0..3 {
        window.click("Undo");
    }
    assert_eq!(ids(&window), before, "each click is a step");
}

/// `Measure: 890 m · …`.
fn length_m(status: &str) -> f64 {
    status.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[test]
fn escape_ends_the_measurement_then_the_mode_then_the_selection() {
    let mut window = window();
    window.click("TF side1");
    window.harness.key_press(Key::M);
    window.steps(2);
    let at = window.centre("Map") + vec2(-60.0, 120.0);
    window.click_at(at);
    assert!(window.app().view().selection.is_some(), "a click of this tool selects nothing");
    let escape = |window: &mut Window| {
        window.harness.key_press(Key::Escape);
        window.steps(2);
    };
    escape(&mut window);
    assert!(window.shows("click two places") && !window.shows("Measure from here"));
    escape(&mut window);
    assert!(!window.shows("click two places") && window.app().view().selection.is_some());
    escape(&mut window);
    assert!(window.app().view().selection.is_none());
}

#[test]
fn only_the_tool_in_use_can_be_grabbed() {
    let mut window = window();
    assert!(window.shows("Fix A") && window.shows(SELECT));
    let place = |window: &Window| window.plan().fix(&"A".into()).unwrap().position;
    let before = place(&window);
    window.click(MEASURE);
    window.drag(window.centre("Fix A"), vec2(20.0, 10.0));
    assert_eq!(place(&window), before);
    window.press(Key::V);
    window.drag(window.centre("Fix A"), vec2(20.0, 10.0));
    assert_ne!(place(&window), before);
}

#[test]
fn a_key_that_is_typed_into_a_field_chooses_no_tool() {
    let mut window = window();
    window.click("TF side1");
    let name = window.harness.get_all_by_role(egui::accesskit::Role::TextInput).next().unwrap();
    name.focus();
    window.steps(1);
    window.harness.key_press(Key::M);
    window.steps(2);
    assert!(!window.shows("click two places"));
}
