//! Map tools, used as a person uses them.

use super::{SQUARE, Window};
use egui::{Key, Pos2, vec2};
use egui_kittest::kittest::Queryable;

const SELECT: &str = "Select and move (V)";
const MEASURE: &str = "Measure (M)";

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

fn click_at(window: &mut Window, at: Pos2) {
    window.harness.hover_at(at);
    window.steps(1);
    window.harness.drag_at(at);
    window.steps(1);
    window.harness.drop_at(at);
    window.steps(3);
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
    click_at(&mut window, from);
    window.harness.hover_at(from + vec2(100.0, 0.0));
    window.steps(2);
    assert!(
        window.shows("090° true"),
        "the pointer is the other end until there is one: {:?}",
        status(&window)
    );
    click_at(&mut window, from + vec2(0.0, -150.0));
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
    click_at(&mut window, at);
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
    window.click(MEASURE);
    assert!(window.harness.query_by_label("Fix A").is_none());
    window.harness.key_press(Key::V);
    window.steps(2);
    assert!(window.harness.query_by_label("Fix A").is_some());
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
