//! One area, zone or runway that is moved as a set is, the ends of a runway, and sets with runways and the places of variables.

use super::handles::sweep;
use super::{SQUARE, Window};
use egui::{Pos2, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::{Area, FlightPlan, LegKind, Place, Runway, Scan, Value, VariableValue, ZoneShape};
use gcs_app::command::Selection;
use geometry::LatLon;
use geometry::geodesy::normalise_180;

const MOVE: &str = "Move what is selected";
const TURN: &str = "Turn what is selected";
const SCALE: &str = "Scale what is selected";

/// The square with a scan, two zones, an area that is a variable, and a place that is one, to which a leg goes.
fn window() -> Window {
    let ring = |lat: f64, lon: f64| {
        let places = [(0.0, 0.0), (0.0, 0.004), (0.003, 0.004)].map(|(n, e)| (lat + n, lon + e));
        let corner = |(lat, lon)| format!(r#"<corner lat="{lat:.6}" lon="{lon:.6}"/>"#);
        (places.map(corner).concat(), places.map(|(lat, lon)| format!("{lat:.6} {lon:.6}")).join(", "))
    };
    let zones = format!(
        r#"<zones><keepOut id="quarry">{}</keepOut><keepIn id="field">{}</keepIn><keepOut id="mast" lat="36.3155" lon="-84.1560" radius="150"/></zones>"#,
        ring(36.3240, -84.1850).0,
        ring(36.3245, -84.1780).0
    );
    let variables = format!(
        r#"<variables><variable name="burnt" type="polygon" initial="{}"/><variable name="spot" type="position" initial="36.3170 -84.1745"/></variables>"#,
        ring(36.3080, -84.1640).1
    );
    let scan = format!(
        r#"<TF id="to_spot" at="= spot"/><scan id="meadow" spacing="60" heading="40"><area>{}</area></scan></stage><stage id="land""#,
        ring(36.3120, -84.1680).0
    );
    let plan = SQUARE.replacen("<mainPlan", &format!("{zones}{variables}<mainPlan"), 1).replacen(
        r#"</stage>
    <stage id="land""#,
        &scan,
        1,
    );
    let mut window = Window::open_with(&plan, vec2(1280.0, 1000.0), None);
    window.until_analysed();
    assert!(window.plan().leg(&"meadow".into()).is_some() && window.plan().zones.len() == 3);
    window
}

/// As a screen reader does: what begins there lies over it.
fn select_runway(window: &mut Window) {
    window.harness.get_by_label("Runway R05").click_accesskit();
    window.steps(4);
    assert_eq!(window.selected(), "R05");
}

/// The outline of what is selected alone.
fn corners(plan: &FlightPlan, what: &str) -> Vec<LatLon> {
    let zone = plan.zone(&what.into()).map(|zone| &zone.shape);
    let variable = plan.variable(&what.into()).map(|variable| &variable.initial);
    let leg = plan.leg(&what.into()).map(|context| &context.leg.kind);
    match (zone, variable, leg) {
        (Some(ZoneShape::Polygon(corners)), ..) | (_, Some(VariableValue::Polygon(corners)), _) => {
            corners.clone()
        }
        (.., Some(LegKind::Scan(Scan { area: Area::Polygon { corners, .. }, .. }))) => corners.clone(),
        other => panic!("{what} has no corners: {other:?}"),
    }
}

/// How long and in which direction each edge is.
fn edges(corners: &[LatLon]) -> Vec<(f64, f64)> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(from, to)| (from.distance_m(*to), from.bearing_deg(*to))).collect()
}

