//! What other programs write that needs care.
#![cfg(test)]

mod outline;

use interchange::{Areas, Assumptions, Format, Import, read};
use outline::outline;

fn import(format: Format, bytes: &[u8]) -> Import {
    read(format, bytes, &Assumptions::default()).unwrap()
}

fn list(items: &str) -> Import {
    let text = format!("QGC WPL 110\n0 1 0 16 0 0 0 0 36 -84 300 1\n1 0 3 22 0 0 0 0 0 0 60 1\n{items}");
    import(Format::Waypoints, text.as_bytes())
}

fn said(import: &Import, code: &str) -> usize {
    import.notes.iter().filter(|note| note.code == code).count()
}

#[test]
fn neighbouring_waypoints_at_one_place_are_one() {
    let twice = list(
        "2 0 3 16 0 0 0 0 36.1 -84 100 1\n3 0 3 16 5 0 0 0 36.1 -84 100 1\n4 0 3 16 0 0 0 0 36.2 -84 100 1\n\
         5 0 0 177 2 1 0 0 0 0 0 1\n6 0 3 16 0 0 0 0 36.2 -84 100 1\n",
    );
    assert_eq!(
        outline(&twice.plan)[1..],
        [
            "mission",
            "  loop3: 2 times",
            "    item2: TF 36.1 -84, 100 home, end wait 5",
            "    item4: TF 36.2 -84, 100 home",
        ]
    );
    assert_eq!((said(&twice, "duplicate-waypoint"), said(&twice, "jump")), (1, 0));
    let climbing = list("2 0 3 16 0 0 0 0 36.1 -84 100 1\n3 0 3 16 0 0 0 0 36.1 -84 160 1\n");
    assert_eq!(outline(&climbing.plan)[3], "  item3: HA 36.1 -84 Right, 160 home");
    assert_eq!(said(&climbing, "climb-on-the-spot"), 1);
}

#[test]
fn neighbouring_points_of_a_line_at_one_place_are_one() {
    let line = br#"{"type":"LineString","coordinates":[[-84,36,300],[-84,36,350],[-84.1,36.1,350],[-84.1,36.1,350]]}"#;
    let import = import(Format::GeoJson, line);
    assert_eq!(
        outline(&import.plan)[1..],
        ["  route.1: DF 36 -84, 350 amsl", "  route.2: TF 36.1 -84.1, 350 amsl"]
    );
    assert_eq!(said(&import, "duplicate-waypoint"), 1);
}

#[test]
fn what_never_ends_lasts_as_long_as_the_energy() {
    let endless = list(
        "2 0 3 16 0 0 0 0 36.1 -84 100 1\n3 0 3 16 0 0 0 0 36.2 -84 100 1\n4 0 0 177 2 -1 0 0 0 0 0 1\n\
         5 0 3 17 0 0 -75 0 36.3 -84 100 1\n",
    );
    assert_eq!(
        outline(&endless.plan)[2..],
        [
            "  loop2: until battery < 0.4",
            "    item2: TF 36.1 -84, 100 home",
            "    item3: TF 36.2 -84, 100 home",
            "  circle5: until battery < 0.4",
            "    item5: orbit 36.3 -84, 75 m, 1 times Left, 100 home",
        ]
    );
    assert_eq!((said(&endless, "endless-jump"), said(&endless, "endless-circle")), (1, 1));
}

fn qgc(item: &str, more: &str) -> Import {
    let text = format!(
        r#"{{"fileType":"Plan","version":1,{more}"mission":{{"version":2,"items":[{item}],"plannedHomePosition":[36,-84,300]}}}}"#
    );
    import(Format::Plan, text.as_bytes())
}

#[test]
fn an_item_whose_place_stands_beside_empty_parameters() {
    for empty in ["[0,0,0,0,0,0,0]", "[0,0,0,null,null,null,null]"] {
        let item = format!(
            r#"{{"type":"SimpleItem","command":16,"frame":3,"coordinate":[36.1,-84.1,90],"params":{empty}}}"#
        );
        let import = qgc(&item, "");
        assert_eq!(outline(&import.plan)[1], "  item1: DF 36.1 -84.1, 390 amsl");
    }
    let both = r#"{"type":"SimpleItem","command":16,"frame":3,"coordinate":[1,2,3],"params":[0,0,0,0,36.1,-84.1,90]}"#;
    assert_eq!(outline(&qgc(both, "").plan)[1], "  item1: DF 36.1 -84.1, 390 amsl");
}

