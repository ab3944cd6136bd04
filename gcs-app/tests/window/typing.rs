//! Numbers as people type them: with a unit, in another unit, or in none that fits.

use super::creating::EMPTY;
use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::Value;

fn altitude_m(window: &Window, leg: &str) -> f64 {
    match window.plan().leg(&leg.into()).unwrap().leg.altitude.as_ref().unwrap().metres {
        Value::Constant(metres) => metres,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn another_unit_of_the_same_kind_is_converted_in_the_inspector() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side4");
    for (typed, metres) in [("120 ft", 36.576), ("350 m", 350.0), ("0.4 km", 400.0), ("95", 95.0)] {
        window.fill_in(Role::SpinButton, "Altitude", typed);
        window.steps(2);
        assert!(
            (altitude_m(&window, "side4") - metres).abs() < 1e-6,
            "{typed}: {}",
            altitude_m(&window, "side4")
        );
    }
}

#[test]
fn what_is_no_number_changes_nothing_and_is_told_at_the_field() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side4");
    let before = window.plan();
    for typed in ["120 kt", "high", "1,400"] {
        window.fill_in(Role::SpinButton, "Altitude", typed);
        window.steps(3);
        assert_eq!(window.plan(), before, "{typed}");
        assert!(window.shows(&format!("“{typed}” is no number in m")) && window.shows("Nothing was changed"));
        assert!(window.shows("m, km, ft, NM"), "it says what can be typed");
    }
    window.fill_in(Role::SpinButton, "Altitude", "120 m");
    window.steps(3);
    assert!(!window.shows("is no number") && altitude_m(&window, "side4") == 120.0);
}

/// What stood there was lost, each frame was an edit, and so what was typed was, too.
#[test]
fn a_number_that_could_not_be_read_stays_in_its_field_until_another_one_is_typed() {
    let mut window = Window::open(&SQUARE.replacen("\"110\"", "\"11O\"", 1));
    window.until_analysed();
    window.click("TF side4");
    window.steps(2);
    let before = window.app().document().version();
    window.steps(10);
    assert_eq!(window.app().document().version(), before, "nobody edited it");
    assert!(!window.app().document().is_dirty());
    assert!(window.shows("must be a number, not \"11O\""));
    window.fill_in(Role::TextInput, "Altitude", "301 m");
    window.steps(2);
    assert_eq!(altitude_m(&window, "side4"), 301.0);
}

/// The same of a number that can be no formula, of which nothing is kept.
#[test]
fn a_plain_number_that_could_not_be_read_is_typed_anew() {
    let mut window = Window::open(&SQUARE.replacen("length=\"", "length=\"about ", 1));
    window.until_analysed();
    window.click("Problem: R05: give “length” a number: it has none that can be read");
    let before = window.app().document().version();
    window.steps(10);
    assert_eq!(window.app().document().version(), before, "nobody edited it");
    window.fill_in(Role::SpinButton, "Length", "600 m");
    window.steps(2);
    assert_eq!(window.plan().runways[0].length_m, 600.0);
}

#[test]
fn the_card_for_a_new_mission_and_the_world_of_the_preview_read_units_too() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.click("Among the example's hills");
    window.fill_in(Role::SpinButton, "Length", "2000 ft");
    window.steps(2);
    assert!((window.app().view().guide.length_m - 609.6).abs() < 1e-6);
    window.fill_in(Role::SpinButton, "Length", "30 kt");
    window.steps(3);
    assert!(window.shows("“30 kt” is no number in m"));

    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.harness.get_all_by_label("What if").next().unwrap().click();
    window.steps(3);
    window.write_beside("Wind speed", "36 km/h");
    assert!((window.app().view().what_if.wind.speed_mps() - 10.0).abs() < 1e-6);
    window.write_beside("Wind speed", "30 m");
    assert!(window.shows("“30 m” is no number in m/s"));
    assert!((window.app().view().what_if.wind.speed_mps() - 10.0).abs() < 1e-6);
}

impl Window {
    /// Writes into the number beside a slider.
    pub fn write_beside(&mut self, slider: &str, text: &str) {
        let slider = self.harness.get_by_role_and_label(Role::Slider, slider).rect();
        let number = self.harness.query_all_by_role(Role::SpinButton).map(|node| node.rect());
        let number = number.filter(|rect| (rect.center().y - slider.center().y).abs() < 8.0);
        let number = number.min_by(|a, b| a.left().total_cmp(&b.left()));
        let at = number.map_or(slider.center(), |rect| rect.center());
        self.click_at(at);
        self.press_ctrl(egui::Key::A);
        self.harness.event(egui::Event::Text(text.into()));
        self.steps(1);
        self.press(egui::Key::Enter);
        self.steps(2);
    }
}

/// The leg's own name was quoted, and what was typed was gone.
#[test]
fn an_identifier_that_is_none_stays_in_its_field_with_what_is_wrong_with_it() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side4");
    let typed = |window: &Window| {
        let field = window.harness.get_by_role_and_label(Role::TextInput, "Identifier");
        field.accesskit_node().value().unwrap_or_default()
    };
    for (wrong, why) in
        [("side 4", "`side 4` is no identifier"), ("side2", "`side2` is the identifier of something else")]
    {
        window.fill_in(Role::TextInput, "Identifier", wrong);
        window.steps(3);
        assert!(window.shows(why) && typed(&window) == wrong, "{wrong}: {}", typed(&window));
        assert!(window.plan().leg(&"side4".into()).is_some());
    }
    window.fill_in(Role::TextInput, "Identifier", "last");
    window.steps(3);
    assert!(window.plan().leg(&"last".into()).is_some() && window.selected() == "last");
    assert!(!window.shows("is no identifier") && typed(&window) == "last");
}
