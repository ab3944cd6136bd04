//! Plans of QGroundControl in the versions and with the settings that it has written over the years.
#![cfg(test)]

mod outline;

use interchange::{Assumptions, Format, Import, read};
use outline::outline;

/// A take-off at item 1, then these items; home is 349 m high.
fn file(items: &str) -> String {
    let take_off = r#"{"autoContinue":true,"command":22,"doJumpId":1,"frame":3,"params":[15,0,0,null,36.3273,-84.1598,80],"type":"SimpleItem"}"#;
    format!(
        r#"{{"fileType":"Plan","version":1,"groundStation":"QGroundControl","mission":{{"version":2,"firmwareType":3,"vehicleType":1,
        "plannedHomePosition":[36.319,-84.173,349],"items":[{take_off}{items}]}}}}"#
    )
}

fn import(text: &str) -> Import {
    read(Format::Plan, text.as_bytes(), &Assumptions::default()).unwrap()
}

fn said<'a>(import: &'a Import, code: &str) -> Vec<&'a str> {
    import.notes.iter().filter(|n| n.code == code).map(|n| n.message.as_str()).collect()
}

fn landing(kind: &str, keys: &str) -> String {
    format!(
        r#",{{"type":"ComplexItem","complexItemType":"{kind}","landCoordinate":[36.319,-84.173,352],
        "loiterCoordinate":[36.3118,-84.1744,400],"loiterClockwise":false,"loiterRadius":75,{keys}}}"#
    )
}

#[test]
fn a_landing_of_the_first_version_says_of_each_altitude_what_it_counts_from() {
    for (keys, approach, elevation_m) in [
        (r#""loiterAltitudeRelative":false,"landAltitudeRelative":false,"version":1"#, "400 amsl", 352.0),
        (r#""loiterAltitudeRelative":true,"landAltitudeRelative":false,"version":1"#, "400 home", 352.0),
        (r#""altitudesAreRelative":true,"version":2"#, "400 home", 701.0),
    ] {
        let import = import(&file(&landing("fwLandingPattern", keys)));
        assert!(outline(&import.plan)[2].ends_with(approach), "{:?}", outline(&import.plan));
        assert_eq!(import.plan.runways[1].elevation_amsl_m, elevation_m);
    }
}

#[test]
fn a_vertical_landing_pattern_is_told() {
    let keys = r#""altitudesAreRelative":true,"version":1"#;
    assert_eq!(said(&import(&file(&landing("vtolLandingPattern", keys))), "vtol").len(), 1);
    assert_eq!(said(&import(&file(&landing("fwLandingPattern", keys))), "vtol").len(), 0);
}

#[test]
fn heights_that_are_not_known_are_not_zero() {
    let rally = r#""rallyPoints":{"version":2,"points":[[36.32,-84.172,null]]},"version":1,"#;
    let file = file("").replace("-84.173,349]", "-84.173,null]").replacen(r#""version":1,"#, rally, 1);
    let import = import(&file);
    assert_eq!(
        said(&import, "no-home"),
        ["the file doesn't say how high home is: its elevation is taken as 0 m"]
    );
    assert_eq!(said(&import, "no-altitude").len(), 1);
    let rally = import.plan.emergency_plans[0].stages[0].legs[0].altitude.as_ref();
    assert_eq!(
        rally,
        Some(&flight_plan::Altitude {
            metres: flight_plan::Value::Constant(100.0),
            reference: flight_plan::AltitudeReference::Agl
        })
    );
}

#[test]
fn a_landing_that_qgc_puts_above_terrain_is_as_high_as_it_says() {
    let land = r#",{"AMSLAltAboveTerrain":361.5,"Altitude":0,"AltitudeMode":3,"autoContinue":true,"command":21,"doJumpId":2,"frame":0,
        "params":[0,0,0,null,36.3118,-84.1744,361.5],"type":"SimpleItem"}"#;
    assert_eq!(import(&file(land)).plan.runways[1].elevation_amsl_m, 361.5);
}

/// A survey of items 2 to 5 that QGC has worked out this way for, and items behind it.
fn survey(keys: &str, way: &str, behind: &str) -> String {
    let item = |number: usize, place: &str| {
        format!(
            r#"{{"autoContinue":true,"command":16,"doJumpId":{number},"frame":3,"params":[0,0,0,null,{place},100],"type":"SimpleItem"}}"#
        )
    };
    let items = [
        item(2, "36.331,-84.15"),
        item(3, "36.335,-84.15"),
        item(4, "36.335,-84.14"),
        item(5, "36.331,-84.14"),
    ];
    file(&format!(
        r#",{{"TransectStyleComplexItem":{{"CameraCalc":{{"AdjustedFootprintFrontal":0,"AdjustedFootprintSide":40,"DistanceMode":1,
        "DistanceToSurface":100,"version":2}},"Items":[{}],"TurnAroundDistance":0,"VisualTransectPoints":[{way}],"version":2}},
        {keys}"complexItemType":"survey","polygon":[[36.331,-84.15],[36.335,-84.15],[36.335,-84.14],[36.331,-84.14]],
        "type":"ComplexItem","version":5}}{behind}"#,
        items.join(",")
    ))
}

