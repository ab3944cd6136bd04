//! What is written is read again: the same waypoints, within 1e-7 degrees and 0.1 m.
#![cfg(test)]

mod made;
#[path = "made/survey.rs"]
mod survey;

use flight_exec::Action;
use flight_plan::{
    Act, Altitude, AltitudeReference, FlightPlan, Leg, LegAction, LegKind, Pattern, Place, Runway, Scan,
    ScanEntry, ScanStyle, Spacing, Stage, StageKind, Trigger, Value, Zone, ZoneKind, ZoneShape,
};
use geometry::LatLon;
use interchange::{Assumptions, Export, Format, Import, Step, read, write};
use made::{RUNWAY, leg, plan, step, to};
use proptest::prelude::*;
use std::sync::Arc;
use survey::{scan_over, triangle};

/// Formats that hold a path.
const PATHS: [Format; 6] =
    [Format::Plan, Format::Waypoints, Format::Kml, Format::Kmz, Format::GeoJson, Format::Gpx];

/// Waypoints of the legs that were read: position, metres AMSL and speed.
fn flown(import: &Import) -> Vec<(LatLon, f64, Option<f64>)> {
    fn walk(legs: &[Arc<Leg>], into: &mut Vec<(LatLon, f64, Option<f64>)>) {
        for leg in legs {
            let (LegKind::Tf(to) | LegKind::Df { to, .. }) = &leg.kind else { panic!("{leg:?}") };
            let Place::Position(Value::Constant(position)) = &to.place else { panic!("{to:?}") };
            let Some(Altitude { metres: Value::Constant(metres), reference }) = &leg.altitude else {
                panic!("{leg:?}")
            };
            assert_eq!(*reference, AltitudeReference::Amsl);
            let speed =
                leg.speed_mps.as_ref().map(|s| if let Value::Constant(s) = s { *s } else { panic!("{s:?}") });
            into.push((*position, *metres, speed));
        }
    }
    let mut all = Vec::new();
    import.plan.stages.iter().for_each(|s| walk(&s.legs, &mut all));
    all
}

fn again(format: Format, plan: &FlightPlan, steps: &[Step]) -> Import {
    let written = write(format, &Export { plan, steps }).unwrap();
    read(format, &written.bytes, &Assumptions::default()).unwrap()
}

fn near(a: LatLon, b: LatLon) -> bool {
    let lon_deg = (a.lon_deg - b.lon_deg).abs();
    (a.lat_deg - b.lat_deg).abs() <= 1e-7 && lon_deg.min(360.0 - lon_deg) <= 1e-7
}

fn position() -> impl Strategy<Value = LatLon> {
    // anywhere but 0/0, which means "here" in a mission
    (-89.9..=89.9f64, prop_oneof![-180.0..=180.0f64, Just(180.0), Just(-180.0)])
        .prop_map(|(lat, lon)| LatLon::new(lat, lon))
        .prop_filter("here", |p| p.lat_deg != 0.0 || p.lon_deg != 0.0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]
    #[test]
    fn waypoints_come_back(points in prop::collection::vec((position(), -400.0..9000.0f64, 5.0..60.0f64), 2..20)) {
        let legs: Vec<Leg> = points.iter().enumerate().map(|(i, p)| leg(&format!("w{i}"), LegKind::Tf(to(p.0)))).collect();
        let steps: Vec<Step> = points
            .iter()
            .enumerate()
            .map(|(i, (at, altitude_m, speed_mps))| step(&format!("w{i}"), i, *at, *altitude_m, *speed_mps, Action::Fly))
            .collect();
        let plan = plan(legs);
        for format in PATHS {
            let import = again(format, &plan, &steps);
            let found = flown(&import);
            prop_assert_eq!(found.len(), points.len(), "{:?}", format);
            for (found, (at, altitude_m, speed_mps)) in found.iter().zip(&points) {
                prop_assert!(near(found.0, *at), "{:?}: {:?} {:?}", format, found, at);
                prop_assert!((found.1 - altitude_m).abs() < 0.1, "{:?}: {:?} {}", format, found, altitude_m);
                if matches!(format, Format::Plan | Format::Waypoints) {
                    // what differs by less is not worth an item
                    prop_assert!((found.2.unwrap() - speed_mps).abs() < 0.051, "{:?}: {:?} {}", format, found, speed_mps);
                }
            }
            let document = flight_plan::read(flight_plan::write(&import.plan));
            prop_assert_eq!(&document.plan, &import.plan, "{:?}", format);
        }
    }
}