#[test]
fn fences_and_rally_points_in_a_waypoint_list() {
    let text = "QGC WPL 110\n0 1 0 16 0 0 0 0 36 -84 300 1\n\
        1 0 3 5000 0 0 0 0 36 -84 50 1\n\
        2 0 3 5001 3 0 0 0 35.9 -84.1 0 1\n3 0 3 5001 3 0 0 0 36.1 -84.1 0 1\n4 0 3 5001 3 0 0 0 36 -83.9 0 1\n\
        5 0 3 5002 3 0 0 0 36 -84 0 1\n6 0 3 5002 3 0 0 0 36.01 -84 0 1\n7 0 3 5002 3 0 0 0 36 -83.99 0 1\n\
        8 0 3 5004 120 0 0 0 36.02 -84.02 0 1\n9 0 3 5003 5000 0 0 0 36 -84 0 1\n\
        10 0 3 5100 0 0 0 0 36.001 -84 90 1\n";
    let import = import(Format::Waypoints, text.as_bytes());
    assert_eq!(
        outline(&import.plan),
        [
            "keep-in keep-in of 3 corners",
            "keep-out keep-out of 3 corners",
            "keep-out-2 keep-out around 36.02 -84.02, 120 m",
            "keep-in-2 keep-in around 36 -84, 5000 m",
        ]
    );
    let runway = &import.plan.runways[0];
    assert_eq!((runway.id.as_str(), runway.elevation_amsl_m), ("rally", 300.0));
    assert_eq!((said(&import, "rally-as-runway"), said(&import, "breach-return")), (1, 1));
    assert!(!import.is_empty());
    // cut off behind its second corner
    let cut = list("2 0 3 5002 3 0 0 0 36 -84 0 1\n3 0 3 5002 3 0 0 0 36.01 -84 0 1\n");
    assert_eq!((said(&cut, "bad-fence"), cut.plan.zones.len()), (1, 0));
    // with a mission, a rally point by its runway is an emergency plan
    let flown = list("2 0 3 16 0 0 0 0 36.1 -84 100 1\n3 0 0 5100 0 0 0 0 36.001 -84 390 1\n");
    assert_eq!(said(&flown, "rally-as-emergency"), 1);
}

#[test]
fn lists_without_a_home() {
    let rally = import(Format::Waypoints, b"QGC WPL 110\n0 0 3 5100 0 0 0 0 36 -84 90 1\n");
    assert_eq!((rally.plan.runways.len(), said(&rally, "rally-as-runway")), (1, 1));
    let old = import(Format::Waypoints, b"RALLY 36 -84 90 40 0 0\nRALLY\t36.1\t-84\t90\t40\t0\t0\n");
    assert_eq!(old.plan.runways.len(), 2);
    let fence = b"# saved\n36 -84\n35.9 -84.1\n36.1 -84.1\n36 -83.9\n35.9 -84.1\n";
    assert_eq!(Format::by_content(fence), Some(Format::Waypoints));
    assert_eq!(outline(&import(Format::Waypoints, fence).plan), ["keep-in keep-in of 3 corners"]);
    let broken = read(Format::Waypoints, b"36 -84\n36 x\n", &Assumptions::default()).unwrap_err();
    assert!(broken.to_string().starts_with("line 2"), "{broken}");
}

#[test]
fn versions_that_are_not_known_are_told() {
    let fence = r#""geoFence":{"version":1,"polygon":[[36.2,-84.2],[36.2,-84.1],[36.3,-84.1]]},"#;
    let old = qgc("", fence);
    assert_eq!(outline(&old.plan), ["keep-in keep-in of 3 corners"]);
    assert_eq!((said(&old, "fence-version"), said(&old, "plan-version")), (1, 0));
    let text = r#"{"fileType":"Plan","version":2,"mission":{"version":3,"items":[]},"rallyPoints":{"version":1,"points":[]}}"#;
    let import = import(Format::Plan, text.as_bytes());
    assert_eq!(said(&import, "plan-version"), 3);
    assert!(import.is_empty() && said(&import, "empty") == 1);
}

#[test]
fn text_of_older_programs() {
    let kml = b"<?xml version='1.0' encoding='ISO-8859-1'?><kml><Placemark><name>H\xf6he</name>\
        <description>Gipfel \xfcber dem See</description><Point><coordinates>-84,36</coordinates></Point></Placemark></kml>";
    let import = import(Format::Kml, kml);
    assert_eq!(outline(&import.plan), ["fix H-he 36 -84 Gipfel über dem See"]);
    assert_eq!((import.plan.fixes[0].name.as_str(), said(&import, "encoding")), ("Höhe", 1));
}

