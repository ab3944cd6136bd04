//! What is asked for is found and seen whole: in the palette, in the tree and in the inspector.

use super::flying::flying;
use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

fn key(key: Key, modifiers: Modifiers) -> Event {
    Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers }
}

#[test]
fn letters_typed_before_the_palette_is_there_go_into_its_field() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let mut events = vec![key(Key::K, Modifiers::COMMAND)];
    for letter in ["a", "v", "i"] {
        events.push(key(Key::from_name(&letter.to_uppercase()).unwrap(), Modifiers::NONE));
        events.push(Event::Text(letter.into()));
    }
    window.harness.input_mut().events.extend(events);
    window.harness.step();
    window.harness.event(Event::Text("ation".into()));
    window.steps(3);
    assert!(window.shows("Units Aviation"));
    window.press(Key::Enter);
    assert_eq!(window.app().view().units, gcs_app::units::Units::Aviation);
}

#[test]
fn enter_in_an_empty_palette_does_nothing_until_the_arrows_choose() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = window.plan();
    window.press_ctrl(Key::K);
    window.press(Key::Enter);
    assert!(window.app().view().palette.is_some() && window.plan() == before);
    window.press(Key::ArrowDown);
    window.press(Key::ArrowUp);
    window.press(Key::Enter);
    assert!(window.app().view().palette.is_none(), "the first was chosen");
}

#[test]
fn the_size_is_chosen_and_says_where_there_is_no_room_for_it() {
    let mut window = Window::open_with(SQUARE, vec2(1920.0, 1200.0), None);
    window.until_analysed();
    window.ask_for("size 150");
    window.press(Key::Enter);
    assert_eq!(window.app().view().scale.get(), 1.5);
    window.ask_for("size 300");
    assert!(window.paints("The window has no room for that"));
    window.press(Key::Enter);
    assert_eq!(window.app().view().scale.get(), 1.5);
}

#[test]
fn making_a_procedure_keeps_the_tree_where_it_was_and_calls_say_whose_they_are() {
    let mut window = Window::open_with(SQUARE, vec2(1280.0, 560.0), None);
    window.until_analysed();
    window.row_menu(("TF side2", 0), "Make a procedure of it");
    window.steps(4);
    assert!(window.shows("T/O take-off") && window.selected() == "call1");
    window.click("TF side1");
    window.press(Key::P);
    assert!(window.shows("behind side1, in Main plan > circuit"));
    window.ask_for("show leg r1");
    window.press(Key::Enter);
    window.press(Key::P);
    assert!(window.shows("behind r1, in emergency plan return > r-arrival"));
}

#[test]
fn the_tree_follows_what_is_selected_but_not_away_from_the_flight() {
    let mut window = Window::open_with(SQUARE, vec2(1280.0, 560.0), None);
    window.until_analysed();
    window.ask_for("show runway");
    window.press(Key::Enter);
    assert!(window.shows("RWY R05"));
    let (mut flying, _) = flying();
    flying.harness.set_size(vec2(1280.0, 560.0));
    flying.steps(3);
    assert!(flying.shows("TF side2"));
    flying.ask_for("show runway");
    flying.press(Key::Enter);
    assert!(flying.selected() == "R05" && flying.shows("TF side2"));
}

const CORRIDOR: &str = r#"<corridor id="corridor1" name="Power line" width="300" spacing="100" altitude="200" altitudeReference="agl">
    <route><point lat="36.3301" lon="-84.1601"/><point lat="36.3351" lon="-84.1651"/></route></corridor>"#;

#[test]
fn positions_are_seen_whole() {
    let text = SQUARE.replace(
        r#"<TF id="side3" fix="C"/>"#,
        &format!(r#"<TF id="side3" lat="36.3301" lon="-84.1601"/>{CORRIDOR}"#),
    );
    let mut window = Window::open_with(&text, vec2(1280.0, 1000.0), None);
    window.until_analysed();
    for row in ["TF side1", "TF side3", "CORR Power line", "ENR circuit", "RWY R05", "FIX A"] {
        window.click(row);
        let fields = window.harness.query_all_by_role(Role::TextInput);
        let positions =
            fields.filter(|node| node.accesskit_node().value().is_some_and(|v| v.contains("36.3301")));
        let widths: Vec<f32> = positions.map(|node| node.rect().width()).collect();
        assert!(widths.iter().all(|width| *width >= 140.0), "{row}: {widths:?}");
        assert_eq!(widths.is_empty(), !["TF side3", "CORR Power line"].contains(&row), "{row}");
    }
}