#[test]
fn take_off_and_landing_come_back_as_stages() {
    let way = LatLon::new(36.33, -84.16);
    let steps = [
        step("to", 0, RUNWAY.destination(52.0, 800.0), 429.0, 25.0, Action::TakeOff { heading_deg: 52.0 }),
        step("w", 1, way, 500.0, 25.0, Action::Fly),
        step("l", 2, RUNWAY, 349.0, 25.0, Action::Land { heading_deg: 52.0 }),
    ];
    let plan = plan(vec![leg("w", LegKind::Tf(to(way)))]);
    for format in PATHS {
        let import = again(format, &plan, &steps);
        let kinds: Vec<_> = import.plan.stages.iter().map(|s| s.kind).collect();
        assert_eq!((kinds.len(), kinds[0], kinds[2]), (3, StageKind::TakeOff, StageKind::Land), "{format:?}");
        assert_eq!(import.plan.runways.len(), 1, "{format:?}");
        let runway = &import.plan.runways[0];
        // where a format holds no direction, it is the take-off's
        assert!(near(runway.threshold, RUNWAY), "{format:?}: {runway:?}");
        assert!((runway.heading_deg - 52.0).abs() < 1e-3, "{format:?}: {runway:?}");
        assert_eq!(runway.elevation_amsl_m, 349.0);
        // another runway takes over both ends
        let other = Runway { id: "OTHER".into(), heading_deg: 90.0, ..plan.runways[0].clone() };
        let assumptions = Assumptions { runway: Some(other), ..Assumptions::default() };
        let written = write(format, &Export { plan: &plan, steps: &steps }).unwrap();
        let stages = read(format, &written.bytes, &assumptions).unwrap().plan.stages;
        let runways: Vec<_> = stages.iter().filter_map(|s| s.runway.as_ref()).map(|r| r.as_str()).collect();
        assert_eq!((stages.len(), runways), (3, vec!["OTHER", "OTHER"]), "{format:?}");
    }
}

#[test]
fn runways_fixes_and_zones_come_back_from_drawings() {
    let mut plan = plan(vec![]);
    let fix = |id: &str, name: &str, description: &str| flight_plan::Fix {
        id: id.into(),
        position: LatLon::new(36.4, -84.2),
        name: name.into(),
        description: description.into(),
    };
    plan.fixes =
        vec![fix("GAP", "", "gate"), fix("MILL", "The <old> mill", "seen from far"), fix("X", "Ex", "")];
    plan.runways.push(Runway {
        id: "R23".into(),
        priority: 3,
        approach_entry: Some(LatLon::new(36.35, -84.125)),
        ..plan.runways[0].clone()
    });
    let zone = |id: &str, kind, shape| Zone {
        id: id.into(),
        name: String::new(),
        kind,
        shape,
        floor: None,
        ceiling: None,
        active: Vec::new(),
    };
    let square =
        [(36.2, -84.4), (36.2, -84.0), (36.5, -84.0), (36.5, -84.4)].map(|(lat, lon)| LatLon::new(lat, lon));
    plan.zones.push(zone("field", ZoneKind::KeepIn, ZoneShape::Polygon(square.to_vec())));
    let centre = LatLon::new(36.35, -84.1);
    plan.zones.push(zone("town", ZoneKind::KeepOut, ZoneShape::Circle { centre, radius_m: 1234.5 }));
    for format in [Format::Kml, Format::Kmz, Format::GeoJson] {
        let found = again(format, &plan, &[]).plan;
        assert_eq!((&found.runways, &found.zones), (&plan.runways, &plan.zones), "{format:?}");
        assert_eq!(found.fixes, plan.fixes, "{format:?}");
    }
    assert_eq!(again(Format::Gpx, &plan, &[]).plan.fixes, plan.fixes);
    let found = again(Format::Plan, &plan, &[]).plan;
    let shapes = |plan: &FlightPlan| plan.zones.iter().map(|z| (z.kind, z.shape.clone())).collect::<Vec<_>>();
    assert_eq!(shapes(&found), shapes(&plan));
}

