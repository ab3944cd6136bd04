//! Plans of QGroundControl in the versions and with the settings that it has written over the years.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

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
