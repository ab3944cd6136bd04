//! Files of other programs, and what becomes of them.
#![cfg(test)]

mod outline;

use flight_plan::{AltitudeReference, Runway, Severity, Value};
use geometry::LatLon;
use interchange::{Assumptions, Format, Import, read};
use outline::outline;

fn import(format: Format, bytes: &[u8]) -> Import {
    read(format, bytes, &Assumptions::default()).unwrap()
}

/// All notes but that of the aircraft, which every import has.
fn codes(import: &Import) -> Vec<(&str, &str)> {
    let notes = import.notes.iter().filter(|n| n.code != "aircraft-assumed");
    notes.map(|n| (n.code, n.place.as_str())).collect()
}

#[test]
fn a_qgc_plan() {
    let import = import(Format::Plan, include_bytes!("fixtures/survey.plan"));
    assert_eq!(
        outline(&import.plan),
        [
            "take-off on runway at 60 home",
            "mission",
            "  item3: TF 36.327 -84.16, 120 home, 22 m/s",
            "  item4: TF 36.328 -84.15, 80 agl, 22 m/s",
            "  survey: scan of 4 corners, 36.25 m, heading 30, overshoot 30, StartLeft, 100 home, 22 m/s, start series 25, end stop",
            "  corridor: along 3 points, 90 m wide, 30 m, 90 agl, 22 m/s",
            "  approach: HA 36.315 -84.18 Left, 45 home, 22 m/s",
            "land on landing",
            "keep-in keep-in of 4 corners",
            "keep-out keep-out around 36.32 -84.15, 250.5 m",
            "emergency rally on runway",
        ]
    );
    let runway = &import.plan.runways[0];
    assert_eq!((runway.threshold, runway.elevation_amsl_m), (LatLon::new(36.319, -84.173), 349.0));
    // north-east, towards the take-off item; approached from the loiter in the south-west
    assert!((53.0..54.0).contains(&runway.heading_deg), "{}", runway.heading_deg);
    assert_eq!(
        codes(&import),
        [
            ("pattern-setting", "item 5"),
            ("pattern-setting", "item 5"),
            ("entry-point", "item 6"),
            ("pattern-not-carried", "item 7"),
            ("pattern-setting", "item 8"),
            ("runway-made-up", "item 1"),
            ("loiter-as-racetrack", "item 8"),
            ("runway-made-up", "item 8"),
            ("rally-as-emergency", "rally point 1"),
            ("rally-without-runway", "rally point 2"),
        ]
    );
}

#[test]
fn stages_of_legs_that_name_each_other() {
    let import = import(Format::FpXml, include_bytes!("corpus/research-inspection.xml"));
    assert_eq!(
        outline(&import.plan),
        [
            "Departure",
            "  out: DF 36.33 -84.18, 650 amsl, 22 m/s",
            "  in: CF 36.345 -84.18 course 0, 700 amsl",
            "Beacon",
            "  rounds: 3 times",
            "    north: TF 36.36 -84.18 over, 750 amsl",
            "    arc: RF 36.36 -84.16 around 36.36 -84.17 Right, 750 amsl",
            "    south: TF 36.345 -84.16, 750 amsl",
            "  choose: fork wide to the next close to close wait to wait",
            "  wide: scan of 4 corners, 250 m, overshoot 0, Nearest, 800 amsl, 22 m/s, then Beacon.end",
            "  close: 2 times, then Beacon.end",
            "    first: DF 36.35 -84.15, 800 amsl",
            "    second: TF 36.365 -84.15, 800 amsl",
            "  wait: HM 36.34 -84.15 Left, 800 amsl",
            "  Beacon.end: fork",
            "Go-Home",
            "  home: TF 36.325 -84.17, 500 amsl, 20 m/s",
        ]
    );
}

#[test]
fn a_waypoint_list() {
    let import = import(Format::Waypoints, include_bytes!("fixtures/patrol.waypoints"));
    assert_eq!(
        outline(&import.plan),
        [
            "take-off on runway at 60 home",
            "mission",
            "  loop2: until battery < 0.4",
            "    item2: TF 36.327 -84.16, 100 home",
            "    loop4: 3 times",
            "      item4: TF 36.33 -84.15 over, 90 agl, 20 m/s",
            "      item6: TF 36.335 -84.15, 500 amsl, 20 m/s, start series 25, end photo",
            "    item9: orbit 36.336 -84.15, 120 m, 3 times Left, 110 home, 20 m/s",
            "    item10: TF 36.337 -84.15, 110 home, 20 m/s, end wait 45",
            "    item11: HA 36.337 -84.16 Right, 200 home, 20 m/s",
            "    item12: HM 36.338 -84.16 Right, 200 home, 20 m/s",
            "  item17: TF 36.315 -84.18, 50 home, 20 m/s",
            "land on runway",
        ]
    );
    assert_eq!(
        codes(&import),
        [
            ("runway-made-up", "line 3"),
            ("ground-speed", "line 5"),
            ("loiter-as-racetrack", "line 13"),
            ("loiter-as-racetrack", "line 14"),
            ("command-not-carried", "line 15"),
            ("command-not-carried", "line 16"),
            ("endless-jump", "line 17"),
            ("nested-jump", "line 17"),
            ("speed-in-loop", "line 17"),
            ("land-start", "line 18"),
            ("after-landing", "line 21"),
        ]
    );
    let servo = import.notes.iter().find(|n| n.place == "line 15").unwrap();
    assert!(servo.message.contains("183 (DO_SET_SERVO)"), "{servo}");
}

