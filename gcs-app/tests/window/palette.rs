//! The command palette, and the keys: everything that can be done, without the pointer.

use super::flying::flying;
use super::vehicle::{place, status};
use super::{SQUARE, Window};
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_exec::{Command, Phase};
use gcs_app::link::{Call, LinkEvent, LinkState};
use gcs_app::units::Units;

impl Window {
    /// Opens the palette and types into it.
    pub fn ask_for(&mut self, letters: &str) {
        self.press_ctrl(Key::K);
        self.harness.get_by_label("Search commands").type_text(letters);
        self.steps(3);
    }
}

#[test]
fn a_few_letters_and_enter_do_what_they_find() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.ask_for("aviation");
    assert!(window.shows("Units Aviation"));
    window.press(Key::Enter);
    assert_eq!(window.app().view().units, Units::Aviation);
    assert!(window.app().view().palette.is_none());
    window.ask_for("fire and forget");
    assert!(window.shows("Nothing has these letters"));
    window.press(Key::Enter);
    assert!(window.app().view().palette.is_some());
    window.press(Key::Escape);
    assert!(window.app().view().palette.is_none());
}

#[test]
fn arrows_choose_among_what_was_found_and_places_of_the_plan_are_there() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.ask_for("show leg side");
    for _ in 0..2 {
        window.press(Key::ArrowDown);
    }
    window.press(Key::ArrowUp);
    window.press(Key::Enter);
    assert_eq!(window.selected(), "side2");
    // F is for the whole plan, but not while it is typed
    window.ask_for("tool zone");
    window.press(Key::Enter);
    assert!(window.shows("Keep-out zone"), "the tool says what it draws");
}

#[test]
fn words_of_other_programs_find_what_it_is_called_here() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    for (word, name) in [
        ("RTL", "Flight Emergency: fly the alternate in force"),
        ("return to launch", "Tool Draw an emergency plan"),
        ("rally point", "Tool Draw an emergency plan"),
        ("geofence", "Tool Draw a zone"),
        ("go around", "Flight Skip the leg…"),
        ("upload", "Flight Push the plan to the vehicle"),
        ("write mission", "Flight Push the plan to the vehicle"),
        ("loiter", "Tool Draw legs"),
        ("waypoint", "Tool Draw legs"),
        ("survey grid", "Tool Draw an area to scan"),
        ("polygon", "Tool Draw an area to scan"),
        ("orbit", "Tool Draw a circle or search"),
        ("home", "Tool Draw a runway"),
        ("takeoff", "Flight Start and take off"),
        ("KML", "Export Export as KML…"),
        ("kml", "File Import…"),
        ("revert", "Edit Undo"),
    ] {
        window.ask_for(word);
        let is_found = window.harness.query_all_by_label(name).next().is_some();
        assert!(is_found, "{word}: no {name:?}");
        assert!(!window.shows("Nothing has these letters"));
        window.press(Key::Escape);
    }
    // Enter does what was meant, and nothing that happens to have the letters
    window.ask_for("geofence");
    window.press(Key::Enter);
    assert!(window.shows("Keep-out zone"));
    window.ask_for("upload");
    window.press(Key::Enter);
    assert!(window.app().view().palette.is_some(), "there is no vehicle to push it to");
}

#[test]
fn a_command_to_the_aircraft_and_a_leg_of_the_plan_are_not_called_the_same() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.ask_for("hold now");
    assert!(window.shows("Flight Hold now: the aircraft circles where it is"));
    window.press(Key::Escape);
    let at = window.centre("Map") + egui::vec2(90.0, 60.0);
    window.right_click_at(at);
    assert!(window.shows("Add a holding here") && !window.shows("Hold here"));
}

/// Letters that were scattered in other names stood first, and the tool was not found.
#[test]
fn kinds_of_legs_and_the_size_of_the_window_are_found_by_their_words() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    for (words, kind) in [("figure", "Orbit"), ("sector", "Orbit"), ("HM", "TF"), ("creeping", "Scan")] {
        window.ask_for(words);
        window.press(Key::Enter);
        assert!(window.shows(&format!("Kind: {kind}")), "{words}");
        window.press(Key::V);
    }
    for words in ["scale", "interface"] {
        window.ask_for(words);
        assert!(window.shows("Size Larger"), "{words}");
        window.press(Key::Enter);
        assert!(window.app().view().scale.get() > 1.0, "{words}");
        window.press_ctrl(Key::Num0);
    }
}

#[test]
fn what_is_not_possible_says_why_and_does_nothing() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.ask_for("push the plan");
    let row = window.harness.get_by_label("Flight Push the plan to the vehicle");
    assert!(egui_kittest::kittest::NodeT::accesskit_node(&row).is_disabled());
    window.press(Key::Enter);
    assert!(window.app().view().palette.is_some() && window.asked().is_none());
}

/// They were offered, and refused: no command reaches an aircraft without a link.
#[test]
fn what_the_link_carries_is_not_offered_without_one() {
    let (mut window, _) = flying();
    window.leave_open();
    window.send(LinkEvent::Link(LinkState::Off));
    window.harness.set_size(egui::vec2(960.0, 600.0));
    for name in [
        "Hold now: the aircraft circles where it is",
        "Skip the leg…",
        "Emergency: fly the alternate in force",
        "Abort: Safe mode flies home",
        "Rewind to the start",
    ] {
        window.ask_for(name);
        assert!(!window.is_enabled(&format!("Flight {name}")), "{name}");
        // the reason pushed the name out
        for words in [name, "Not connected"] {
            assert!(window.paints_whole(words), "{words}");
        }
        let row = window.harness.get_by_label(&format!("Flight {name}")).rect();
        assert!(row.height() < 36.0, "in one line: {name} at {row}");
        window.press(Key::Enter);
        assert!(window.far.orders.try_recv().is_err() && !window.shows("refused"), "{name}");
        window.press(Key::Escape);
    }
}

