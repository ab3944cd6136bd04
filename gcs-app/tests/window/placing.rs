//! Procedures, emergency plans and variables by hand on the map; what is near is meant; places that are typed.

use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::{Area, Id, LegKind, Place, Value, VariableValue, ZoneShape};
use geometry::LatLon;

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// A window whose plan has a part more before its main plan.
fn with(part: &str) -> Window {
    let mut window = Window::open(&SQUARE.replace("<mainPlan", &format!("{part}<mainPlan")));
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    window
}

const VARIABLE: &str = r#"<variables><variable name="fire" type="position" initial="36.322 -84.168"/><variable name="reach" type="number" unit="m" initial="400"/></variables>"#;

fn type_place(window: &mut Window, text: &str) {
    let field = window.harness.get_by_label("Place to draw");
    field.focus();
    window.steps(2);
    window.harness.get_by_label("Place to draw").type_text(text);
    window.steps(2);
    window.press(Key::Enter);
}

/// Digits went nowhere, and the letters behind them were keys of the window.
#[test]
fn a_place_that_is_typed_after_the_key_of_a_tool_goes_into_its_field() {
    let mut window = window();
    window.press(Key::X);
    for (keys, lat_deg) in [(["3", "6", ".322, -84.168"], 36.322), (["-", "3", "6.322, -84.168"], -36.322)] {
        for text in keys {
            window.harness.event(Event::Text(text.into()));
            window.steps(3);
        }
        window.press(Key::Enter);
        let made = window.plan().fix(&Id::new(&window.selected())).unwrap().position;
        assert!(made.distance_m(LatLon::new(lat_deg, -84.168)) < 1.0, "{made:?}");
        window.press(Key::Escape);
        window.press(Key::Escape);
        window.press(Key::X);
    }
}

#[test]
fn a_procedure_is_placed_by_its_anchor_and_its_bearing() {
    let mut window = window();
    window.harness.get_by_label("TF side2").click_secondary();
    window.steps(3);
    let at = window.harness.get_by_label_contains("Make a procedure of it").rect().center();
    window.click_at(at);
    window.click("TF side4");
    window.press(Key::P);
    let anchor = window.centre("Map") + vec2(60.0, 60.0);
    window.harness.hover_at(anchor);
    window.steps(2);
    assert!(window.shows("Procedure procedure1 behind side4, in Main plan > circuit: click its anchor"));
    window.click_at(anchor);
    window.harness.hover_at(anchor + vec2(80.0, 0.0));
    window.steps(2);
    assert!(window.shows("bearing 090°"));
    window.click_at(anchor + vec2(80.0, 0.0));
    let made = Id::new(&window.selected());
    let LegKind::Call(call) = window.plan().leg(&made).unwrap().leg.kind.clone() else { panic!("no call") };
    assert!(call.anchor.is_some());
    assert!(matches!(call.bearing_deg, Some(Value::Constant(b)) if (89.0..91.0).contains(&b)), "{call:?}");
    window.click("Undo");
    assert!(window.plan().leg(&made).is_none(), "one step");
}