#[test]
fn jumps_that_make_no_loop_are_noted() {
    let list = |jumps: &str| {
        format!(
            "QGC WPL 110\n0 1 0 16 0 0 0 0 36 -84 300 1\n1 0 3 22 0 0 0 0 0 0 60 1\n2 0 3 16 0 0 0 0 36.1 -84 100 1\n\
             3 0 3 16 0 0 0 0 36.2 -84 100 1\n{jumps}"
        )
    };
    let nest: String = (4..20).map(|n| format!("{n} 0 0 177 2 1 0 0 0 0 0 1\n")).collect();
    for (jumps, expected) in [
        ("4 0 0 177 9 1 0 0 0 0 0 1\n", "leads to no leg before it"),
        ("4 0 0 177 3 1 0 0 0 0 0 1\n5 0 3 16 0 0 0 0 36.3 -84 100 1\n6 0 0 177 3 1 0 0 0 0 0 1\n", ""),
        (
            "4 0 0 177 2 1 0 0 0 0 0 1\n5 0 3 16 0 0 0 0 36.3 -84 100 1\n6 0 0 177 3 1 0 0 0 0 0 1\n",
            "middle of another loop",
        ),
        ("4 0 0 177 nan 1 0 0 0 0 0 1\n", "leads to no leg before it"),
        ("4 0 0 177 2 0 0 0 0 0 0 1\n", ""),
        (&nest, "would nest 9 loops"),
    ] {
        let import = import(Format::Waypoints, list(jumps).as_bytes());
        let said: String =
            import.notes.iter().filter(|n| n.code == "jump").map(|n| n.message.as_str()).collect();
        assert_eq!(said.is_empty(), expected.is_empty(), "{said}");
        assert!(said.contains(expected), "{jumps}: {said}");
    }
}

#[test]
fn without_a_home_heights_are_above_ground() {
    let import = import(
        Format::Waypoints,
        b"QGC WPL 110\n1 0 3 16 0 0 0 0 36.1 -84 100 1\n2 0 3 16 0 0 0 0 36.2 -84 100 1\n",
    );
    let legs = &import.plan.stages[0].legs;
    assert!(legs.iter().all(|l| l.altitude.as_ref().unwrap().reference == AltitudeReference::Agl));
    assert_eq!(outline(&import.plan)[1], "  item1: DF 36.1 -84, 100 agl");
    assert_eq!(codes(&import), [("no-home", "line 2")]);
}

#[test]
fn a_kml_file_packed_or_not() {
    let kml = include_bytes!("fixtures/places.kml");
    let import = import(Format::Kml, kml);
    assert_eq!(import.plan.name, "Fire & water");
    assert_eq!(
        outline(&import.plan),
        [
            "fix Tower 36.33 -84.15 <b>Lookout</b>",
            "Road",
            "  Road.1: DF 36.32 -84.16, 120 agl",
            "  Road.2: TF 36.33 -84.15, 130 agl",
            "  Road.3: TF 36.335 -84.14, 140 agl",
            "Lake-stage",
            "  Lake: scan of 4 corners, 100 m, overshoot 0, Nearest, 1 holes, 100 agl",
        ]
    );
    assert_eq!(
        codes(&import),
        [
            ("looks-not-carried", "line 5"),
            ("no-geometry", "line 33 (Nothing)"),
            ("element-not-carried", "line 34"),
            ("no-geometry", "line 34 (Ride)"),
            ("element-not-carried", "line 35"),
            ("area-as-scan", "line 26 (Lake)"),
            ("no-altitude", "line 26 (Lake)"),
        ]
    );
    assert!(import.notes[0].message.contains("4 times"), "{}", import.notes[0]);
}

