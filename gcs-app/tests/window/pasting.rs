//! Copy, cut, paste and duplicate on the map.

use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Event, OutputCommand, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::{Id, transform};

/// With the square circuit, looked at.
pub fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// Those of its stage, by their identifiers.
pub fn legs(window: &Window) -> Vec<String> {
    let stage = window.plan().stage(&"circuit".into()).unwrap().clone();
    stage.legs.iter().map(|leg| leg.id.to_string()).collect()
}

/// What a key puts on the clipboard.
pub fn taken(window: &mut Window, event: Event) -> String {
    window.harness.event(event);
    window.harness.step();
    let commands = window.harness.output().platform_output.commands.clone();
    window.steps(3);
    let text = commands.into_iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text),
        _ => None,
    });
    text.unwrap_or_default()
}

#[test]
fn copied_legs_are_pasted_at_the_pointer_even_in_another_window() {
    let mut window = window();
    window.click("TF side2");
    let text = taken(&mut window, Event::Copy);
    assert!(text.contains("<TF") && text.contains("side2"), "{text}");
    let mut other = self::window();
    other.click("TF side4");
    let here = other.centre("Map") + vec2(90.0, 60.0);
    other.harness.hover_at(here);
    other.steps(2);
    other.paste(&text);
    assert_eq!(legs(&other), ["side1", "side2", "side3", "side4", "side5"]);
    assert_eq!(other.selected(), "side5");
    assert!(other.centre("Waypoint side5").distance(here) < 3.0);
    other.click("Undo");
    assert_eq!(legs(&other), ["side1", "side2", "side3", "side4"], "one step");
}

#[test]
fn cut_takes_away_and_ctrl_d_doubles() {
    let mut window = window();
    window.click("TF side2");
    window.press_ctrl(egui::Key::D);
    assert_eq!(legs(&window), ["side1", "side2", "side5", "side3", "side4"]);
    assert_eq!(window.selected(), "side5");
    let plan = window.plan();
    let places = |id: &str| transform::places(&plan, plan.leg(&Id::new(id)).unwrap().leg);
    assert_eq!(places("side5"), places("side2"));
    let text = taken(&mut window, Event::Cut);
    assert!(text.contains("side5"));
    assert_eq!(legs(&window), ["side1", "side2", "side3", "side4"]);
}

#[test]
fn a_set_of_legs_is_copied_and_pasted_as_one() {
    let mut window = window();
    window.click("TF side1");
    for _ in 0..2 {
        window.press_with(egui::Modifiers::SHIFT, egui::Key::ArrowDown);
    }
    assert_eq!(window.app().view().also.len(), 2);
    let text = taken(&mut window, Event::Copy);
    let mut other = self::window();
    other.click("TF side4");
    let here = other.centre("Map") + vec2(60.0, 40.0);
    other.harness.hover_at(here);
    other.steps(2);
    other.paste(&text);
    assert_eq!(legs(&other), ["side1", "side2", "side3", "side4", "side5", "side6", "side7"]);
    assert_eq!(other.app().view().also.len(), 2, "they are selected");
    let plan = other.plan();
    let at = |id: &str| transform::places(&plan, plan.leg(&Id::new(id)).unwrap().leg)[0];
    for (a, b, copied_a, copied_b) in
        [("side1", "side2", "side5", "side6"), ("side2", "side3", "side6", "side7")]
    {
        let (was, is) = (at(a).distance_m(at(b)), at(copied_a).distance_m(at(copied_b)));
        assert!((was - is).abs() < 0.5, "{was} {is}");
    }
    other.click("Undo");
    assert_eq!(legs(&other).len(), 4, "one step");
}

/// They came between the first and the second.
#[test]
fn copies_of_several_legs_come_behind_the_last_of_them() {
    let mut window = window();
    window.click("TF side1");
    for _ in 0..2 {
        window.press_with(egui::Modifiers::SHIFT, egui::Key::ArrowDown);
    }
    let text = taken(&mut window, Event::Copy);
    window.paste(&text);
    assert_eq!(legs(&window), ["side1", "side2", "side3", "side5", "side6", "side7", "side4"]);
}