#[test]
fn kml_that_was_copied_from_a_file() {
    let placemark =
        "<Placemark><name>Camp</name><Point><coordinates>-84,36</coordinates></Point></Placemark>";
    for text in [
        placemark.to_owned(),
        format!("<Folder>{placemark}</Folder>"),
        format!(
            "<?xml version='1.0'?>\n<Document xmlns='http://www.opengis.net/kml/2.2'>{placemark}</Document>"
        ),
    ] {
        assert_eq!(Format::by_content(text.as_bytes()), Some(Format::Kml), "{text}");
        assert_eq!(outline(&import(Format::Kml, text.as_bytes()).plan), ["fix Camp 36 -84 "]);
    }
}

#[test]
fn longitudes_beyond_180_degrees() {
    let json = br#"{"type":"LineString","coordinates":[[179.5,10],[181.5,10],[-183.5,10]]}"#;
    let kml = b"<kml><Placemark><LineString><coordinates>179.5,10 181.5,10 -183.5,10</coordinates></LineString></Placemark></kml>";
    let gpx = b"<gpx><rte><rtept lat='10' lon='179.5'/><rtept lat='10' lon='181.5'/><rtept lat='10' lon='-183.5'/></rte></gpx>";
    for (format, bytes) in [(Format::GeoJson, &json[..]), (Format::Kml, &kml[..]), (Format::Gpx, &gpx[..])] {
        let import = import(format, bytes);
        let lines = outline(&import.plan);
        let tracks = lines.iter().filter(|l| l.contains("TF 10 -178.5") || l.contains("TF 10 176.5"));
        assert_eq!((tracks.count(), said(&import, "longitude-range")), (2, 1), "{format:?}: {lines:?}");
    }
    let far = import(Format::GeoJson, br#"{"type":"Point","coordinates":[999,10]}"#);
    assert_eq!(said(&far, "no-position"), 1);
}

#[test]
fn areas_become_what_is_asked_for() {
    let ring = "[[-84,36],[-83.9,36],[-83.9,36.1],[-84,36]]";
    let json = format!(
        r#"{{"type":"Feature","properties":{{"name":"Air base"}},"geometry":{{"type":"Polygon","coordinates":[{ring}]}}}}"#
    );
    for (areas, line, code) in [
        (Areas::Scan, "Air-base-stage", "area-as-scan"),
        (Areas::KeepIn, "Air-base keep-in of 3 corners", "area-as-zone"),
        (Areas::KeepOut, "Air-base keep-out of 3 corners", "area-as-zone"),
    ] {
        let assumptions = Assumptions { areas, ..Assumptions::default() };
        let import = read(Format::GeoJson, json.as_bytes(), &assumptions).unwrap();
        assert_eq!((outline(&import.plan)[0].as_str(), said(&import, code)), (line, 1));
        assert!(import.has_areas());
        assert!(import.plan.zones.iter().all(|zone| zone.name == "Air base"));
    }
    let point = import(Format::GeoJson, br#"{"type":"Point","coordinates":[-84,36]}"#);
    assert!(!point.has_areas());
}

/// A plan of stages in the research's XML, of one stage.
fn stage(legs: &str) -> Import {
    let text =
        format!("<FlightPlan><MainFP><stages><stage id='A'>{legs}</stage></stages></MainFP></FlightPlan>");
    import(Format::FpXml, text.as_bytes())
}

fn track(id: &str, lat: f64, next: &str) -> String {
    let next = if next.is_empty() { String::new() } else { format!("<next>{next}</next>") };
    format!(
        "<leg id='{id}' xsi_type='TFLeg'><dest><coordinates>{lat} -84</coordinates><altitude>500</altitude></dest>{next}</leg>"
    )
}

#[test]
fn branches_that_lead_back_into_a_loop_belong_to_it() {
    let body = |body: &str| {
        stage(&format!(
            "<leg id='loop' xsi_type='IterativeLeg'><body>{body}</body><upperBound>2</upperBound><first>in</first><last>out</last>\
             <next>end</next></leg>{}<leg id='ask' xsi_type='IntersectionLeg'><nextList>left right away</nextList></leg>\
             {}{}{}{}{}",
            track("in", 36.1, ""),
            track("left", 36.2, "left2"),
            track("left2", 36.3, "out"),
            track("right", 36.4, "out"),
            track("out", 36.5, ""),
            track("end", 36.6, "") + &track("away", 36.7, "end"),
        ))
    };
    for named in ["in ask out", "in ask"] {
        let import = body(named);
        let lines = outline(&import.plan);
        let fork = lines.iter().find(|line| line.contains("ask: fork")).unwrap();
        assert!(fork.contains("left to left") || fork.contains("left to the next"), "{lines:#?}");
        assert!(fork.contains("right to right"), "{lines:#?}");
        let inside = |leg: &str| lines.iter().any(|line| line.starts_with(&format!("    {leg}: ")));
        assert!(["in", "left", "left2", "right", "out"].into_iter().all(inside), "{lines:#?}");
        assert!(!inside("end") && !inside("away"));
        // nothing can be done for a branch that leaves the loop
        assert_eq!(said(&import, "branch-across-loop"), 1, "{named}");
    }
}

#[test]
fn stage_that_does_not_say_where_it_begins_begins_where_nobody_leads_to() {
    let backwards = stage(&(track("fin", 36.1, "") + &track("mid", 36.2, "fin") + &track("go", 36.3, "mid")));
    assert_eq!(
        outline(&backwards.plan),
        [
            "A",
            "  go: DF 36.3 -84, 500 amsl, then mid",
            "  fin: TF 36.1 -84, 500 amsl, then A.end",
            "  mid: TF 36.2 -84, 500 amsl, then fin",
            "  A.end: fork"
        ]
    );
    assert_eq!(said(&backwards, "order-assumed"), 1);
    let forwards = stage(&(track("go", 36.3, "mid") + &track("mid", 36.2, "fin") + &track("fin", 36.1, "")));
    assert_eq!((outline(&forwards.plan).len(), said(&forwards, "order-assumed")), (4, 0));
}

#[test]
fn speed_of_the_file_is_flown_where_the_aircraft_can() {
    let square = |speed: &str| {
        let text = format!(
            r#"{{"fileType":"Plan","version":1,"mission":{{"cruiseSpeed":{speed},"items":[{{"type":"SimpleItem","command":16,"frame":3,
            "params":[0,0,0,null,36.1,-84.1,90]}}],"plannedHomePosition":[36,-84,300],"version":2}}}}"#
        );
        let import = import(Format::Plan, text.as_bytes());
        let told = import.notes.iter().find(|note| note.code == "aircraft-assumed").unwrap().message.clone();
        (import.plan.stages[0].speed_mps.clone(), told, said(&import, "speed-not-flown"))
    };
    let (speed, told, _) = square("18");
    assert_eq!(speed, Some(flight_plan::Value::Constant(18.0)));
    assert!(told.contains("18 m/s") && told.contains("20 m/s"), "{told}");
    let (speed, told, left_out) = square("20");
    assert_eq!((speed, left_out), (None, 0));
    assert!(told.contains("it flies at 20 m/s"), "{told}");
    let (speed, told, left_out) = square("90");
    assert_eq!((speed, left_out), (None, 1));
    assert!(told.contains("`fast-wing`") && told.contains("90 m/s") && told.contains("38 m/s"), "{told}");
}

