//! A flight in a small window, or one that shows everything larger: what nobody flies without is in sight.

use super::considering::{considered, foresight};
use super::emergency::in_emergency;
use super::filing::edit;
use super::fleet::tab;
use super::flying::flying;
use super::recovering::{edit_and_kill, window_in};
use super::states::{THEMES, examine, placed, widgets};
use super::vehicle::{decision, position};
use super::whatif::FIRE_WATCH;
use super::{SQUARE, Window};
use egui::{Key, Rect, Vec2, vec2};
use egui_kittest::kittest::Queryable;
use flight_exec::{Command, Foresight, IterationPlace};
use gcs_app::link::{Call, Reply, Telemetry};
use usal::contract::{Air, Alarm, Power, Severity, Stamped};

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
        window.receive_attitude();
        let still = Air {
            airspeed_mps: 24.0,
            wind_east_mps: 0.0,
            wind_north_mps: 0.0,
            pressure_hpa: 980.0,
            temperature_c: 15.0,
        };
        window.receive(Telemetry::Air(Stamped { time_s: 3.0, validity_s: 5.0, value: still }));
        window.steps(20);
        let bottom = window.harness.get_by_label("⏸ Hold").rect().top();
        let vital = ["ENERGY LOW", "Arrival ▸ r1", "above runway R05", "71 % · 24.1 V"];
        for text in vital {
            let rect = window.harness.get_by_label_contains(text).rect();
            assert!(rect.bottom() < bottom, "{size}: {text} is at {rect}, the panel ends at {bottom}");
        }
        assert!(!window.shows("Coverage of the whole path"), "{size}");
        let numbers = rect(&window, "TAS 24.0 m/s · 500 m AMSL · HDG 040°");
        assert!(numbers.bottom() < bottom, "{size}: what the display has no room for is at {numbers}");
        assert!(
            window.paints_whole("TAS 24.0 m/s · 500 m AMSL · HDG 040°"),
            "{size}: they were cut at the right"
        );
        window.click("What if");
        assert!(window.shows("Coverage of the whole path"), "{size}: it was asked for");
    }
}

/// The battery was below the fold, and so was the height above the ground in a loop.
#[test]
fn below_the_horizon_the_vital_values_come_first() {
    let (mut window, mut value) = flying();
    value.emergency_in_force = Some("return".into());
    if let Some(place) = &mut value.place {
        place.iterations =
            vec![IterationPlace { leg: "rounds".into(), iteration: 2, of: Some(3), reverse: false }];
    }
    window.receive_status(value);
    let power = Power { voltage_v: 24.1, current_a: 9.0, battery: 0.71, fuel: None };
    window.receive(Telemetry::Power(Stamped { time_s: 1.0, validity_s: 5.0, value: power }));
    window.harness.set_size(vec2(1280.0, 800.0));
    window.steps(3);
    let end = rect(&window, "⏸ Hold").top();
    let horizon = said(&window, "Primary flight display");
    let vital = ["circuit ▸ side2", "above the ground", "71 % · 24.1 V"];
    for text in vital {
        let found = window.harness.get_all_by_label_contains(text).last().unwrap().rect();
        assert!(found.top() > horizon.bottom() && found.bottom() < end, "{text} is at {found}");
    }
}

/// What stands on the map with these words, line by line.
fn lines(window: &Window, words: &str) -> Vec<String> {
    let shapes = window.harness.output().shapes.iter();
    let mut texts = shapes.flat_map(|clipped| super::painted::texts(&clipped.shape));
    let galley = &texts.find(|text| text.galley.text().contains(words)).unwrap().galley;
    galley.rows.iter().map(|row| row.text()).collect()
}

/// They took three lines of the map, which is small.
#[test]
fn what_the_emergency_tool_says_takes_two_lines() {
    let mut window = opened(SQUARE);
    window.click("TF side2");
    window.press(Key::E);
    assert_eq!(lines(&window, "click the runway it leads to").len(), 1);
    let runway = window.centre("Runway R05");
    window.click_at(runway);
    window.harness.hover_at(runway + vec2(30.0, -40.0));
    window.steps(5);
    assert!(window.paints(" From side2: "));
    let lines = lines(&window, "click its places outwards");
    assert_eq!(lines.len(), 2, "{lines:?}");
}