#[test]
fn a_dangerous_command_is_given_by_holding_alone() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.connect();
    let mut value = status(Phase::Flying);
    value.plan = Some(window.app().analysis().hash.clone().into());
    value.place = Some(place("circuit", "side2"));
    window.receive_position(false);
    window.receive_status(value);
    while window.asked().is_some() {}
    window.ask_for("abort safe");
    window.press(Key::Enter);
    assert!(window.asked().is_none(), "nothing was said");
    let at = window.centre("Abort: Safe mode flies home (hold)");
    window.tap_at(at);
    assert!(window.shows("Nothing was done: hold it"), "pressed and let go between two frames");
    window.hold("Abort: Safe mode flies home (hold)", 30);
    assert!(window.asked().is_none(), "not held long enough");
    window.hold("Abort: Safe mode flies home (hold)", 70);
    let Some((_, Call::Plan(command))) = window.asked() else { panic!("no command") };
    assert_eq!(command, Command::AbortToSafe);
}

#[test]
fn a_window_is_not_made_larger_than_it_has_room_for() {
    let mut window = Window::open_with(SQUARE, egui::vec2(960.0, 600.0), None);
    window.until_analysed();
    for _ in 0..20 {
        window.press_ctrl(Key::Plus);
    }
    assert_eq!((window.app().view().scale.get(), window.harness.ctx.zoom_factor()), (1.0, 1.0));
    window.ask_for("larger");
    assert!(window.paints("The window has no room for that"));
}

#[test]
fn keys_change_the_size_and_a_key_of_the_palette_is_shown() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    for _ in 0..3 {
        window.press_ctrl(Key::Plus);
    }
    assert!((window.app().view().scale.get() - 1.3).abs() < 1e-6);
    assert!((window.harness.ctx.zoom_factor() - 1.3).abs() < 1e-6);
    window.press_ctrl(Key::Minus);
    assert!((window.app().view().scale.get() - 1.2).abs() < 1e-6);
    window.press_ctrl(Key::Num0);
    for _ in 0..8 {
        window.press_ctrl(Key::Minus);
    }
    assert!((window.app().view().scale.get() - 0.5).abs() < 1e-6, "no smaller");
    window.harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    window.steps(3);
    assert!(window.app().view().palette.is_some());
    window.harness.get_by_label("Search commands").type_text("duplicate");
    window.steps(3);
    assert!(!window.paints("Ctrl+D"), "why it is not possible stands there");
    window.press(Key::Escape);
    window.click("TF side2");
    window.ask_for("duplicate");
    assert!(window.paints("Ctrl+D"));
}

/// Of every action that has a key, possible now or not.
#[test]
fn every_key_stands_beside_its_action() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    let mut shown = 0;
    for (name, keys) in gcs_app::actions::keys() {
        let key = keys.split(" or ").next().unwrap();
        window.ask_for(name);
        let is_row = |row: &egui_kittest::Node<'_>| {
            let label = row.accesskit_node().label().unwrap_or_default();
            label.ends_with(&format!(" {name}"))
        };
        let rows = window.harness.query_all_by_role(egui::accesskit::Role::Button).filter(is_row);
        // what led here is here already
        let Some(row) = rows.reduce(|_, row| row) else {
            assert_eq!(name, "All commands…");
            window.press(Key::Escape);
            continue;
        };
        let is_possible = !row.accesskit_node().is_disabled();
        shown += usize::from(is_possible);
        assert!(!is_possible || !window.places_of(|text| text == key).is_empty(), "{name}: no {key}");
        window.press(Key::Escape);
    }
    assert!(shown > 20, "{shown}");
}

#[test]
fn f1_opens_the_topic_of_what_is_selected_and_links_lead_on() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.press(Key::F1);
    assert!(window.shows("From an empty map to a flight"));
    window.press(Key::F1);
    window.ask_for("show leg side1");
    window.press(Key::Enter);
    window.press(Key::F1);
    assert_eq!(window.app().view().help.as_deref(), Some("plan-language.md#tf-track-to-fix"));
    window.click("Search the help");
    window.harness.get_by_label("Search the help").type_text("teardrop");
    window.steps(3);
    window.click("HF, hold to fix");
    assert_eq!(window.app().view().help.as_deref(), Some("plan-language.md#hf-hold-to-fix"));
    window.press(Key::F1);
    assert_eq!(window.app().view().help, None);
}

#[test]
fn escape_closes_the_help_before_it_selects_nothing() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    window.press(Key::F1);
    assert!(window.app().view().help.is_some());
    window.press(Key::Escape);
    assert!(window.app().view().help.is_none() && window.selected() == "side2");
    window.press(Key::Escape);
    assert_eq!(window.selected(), "");
}

#[test]
fn engine_failure_is_raised_from_the_palette() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.ask_for("engine fails");
    window.press(Key::Enter);
    assert_eq!(window.app().view().alarm, Some(flight_plan::Cause::Engine));
    assert!(window.app().view().cursor_s.is_some());
}

#[test]
fn what_has_the_word_in_its_name_comes_before_what_is_in_a_group_of_that_name() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.ask_for("maps");
    window.press(Key::Enter);
    assert!(window.app().view().maps && !window.app().view().edge.graticule);
}

/// Nobody knows the key of the menu who has none on his keyboard.
#[test]
fn the_menu_of_what_is_selected_is_found_with_its_key() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    window.ask_for("open the menu of what");
    assert!(window.paints("Shift+F10"));
    window.press(Key::Enter);
    assert!(window.shows("Put into a loop"));
}