/// Home is at 36/-84; the mission comes back from the north.
fn there_and_back(take_off: &str, end: &str) -> Import {
    let text = format!(
        "QGC WPL 110\n0 1 0 16 0 0 0 0 36 -84 300 1\n1 0 3 22 0 0 0 0 {take_off} 50 1\n\
         2 0 3 16 0 0 0 0 36.01 -83.99 100 1\n3 0 3 16 0 0 0 0 36.02 -84 100 1\n4 0 {end} 1\n"
    );
    import(Format::Waypoints, text.as_bytes())
}

#[test]
fn who_takes_off_at_home_takes_off_towards_what_is_flown() {
    for (take_off, end) in
        [("0 0", "3 20 0 0 0 0 0 0 0"), ("36 -84", "3 20 0 0 0 0 0 0 0"), ("36 -84", "3 21 0 0 0 0 36 -84 0")]
    {
        let import = there_and_back(take_off, end);
        let [runway, landing] = &import.plan.runways[..] else { panic!("{:?}", import.plan.runways) };
        assert!((38.0..40.0).contains(&runway.heading_deg), "{take_off}: {runway:?}");
        assert!((179.0..181.0).contains(&landing.heading_deg), "as it comes back: {landing:?}");
    }
}

#[test]
fn command_beyond_every_number_is_told_as_what_it_is() {
    let import = list("1 0 3 123456789012345678901 0 0 0 0 36.01 -83.99 100 1\n");
    let told = import.notes.iter().find(|note| note.code == "command-not-carried").unwrap();
    assert!(!told.message.contains("65535"), "{told}");
}
