//! What a screen reader finds on the map, and the keyboard with it.

use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Key, Pos2};
use egui_kittest::kittest::{NodeT, Queryable};

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.steps(2);
    window
}

#[test]
fn things_on_the_map_have_names_and_are_selected_by_them() {
    let mut window = window();
    let map = window.harness.get_by_label("Map").rect();
    for (name, id) in [
        ("Runway R05", "R05"),
        ("Path of side2", "side2"),
        ("Path of emergency plan return", "return"),
        ("Fix C", "C"),
    ] {
        let node = window.harness.get_by_label(name);
        assert!(map.contains_rect(node.rect()), "{name}: {}", node.rect());
        assert_eq!(node.accesskit_node().role(), Role::Button, "{name}");
        node.click_accesskit();
        window.steps(3);
        assert_eq!(window.selected(), id);
    }
    // the pointer meets what lies there
    window.click("Path of side2");
    assert_eq!(window.selected(), "side2");
}

#[test]
fn a_zone_has_its_name() {
    let zone = r#"<zones><keepOut id="quarry" lat="36.3141" lon="-84.1567" radius="150"/></zones><mainPlan"#;
    let mut window = Window::open(&SQUARE.replacen("<mainPlan", zone, 1));
    window.until_analysed();
    let is_it = |label: String| label.starts_with("Keep out: quarry");
    let zone = window
        .harness
        .query_all_by_role(Role::Button)
        .find(|node| node.accesskit_node().label().is_some_and(is_it))
        .unwrap();
    assert!(window.harness.get_by_label("Map").rect().contains_rect(zone.rect()));
    zone.click_accesskit();
    window.steps(3);
    assert_eq!(window.selected(), "quarry");
}

#[test]
fn what_has_the_focus_on_the_map_is_selected_by_enter() {
    let mut window = window();
    window.harness.get_by_label("Path of side3").focus();
    window.steps(2);
    assert!(window.harness.get_by_label("Path of side3").is_focused());
    window.press(Key::Enter);
    assert_eq!(window.selected(), "side3");
    window.harness.get_by_label("Fix A").focus();
    window.steps(2);
    window.press(Key::Enter);
    assert_eq!(window.selected(), "A");
}

#[test]
fn fixes_are_found_while_another_tool_is_in_use() {
    let mut window = window();
    window.press(Key::M);
    window.harness.get_by_label("Fix B").click_accesskit();
    window.steps(3);
    assert_eq!(window.selected(), "B");
}

#[test]
fn aircraft_is_named_with_its_height() {
    let mut window = window();
    window.connect();
    window.receive_position(false);
    window.steps(3);
    let node = window.harness.query_all_by_label_contains("Aircraft ").next().unwrap();
    assert!(node.accesskit_node().label().unwrap().ends_with(" AMSL"), "{node:?}");
}

#[test]
fn only_what_is_in_view_is_offered_and_not_without_end() {
    let fixes: String = (0..1000)
        .map(|i| {
            format!(
                "<fix id='F{i}' lat='{}' lon='{}'/>",
                36.30 + 0.001 * f64::from(i / 32),
                -84.19 + 0.001 * f64::from(i % 32)
            )
        })
        .collect();
    let mut window = Window::open(&SQUARE.replacen("<fixes>", &format!("<fixes>{fixes}"), 1));
    window.until_analysed();
    window.press(Key::M);
    let offered = |window: &Window| window.harness.query_all_by_label_contains("Fix F").count();
    assert!((100..=300).contains(&offered(&window)), "{}", offered(&window));
    let map = window.harness.get_by_label("Map").rect();
    (0..12).for_each(|_| window.press(Key::Plus));
    let inside = |at: Pos2| map.contains(at);
    assert!(window.harness.query_all_by_label_contains("Fix F").all(|node| inside(node.rect().center())));
    assert!(offered(&window) < 30, "{}", offered(&window));
}
