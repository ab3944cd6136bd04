//! The leg being flown, when a variable or a new plan changes it: altitude, speed and geometry.

use crate::rig::{GROUND_M, Rig, document_with, fix, program};
use flight_exec::Waypoint;
use geometry::LatLon;

const VARIABLES: &str = r#"<variable name="h" type="number" initial="200" min="100" max="400"/>
    <variable name="v" type="number" initial="22" min="18" max="33"/>
    <variable name="s" type="number" initial="300" min="100" max="400"/>
    <variable name="c" type="number" initial="0" min="-180" max="180"/>"#;

/// What is made of more than one waypoint, altitude and speed by variables.
const LEGS: [(&str, &str); 6] = [
    ("scan", r#"<scan id="p" spacing="= s" heading="0"@><area fix="C4" radius="900"/></scan>"#),
    (
        "spiral",
        r#"<spiral id="p" spacing="= s" outerRadius="900" direction="outward" turn="left"@><centre fix="C4"/></spiral>"#,
    ),
    ("orbit", r#"<orbit id="p" radius="500" turns="3" turn="left"@><centre fix="C4"/></orbit>"#),
    ("holding", r#"<HM id="p" fix="C4" course="= c" turn="right" length="600" maxLaps="4"@/>"#),
    ("racetrack", r#"<HF id="p" fix="C4" course="= c" turn="right" length="1500"@/>"#),
    ("arc", r#"<RF id="p" fix="D2" centreFix="C2" turn="right"@/><TF id="q" fix="D1"/>"#),
];

fn document(leg: &str) -> String {
    let own = r#" altitude="= h" altitudeReference="agl" speed="= v""#;
    let mut leg = leg.replace('@', own);
    for name in ["C2", "D2"] {
        let at = fix(name);
        let centre = format!(r#"centreLat="{}" centreLon="{}""#, at.lat_deg, at.lon_deg);
        leg = leg.replace(&format!(r#"centreFix="{name}""#), &centre);
    }
    document_with(
        &format!(r#"<TF id="a" fix="B1"/><TF id="b" fix="B2"/>{leg}<TF id="z" fix="A3"/>"#),
        VARIABLES,
        "",
    )
}

fn flying(leg: &str) -> Rig {
    let mut rig = Rig::flying(&document(leg));
    rig.fly_to("p");
    rig.fly_one();
    rig.fly_one();
    rig
}

/// What is flown of the leg from now on, but for what is nearer than a turn: that is never altered.
fn rest(rig: &mut Rig) -> Vec<Waypoint> {
    let (from, mut at, mut way_m) = (rig.flown.len(), rig.position, 0.0);
    let current = rig.buffer.front().cloned();
    rig.fly_to_the_end();
    let later = current.into_iter().chain(rig.flown[from..].iter().cloned());
    let far = later.skip_while(|w| {
        way_m += at.distance_m(w.position);
        at = w.position;
        way_m < 400.0
    });
    far.filter(|w| w.leg.as_str() == "p").collect()
}

fn is_at(w: &Waypoint, h: f64, v: f64) -> bool {
    (w.altitude_amsl_m - GROUND_M - h).abs() < 0.5 && w.airspeed_mps == v
}

#[test]
fn a_variable_changes_altitude_and_speed_of_the_leg_being_flown() {
    for (name, leg) in LEGS {
        let mut rig = flying(leg);
        rig.set("h", 215.0).unwrap();
        rig.now += flight_exec::Time::from_secs(2);
        rig.set("v", 28.0).unwrap();
        rig.now += flight_exec::Time::from_secs(2);
        rig.report();
        let rest = rest(&mut rig);
        assert!(!rest.is_empty(), "{name}");
        for w in rest.iter().skip(1) {
            assert!(is_at(w, 215.0, 28.0), "{name}: {w:?}");
        }
    }
}

#[test]
fn a_new_plan_changes_altitude_and_speed_of_the_leg_being_flown() {
    for (name, leg) in LEGS {
        let mut rig = flying(leg);
        let new = leg.replace('@', r#" altitude="215" altitudeReference="agl" speed="28""#);
        rig.update(&program(&document(&new))).unwrap();
        let rest = rest(&mut rig);
        assert!(!rest.is_empty(), "{name}");
        for w in rest.iter().skip(1) {
            assert!(is_at(w, 215.0, 28.0), "{name}: {w:?}");
        }
    }
}

/// Whether the rest of a leg, as flown, is that of the new plan.
type Arrived = fn(&[LatLon]) -> bool;

/// Where a leg ends up after its own geometry was changed while it was flown.
#[test]
fn a_new_plan_changes_the_geometry_of_the_leg_being_flown() {
    let cases: [(&str, &str, &str, Arrived); 5] = [
        (
            "the fix of a holding",
            r#"<HM id="p" fix="C4" course="0" turn="right" length="600" maxLaps="4"/>"#,
            r#"<HM id="p" fix="C5" course="0" turn="right" length="600" maxLaps="4"/>"#,
            |rest| rest.iter().filter(|p| p.distance_m(fix("C5")) < 1.0).count() >= 2,
        ),
        (
            "the side of a racetrack",
            r#"<HF id="p" fix="C4" course="0" turn="right" length="1500"/>"#,
            r#"<HF id="p" fix="C4" course="0" turn="left" length="1500"/>"#,
            |rest| rest.iter().any(|p| p.lon_deg < fix("C4").lon_deg - 0.001),
        ),
        (
            "the centre of an arc",
            r#"<RF id="p" fix="D2" centreFix="C2" turn="right"/><TF id="q" fix="D1"/>"#,
            r#"<RF id="p" fix="F2" centreFix="D2" turn="right"/><TF id="q" fix="F1"/>"#,
            |rest| rest.last().is_some_and(|p| p.distance_m(fix("F2")) < 1.0),
        ),
        (
            "the fix of a course",
            r#"<CF id="p" fix="D5" course="0"/>"#,
            r#"<CF id="p" fix="E5" course="0"/>"#,
            |rest| rest.last().is_some_and(|p| p.distance_m(fix("E5")) < 1.0),
        ),
        (
            "the track until an altitude",
            r#"<FA id="p" fix="C4" course="0" altitude="1200" altitudeReference="agl"/>"#,
            r#"<FA id="p" fix="C4" course="90" altitude="1200" altitudeReference="agl"/>"#,
            |rest| rest.last().is_some_and(|p| p.lon_deg > fix("C4").lon_deg + 0.005),
        ),
    ];
    for (what, old, new, arrived) in cases {
        let mut rig = Rig::flying(&document(old));
        rig.fly_to("p");
        rig.fly_one();
        rig.update(&program(&document(new))).unwrap();
        let rest: Vec<_> = rest(&mut rig).iter().map(|w| w.position).collect();
        assert!(arrived(&rest), "{what}: {rest:?}");
        let legs = rig.legs().replace(" q", "");
        assert_eq!(legs, "a b p z", "{what}: the leg goes on, it isn't entered again");
    }
}

/// Laps flown count on: four are four.
#[test]
fn laps_of_a_holding_that_has_changed_count_on() {
    let holding = r#"<HM id="p" fix="C4" course="= c" turn="right" length="600" maxLaps="3"/>"#;
    let mut rig = Rig::flying(&document(holding));
    let at_fix = |rig: &Rig| rig.flown.iter().filter(|w| w.position.distance_m(fix("C4")) < 1.0).count();
    while at_fix(&rig) < 3 {
        rig.fly_one();
    }
    rig.fly_one();
    rig.set("c", 90.0).unwrap();
    rig.fly_to_the_end();
    // to the fix, one lap and two; the third begins anew at the fix
    assert_eq!(at_fix(&rig), 5);
}

/// Only values lay it out anew, not the wind.
#[test]
fn a_wind_that_has_freshened_leaves_the_leg_being_flown_as_it_is() {
    for (name, leg) in LEGS {
        let mut rig = flying(leg);
        let before = rig.buffer.clone();
        rig.wind_east_mps = 13.0;
        rig.report();
        rig.set("s", 300.0).unwrap();
        rig.now += flight_exec::Time::from_secs(2);
        rig.report();
        let of_leg = |b: &std::collections::VecDeque<Waypoint>| {
            b.iter().filter(|w| w.leg.as_str() == "p").cloned().collect::<Vec<_>>()
        };
        assert_eq!(of_leg(&rig.buffer), of_leg(&before), "{name}");
    }
}

/// On its track it turns where it is; the fix behind it is not flown to once more.
#[test]
fn a_climb_along_a_track_goes_on_from_where_its_course_was_changed() {
    let climb = r#"<FA id="p" fix="C4" course="= c" altitude="1200" altitudeReference="agl"/>"#;
    let mut rig = Rig::flying(&document(climb));
    rig.fly_to("p");
    while rig.flown.iter().filter(|w| w.leg.as_str() == "p").count() < 4 {
        rig.fly_one();
    }
    rig.set("c", 90.0).unwrap();
    let rest: Vec<_> = rest(&mut rig).iter().map(|w| w.position).collect();
    let last = rest.last().unwrap();
    assert!(last.lon_deg > fix("C4").lon_deg + 0.005, "{rest:?}");
    assert!(rest.iter().all(|p| p.distance_m(fix("C4")) > 1000.0), "{rest:?}");
}