#[test]
fn a_geojson_file() {
    let import = import(Format::GeoJson, include_bytes!("fixtures/places.geojson"));
    assert_eq!(
        outline(&import.plan),
        [
            "fix Tower 36.33 -84.15 ",
            "fix Both 36.1 -84.1 ",
            "route",
            "  route.1: DF 36.32 -84.16, 450 amsl",
            "  route.2: TF 36.33 -84.15, 460 amsl",
            "Lake-stage",
            "  Lake: scan of 3 corners, 100 m, overshoot 0, Nearest, 100 agl",
            "Both-2",
            "  Both-2.1: DF 36.1 -84.1, 100 agl",
            "  Both-2.2: TF 36.2 -84.2, 100 agl",
            "Both-3",
            "  Both-3.1: DF 36.3 -84.3, 100 agl",
            "  Both-3.2: TF 36.4 -84.4, 100 agl",
        ]
    );
    assert_eq!(
        codes(&import),
        [
            ("property-not-carried", "feature 1 (Tower)"),
            ("ellipsoid", "feature 2"),
            ("no-position", "feature 4 (Both)"),
            ("no-geometry", "feature 4 (Both)"),
            ("no-geometry", "feature 5"),
            ("area-as-scan", "feature 3 (Lake)"),
            ("no-altitude", "feature 3 (Lake)"),
        ]
    );
}

#[test]
fn a_gpx_file() {
    let import = import(Format::Gpx, include_bytes!("fixtures/tour.gpx"));
    assert_eq!(import.plan.name, "Tour");
    assert_eq!(
        outline(&import.plan),
        [
            "fix TOWER 36.33 -84.15 ",
            "There",
            "  A: DF 36.32 -84.16, 450 amsl",
            "  B: TF 36.33 -84.15, 100 agl",
            "Back",
            "  Back.1: DF 36.33 -84.15, 460 amsl",
            "  Back.2: TF 36.32 -84.16, 100 agl",
        ]
    );
    assert_eq!(
        codes(&import),
        [
            ("element-not-carried", "line 3"),
            ("element-not-carried", "line 4"),
            ("element-not-carried", "line 4"),
            ("no-position", "line 9"),
            ("element-not-carried", "line 14"),
            ("element-not-carried", "line 14"),
            ("bad-altitude", "line 15"),
            ("altitude-not-carried", "line 4"),
            ("no-altitude", "line 5"),
        ]
    );
}

#[test]
fn with_a_runway_a_drawing_can_be_flown() {
    let runway = Runway {
        id: "R05".into(),
        threshold: LatLon::new(36.319, -84.173),
        elevation_amsl_m: 349.0,
        heading_deg: 52.0,
        length_m: 600.0,
        priority: 1,
        approach_entry: None,
    };
    let assumptions = Assumptions { runway: Some(runway), ..Assumptions::default() };
    let plan = read(Format::Gpx, include_bytes!("fixtures/tour.gpx"), &assumptions).unwrap().plan;
    let stages: Vec<_> = plan.stages.iter().map(|s| s.id.as_str()).collect();
    assert_eq!(stages, ["take-off", "There", "Back", "land"]);
    let plan = read(Format::Plan, include_bytes!("fixtures/survey.plan"), &assumptions).unwrap().plan;
    assert_eq!(plan.runways.len(), 1);
    assert!(plan.stages.iter().all(|s| s.runway.as_ref().is_none_or(|r| r.as_str() == "R05")));
}

