//! Lists of mission items, as autopilots understand them.
#![cfg(test)]

mod outline;

use geometry::LatLon;
use interchange::{Assumptions, Format, Import, read};
use outline::outline;

/// Home, 349 m high, and these items.
fn list(items: &str) -> Import {
    let text = format!("QGC WPL 110\n0 1 0 16 0 0 0 0 36.319 -84.173 349 1\n{items}");
    read(Format::Waypoints, text.as_bytes(), &Assumptions::default()).unwrap()
}

/// The same behind a take-off and two waypoints, items 1 to 3.
fn behind_two(items: &str) -> Import {
    list(&format!(
        "1 0 3 22 15 0 0 0 36.3273 -84.1598 80 1\n2 0 3 16 0 0 0 0 36.3273 -84.1498 120 1\n\
         3 0 3 16 0 0 0 0 36.3209 -84.1537 100 1\n{items}"
    ))
}

fn said<'a>(import: &'a Import, code: &str) -> Vec<&'a str> {
    import.notes.iter().filter(|n| n.code == code).map(|n| n.place.as_str()).collect()
}

#[test]
fn a_landing_on_the_spot_is_where_the_aircraft_is() {
    let import = behind_two("4 0 3 21 0 0 0 0 0 0 0 1\n");
    let runway = import.plan.runways.last().unwrap();
    assert_eq!((runway.threshold, runway.elevation_amsl_m), (LatLon::new(36.3209, -84.1537), 349.0));
    // as it came there, south-west
    assert!((200.0..220.0).contains(&runway.heading_deg), "{}", runway.heading_deg);
}

#[test]
fn a_landing_at_a_height_above_ground_says_what_is_not_known() {
    let import = behind_two("4 0 10 21 0 0 0 0 36.3190 -84.1730 5 1\n");
    assert_eq!(import.plan.runways.last().unwrap().elevation_amsl_m, 354.0);
    assert_eq!(said(&import, "terrain-landing"), ["line 6"]);
}

#[test]
fn a_loiter_on_the_spot_keeps_place_and_altitude() {
    let import = behind_two(
        "4 0 3 19 30 0 0 0 0 0 0 1\n5 0 3 18 3 0 100 0 0 0 0 1\n6 0 3 16 0 0 0 0 36.33 -84.16 90 1\n\
         7 0 3 19 20 0 0 0 0 0 150 1\n8 0 3 17 0 0 100 0 36.34 -84.16 0 1\n9 0 0 17 0 0 100 0 36.34 -84.17 0 1\n",
    );
    assert_eq!(
        outline(&import.plan)[2..],
        [
            "  item2: TF 36.3273 -84.1498, 120 home",
            "  item3: TF 36.3209 -84.1537, 100 home, end wait 30",
            "  item5: orbit 36.3209 -84.1537, 100 m, 3 times Right",
            "  item6: TF 36.33 -84.16, 90 home",
            "  item7: HA 36.33 -84.16 Right, 150 home, end wait 20",
            "  circle8: until battery < 0.4",
            "    item8: orbit 36.34 -84.16, 100 m, 1 times Right",
            "  circle9: until battery < 0.4",
            "    item9: orbit 36.34 -84.17, 100 m, 1 times Right, 0 amsl",
        ]
    );
    assert_eq!(said(&import, "loiter-altitude"), ["line 6"]);
}

#[test]
fn a_loop_does_not_wait_at_its_end() {
    let import =
        behind_two("4 0 2 177 2 1 0 0 0 0 0 1\n5 0 3 19 30 0 0 0 0 0 0 1\n6 0 2 93 5 0 0 0 0 0 0 1\n");
    assert_eq!(
        outline(&import.plan)[2..],
        [
            "  loop2: 2 times",
            "    item2: TF 36.3273 -84.1498, 120 home",
            "    item3: TF 36.3209 -84.1537, 100 home",
            "  item5: HA 36.3209 -84.1537 Right, 100 home, end wait 30, end wait 5",
        ]
    );
}

#[test]
fn a_jump_to_a_wait_leads_into_the_middle_of_a_leg() {
    let import = behind_two(
        "4 0 3 19 30 0 0 0 0 0 0 1\n5 0 3 16 0 0 0 0 36.33 -84.16 90 1\n6 0 2 177 4 1 0 0 0 0 0 1\n",
    );
    assert_eq!(said(&import, "jump"), ["line 8"]);
}