#[test]
fn what_other_tools_say_while_they_draw_takes_two_lines() {
    let lead = r#"<procedures><procedure id="look" reference="36.3 -84.1"><TF id="p1" lat="36.3" lon="-84.1"/><TF id="p2" lat="36.31" lon="-84.1"/></procedure></procedures><mainPlan"#;
    for (key, words) in [
        (Key::Z, "Keep-out zone"),
        (Key::A, "Scan"),
        (Key::L, "Corridor"),
        (Key::O, "Orbit"),
        (Key::P, "Procedure"),
        (Key::T, "eg"),
    ] {
        let mut window = opened(&SQUARE.replace("<mainPlan", lead));
        window.click("TF side2");
        window.press(key);
        let at = rect(&window, "Map").center();
        let said = (0..3).map(|clicks| {
            window.harness.hover_at(at + vec2(45.0 * clicks as f32, 30.0 * (clicks % 2) as f32));
            window.steps(5);
            let said = lines(&window, words);
            window.click_at(at + vec2(45.0 * clicks as f32, 30.0 * (clicks % 2) as f32));
            // no double click
            window.steps(40);
            said
        });
        for said in said.collect::<Vec<_>>() {
            assert!(said.len() <= 2 && !said.concat().contains('…'), "{key:?}: {said:?}");
        }
    }
}

/// The smallest window.
const SMALL: Vec2 = vec2(960.0, 600.0);

fn opened(text: &str) -> Window {
    let mut window = Window::open_with(text, SMALL, None);
    window.until_analysed();
    window
}

fn rect(window: &Window, label: &str) -> Rect {
    window.harness.get_by_label(label).rect()
}

/// Where the tool in use says this.
fn said(window: &Window, words: &str) -> Rect {
    window.harness.get_by_label_contains(words).rect()
}

/// They were cut where they say what to do.
#[test]
fn alarms_and_answers_are_read_whole() {
    for size in [SMALL, SMALL / 0.8] {
        let (mut window, value) = flying();
        window.harness.set_size(size);
        let alarm = |id: &str, advice: &str| Alarm {
            id: id.into(),
            severity: Severity::Warning,
            source: "gateway".into(),
            advice: advice.into(),
            cause: None,
        };
        let sinks = "The aircraft sinks although it is given full throttle: the engine may have failed. Land at the nearest runway \
                     within gliding reach.";
        let taken = "A pilot, another station or a failsafe of the autopilot decides what is flown, and not the plan. Resume when he \
                     gives it back.";
        window.receive_gateway(vec![alarm("engine-suspected", sinks), alarm("not-in-command", taken)]);
        window.receive_status(value);
        let first = window.harness.get_all_by_label_contains("circuit ▸ side2").last().unwrap().rect().top();
        for advice in [sinks, taken] {
            assert!(
                window.paints_whole(advice) && said(&window, advice).bottom() <= first,
                "{size}: {advice}"
            );
        }
        let hold = rect(&window, "⏸ Hold");
        let told = |window: &mut Window, why: &str| {
            window.click("⏸ Hold");
            let asked = std::iter::from_fn(|| window.asked());
            let (ticket, _) = asked.filter(|(_, call)| *call == Call::Plan(Command::Hold)).last().unwrap();
            window.answer(ticket, Err(why.into()));
            window.paints_whole(why)
        };
        let dropped = "nobody took it for 4 s, so it was dropped and will not be done: check the link, then give it again";
        assert!(told(&mut window, dropped) && !window.shows("Read all of this answer"), "{size}");
        let long = "a sentence that says what to do, ".repeat(12);
        assert!(!told(&mut window, &long), "{size}: it has two lines");
        window.click("Read all of this answer");
        assert!(window.paints_whole(&long), "{size}: over the map");
        assert_eq!(rect(&window, "⏸ Hold"), hold, "{size}: no button moves for it");
        window.steps(60);
        assert!(window.paints_whole(&long), "{size}: it is read for as long as it takes");
        told(&mut window, dropped);
        assert!(!window.shows(&long), "{size}: the card of another answer would be false by now");
    }
}

#[test]
fn a_decision_hides_nothing_of_the_map() {
    let (mut window, mut value) = flying();
    value.decision = Some(decision(Some("again")));
    window.receive_status(value);
    for size in [SMALL, vec2(1280.0, 800.0)] {
        window.harness.set_size(size);
        window.steps(3);
        let (map, first) = (rect(&window, "Map"), said(&window, "Decide at ask"));
        assert!(first.top() > map.bottom() - 20.0, "{size}: {first} over {map}");
        assert!(said(&window, "Nobody decides").bottom() < rect(&window, "⏸ Hold").top(), "{size}");
    }
}

#[test]
fn on_a_small_map_a_tool_says_all_of_it_and_gives_way_to_what_is_drawn() {
    let mut window = opened(SQUARE);
    window.press(Key::A);
    let map = rect(&window, "Map");
    let line = said(&window, "Scan ");
    assert!((12.0..60.0).contains(&line.height()), "in as few lines as it takes, {line}");
    assert!(line.bottom() > map.bottom() - 60.0, "{line}, the map {map}");
    for beside in ["Measure (M)", "Zoom in"] {
        assert!(!line.intersects(rect(&window, beside)), "{beside}");
    }
    // nothing is drawn yet: it stays where its choices can be reached
    window.harness.hover_at(line.center() - vec2(0.0, 30.0));
    window.steps(2);
    assert_eq!(said(&window, "Scan "), line);
    window.click_at(map.center());
    window.harness.hover_at(line.center() - vec2(0.0, 30.0));
    window.steps(2);
    let away = said(&window, "Scan: ");
    assert!(away.bottom() < map.top() + 80.0 && away.height() < 60.0, "{away}");
    window.harness.hover_at(map.center());
    window.steps(2);
    assert!((said(&window, "Scan: ").bottom() - line.bottom()).abs() < 2.0, "it comes back");
}