/// The first one, too, which stands where its procedure was drawn: it is dragged to the next pylon.
#[test]
fn a_call_says_of_what_it_is_and_is_dragged_by_its_mark() {
    let own = r#"<TF id="side2" lat="36.3180" lon="-84.1500"/>"#;
    let mut window = Window::open(&SQUARE.replacen(r#"<TF id="side2" fix="B"/>"#, own, 1));
    window.until_analysed();
    window.row_menu(("TF side2", 0), "Make a procedure of it");
    window.press(Key::Escape);
    window.until_analysed();
    let flown = |window: &Window| {
        let forecast = &window.app().analysis().forecast;
        forecast
            .passages
            .iter()
            .find(|p| p.leg.as_str() == "call1.side2")
            .map(|p| forecast.points[p.end - 1].position)
    };
    let before = flown(&window).unwrap();
    assert!(window.paints("call1 of procedure1"), "on the map");
    assert!(!window.places_of(|text| text == "of procedure1").is_empty(), "in its row");
    let mark = window.centre("Waypoint call1");
    window.drag(mark, vec2(40.0, 30.0));
    let plan = window.plan();
    let LegKind::Call(call) = &plan.leg(&"call1".into()).unwrap().leg.kind else { panic!("no call") };
    assert!(matches!(call.anchor, Some(Place::Position(Value::Constant(_)))), "{call:?}");
    assert!(window.centre("Waypoint call1").distance(mark + vec2(40.0, 30.0)) < 3.0);
    window.click("Undo");
    window.until_analysed();
    assert_eq!(flown(&window).map(|at| at.distance_m(before) < 1.0), Some(true), "one step");
}

/// A procedure is changed where it is defined, and wherever it is called.
#[test]
fn the_legs_of_a_procedure_are_dragged_while_it_is_open() {
    let procedure = r#"<procedures><procedure id="look" name="Pylon look" reference="36.3205 -84.1650"><TF id="up" lat="36.3205" lon="-84.1650"/>
        <orbit id="round" radius="150" turns="1"><centre lat="36.3230" lon="-84.1600"/></orbit></procedure></procedures>"#;
    let calls =
        r#"<call id="one" procedure="look"/><call id="two" procedure="look" lat="36.3150" lon="-84.1750"/>"#;
    let plan = SQUARE.replace("<mainPlan", &format!("{procedure}<mainPlan"));
    let mut window = Window::open(&plan.replace(r#"<TF id="side3" fix="C"/>"#, calls));
    window.until_analysed();
    let before = window.plan();
    assert_eq!(window.errors(), Vec::<String>::new());
    let offers = |window: &Window| window.harness.query_by_label("Waypoint up").is_some();
    assert!(!offers(&window) && !window.paints("as it is defined"));
    let flown = |window: &Window, leg: &str| {
        let forecast = &window.app().analysis().forecast;
        let passage = forecast.passages.iter().find(|passage| passage.leg.as_str() == leg).unwrap();
        forecast.points[passage.end - 1].position
    };
    let were = ["one.up", "two.up"].map(|leg| flown(&window, leg));
    window.select_row(("PROC Pylon look", 0));
    window.steps(3);
    assert!(offers(&window) && window.paints("Pylon look, as it is defined"));
    let mark = window.centre("Waypoint up");
    window.drag(mark, vec2(30.0, 25.0));
    assert!(window.centre("Waypoint up").distance(mark + vec2(30.0, 25.0)) < 3.0);
    window.until_analysed();
    for (leg, was) in ["one.up", "two.up"].into_iter().zip(were) {
        assert!(flown(&window, leg).distance_m(was) > 20.0, "{leg}: it follows in each call");
    }
    window.click("Centre of round");
    let rim = window.centre("Radius of round");
    window.drag(rim, vec2(20.0, 0.0));
    let (_, round) =
        window.plan().procedure_leg(&"round".into()).map(|(p, leg)| (p.id.clone(), leg.clone())).unwrap();
    assert!(matches!(round.kind, LegKind::Orbit { radius_m: Value::Constant(metres), .. } if metres > 151.0));
    window.click("Undo");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step each");
    window.press(Key::Escape);
    assert!(!offers(&window), "it is closed with the selection");
}

/// It stood over the map for minutes.
#[test]
fn why_a_click_did_nothing_is_not_said_for_ever() {
    let mut window = window();
    window.press(Key::E);
    let map = window.centre("Map");
    window.click_at(map + vec2(200.0, -200.0));
    assert!(window.shows("Click a runway"));
    window.steps(60 * 21);
    assert!(!window.shows("Click a runway"));
}

#[test]
fn an_emergency_plan_is_drawn_from_the_runway_outwards() {
    let mut window = window();
    let (had, runway) = (window.plan().emergency_plans.len(), window.plan().runways[0].clone());
    window.press(Key::E);
    assert!(window.shows("click the runway"));
    let map = window.centre("Map");
    window.click_at(map + vec2(200.0, -200.0));
    assert!(window.shows("Click a runway"), "there is none");
    window.harness.key_press(Key::M);
    window.steps(2);
    type_place(&mut window, runway.id.as_str());
    let threshold = window.centre("Measure from here");
    window.press(Key::Escape);
    window.press(Key::E);
    window.click_at(threshold);
    assert!(!window.shows("Click a runway"), "one was clicked");
    let far = map + vec2(-150.0, 150.0);
    window.click_at(map + vec2(-60.0, 120.0));
    window.click_at(far);
    window.press(Key::Enter);
    let plan = window.plan();
    assert_eq!(plan.emergency_plans.len(), had + 1);
    let made = plan.emergency_plan(&window.selected().as_str().into()).unwrap();
    let kinds: Vec<&str> = made.stages[0].legs.iter().map(|leg| leg.kind_name()).collect();
    assert_eq!(kinds[..3], ["DF", "TF", "DF"], "from far outside, then in, then the final");
    window.click("Undo");
    assert_eq!(window.plan().emergency_plans.len(), had, "one step");
}

#[test]
fn a_waypoint_that_is_dragged_onto_a_variable_is_that_variable() {
    let mut window = with(VARIABLE);
    window.click("TF side4");
    window.press(Key::T);
    let at = window.centre("Map") + vec2(90.0, 120.0);
    window.click_at(at);
    window.press(Key::V);
    let before = window.plan();
    let variable = window.centre("Place of fire");
    let from = window.centre("Waypoint leg1");
    window.drag(from, variable - from + vec2(3.0, 2.0));
    let place = window.plan().leg(&"leg1".into()).unwrap().leg.place().cloned();
    assert_eq!(place, Some(Place::Position(Value::Expression("fire".into()))));
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

#[test]
fn a_scan_whose_centre_is_dragged_onto_a_variable_is_about_that_variable() {
    let mut window = with(VARIABLE);
    window.click("TF side4");
    window.press(Key::A);
    window.click("circle");
    let at = window.centre("Map") + vec2(90.0, 120.0);
    window.click_at(at);
    window.click_at(at + vec2(60.0, 0.0));
    window.press(Key::V);
    let (before, scan) = (window.plan(), Id::new(&window.selected()));
    let (variable, from) = (window.centre("Place of fire"), window.centre(&format!("Centre of {scan}")));
    window.drag(from, variable - from + vec2(3.0, 2.0));
    let LegKind::Scan(dragged) = window.plan().leg(&scan).unwrap().leg.kind.clone() else {
        panic!("no scan")
    };
    let Area::Circle { centre, .. } = dragged.area else { panic!("no circle") };
    assert_eq!(centre, Place::Position(Value::Expression("fire".into())));
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

#[test]
fn a_number_is_bound_from_the_menu_of_its_leg() {
    let mut window = with(VARIABLE);
    window.click("TF side4");
    window.press(Key::O);
    let at = window.centre("Map") + vec2(60.0, 60.0);
    window.click_at(at);
    window.click_at(at + vec2(90.0, 0.0));
    window.press(Key::V);
    window.harness.get_by_label("ORB orbit1").click_secondary();
    window.steps(3);
    window.click("Bind to a variable");
    window.harness.get_by_role_and_label(Role::Button, "Radius").click();
    window.steps(4);
    window.click("reach");
    let LegKind::Orbit { radius_m, .. } = window.plan().leg(&"orbit1".into()).unwrap().leg.kind.clone()
    else {
        panic!("no orbit")
    };
    assert_eq!(radius_m, Value::Expression("reach".into()));
}

#[test]
fn a_leg_that_is_drawn_on_a_variable_goes_where_it_says() {
    let mut window = with(VARIABLE);
    let at = window.centre("Place of fire");
    window.click("TF side4");
    window.press(Key::T);
    window.harness.hover_at(at + vec2(4.0, 4.0));
    window.steps(2);
    window.click_at(at + vec2(4.0, 4.0));
    let place = window.plan().leg(&"leg1".into()).unwrap().leg.place().cloned();
    assert_eq!(place, Some(Place::Position(Value::Expression("fire".into()))));
    assert_eq!(window.plan().variables[0].initial, with(VARIABLE).plan().variables[0].initial);
}

#[test]
fn a_centre_line_snaps_and_alt_holds_that_off() {
    let mut window = window();
    let runway = window.plan().runways[0].clone();
    window.press(Key::M);
    type_place(&mut window, &format!("{:03.0}° 900 m from {}", runway.heading_deg + 180.0, runway.id));
    let on_line = window.centre("Measure from here");
    window.press(Key::Escape);
    window.press(Key::X);
    let beside = on_line + vec2(4.0, 5.0);
    window.click_at(beside);
    let fix = |window: &Window| window.plan().fix(&window.selected().as_str().into()).unwrap().position;
    let off = |window: &Window| {
        let way = runway.threshold.inverse(fix(window));
        let off_rad = (way.bearing_start_deg - runway.heading_deg).to_radians();
        (way.distance_m * off_rad.sin()).abs()
    };
    assert!(off(&window) < 1.0, "on the line: {}", off(&window));
    window.click("Undo");
    window.harness.key_down_modifiers(Modifiers::ALT, Key::F12);
    for pressed in [true, false] {
        let event = Event::PointerButton {
            pos: beside,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::ALT,
        };
        window.harness.event_modifiers(event, Modifiers::ALT);
        window.steps(1);
    }
    window.harness.key_up(Key::F12);
    window.steps(2);
    assert!(off(&window) > 2.0, "beside it: {}", off(&window));
}

/// What is drawn beside a thing is drawn on it, and it says so before the click.
#[test]
fn corners_waypoints_and_both_ends_of_a_runway_snap() {
    let zone = r#"<zones><keepOut id="wood"><corner lat="36.300" lon="-84.170"/><corner lat="36.300" lon="-84.165"/><corner lat="36.304" lon="-84.165"/></keepOut></zones>"#;
    let mut window = with(zone);
    window.click("TF side4");
    window.press(Key::T);
    let at = window.centre("Map") + vec2(90.0, 120.0);
    window.click_at(at);
    window.press(Key::V);
    let plan = window.plan();
    let runway = plan.runways[0].clone();
    let end = runway.threshold.destination(runway.heading_deg, runway.length_m);
    let ZoneShape::Polygon(corners) = &plan.zones[0].shape else { panic!("no polygon") };
    let Some(Place::Position(Value::Constant(leg))) = plan.leg(&"leg1".into()).unwrap().leg.place().cloned()
    else {
        panic!("no position")
    };
    for (what, place) in [
        ("Corner 2 of wood", corners[1]),
        ("Waypoint leg1", leg),
        ("threshold of R05", runway.threshold),
        ("end of R05", end),
    ] {
        window.press(Key::M);
        type_place(&mut window, &format!("{}, {}", place.lat_deg, place.lon_deg));
        let on = window.centre("Measure from here");
        window.press(Key::Escape);
        window.press(Key::X);
        let beside = on + vec2(5.0, 4.0);
        window.harness.hover_at(beside);
        window.steps(2);
        assert!(window.paints(what), "{what}");
        window.click_at(beside);
        let made = window.plan().fix(&window.selected().as_str().into()).unwrap().position;
        assert!(made.distance_m(place) < 0.1, "{what}: {} m", made.distance_m(place));
        window.press(Key::Escape);
        window.click("Undo");
    }
}

#[test]
fn places_are_typed_into_the_tool_by_bearing_and_distance_too() {
    let mut window = window();
    window.click("TF side4");
    window.press(Key::T);
    type_place(&mut window, "A");
    let place = window.plan().leg(&"leg1".into()).unwrap().leg.place().cloned();
    assert_eq!(place, Some(Place::Fix("A".into())));
    type_place(&mut window, "045° 800 m");
    let plan = window.plan();
    let from = plan.fix(&"A".into()).unwrap().position;
    let Some(Place::Position(Value::Constant(to))) = plan.leg(&"leg2".into()).unwrap().leg.place().cloned()
    else {
        panic!("no position")
    };
    assert!((from.distance_m(to) - 800.0).abs() < 0.5 && (from.bearing_deg(to) - 45.0).abs() < 0.01);
    type_place(&mut window, "nowhere at all");
    assert!(window.shows("is no place that can be read"));
}

#[test]
fn a_zone_gets_its_altitudes_while_it_is_drawn() {
    let mut window = window();
    window.press(Key::Z);
    window.click("circle");
    window.click("Ceiling");
    let at = window.centre("Map") + vec2(60.0, 60.0);
    window.click_at(at);
    window.click("Floor");
    window.click_at(at + vec2(60.0, 0.0));
    let zone = window.plan().zones[0].clone();
    let metres = |limit: &Option<flight_plan::Altitude>| limit.as_ref().map(|a| a.metres.clone());
    assert_eq!(metres(&zone.floor), Some(Value::Constant(0.0)));
    assert_eq!(metres(&zone.ceiling), Some(Value::Constant(120.0)));
    assert!(matches!(zone.shape, ZoneShape::Circle { .. }));
}

#[test]
fn what_cannot_be_flown_is_said_while_it_is_drawn() {
    let mut window = window();
    window.click("TF side4");
    window.press(Key::T);
    let at = window.centre("Map") + vec2(60.0, 60.0);
    window.harness.hover_at(at);
    window.steps(2);
    assert!(window.shows("Draw legs behind side4"));
    window.click_at(at);
    window.harness.hover_at(at + vec2(90.0, 40.0));
    window.steps(3);
    assert!(window.shows("Next leg: ") && !window.shows("can't be flown"));
    let p = gcs_app::theme::palette(true);
    let lines = |window: &Window| [p.warning, p.accent].map(|colour| window.lines_within("Map", colour));
    let [red, drawn] = lines(&window);
    assert_eq!(red, 0);
    // an arc so small that the aircraft can't turn
    super::drawing::choose(&mut window, "Kind: ", "RF arc to a fix");
    window.harness.hover_at(at + vec2(14.0, 14.0));
    window.steps(3);
    assert!(window.shows("can't be flown"));
    assert!(lines(&window)[0] > 0 && lines(&window)[1] < drawn, "it is red, and no path is drawn");
}

#[test]
fn a_pointer_at_rest_is_no_leg_and_no_circle() {
    let mut window = window();
    window.click("TF side4");
    window.press(Key::T);
    let at = window.centre("Map") + vec2(60.0, 60.0);
    window.click_at(at);
    window.until_analysed();
    window.steps(2);
    assert!(window.shows("click where to fly next") && !window.shows("can't be flown"));
    window.press(Key::Escape);
    window.press(Key::O);
    window.click_at(at + vec2(-90.0, 40.0));
    assert!(window.shows("click the rim") && !window.shows("can't be flown"));
}

#[test]
fn a_dragged_variable_moves_alone() {
    let mut window = with(VARIABLE);
    let at = window.centre("Place of fire");
    window.drag(at, vec2(40.0, 30.0));
    let VariableValue::Position(to) = window.plan().variables[0].initial.clone() else { panic!("no place") };
    assert!(to.lat_deg < 36.322 && to.lon_deg > -84.168);
    window.click("Undo");
    assert!(!window.is_enabled("Undo"));
}

/// It got a copy of the place, and only identifiers were known.
#[test]
fn a_name_that_is_typed_binds_as_a_click_on_the_thing_does() {
    let mut window = with(VARIABLE);
    window.press(Key::T);
    type_place(&mut window, "Fire");
    let place = |window: &Window| {
        let plan = window.plan();
        plan.leg(&Id::new(&window.selected())).unwrap().leg.place().cloned()
    };
    assert_eq!(place(&window), Some(Place::Position(Value::Expression("fire".into()))));
    type_place(&mut window, "a");
    assert_eq!(place(&window), Some(Place::Fix("A".into())));
}
