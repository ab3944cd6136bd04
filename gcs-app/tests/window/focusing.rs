//! The keyboard alone: Tab goes through the window, and what has the keyboard is to be seen.

use super::{SQUARE, Window};
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
