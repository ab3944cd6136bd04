//! Every list that opens is used without a pointer: opened, gone through, taken from, left.

use super::creating::EMPTY;
use super::{SQUARE, Window};
use egui::Key;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};

impl Window {
    fn list(&self, name: &str) -> egui_kittest::Node<'_> {
        self.harness
            .get_all_by_role(Role::ComboBox)
            .find(|node| node.accesskit_node().label().is_some_and(|label| label.starts_with(name)))
            .unwrap_or_else(|| panic!("no list {name}"))
    }

    fn list_shows(&self, name: &str) -> String {
        self.list(name).accesskit_node().value().unwrap_or_default()
    }

    fn focus_list(&mut self, name: &str) {
        self.list(name).focus();
        self.steps(2);
    }

    fn type_letter(&mut self, letter: &str) {
        self.harness.event(egui::Event::Text(letter.into()));
        self.steps(3);
    }
}

/// Opens it, goes to its end and back, leaves it, and takes its last option.
fn check(window: &mut Window, name: &str) {
    let before = window.list_shows(name);
    for leaves in [true, false] {
        window.focus_list(name);
        window.press(Key::Space);
        assert!(egui::Popup::is_any_open(&window.harness.ctx), "{name}: Space opens it");
        window.press(Key::End);
        window.press(Key::ArrowUp);
        window.press(Key::Home);
        window.press(Key::End);
        window.press(if leaves { Key::Escape } else { Key::Enter });
        assert!(!egui::Popup::is_any_open(&window.harness.ctx), "{name}: it is closed");
        assert_eq!(window.list_shows(name) == before, leaves, "{name}");
    }
}

#[test]
fn lists_of_panels_are_used_by_keyboard() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    check(&mut window, "Play speed");
    super::fleet::tab(&mut window, "What if");
    window.click("TF side2");
    check(&mut window, "Autopilot");
    window.focus_list("Autopilot");
    window.press(Key::Enter);
    window.type_letter("a");
    window.press(Key::Enter);
    assert!(window.list_shows("Autopilot").starts_with('a'), "what begins with the letter");
}

#[test]
fn lists_of_tools_are_used_by_keyboard() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    window.press(Key::A);
    check(&mut window, "Kind");
    check(&mut window, "Where");
    window.press(Key::V);
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.click("Among the example's hills");
    check(&mut window, "Aircraft");
}
