//! The keyboard alone: Tab goes through the window, and what has the keyboard is to be seen.

use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, Shape};
use egui_kittest::kittest::{NodeT, Queryable};

fn focused(window: &Window) -> Option<(String, Rect)> {
    let node = window.harness.query_all_by(|node| node.is_focused()).next()?;
    let label = node.accesskit_node().label().or(node.accesskit_node().value()).unwrap_or_default();
    node.accesskit_node().bounding_box()?;
    Some((label, node.rect()))
}

fn has_ring(window: &Window, rect: Rect) -> bool {
    let ring = rect.expand(1.0);
    window.harness.output().shapes.iter().any(|clipped| match &clipped.shape {
        Shape::Rect(shape) => {
            shape.rect.min.distance(ring.min) < 1.0 && shape.rect.max.distance(ring.max) < 1.0
        }
        _ => false,
    })
}

#[test]
fn f6_goes_from_panel_to_panel_and_into_them() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let goes_to = |window: &mut Window, modifiers, expected: &str| {
        window.harness.key_press_modifiers(modifiers, Key::F6);
        window.steps(3);
        let (label, rect) = focused(window).expect(expected);
        assert_eq!(label, expected);
        assert!(has_ring(window, rect), "{label}");
    };
    for panel in ["Main plan", "Problems", "Map", "Profile", "Inspector", "Main plan"] {
        goes_to(&mut window, Modifiers::NONE, panel);
    }
    window.press(Key::ArrowDown);
    assert_eq!(window.selected(), "take-off", "the arrows walk the plan at once");
    goes_to(&mut window, Modifiers::SHIFT, "Inspector");
    window.press(Key::Tab);
    let (label, rect) = focused(&window).unwrap();
    assert!(rect.left() > window.centre("Map").x, "Tab leads into the panel: {label}");
    goes_to(&mut window, Modifiers::SHIFT, "Profile");
    goes_to(&mut window, Modifiers::NONE, "Inspector");
}

#[test]
fn tab_leads_through_the_window_and_what_has_the_keyboard_is_seen() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    let mut seen = Vec::<String>::new();
    for _ in 0..200 {
        window.harness.key_press(Key::Tab);
        window.steps(1);
        let Some((label, rect)) = focused(&window) else { continue };
        let is_typed = window.harness.ctx.text_edit_focused();
        assert!(is_typed || rect.area() == 0.0 || has_ring(&window, rect), "{label} at {rect}");
        if seen.first() == Some(&label) && seen.len() > 20 {
            break;
        }
        seen.push(label);
    }
    for name in [
        "Legwork",
        "○ Connect",
        "TF side2",
        "Map",
        "Runway R05",
        "Path of side4",
        "Fix A",
        "▶ Preview",
        "Identifier",
    ] {
        assert!(seen.iter().any(|label| label == name), "{name} among {seen:?}");
    }
}

/// Space or Enter opens it, arrows choose, Enter takes, Escape leaves it as it was.
#[test]
fn a_choice_is_made_by_keyboard() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    let before = window.plan();
    let to =
        |window: &Window| window.harness.get_by_role_and_label(Role::ComboBox, "To").accesskit_node().value();
    let options = |window: &Window| window.harness.query_all_by_label("a position").count();
    for (opens, keys, taken) in [
        (Key::Space, vec![Key::ArrowDown, Key::Enter], "a position"),
        (Key::Enter, vec![Key::ArrowUp, Key::Space], "a fix"),
        (Key::Space, vec![Key::ArrowDown, Key::ArrowDown, Key::Escape], "a fix"),
    ] {
        window.harness.get_by_role_and_label(Role::ComboBox, "To").focus();
        window.steps(2);
        window.press(opens);
        assert!(options(&window) > 0, "{opens:?} opens it");
        assert_eq!(focused(&window).map(|(label, _)| label).as_deref(), to(&window).as_deref(), "{opens:?}");
        for key in keys {
            window.press(key);
        }
        assert_eq!(to(&window).as_deref(), Some(taken), "{opens:?}");
        assert_eq!(options(&window), 0, "it is closed");
        assert_eq!(window.selected(), "side2", "the keys go nowhere else");
    }
    window.press_ctrl(Key::Z);
    window.press_ctrl(Key::Z);
    assert_eq!(window.plan(), before);
}