fn loiter(number: usize) -> String {
    format!(
        r#",{{"autoContinue":true,"command":18,"doJumpId":{number},"frame":3,"params":[2,0,100,0,0,0,0],"type":"SimpleItem"}}"#
    )
}

#[test]
fn a_loiter_on_the_spot_behind_a_survey_is_where_that_ends() {
    let way = "[36.331,-84.15],[36.335,-84.15],[36.335,-84.14],[36.331,-84.14]";
    let known = import(&survey(r#""angle":0,"#, way, &loiter(6)));
    assert_eq!(outline(&known.plan)[3], "  item6: orbit 36.331 -84.14, 100 m, 2 times Right");
    let unworked = survey(r#""angle":0,"#, "", &loiter(6)).replace(r#""command":16"#, r#""command":206"#);
    let unknown = import(&unworked);
    assert_eq!((outline(&unknown.plan).len(), said(&unknown, "no-position").len()), (3, 1));
}

#[test]
fn a_jump_into_a_survey_is_told() {
    let jump = |to: usize| {
        format!(
            r#",{{"autoContinue":true,"command":177,"doJumpId":6,"frame":2,"params":[{to},2,0,0,0,0,0],"type":"SimpleItem"}}"#
        )
    };
    let middle = import(&survey("", "", &jump(4)));
    assert!(said(&middle, "jump")[0].contains("into the middle"), "{:?}", middle.notes);
    let begin = import(&survey("", "", &jump(2)));
    assert!(
        said(&begin, "jump").is_empty() && outline(&begin.plan)[2] == "  loop2: 3 times",
        "{:?}",
        begin.notes
    );
}

/// East of north by 120° QGC flies tracks at -60°, and names its corners there.
#[test]
fn a_survey_begins_where_its_way_does() {
    for (angle_deg, first, entry) in [
        ("0", "[36.331,-84.15]", "StartLeft"),
        ("0", "[36.335,-84.14]", "EndRight"),
        ("120", "[36.336,-84.151]", "StartLeft"),
        ("-60", "[36.336,-84.151]", "EndRight"),
        ("200", "[36.335,-84.14]", "StartLeft"),
    ] {
        let keys = format!(r#""angle":{angle_deg},"entryLocation":3,"#);
        let found = outline(&import(&survey(&keys, first, "")).plan);
        assert!(found[2].contains(&format!(" {entry},")), "{angle_deg} {first}: {}", found[2]);
    }
    let unworked =
        survey(r#""angle":0,"entryLocation":3,"#, "", "").replace(r#""command":16"#, r#""command":206"#);
    let unworked = import(&unworked);
    assert!(outline(&unworked.plan)[2].contains(" StartRight,"));
    assert_eq!(said(&unworked, "entry-point").len(), 1);
}

/// As QGC wrote surveys until version 3.3.
#[test]
fn a_survey_of_the_third_version() {
    let old = |kind: &str, more: &str| {
        file(&format!(
            r#",{{"camera":{{"focalLength":16,"groundResolution":3,"imageFrontalOverlap":70,"imageSideOverlap":75,"name":"Sony ILCE-QX1",
            "orientationLandscape":true,"resolutionHeight":3632,"resolutionWidth":5456,"sensorHeight":15.4,"sensorWidth":23.2}},
            "cameraTrigger":true,"cameraTriggerDistance":25,{kind},"fixedValueIsAltitude":false,"grid":{{"altitude":100,"angle":35,
            "relativeAltitude":false,"spacing":36.25,"turnAroundDistance":20}},{more}"manualGrid":false,
            "polygon":[[36.331,-84.15],[36.335,-84.15],[36.335,-84.14],[36.331,-84.14]]}}"#
        ))
    };
    let third = import(&old(
        r#""type":"ComplexItem","complexItemType":"survey","version":3"#,
        r#""hoverAndCapture":true,"#,
    ));
    assert_eq!(
        outline(&third.plan)[2],
        "  survey: scan of 4 corners, 36.25 m, heading 35, overshoot 20, EndRight, 100 amsl, start series 25, end stop"
    );
    assert_eq!(said(&third, "pattern-setting"), ["stopping for each picture is left out"]);
    let second = import(&old(r#""type":"survey","version":2"#, r#""refly90Degrees":true,"#));
    let flight_plan::LegKind::Scan(scan) = &second.plan.stages[1].legs[0].kind else {
        panic!("{:?}", second.plan)
    };
    assert_eq!(scan.style, flight_plan::ScanStyle::CrissCross);
}

fn fence(fence: &str) -> Import {
    import(&file("").replacen(r#""version":1,"#, &format!(r#""geoFence":{fence},"version":1,"#), 1))
}

#[test]
fn several_fences_to_stay_inside_of_are_told() {
    let circle = |inclusion: bool| {
        format!(
            r#"{{"circle":{{"center":[36.32,-84.15],"radius":250}},"inclusion":{inclusion},"version":1}}"#
        )
    };
    let told = |a, b| {
        let import =
            fence(&format!(r#"{{"version":2,"polygons":[],"circles":[{},{}]}}"#, circle(a), circle(b)));
        let export = interchange::Export { plan: &import.plan, steps: &[] };
        let written = interchange::write(Format::Plan, &export).unwrap();
        let again = written.notes.iter().filter(|n| n.code == "several-keep-in").count();
        (said(&import, "several-keep-in").len(), again)
    };
    assert_eq!((told(true, true), told(true, false)), ((1, 1), (0, 0)));
}

#[test]
fn a_fence_of_the_first_version_is_told() {
    let old =
        fence(r#"{"version":1,"parameters":[],"polygon":[[36.25,-84.25],[36.25,-84.1],[36.37,-84.1]]}"#);
    assert_eq!(said(&old, "fence-version").len(), 2);
}

#[test]
fn items_with_a_coordinate() {
    for params in [r#""params":[0,3,0,0]"#, r#""param1":0,"param2":3,"param3":0,"param4":0"#] {
        let item = format!(
            r#",{{"autoContinue":true,"command":16,"coordinate":[36.3209,-84.1537,90],"doJumpId":2,"frame":3,{params},"type":"SimpleItem"}}"#
        );
        assert_eq!(outline(&import(&file(&item)).plan)[2], "  item2: TF 36.3209 -84.1537 over, 90 home");
    }
    let without = r#",{"autoContinue":true,"command":16,"doJumpId":2,"frame":3,"type":"SimpleItem"}"#;
    assert_eq!(said(&import(&file(without)), "bad-item").len(), 1);
}

#[test]
fn a_mission_of_another_vehicle_is_told() {
    let of = |kind: &str| file("").replace(r#""vehicleType":1"#, &format!(r#""vehicleType":{kind}"#));
    assert_eq!(said(&import(&of("2")), "vehicle-type").len(), 1);
    assert!(["1", "20", "null"].iter().all(|kind| said(&import(&of(kind)), "vehicle-type").is_empty()));
}

#[test]
fn rates_of_climb_over_terrain_are_told() {
    let keys = r#""DistanceMode":3"#;
    let terrain = survey("", "", "").replace(r#""DistanceMode":1"#, keys).replace(
        r#""TurnAroundDistance":0"#,
        r#""TerrainAdjustMaxClimbRate":3,"TerrainAdjustMaxDescentRate":0,"TerrainAdjustTolerance":10,"TurnAroundDistance":0"#,
    );
    assert_eq!(said(&import(&terrain), "pattern-setting").len(), 1);
    assert_eq!(said(&import(&survey("", "", "")), "pattern-setting").len(), 0);
}