/// What is read is a document of ours: written and read again it is the same, without an error.
#[test]
fn aircraft_suits_what_the_file_says_of_its_vehicle() {
    let plan = |vehicle: &str| {
        format!(r#"{{"fileType":"Plan","version":1,"mission":{{{vehicle}"items":[],"version":2}}}}"#)
    };
    let list = |line: &str| format!("QGC WPL 110\n{line}");
    for (format, text, expected) in [
        (Format::Plan, plan(r#""cruiseSpeed":15,"vehicleType":1,"#), "foam-wing"),
        (Format::Plan, plan(r#""cruiseSpeed":15,"vehicleType":22,"#), "vtol-wing"),
        (Format::Plan, plan(""), "trainer"),
        (Format::Waypoints, list("1 0 3 178 0 40 -1 0 0 0 0 1"), "fast-wing"),
        (Format::Waypoints, list("1 0 3 178 2 9 -1 0 0 0 0 1"), "trainer"),
        (Format::Waypoints, list("1 0 3 84 0 0 0 0 36.3 -84.1 50 1"), "vtol-wing"),
    ] {
        let import = import(format, text.as_bytes());
        assert_eq!(import.plan.aircraft, expected, "{text}");
        let told = import.notes.iter().find(|n| n.code == "aircraft-assumed").unwrap();
        assert!(
            told.message.contains(expected)
                && !told.message.contains("--")
                && told.message.contains("long-range-wing"),
            "{told}"
        );
    }
    let chosen = Assumptions { aircraft: Some("foam-wing".into()), ..Assumptions::default() };
    let import = read(Format::Plan, plan("").as_bytes(), &chosen).unwrap();
    assert_eq!(import.plan.aircraft, "foam-wing");
    assert!(import.notes.iter().all(|n| n.code != "aircraft-assumed"), "it was said");
}

#[test]
fn imports_are_good_documents() {
    let files: [(Format, &[u8]); 5] = [
        (Format::Plan, include_bytes!("fixtures/survey.plan")),
        (Format::Waypoints, include_bytes!("fixtures/patrol.waypoints")),
        (Format::Kml, include_bytes!("fixtures/places.kml")),
        (Format::GeoJson, include_bytes!("fixtures/places.geojson")),
        (Format::Gpx, include_bytes!("fixtures/tour.gpx")),
    ];
    for (format, bytes) in files {
        assert_eq!(Format::by_content(bytes), Some(format));
        let plan = import(format, bytes).plan;
        let again = flight_plan::read(flight_plan::write(&plan));
        let errors: Vec<_> = again.problems.iter().filter(|p| p.severity == Severity::Error).collect();
        assert!(errors.is_empty(), "{format:?}: {errors:?}");
        assert_eq!(again.plan, plan, "{format:?}");
    }
}

#[test]
fn a_camera_that_does_not_fit_its_footprint_gives_way() {
    let plan = include_str!("fixtures/survey.plan")
        .replace("\"AdjustedFootprintSide\": 36.25", "\"AdjustedFootprintSide\": 50");
    let import = import(Format::Plan, plan.as_bytes());
    assert!(import.notes.iter().any(|n| n.code == "camera"));
    let survey = import.plan.leg(&"survey".into()).unwrap().leg;
    let flight_plan::LegKind::Scan(scan) = &survey.kind else { panic!("{survey:?}") };
    assert_eq!(scan.spacing, flight_plan::Spacing::Metres(Value::Constant(50.0)));
}

fn list(items: &str) -> String {
    format!("QGC WPL 110\n0 1 0 16 0 0 0 0 36.319 -84.173 60 1\n{items}")
}

/// Home is at 60 m, the waypoints 100 m above it; there is no take-off in the plan that `home` could mean.
#[test]
fn heights_above_home_without_a_take_off_to_count_from() {
    let late = list(
        "1 0 3 16 0 0 0 0 36.33 -84.16 100 1\n2 0 3 22 0 0 0 0 0 0 60 1\n3 0 3 16 0 0 0 0 36.34 -84.16 100 1\n",
    );
    let import = import(Format::Waypoints, late.as_bytes());
    assert_eq!(codes(&import), [("second-take-off", "line 4")]);
    let altitudes: Vec<_> = import.plan.stages[0].legs.iter().map(|l| l.altitude.clone().unwrap()).collect();
    for altitude in altitudes {
        assert_eq!((altitude.metres, altitude.reference), (Value::Constant(160.0), AltitudeReference::Amsl));
    }
}

#[test]
fn speeds_of_climb_and_descent_are_no_airspeeds() {
    let climb = list("1 0 2 178 2 3 -1 0 0 0 0 1\n2 0 3 16 0 0 0 0 36.33 -84.16 100 1\n");
    let import = import(Format::Waypoints, climb.as_bytes());
    assert_eq!(import.plan.stages[0].legs[0].speed_mps, None);
    assert_eq!(codes(&import), [("command-not-carried", "line 3")]);
}

#[test]
fn a_jump_that_does_not_say_how_often() {
    let jump = list("1 0 3 16 0 0 0 0 36.33 -84.16 100 1\n2 0 2 177 1 nan 0 0 0 0 0 1\n");
    let import = import(Format::Waypoints, jump.as_bytes());
    assert_eq!(codes(&import), [("jump", "line 4")]);
    assert_eq!(import.plan.stages[0].legs.len(), 1);
}

#[test]
fn a_second_home_position() {
    let text = list("1 0 3 16 0 0 0 0 36.33 -84.16 100 1\n0 0 0 16 0 0 0 0 36.33 -84.16 900 1\n");
    let error = read(Format::Waypoints, text.as_bytes(), &Assumptions::default()).unwrap_err().to_string();
    assert!(error.contains("line 4") && error.contains("item 0 is the home position"), "{error}");
}

#[test]
fn coordinates_in_another_reference_system() {
    let file = |crs: &str| {
        format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"{crs}"}}}},"features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"Point","coordinates":[60.0,40.0]}}}}]}}"#
        )
    };
    let read = |crs: &str| read(Format::GeoJson, file(crs).as_bytes(), &Assumptions::default());
    assert!(read("urn:ogc:def:crs:OGC:1.3:CRS84").is_ok());
    let error = read("urn:ogc:def:crs:EPSG::3857").unwrap_err().to_string();
    assert!(error.contains("EPSG::3857"), "{error}");
}
