//! A flight in a small window, or one that shows everything larger: what nobody flies without is in sight.

use super::emergency::in_emergency;
use super::flying::flying;
use super::vehicle::position;
use super::{SQUARE, Window};
use egui::vec2;
use egui_kittest::kittest::Queryable;
use gcs_app::link::Telemetry;
use usal::contract::{Alarm, Power, Severity, Stamped};

#[test]
fn alarms_and_vital_values_are_in_sight_and_what_if_gives_way_until_it_is_asked_for() {
    // the second: 960 by 600 at 112 %, or a laptop at 150 %
    for size in [vec2(960.0, 600.0), vec2(853.0, 533.0)] {
        let mut window = in_emergency();
        window.receive(position(2.0, 500.0, true));
        window.click("What if");
        window.harness.set_size(size);
        window.receive(position(3.0, 500.0, false));
        let value = Power { voltage_v: 24.1, current_a: 9.0, battery: 0.71, fuel: None };
        window.receive(Telemetry::Power(Stamped { time_s: 3.0, validity_s: 5.0, value }));
        let (id, source, advice) = ("energy-low".into(), "gateway".into(), "Land soon.".into());
        window.receive_gateway(vec![Alarm { id, severity: Severity::Caution, source, advice, cause: None }]);
        window.steps(3);
        let bottom = window.harness.get_by_label("⏸ Hold").rect().top();
        let vital = ["ENERGY LOW", "r-approach ▸ r1", "above the ground", "71 % · 24.1 V"];
        for text in vital {
            let rect = window.harness.get_by_label_contains(text).rect();
            assert!(rect.bottom() < bottom, "{size}: {text} is at {rect}, the panel ends at {bottom}");
        }
        assert!(!window.shows("Coverage of the whole path"), "{size}");
        window.click("What if");
        assert!(window.shows("Coverage of the whole path"), "{size}: it was asked for");
    }
}

/// The tool in use.
fn tool(window: &Window) -> &'static str {
    window.app().map().tool_cards().into_iter().find(|(_, in_use)| *in_use).unwrap().0.id
}

#[test]
fn in_flight_the_tools_of_a_small_map_are_behind_one_button() {
    let (mut window, _) = flying();
    assert!(window.shows("Measure (M)"), "there is room");
    window.harness.set_size(vec2(960.0, 600.0));
    window.steps(3);
    assert!(!window.shows("Measure (M)"));
    window.click("Tools of the map");
    window.click("Measure (M)");
    assert_eq!(tool(&window), "measure");
    window.press(egui::Key::V);
    assert_eq!(tool(&window), "select");
    let map = window.harness.get_by_label("Map").rect();
    let button = window.harness.get_by_label("Tools of the map").rect();
    assert!(button.right() < map.left() + 50.0, "{button} {map}");
}

#[test]
fn the_compass_lies_under_no_button() {
    let (mut window, _) = flying();
    window.harness.set_size(vec2(960.0, 600.0));
    window.steps(3);
    let buttons = ["Follow the aircraft", "What the lines mean"];
    for north in window.places_of(|text| text == "N") {
        for button in buttons.map(|button| window.harness.get_by_label(button).rect()) {
            assert!(!button.intersects(north), "{button} {north}");
        }
    }
}

#[test]
fn a_message_is_no_wider_than_the_map() {
    let mut window = Window::open_with(SQUARE, vec2(960.0, 600.0), None);
    window.until_analysed();
    window.click("TF side2");
    window.paste("something that is neither a leg nor a drawing nor coordinates, and goes on for long enough to be cut");
    let map = window.harness.get_by_label("Map").rect();
    assert!(map.width() < 440.0, "{map:?}");
    let text = window.app().view().notice.clone().unwrap();
    for part in ["Close this message", text.as_str()] {
        let rect = window.harness.get_by_label(part).rect();
        assert!(
            map.x_range().contains(rect.left()) && map.x_range().contains(rect.right()),
            "{part}: {rect:?}"
        );
    }
}