#[test]
fn surveys_and_corridors_come_back_as_patterns() {
    let corners = triangle();
    let series = |every_m| LegAction {
        trigger: Trigger::Start,
        act: Act::PhotoSeries { every_m: Value::Constant(every_m) },
    };
    let stop = LegAction { trigger: Trigger::End, act: Act::PhotoStop };
    let altitude = Some(Altitude { metres: Value::Constant(120.0), reference: AltitudeReference::Agl });
    let scan = Scan { style: ScanStyle::CrissCross, ..scan_over(&corners) };
    let corridor = Pattern::Corridor {
        route: corners.iter().map(|c| Place::Position(Value::Constant(*c))).collect(),
        width_m: Value::Constant(90.0),
        spacing: Spacing::Metres(Value::Constant(30.0)),
    };
    let mut legs = vec![leg("survey", LegKind::Scan(scan)), leg("corridor", LegKind::Pattern(corridor))];
    legs[0].altitude = altitude.clone();
    legs[1].altitude = altitude;
    legs[0].actions = vec![series(25.0), stop.clone()];
    let steps: Vec<Step> = ["survey", "survey", "corridor", "corridor"]
        .iter()
        .enumerate()
        .map(|(i, id)| step(id, i / 2, corners[i % 3], 500.0, 25.0, Action::Fly))
        .collect();
    let plan = plan(legs.clone());
    let written = write(Format::Plan, &Export { plan: &plan, steps: &steps }).unwrap();
    assert!(written.notes.iter().all(|n| n.code != "flattened"), "{:?}", written.notes);
    // QGC has its own way of finding a corner
    assert!(
        written.notes.iter().any(|n| n.code == "entry-point" && n.place == "survey"),
        "{:?}",
        written.notes
    );
    let found = read(Format::Plan, &written.bytes, &Assumptions::default()).unwrap().plan;
    for (wanted, found) in legs.iter().zip(&found.stages[0].legs) {
        assert_eq!(
            (&wanted.kind, &wanted.altitude, &wanted.actions),
            (&found.kind, &found.altitude, &found.actions)
        );
    }
    // the items that fly them are in the file, numbered on
    let json: serde_json::Value = serde_json::from_slice(&written.bytes).unwrap();
    let items = json["mission"]["items"].as_array().unwrap();
    let inside = items[1]["TransectStyleComplexItem"]["Items"].as_array().unwrap();
    let commands: Vec<_> = inside.iter().map(|i| i["command"].as_u64().unwrap()).collect();
    // QGC makes them anew, and would forget the speed
    assert_eq!((commands, items[0]["command"].as_u64()), (vec![206, 16, 16, 206], Some(178)));
    assert_eq!(items[2]["TransectStyleComplexItem"]["Items"][0]["doJumpId"], 6);
}

fn surveyed(leg: &Leg, stage_altitude: Option<Altitude>) -> (interchange::Written, FlightPlan) {
    let mut plan = plan(vec![leg.clone()]);
    plan.stages[1].altitude = stage_altitude;
    let steps = triangle().map(|at| step("survey", 0, at, 500.0, 21.0, Action::Fly));
    let written = write(Format::Plan, &Export { plan: &plan, steps: &steps }).unwrap();
    let found = read(Format::Plan, &written.bytes, &Assumptions::default()).unwrap().plan;
    (written, found)
}

#[test]
fn a_survey_takes_the_altitude_of_its_stage_along() {
    let leg = leg("survey", LegKind::Scan(scan_over(&triangle())));
    let level = |metres| Some(Altitude { metres, reference: AltitudeReference::Amsl });
    let (_, found) = surveyed(&leg, level(Value::Constant(500.0)));
    assert_eq!(found.stages[0].legs[0].altitude, level(Value::Constant(500.0)));
    for unknown in [None, level(Value::Expression("height".into()))] {
        let (written, found) = surveyed(&leg, unknown);
        assert!(written.notes.iter().any(|n| n.code == "flattened"), "{:?}", written.notes);
        assert!(found.stages[0].legs.iter().all(|l| matches!(l.kind, LegKind::Tf(_) | LegKind::Df { .. })));
    }
}

#[test]
fn speed_and_video_of_a_survey_come_back() {
    let mut leg = leg("survey", LegKind::Scan(scan_over(&triangle())));
    let video = |trigger, act| LegAction { trigger, act };
    leg.actions = vec![video(Trigger::Start, Act::VideoStart), video(Trigger::End, Act::VideoStop)];
    let height = Altitude { metres: Value::Constant(120.0), reference: AltitudeReference::Agl };
    let (written, found) = surveyed(&leg, Some(height));
    // QGC refuses a pattern above terrain without it
    let json: serde_json::Value = serde_json::from_slice(&written.bytes).unwrap();
    let pattern = json["mission"]["items"].as_array().unwrap().iter().find(|i| i["type"] == "ComplexItem");
    let transect = &pattern.unwrap()["TransectStyleComplexItem"];
    for (key, value) in [("Tolerance", 10.0), ("MaxClimbRate", 0.0), ("MaxDescentRate", 0.0)]
        .map(|(k, v)| (format!("TerrainAdjust{k}"), v))
    {
        assert_eq!(transect[&key], value, "{key}");
    }
    let found = &found.stages[0].legs[0];
    assert_eq!((&found.speed_mps, &found.actions), (&Some(Value::Constant(21.0)), &leg.actions));
}