#[test]
fn one_area_is_moved_turned_and_scaled_by_the_handles_of_a_set() {
    let mut window = window();
    for (row, what) in
        [("SCAN meadow", "meadow"), ("OUT quarry", "quarry"), ("IN field", "field"), ("VAR burnt", "burnt")]
    {
        window.select_row((row, 0));
        window.steps(4);
        assert_eq!(window.selected(), what);
        let plan = window.plan();
        let before = edges(&corners(&plan, what));
        for (grip, by, turns, scales) in [
            (MOVE, vec2(24.0, 15.0), false, false),
            (TURN, vec2(40.0, 40.0), true, false),
            (SCALE, vec2(25.0, 20.0), false, true),
        ] {
            let at = window.centre(grip);
            window.drag(at, by);
            let after = corners(&window.plan(), what);
            assert_ne!(after, corners(&plan, what), "{what}: {grip}");
            let change: Vec<(f64, f64)> = edges(&after)
                .iter()
                .zip(&before)
                .map(|(is, was)| (is.0 / was.0, normalise_180(is.1 - was.1)))
                .collect();
            for (scale, turn_deg) in &change {
                assert!((scale - change[0].0).abs() < 1e-3, "{what} keeps its shape: {change:?}");
                assert!(if scales { *scale > 1.05 } else { (scale - 1.0).abs() < 1e-3 }, "{change:?}");
                assert!(if turns { *turn_deg > 5.0 } else { turn_deg.abs() < 0.05 }, "{change:?}");
            }
            window.click("Undo");
            assert_eq!(window.plan(), plan, "one step");
        }
    }
}

#[test]
fn a_circle_is_not_turned_and_a_runway_never_scaled() {
    let mut window = window();
    window.select_row(("OUT mast", 0));
    window.steps(4);
    assert!(window.shows(MOVE) && window.shows(SCALE) && !window.shows(TURN));
    select_runway(&mut window);
    assert!(window.shows(MOVE) && window.shows(TURN) && !window.shows(SCALE));
    window.click("Fix A");
    window.steps(4);
    assert!(!window.shows(MOVE), "a place has no extent");
}

/// Its middle and its radius are two variables.
#[test]
fn a_circle_that_variables_say_is_moved_and_scaled_by_them() {
    let text = include_str!("../../../assets/plans/fire-watch.xml");
    let mut window = Window::open_with(text, vec2(1280.0, 1000.0), None);
    window.until_analysed();
    let plan = window.plan();
    let said = |plan: &FlightPlan, name: &str| plan.variable(&name.into()).unwrap().initial.clone();
    let is_circle = |leg: &flight_plan::Leg| match &leg.kind {
        LegKind::Scan(Scan { area: Area::Circle { .. }, .. }) => Some(leg.id.clone()),
        _ => None,
    };
    let scan = plan.all_legs().iter().find_map(|context| is_circle(context.leg)).unwrap();
    window.select_row((&format!("SCAN {}", plan.label(&scan)), 0));
    window.steps(4);
    assert_eq!(window.selected(), scan.as_str());
    for (grip, changes, stays) in
        [(MOVE, "fire_centre", "fire_radius"), (SCALE, "fire_radius", "fire_centre")]
    {
        let at = window.centre(grip);
        window.drag(at, vec2(14.0, 11.0));
        let after = window.plan();
        assert_ne!(said(&after, changes), said(&plan, changes));
        match (said(&after, stays), said(&plan, stays)) {
            (VariableValue::Position(is), VariableValue::Position(was)) => assert!(is.distance_m(was) < 1.0),
            (is, was) => assert_eq!(is, was),
        }
        window.click("Undo");
        assert_eq!(window.plan(), plan, "one step");
    }
}

fn altitudes(plan: &FlightPlan) -> Vec<Option<flight_plan::Altitude>> {
    plan.all_legs().iter().map(|context| context.leg.altitude.clone()).collect()
}

#[test]
fn a_runway_is_moved_and_turned_as_it_is_and_with_its_other_direction() {
    let mut window = window();
    select_runway(&mut window);
    window.click("Add its other direction");
    select_runway(&mut window);
    let plan = window.plan();
    for (grip, by) in [(MOVE, vec2(30.0, -12.0)), (TURN, vec2(40.0, 40.0))] {
        let at = window.centre(grip);
        window.drag(at, by);
        let after = window.plan();
        for (was, is) in plan.runways.iter().zip(&after.runways) {
            assert!(was.threshold.distance_m(is.threshold) > 10.0, "{grip}: {}", is.id);
            assert_eq!((was.length_m, was.elevation_amsl_m), (is.length_m, is.elevation_amsl_m));
            assert_eq!(grip == TURN, (was.heading_deg - is.heading_deg).abs() > 1.0);
        }
        assert!(after.opposite(&after.runways[0]).is_some(), "it is one strip");
        assert_eq!(altitudes(&after), altitudes(&plan));
        window.click("Undo");
        assert_eq!(window.plan(), plan, "one step");
    }
}