#[test]
fn the_choices_of_a_tool_are_behind_a_button_of_its_line() {
    let mut window = opened(SQUARE);
    window.press(Key::Z);
    assert!(!window.shows("keep in"));
    window.click("Choices of the tool");
    window.click("keep in");
    assert!(window.shows("Place to draw") && window.shows("Keep-in"), "it is still open");
    window.click_at(rect(&window, "Map").center());
    assert!(!window.shows("keep in"));
}

/// Nothing of it is cut, in the dark and in the light.
fn assert_whole(window: &mut Window, question: &str) {
    window.harness.set_size(SMALL);
    let mut found = Vec::new();
    for theme in THEMES {
        examine(question, SMALL, theme, window, &mut found);
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn every_question_is_whole_in_the_smallest_window() {
    let folder = tempfile::tempdir().unwrap();
    edit_and_kill(folder.path());
    let mut window = window_in(folder.path(), SQUARE);
    assert_whole(&mut window, "Recover the changes");
    window.click("Later");
    let (mut window, ticket) = considered();
    let next = Some("the-way-along-the-northern-ridge-to-the-old-power-line".into());
    let foresight = Foresight { next_leg: next, ..foresight() };
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight))));
    assert_whole(&mut window, "Skip side2, fly …");
    window.click("Cancel");
    edit(&mut window);
    window.press_ctrl(Key::Q);
    assert_whole(&mut window, "Save and quit");
    window.click("Discard the changes");
    assert!(window.app().is_leaving());
}

#[test]
fn what_if_leaves_the_inspector_its_room() {
    let mut window = opened(SQUARE);
    window.click("What if");
    let below = rect(&window, "Hide What if").top();
    for text in ["Add alternate by cause", "Select something in the tree"] {
        let shown = said(&window, text);
        assert!(shown.bottom() < below, "{text} at {shown}");
    }
    let alarms = said(&window, "Coverage of the whole path");
    assert!(alarms.bottom() < SMALL.y, "{alarms}");
}

#[test]
fn problems_and_table_show_more_than_two_rows() {
    let mut window = opened(FIRE_WATCH);
    tab(&mut window, "Table");
    let all = widgets(&window);
    let is_whole = |name: &str| {
        placed(&all).into_iter().filter(|w| w.name.starts_with(name) && w.seen == w.rect).count()
    };
    assert!(is_whole("Name of ") >= 3, "and the headings of stages between them: {}", is_whole("Name of "));
    let problems = SMALL.y - rect(&window, "Hide Problems").top();
    assert!(problems > 170.0, "{problems}");
}

#[test]
fn the_cursors_words_stay_on_the_plot_of_the_profile() {
    let long = FIRE_WATCH.replace("Sweep the fire", "Sweep the fire from the northern side of the valley");
    let mut window = opened(&long);
    let profile = said(&window, "Vertical profile");
    window.click_at(profile.center());
    let words = window.places_of(|text| text.contains(" AGL"));
    let marks = window.places_of(|text| ["500", "1000"].contains(&text));
    assert!(!words.is_empty() && !marks.is_empty());
    for (words, mark) in words.iter().flat_map(|words| marks.iter().map(move |mark| (words, mark))) {
        assert!(profile.contains_rect(*words) && words.left() > mark.right(), "{words} and {mark}");
    }
}

/// The tool in use.
pub fn tool(window: &Window) -> &'static str {
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

/// The choice before it took all of the row, and the panel cut the rest off.
#[test]
fn the_inspector_of_a_scan_that_is_bound_is_not_cut_off() {
    let variable = r#"<variables><variable name="burnt_area_of_the_north" type="polygon" initial="36.33 -84.185, 36.33 -84.175, 36.325 -84.18"/></variables><mainPlan"#;
    let scan = r#"<scan id="sweep" spacing="60"><area polygon="= burnt_area_of_the_north"/></scan>"#;
    let plan = SQUARE.replace(r#"<TF id="side3" fix="C"/>"#, scan).replacen("<mainPlan", variable, 1);
    let mut window = opened(&plan);
    window.select_row(("SCAN sweep", 0));
    window.steps(3);
    let bind = rect(&window, "Area: bind to a variable");
    let panel = rect(&window, "Hide Inspector");
    assert!(bind.right() <= panel.right() + 4.0 && bind.right() < SMALL.x, "{bind} {panel}");
}