#[test]
fn what_qgc_has_no_word_for_is_told() {
    let mut scan = scan_over(&triangle());
    scan.entry = ScanEntry::Nearest;
    scan.spacing = Spacing::Camera {
        field_of_view_deg: Value::Constant(60.0),
        overlap: Value::Constant(0.7),
        height_m: Some(Value::Constant(120.0)),
    };
    let height = Altitude { metres: Value::Constant(120.0), reference: AltitudeReference::Agl };
    let (written, _) = surveyed(&leg("survey", LegKind::Scan(scan)), Some(height));
    let codes: Vec<_> = written.notes.iter().map(|n| n.code).collect();
    assert!(codes.contains(&"camera") && codes.contains(&"entry-point"), "{codes:?}");
}

/// Approach and touch-down as one pattern; emergency plans as rally points.
#[test]
fn landings_and_rally_points_of_a_qgc_plan() {
    let (far, gate) = (LatLon::new(36.33, -84.16), LatLon::new(36.315, -84.18));
    let mut plan = plan(vec![leg("far", LegKind::Tf(to(far))), leg("gate", LegKind::Tf(to(gate)))]);
    let mut way = leg("out", LegKind::Df { to: to(far), turn: None });
    way.altitude = Some(Altitude { metres: Value::Constant(500.0), reference: AltitudeReference::Amsl });
    let mut arrival = plan.stages[1].clone();
    (arrival.id, arrival.kind, arrival.legs) = ("e".into(), StageKind::Arrival, vec![way.into()]);
    let emergency = |legs: Stage| flight_plan::EmergencyPlan {
        id: "out".into(),
        name: String::new(),
        runway: "R05".into(),
        stages: vec![legs],
    };
    plan.emergency_plans.push(emergency(arrival));
    let steps = [
        step("far", 0, far, 500.0, 25.0, Action::Fly),
        step("gate", 1, gate, 420.0, 25.0, Action::Fly),
        step("l", 2, RUNWAY, 349.0, 25.0, Action::Land { heading_deg: 52.0 }),
    ];
    let written = write(Format::Plan, &Export { plan: &plan, steps: &steps }).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&written.bytes).unwrap();
    let items = json["mission"]["items"].as_array().unwrap();
    let kinds: Vec<_> = items.iter().map(|i| i["complexItemType"].as_str().unwrap_or("item")).collect();
    assert_eq!(kinds, ["item", "item", "fwLandingPattern"]);
    assert_eq!(json["rallyPoints"]["points"], serde_json::json!([[36.33, -84.16, 151.0]]));
    let found = read(Format::Plan, &written.bytes, &Assumptions::default()).unwrap().plan;
    let amsl = |m| Some(Altitude { metres: Value::Constant(m), reference: AltitudeReference::Amsl });
    let legs = &found.stages[0].legs;
    assert_eq!((legs.len(), &legs[1].altitude), (2, &amsl(420.0)));
    assert!(near(found.runways[0].threshold, RUNWAY) && found.runways[0].elevation_amsl_m == 349.0);
    let emergency = &found.emergency_plans[0].stages[0].legs[0];
    assert_eq!(
        (&emergency.kind, &emergency.altitude),
        (&LegKind::Df { to: to(far), turn: None }, &amsl(500.0))
    );
}

#[test]
fn actions_and_waits_are_items() {
    let at = LatLon::new(36.33, -84.15);
    let mut way = leg("w", LegKind::Tf(to(at)));
    let action = |trigger, act| LegAction { trigger, act };
    way.actions = vec![
        action(Trigger::Every(Value::Constant(30.0)), Act::Photo),
        action(Trigger::Start, Act::VideoStart),
        action(Trigger::End, Act::Wait { seconds: Value::Constant(20.0) }),
        action(Trigger::End, Act::Photo),
        action(Trigger::Distance(Value::Constant(5.0)), Act::Photo),
    ];
    let plan = plan(vec![way]);
    let steps = [step("w", 0, at, 500.0, 25.0, Action::Fly), step("w", 1, at, 500.0, 25.0, Action::Fly)];
    let written = write(Format::Waypoints, &Export { plan: &plan, steps: &steps }).unwrap();
    let commands: Vec<_> = std::str::from_utf8(&written.bytes)
        .unwrap()
        .lines()
        .skip(2)
        .map(|l| l.split('\t').nth(3).unwrap().to_owned())
        .collect();
    // once for each passage; the speed is commanded when it changes
    assert_eq!(commands, ["206", "2500", "178", "19", "206", "203", "206", "2500", "19", "206", "203"]);
    let lost: Vec<_> = written.notes.iter().filter(|n| n.code == "action-not-carried").collect();
    assert_eq!(lost.len(), 1);
    assert!(lost[0].place == "w" && lost[0].message.starts_with('1'), "{lost:?}");
}