#[test]
fn legs_fixes_and_zones_are_one_set() {
    let zone = r#"<zones><keepOut id="village" lat="36.3300" lon="-84.1900" radius="150"/></zones><mainPlan"#;
    let fix = r#"<fix id="D" lat="36.311787" lon="-84.184407"/><fix id="E" lat="36.3280" lon="-84.1780"/>"#;
    let plan = SQUARE.replace(r#"<fix id="D" lat="36.311787" lon="-84.184407"/>"#, fix);
    let mut window = Window::open(&plan.replacen("<mainPlan", zone, 1));
    window.until_analysed();
    window.select_row(("TF side4", 0));
    window.steps(2);
    for row in ["OUT village", "FIX E"] {
        window.harness.get_by_role_and_label(Role::TreeItem, row).scroll_to_me();
        window.steps(10);
        window.select_row_with((row, 0), egui::Modifiers::COMMAND);
        window.steps(2);
    }
    assert!(window.shows("3 together"));
    let before = window.plan();
    window.click("Raise them");
    let altitude = |window: &Window, leg: &str| window.plan().leg(&leg.into()).unwrap().leg.altitude.clone();
    assert!(
        altitude(&window, "side4").is_some() && altitude(&window, "side3").is_none(),
        "the leg among them"
    );
    window.click("Undo");
    let grip = window.centre("Move what is selected");
    window.drag(grip, vec2(-25.0, 30.0));
    let moved = window.plan();
    assert_ne!(moved.zone(&"village".into()), before.zone(&"village".into()));
    assert_ne!(moved.fix(&"E".into()), before.fix(&"E".into()));
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
    let text = taken(&mut window, Event::Copy);
    window.paste(&text);
    let pasted = window.plan();
    assert_eq!((pasted.zones.len(), pasted.fixes.len(), legs(&window).len()), (2, 6, 5));
    assert_eq!(window.app().view().also.len(), 2, "what was pasted is selected");
    window.press(egui::Key::Delete);
    assert_eq!(window.plan(), before, "and goes as one");
}

#[test]
fn a_stage_is_copied_as_its_legs_and_a_zone_as_a_zone() {
    let mut window = window();
    window.select_row(("ENR circuit", 0));
    window.steps(2);
    let text = taken(&mut window, Event::Copy);
    assert!(text.contains("side1") && text.contains("side4"), "{text}");
}

#[test]
fn pasted_coordinates_are_a_waypoint() {
    let mut window = window();
    window.click("TF side4");
    let at = gcs_app::coordinates::position("36°31'N 84°12'W").unwrap();
    window.paste("  36°31'N 84°12'W\n");
    let plan = window.plan();
    let leg = plan.leg(&"leg1".into()).unwrap();
    assert!(transform::places(&plan, leg.leg)[0].distance_m(at) < 0.1);
    // where the pointer is not, and by the name of something
    window.paste("090° 300 m from A");
    let plan = window.plan();
    let a = plan.fix(&"A".into()).unwrap().position;
    let second = transform::places(&plan, plan.leg(&"leg2".into()).unwrap().leg)[0];
    assert!((second.distance_m(a) - 300.0).abs() < 0.1);
}

#[test]
fn what_cannot_be_pasted_is_refused_in_words() {
    let mut window = window();
    let line = |coordinates: &str| {
        format!(
            "<kml><Placemark><LineString><coordinates>{coordinates}</coordinates></LineString></Placemark></kml>"
        )
    };
    for (text, why) in [
        ("x".repeat(50 << 20), "50 MB"),
        ("hello".into(), "neither legs nor a place"),
        ("<html/>".into(), "no flight plan"),
        ("<kml/>".into(), "no point, line or area"),
        ("<kml>".into(), "That KML can't be pasted"),
        (line("abc,def 9.9,46.5"), "line 1: 1 of its coordinates can be read"),
        (format!("<kml>{}</kml>", " ".repeat(5 << 20)), "more than 4 MB"),
    ] {
        window.paste(&text);
        let notice = window.app().view().notice.clone().unwrap_or_default();
        assert!(notice.contains(why), "{notice}");
    }
    assert!(!window.is_enabled("Undo"));
}

#[test]
fn a_drawing_of_another_program_becomes_legs() {
    let mut window = window();
    window.click("TF side2");
    window.paste(include_str!("../../../shared/interchange/tests/fixtures/places.kml"));
    let plan = window.plan();
    let stage = plan.stage(&"circuit".into()).unwrap();
    let kinds: Vec<&str> = stage.legs.iter().map(|leg| gcs_app::panels::tree::leg_tag(&leg.kind)).collect();
    assert_eq!(kinds, ["TF", "TF", "TF", "CORR", "SCAN", "TF", "TF"]);
    assert_eq!(stage.legs[3].name, "Road");
    let flight_plan::LegKind::Scan(scan) = &stage.legs[4].kind else { panic!() };
    assert!(matches!(&scan.area, flight_plan::Area::Polygon { holes, .. } if holes.len() == 1));
    window.click("Undo");
    assert_eq!(legs(&window).len(), 4, "one step");
}

/// It went in between the hold and the final.
#[test]
fn a_mission_goes_before_the_arrival_whatever_of_that_is_selected() {
    let home = r#"<stage id="home" type="arrival"><TF id="hold" fix="D"/><TF id="final" fix="A"/></stage><stage id="land" "#;
    let plan = SQUARE.replacen(r#"<stage id="land" "#, home, 1);
    let mut window = Window::open(&plan);
    window.until_analysed();
    window.click("TF hold");
    window.press(egui::Key::L);
    assert!(window.shows("at the end of circuit") && !window.shows("behind hold"));
    window.press(egui::Key::T);
    assert!(window.shows("Draw legs behind hold"), "a leg of the arrival is drawn there");
    window.press(egui::Key::Escape);
    window.paste(include_str!("../../../shared/interchange/tests/fixtures/places.kml"));
    assert_eq!(legs(&window).len(), 7);
    assert_eq!(window.plan().stage(&"home".into()).unwrap().legs.len(), 2);
    window.click("TF hold");
    window.paste("36°19'N 84°10'W");
    assert_eq!(legs(&window).len(), 8);
}

/// Who clicked a problem of the emergency plan has it selected, and may mean the main plan.
#[test]
fn what_is_pasted_into_an_emergency_plan_is_told() {
    let drawing = include_str!("../../../shared/interchange/tests/fixtures/places.kml");
    let mut window = window();
    window.click("TF side2");
    window.paste(drawing);
    assert_eq!(legs(&window).len(), 7, "into the main plan");
    assert!(!window.shows("Pasted into"));
    window.click("ALT return");
    assert_eq!(window.selected(), "return");
    window.paste(drawing);
    assert!(window.shows("Pasted into emergency plan return > "), "{:?}", window.app().view().notice);
}

#[test]
fn the_map_comes_to_what_is_pasted_out_of_its_view() {
    let mut window = window();
    window.click("TF side4");
    let map = window.harness.get_by_label("Map").rect();
    let route = "-83.1,36.9,0 -83.0,36.95,0";
    window.paste(&format!(
        r#"<kml xmlns="http://www.opengis.net/kml/2.2"><Placemark><name>Road</name><LineString><coordinates>{route}</coordinates></LineString></Placemark></kml>"#
    ));
    window.steps(3);
    let made = window.selected();
    let leg = window.plan().leg(&made.as_str().into()).unwrap().leg.clone();
    assert_eq!(leg.name, "Road");
    for mark in ["Waypoint Road", "Corner 2 of Road"] {
        assert!(map.contains(window.centre(mark)), "{mark}");
    }
}

#[test]
fn stages_are_moved_and_copied_as_one_set() {
    let more = r#"<stage id="more" type="en-route" altitude="150" altitudeReference="home">
        <TF id="m1" lat="36.3150" lon="-84.1900"/><TF id="m2" lat="36.3180" lon="-84.1850"/></stage>
        <stage id="land""#;
    let mut window = Window::open(&SQUARE.replacen(r#"<stage id="land""#, more, 1));
    window.until_analysed();
    window.select_row(("ENR circuit", 0));
    window.steps(2);
    window.select_row_with(("ENR more", 0), egui::Modifiers::COMMAND);
    window.steps(2);
    let before = window.plan();
    let grip = window.centre("Move what is selected");
    window.drag(grip, vec2(-20.0, 15.0));
    let moved = window.plan();
    let places = |plan: &flight_plan::FlightPlan, leg: &str| {
        transform::places(plan, plan.leg(&Id::new(leg)).unwrap().leg)
    };
    for leg in ["side1", "side3", "m1", "m2"] {
        assert_ne!(places(&moved, leg), places(&before, leg), "{leg}");
    }
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
    let text = taken(&mut window, Event::Copy);
    assert!(text.contains("side1") && text.contains("m2"), "{text}");
    assert_eq!(taken(&mut window, Event::Cut), text);
    let cut = window.plan();
    assert_eq!(cut.stages.len(), before.stages.len(), "what is not on the clipboard stays");
    assert!(["circuit", "more"].iter().all(|id| cut.stage(&Id::new(id)).unwrap().legs.is_empty()));
}

#[test]
fn what_is_typed_into_a_field_is_pasted_there() {
    use egui_kittest::kittest::Queryable;
    let mut window = window();
    window.click("TF side1");
    let name = window.harness.get_all_by_role(egui::accesskit::Role::TextInput).next().unwrap();
    name.focus();
    window.steps(1);
    window.paste("36.5, -84.2");
    assert_eq!(legs(&window), ["side1", "side2", "side3", "side4"]);
}

#[test]
fn a_clipboard_too_large_for_a_field_is_refused_in_words() {
    let mut window = Window::open(SQUARE);
    window.press_ctrl(egui::Key::K);
    window.paste(&"x".repeat(50 << 20));
    assert!(window.shows("Nothing was pasted: the clipboard holds 51200 kB"));
}

/// It has no place where the pointer could put it: it leads to its runway from wherever it is needed.
#[test]
fn an_emergency_plan_is_copied_doubled_and_cut() {
    let mut window = window();
    let before = window.plan();
    let ids = |window: &Window| -> Vec<String> {
        window.plan().emergency_plans.iter().map(|plan| plan.id.to_string()).collect()
    };
    let of = ids(&window);
    assert_eq!(of.len(), 1);
    window.click("ALT return");
    let text = taken(&mut window, Event::Copy);
    assert!(text.contains("<emergencyPlan"), "{text}");
    window.paste(&text);
    assert_eq!((ids(&window).len(), window.plan().runways.len()), (2, before.runways.len()));
    assert_eq!(window.selected(), ids(&window)[1], "what was pasted is selected");
    window.press_ctrl(egui::Key::D);
    assert_eq!(ids(&window).len(), 3);
    let text = taken(&mut window, Event::Cut);
    assert!(text.contains("<emergencyPlan") && ids(&window).len() == 2);
    window.click("Undo");
    window.click("Undo");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step each");
}

/// It has no place either: calls put it where it is flown.
#[test]
fn a_procedure_and_a_variable_are_copied_doubled_and_cut() {
    let named = r#"<procedures><procedure id="look" name="Pylon look" reference="36.3205 -84.1650">
        <TF id="up" lat="36.3205" lon="-84.1650"/></procedure></procedures>"#;
    let variables = r#"<variables><variable name="fast" type="number" unit="m/s" initial="24"/></variables>"#;
    let plan = SQUARE.replace("<mainPlan", &format!("{variables}{named}<mainPlan"));
    let mut window = Window::open(&plan);
    window.until_analysed();
    let before = window.plan();
    let counts = |window: &Window| (window.plan().procedures.len(), window.plan().variables.len());
    for (row, tag, one_more) in
        [("PROC Pylon look", "<procedure ", (2, 1)), ("VAR fast", "<variable ", (1, 2))]
    {
        window.select_row((row, 0));
        let text = taken(&mut window, Event::Copy);
        assert!(text.contains(tag), "{text}");
        window.paste(&text);
        assert_eq!(counts(&window), one_more, "{row}");
        window.press_ctrl(egui::Key::D);
        assert_eq!(counts(&window), (2 * one_more.0 - 1, 2 * one_more.1 - 1), "{row}");
        let text = taken(&mut window, Event::Cut);
        assert!(text.contains(tag) && counts(&window) == one_more, "{row}: {text}");
        for _ in 0..3 {
            window.click("Undo");
        }
        assert_eq!(window.plan(), before, "{row}: one step each");
    }
}