#[test]
fn items_in_local_frames_are_nowhere_on_the_map() {
    let import = behind_two(
        "4 0 1 16 0 0 0 0 50 20 -30 1\n5 0 4 19 30 0 0 0 50 20 30 1\n6 0 1 21 0 0 0 0 5 2 0 1\n7 0 2 93 5 0 0 0 0 0 0 1\n",
    );
    assert_eq!(
        outline(&import.plan)[2..],
        ["  item2: TF 36.3273 -84.1498, 120 home", "  item3: TF 36.3209 -84.1537, 100 home, end wait 5"]
    );
    assert_eq!(said(&import, "local-frame"), ["line 6"]);
}

#[test]
fn what_an_autopilot_flies_otherwise_in_later_passes_is_told() {
    let nested = behind_two(
        "4 0 2 177 3 3 0 0 0 0 0 1\n5 0 3 16 0 0 0 0 36.3118 -84.1844 100 1\n6 0 2 177 2 2 0 0 0 0 0 1\n",
    );
    assert_eq!((said(&nested, "nested-jump"), said(&nested, "speed-in-loop")), (vec!["line 8"], vec![]));
    let faster = behind_two(
        "4 0 2 178 0 28 -1 0 0 0 0 1\n5 0 3 16 0 0 0 0 36.3118 -84.1844 100 1\n6 0 2 177 2 2 0 0 0 0 0 1\n",
    );
    assert_eq!((said(&faster, "nested-jump"), said(&faster, "speed-in-loop")), (vec![], vec!["line 8"]));
    let steady = behind_two(
        "4 0 2 178 0 28 -1 0 0 0 0 1\n5 0 3 16 0 0 0 0 36.3118 -84.1844 100 1\n6 0 2 177 5 2 0 0 0 0 0 1\n",
    );
    assert_eq!((said(&steady, "nested-jump"), said(&steady, "speed-in-loop")), (vec![], vec![]));
}

#[test]
fn a_home_without_an_elevation_is_not_at_sea_level() {
    let text = "QGC WPL 110\n0 1 0 16 0 0 0 0 36.319 -84.173 nan 1\n1 0 3 16 0 0 0 0 36.3273 -84.1598 80 1\n";
    let import = read(Format::Waypoints, text.as_bytes(), &Assumptions::default()).unwrap();
    assert_eq!(outline(&import.plan)[1], "  item1: DF 36.3273 -84.1598, 80 agl");
    assert_eq!(said(&import, "no-home"), ["line 3"]);
}

#[test]
fn settings_of_loiters_and_landings_that_have_no_counterpart() {
    let import = list(
        "1 0 3 22 15 0 0 0 0 0 80 1\n2 0 3 18 2 0 100 0 0 0 90 1\n3 0 3 21 60 0 0 0 36.319 -84.173 0 1\n",
    );
    assert_eq!(
        (said(&import, "loiter-place"), said(&import, "landing-setting")),
        (vec!["line 4"], vec!["line 5"])
    );
}

#[test]
fn a_landing_that_is_not_as_high_as_its_runway_is_told() {
    let at = |height_m: &str| {
        let landing = format!("4 0 3 21 0 0 0 52.1 36.319 -84.173 {height_m} 1\n");
        said(&behind_two(&landing), "runway-elevation").len()
    };
    assert_eq!((at("0"), at("12")), (0, 1));
}

/// Three fields: each flight takes off where the one before has landed; what stands between is left out.
#[test]
fn a_mission_that_lands_and_takes_off_again_is_several_flights() {
    let import = behind_two(
        "4 0 3 21 0 0 0 0 36.3400 -84.1600 0 1\n5 0 3 16 0 0 0 0 36.35 -84.15 90 1\n\
         6 0 3 22 15 0 0 0 36.3500 -84.1500 70 1\n7 0 3 16 0 0 0 0 36.36 -84.14 110 1\n\
         8 0 0 177 2 1 0 0 0 0 0 1\n9 0 3 21 0 0 0 0 36.3700 -84.1400 10 1\n\
         10 0 3 22 15 0 0 0 0 0 75 1\n11 0 3 16 0 0 0 0 36.33 -84.16 120 1\n\
         12 0 3 21 0 0 0 0 36.3190 -84.1730 0 1\n",
    );
    assert_eq!(
        outline(&import.plan),
        [
            "take-off on runway at 80 home",
            "mission",
            "  item2: TF 36.3273 -84.1498, 120 home",
            "  item3: TF 36.3209 -84.1537, 100 home",
            "land on landing",
            "take-off on landing at 70 home",
            "mission-2",
            "  item7: TF 36.36 -84.14, 110 home",
            "land on landing-2",
            "take-off on landing-2 at 75 home",
            "mission-3",
            "  item11: TF 36.33 -84.16, 120 home",
            "land on landing-3",
        ]
    );
    assert_eq!(said(&import, "several-flights").len(), 1);
    assert_eq!((said(&import, "after-landing"), said(&import, "jump")), (vec!["line 7"], vec!["line 10"]));
}
