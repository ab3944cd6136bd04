//! What each kind of leg gives.

use crate::rig::{GROUND_M, HOME, Rig, check, fix};
use flight_exec::Action;
use flight_exec::{Command, Event, Phase};
use geometry::LatLon;

#[test]
fn take_off_tracks_landing() {
    let rig =
        check(r#"<IF id="i" fix="A1"/><TF id="t" fix="B1" altitude="700" altitudeReference="amsl"/>"#, "i t");
    let (first, last) = (rig.flown.first().unwrap(), rig.flown.last().unwrap());
    assert_eq!(first.action, Action::TakeOff { heading_deg: 90.0 });
    assert!((first.altitude_amsl_m - 400.0).abs() < 1e-6);
    assert_eq!(last.action, Action::Land { heading_deg: 90.0 });
    assert!(last.end_of_plan && rig.flown.iter().filter(|w| w.end_of_plan).count() == 1);
    assert!(last.position.distance_m(HOME) < 0.1);
    let altitudes: Vec<_> =
        rig.flown.iter().filter(|w| w.leg.as_str().len() == 1).map(|w| w.altitude_amsl_m).collect();
    assert_eq!(altitudes, [GROUND_M + 200.0, 700.0], "the stage's above ground, then the leg's own");
}

#[test]
fn altitude_and_speed_come_from_leg_loop_stage_and_profile() {
    let legs = r#"
        <TF id="a" fix="A1" speed="30"/>
        <iterative id="l" form="forward" count="1" altitude="700" altitudeReference="amsl" speed="20">
          <TF id="b" fix="B1"/><TF id="c" fix="B2" altitude="800" altitudeReference="amsl"/>
        </iterative>
        <TF id="d" fix="A2"/>"#;
    let rig = check(legs, "a b c d");
    let seen: Vec<_> = ["a", "b", "c", "d"]
        .iter()
        .map(|l| rig.flown.iter().find(|w| w.leg.as_str() == *l).unwrap())
        .map(|w| (w.altitude_amsl_m, w.airspeed_mps))
        .collect();
    assert_eq!(seen, [(500.0, 30.0), (700.0, 20.0), (800.0, 20.0), (500.0, 25.0)]);
}

#[test]
fn next_jumps() {
    let legs = r#"<TF id="a" fix="A1" next="c"/><TF id="b" fix="B1" next="d"/>
        <TF id="c" fix="B2" next="b"/><TF id="d" fix="A2"/>"#;
    check(legs, "a c b d");
}

#[test]
fn an_arc_is_flown_around_its_centre() {
    let centre = fix("B1");
    let (from, to) = (centre.destination(180.0, 600.0), centre.destination(0.0, 600.0));
    let at = |p: LatLon| format!(r#"lat="{}" lon="{}""#, p.lat_deg, p.lon_deg);
    let (before, after) = (at(from.destination(270.0, 2500.0)), at(to.destination(270.0, 2500.0)));
    let (start, end) = (at(from), at(to));
    let (lat, lon) = (centre.lat_deg, centre.lon_deg);
    let legs = format!(
        r#"<TF id="a" {before}/><TF id="b" {start}/>
           <RF id="r" {end} centreLat="{lat}" centreLon="{lon}" turn="left"/><TF id="c" {after}/>"#
    );
    let rig = check(&legs, "a b r c");
    let arc: Vec<_> = rig.flown.iter().filter(|w| w.leg.as_str() == "r").collect();
    assert!(arc.len() > 5);
    assert!(arc.iter().all(|w| (-0.1..3.1).contains(&(centre.distance_m(w.position) - 600.0))));
    assert!(arc.last().unwrap().position.distance_m(to) < 0.1);
    let east = arc.iter().filter(|w| w.position.lon_deg > centre.lon_deg).count();
    assert!(east >= arc.len() - 1, "a left turn from south to north goes round by the east");
}

#[test]
fn a_holding_to_fix_flies_one_lap() {
    let legs = r#"<TF id="a" fix="B1"/><HF id="h" fix="B2" course="0" turn="right" length="800"/><TF id="c" fix="A2"/>"#;
    let rig = check(legs, "a h c");
    let crossings =
        rig.flown.iter().filter(|w| w.leg.as_str() == "h" && w.position.distance_m(fix("B2")) < 0.1);
    assert_eq!(crossings.count(), 2, "to the fix, and back over it after the lap");
}

#[test]
fn a_holding_to_altitude_goes_on_until_it_is_really_reached() {
    let legs = r#"<TF id="a" fix="B1"/>
        <HA id="h" fix="B2" course="0" turn="right" length="800" altitude="700" altitudeReference="amsl"/><TF id="c" fix="A2"/>"#;
    let laps = |altitude_amsl_m: f64, at_most: usize| {
        let mut rig = Rig::started(legs);
        rig.fly_to("h");
        rig.altitude_amsl_m = Some(altitude_amsl_m);
        let fix = fix("B2");
        let mut crossings = 0;
        while rig.leg() == "h" && crossings < at_most {
            let at_fix = rig.buffer.front().unwrap().position.distance_m(fix) < 0.1;
            rig.fly_one();
            crossings += usize::from(at_fix);
        }
        crossings
    };
    assert_eq!(laps(700.0, 50), 1, "there already: over the fix and on");
    assert_eq!(laps(680.0, 20), 20, "never reached: lap after lap");
}

#[test]
fn an_orbit_is_flown_as_often_as_asked() {
    let legs = format!(
        r#"<TF id="a" fix="B1"/><orbit id="o" radius="300" turns="2" turn="left"><centre lat="{}" lon="{}"/></orbit><TF id="c" fix="A2"/>"#,
        fix("B2").lat_deg,
        fix("B2").lon_deg
    );
    let rig = check(&legs, "a o c");
    let bearings: Vec<_> = rig
        .flown
        .iter()
        .filter(|w| w.leg.as_str() == "o")
        .map(|w| fix("B2").bearing_deg(w.position))
        .collect();
    let turned: f64 = bearings.windows(2).map(|b| geometry::geodesy::normalise_180(b[1] - b[0])).sum();
    assert!((-1080.0..=-719.0).contains(&turned), "{turned}");
}

#[test]
fn a_scan_covers_its_area_and_turns_outside() {
    let legs = r#"<TF id="a" fix="B1"/>
        <scan id="s" spacing="150" heading="0" overshoot="50"><area fix="C3" radius="590"/></scan><TF id="c" fix="A2"/>"#;
    let rig = check(legs, "a s c");
    let points: Vec<_> = rig.flown.iter().filter(|w| w.leg.as_str() == "s").collect();
    assert_eq!(points.len(), 2 * 8, "1180 m in lines of 150 m, two points each");
    let out = points.iter().map(|w| fix("C3").distance_m(w.position)).fold(f64::INFINITY, f64::min);
    assert!(out > 590.0, "every turn is outside the area: {out}");
}

#[test]
fn the_phase_is_told() {
    let mut rig = Rig::started(r#"<TF id="a" fix="B1"/>"#);
    assert_eq!(rig.executor.status().phase, Phase::Flying);
    rig.fly_one();
    assert_eq!(rig.command(Command::Start).unwrap_err().code, "already-flying");
    rig.fly_to_the_end();
    assert!(rig.events.contains(&Event::PhaseChanged { phase: Phase::Finished }));
    rig.command(Command::Start).unwrap();
    rig.flown.clear();
    rig.fly_to_the_end();
}

/// What a climb-out is above: the runway's ground, or the sea.
#[test]
fn a_take_off_climbs_to_its_altitude_whatever_it_is_above() {
    let text = crate::rig::document(r#"<TF id="a" fix="B1" altitude="150" altitudeReference="home"/>"#);
    for (reference, climbed_m) in [("agl", 100.0), ("home", 100.0), ("amsl", 480.0 - GROUND_M)] {
        let altitude = if reference == "amsl" { 480 } else { 100 };
        let stage = format!(r#"altitude="{altitude}" altitudeReference="{reference}"/>"#);
        let text = text.replacen(r#"altitude="100" altitudeReference="agl"/>"#, &stage, 1);
        let mut rig = Rig::flying(&text);
        assert!((rig.buffer[0].altitude_amsl_m - GROUND_M - climbed_m).abs() < 1e-6, "{reference}");
        rig.fly_to("a");
        assert!((rig.flown.last().unwrap().altitude_amsl_m - GROUND_M - 150.0).abs() < 1e-6, "above home");
    }
}

/// PX4 leaves a line when its list is changed in the middle of it: what follows a long line is fed before that begins.
#[test]
fn what_follows_a_long_line_is_handed_out_before_it_begins() {
    let legs = r#"<TF id="a" fix="A1"/><TF id="long" fix="D1"/>
        <expandingSquare id="s" spacing="300" radius="900" turn="right"><centre fix="D1"/></expandingSquare>"#;
    let mut rig = Rig::started(legs);
    rig.fly_to("a");
    let ahead: Vec<_> = rig.buffer.iter().collect();
    let long = ahead.iter().position(|w| w.leg.as_str() == "long").unwrap();
    let behind_s = |w: &[&flight_exec::Waypoint]| w[0].position.distance_m(w[1].position) / w[1].airspeed_mps;
    let seconds: f64 = ahead[long..].windows(2).map(behind_s).sum();
    assert!(seconds >= 110.0, "{seconds:.0} s behind the long line, {} waypoints", ahead.len());
}