#[test]
fn what_is_lost_is_told() {
    let at = LatLon::new(36.33, -84.15);
    let mut plan = plan(vec![leg(
        "orbit",
        LegKind::Orbit {
            centre: Place::Position(Value::Constant(at)),
            radius_m: Value::Constant(200.0),
            turns: Value::Constant(1.0),
            turn: flight_plan::TurnDirection::Left,
        },
    )]);
    plan.variables.push(flight_plan::Variable {
        name: "fire".into(),
        initial: flight_plan::VariableValue::Bool(false),
        unit: String::new(),
        min: None,
        max: None,
        max_length: None,
        writers: Vec::new(),
    });
    let steps = [step("orbit", 0, at, 500.0, 25.0, Action::Fly)];
    let codes = |format| {
        let written = write(format, &Export { plan: &plan, steps: &steps }).unwrap();
        written.notes.iter().map(|n| format!("{} {}", n.place, n.code)).collect::<Vec<_>>()
    };
    let always = ["orbit flattened", "fire variable-not-carried"];
    for (format, more) in [
        (Format::Plan, &["R05 runway-not-carried"][..]),
        (Format::Waypoints, &["R05 runway-not-carried"]),
        (Format::Kml, &["waypoints speeds-not-carried"]),
        (Format::Gpx, &["R05 runway-not-carried", "waypoints speeds-not-carried"]),
        (Format::Csv, &["R05 runway-not-carried"]),
    ] {
        let expected: Vec<_> = always.iter().chain(more).map(|s| (*s).to_owned()).collect();
        assert_eq!(codes(format), expected, "{format:?}");
    }
}

#[test]
fn names_of_legs_and_what_runways_have_are_told() {
    let at = LatLon::new(36.33, -84.15);
    let mut named = plan(vec![Leg { name: "To the mill".into(), ..leg("w", LegKind::Tf(to(at))) }]);
    named.stages[1].legs.push(Leg { name: "Never".into(), ..leg("x", LegKind::Tf(to(at))) }.into());
    named.runways[0].approach_entry = Some(at);
    let steps = [step("w", 0, at, 500.0, 25.0, Action::Fly)];
    let told = |format, plan: &FlightPlan, code: &str| {
        let notes = write(format, &Export { plan, steps: &steps }).unwrap().notes;
        notes.into_iter().filter(|n| n.code == code).map(|n| n.message).collect::<Vec<_>>()
    };
    let nameless = plan(vec![leg("w", LegKind::Tf(to(at)))]);
    for (_, format) in Format::ALL.into_iter().filter(|(_, format)| format.is_written()) {
        let names = told(format, &named, "leg-names-not-carried");
        assert_eq!(names, ["the names of the legs (1) are left out"], "{format:?}");
        assert!(told(format, &nameless, "leg-names-not-carried").is_empty(), "{format:?}");
    }
    for format in [Format::Plan, Format::Waypoints, Format::Gpx, Format::Csv] {
        let (entry, none) =
            (told(format, &named, "runway-not-carried"), told(format, &nameless, "runway-not-carried"));
        let all = "heading, length, priority and approach entry of this runway are left out";
        assert_eq!((entry, none[0].contains("priority")), (vec![all.to_owned()], true), "{format:?}");
        assert!(!none[0].contains("entry"), "{format:?}");
    }
}

#[test]
fn csv_has_a_line_for_each_waypoint() {
    let at = LatLon::new(36.33, -84.15);
    let steps = [step("w", 3, at, 500.0, 25.0, Action::Land { heading_deg: 0.0 })];
    let written = write(Format::Csv, &Export { plan: &plan(vec![]), steps: &steps }).unwrap();
    let text = String::from_utf8(written.bytes).unwrap();
    assert_eq!(text.lines().nth(1), Some("1,w,36.330000000,-84.150000000,500.0000,25.000,land,false,3"));
    assert_eq!(text.lines().count(), 2);
}