fn runway(window: &Window) -> Runway {
    window.plan().runways[0].clone()
}

#[test]
fn the_ends_of_a_selected_runway_are_dragged_and_say_how_it_lies() {
    let mut window = window();
    assert!(!window.shows("End of R05"), "only those of the selected one");
    select_runway(&mut window);
    let plan = window.plan();
    let was = runway(&window);
    let far_end = |runway: &Runway| runway.from_other_end().threshold;
    let from = window.centre("End of R05");
    let to = from + vec2(20.0, 14.0);
    window.harness.hover_at(from);
    window.harness.drag_at(from);
    for part in 1..=4 {
        window.harness.hover_at(from + (to - from) * (part as f32 / 4.0));
        window.steps(2);
    }
    let is = runway(&window);
    assert_eq!((is.threshold, is.elevation_amsl_m), (was.threshold, was.elevation_amsl_m));
    assert!((is.heading_deg - was.heading_deg).abs() > 3.0 && is.length_m != was.length_m, "{is:?}");
    let said = format!("{:.0} m · {:03.0}°", is.length_m, is.heading_deg);
    assert!(window.paints(&said), "{said} is said meanwhile");
    window.harness.drop_at(to);
    window.steps(3);
    assert!(window.centre("End of R05").distance(to) < 2.0, "it is where the pointer left it");
    assert_eq!(altitudes(&window.plan()), altitudes(&plan));
    window.click("Undo");
    assert_eq!(window.plan(), plan, "one step");
    let threshold = window.centre("Threshold of R05");
    window.drag(threshold, vec2(-18.0, 16.0));
    let is = runway(&window);
    assert!(is.threshold.distance_m(was.threshold) > 20.0 && is.length_m != was.length_m);
    assert!(far_end(&is).distance_m(far_end(&was)) < 1.0, "its end stays");
    window.click("Undo");
    assert_eq!(window.plan(), plan, "one step");
    window.press_ctrl(egui::Key::L);
    let threshold = window.centre("Threshold of R05");
    window.drag(threshold, vec2(-18.0, 16.0));
    assert_eq!(window.plan(), plan, "the map is locked");
}

#[test]
fn a_box_takes_runways_and_places_of_variables_and_moves_them_as_one() {
    let mut window = window();
    let ends: Vec<Pos2> = {
        select_runway(&mut window);
        ["Threshold of R05", "End of R05", "Variable spot"].map(|name| window.centre(name)).to_vec()
    };
    window.press(egui::Key::Escape);
    let around = egui::Rect::from_points(&ends).expand(8.0);
    sweep(&mut window, around.left_top(), around.right_bottom());
    let view = window.app().view();
    let selected: Vec<&Selection> = view.selection.iter().chain(&view.also).collect();
    let wanted = [Selection::Runway("R05".into()), Selection::Variable("spot".into())];
    assert!(wanted.iter().all(|what| selected.contains(&what)), "{selected:?}");
    let plan = window.plan();
    let spot = |plan: &FlightPlan| match plan.variable(&"spot".into()).unwrap().initial {
        VariableValue::Position(at) => at,
        ref other => panic!("{other:?}"),
    };
    let at = window.centre(MOVE);
    window.drag(at, vec2(30.0, 20.0));
    let after = window.plan();
    let (was, is) = (&plan.runways[0], &after.runways[0]);
    let way = |from: LatLon, to: LatLon| (from.distance_m(to), from.bearing_deg(to));
    let (of_runway, of_spot) = (way(was.threshold, is.threshold), way(spot(&plan), spot(&after)));
    assert!(of_runway.0 > 50.0 && (of_runway.0 - of_spot.0).abs() < 0.1, "{of_runway:?} {of_spot:?}");
    assert!((of_runway.1 - of_spot.1).abs() < 0.1);
    let to_spot = after.leg(&"to_spot".into()).unwrap().leg.place().cloned();
    assert_eq!(to_spot, Some(Place::Position(Value::Expression("spot".into()))), "and the leg with it");
    window.click("Undo");
    assert_eq!(window.plan(), plan, "one step");
    window.press(egui::Key::Delete);
    let left = window.plan();
    assert!(left.runway(&"R05".into()).is_none() && left.variable(&"spot".into()).is_none());
    window.click("Undo");
    assert_eq!(window.plan(), plan, "one step");
}
