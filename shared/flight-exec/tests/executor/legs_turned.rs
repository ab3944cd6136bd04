//! Turns to a fix, and turns that go the other way when a leg is flown backwards.

use crate::rig::{Rig, check, document_with, fix};
use flight_exec::{Event, FARTHEST_M};
use flight_plan::VariableValue;
use geometry::geodesy::normalise_180;
use geometry::{LatLon, LocalFrame};

/// Positions of each passage of a leg, in order.
fn passages(rig: &Rig, leg: &str) -> Vec<Vec<LatLon>> {
    let runs = rig.flown.chunk_by(|a, b| a.leg == b.leg);
    let of_leg = runs.filter(|run| run[0].leg.as_str() == leg);
    of_leg.map(|run| run.iter().map(|w| w.position).collect()).collect()
}

/// Course changes along a way that begins on a course, summed: degrees, positive to the right.
fn turned_deg(course_deg: f64, way: &[LatLon]) -> f64 {
    let courses = way.windows(2).map(|w| w[0].bearing_deg(w[1]));
    let mut before_deg = course_deg;
    let changes = courses.map(|deg| normalise_180(deg - std::mem::replace(&mut before_deg, deg)));
    changes.sum()
}

fn at(p: LatLon) -> String {
    format!(r#"lat="{}" lon="{}""#, p.lat_deg, p.lon_deg)
}

/// Eastwards over B1, then to a fix in the north (B3) or the south (B0).
#[test]
fn a_coded_first_turn_leads_round_when_the_fix_is_on_the_other_side() {
    for (to, turn, expected_deg) in [
        ("B3", "", -90.0),
        ("B3", r#"turn="left""#, -90.0),
        ("B3", r#"turn="right""#, 270.0),
        ("B0", r#"turn="right""#, 90.0),
        ("B0", r#"turn="left""#, -270.0),
    ] {
        let rig = check(
            &format!(r#"<TF id="a" fix="A1"/><TF id="b" fix="B1"/><DF id="d" fix="{to}" {turn}/>"#),
            "a b d",
        );
        let points = passages(&rig, "d").concat();
        let way = Vec::from_iter([fix("B1")].into_iter().chain(points.iter().copied()));
        // round the other side the path comes back one radius beside the fix it left: below 400 m on 2 km
        let off_deg = turned_deg(90.0, &way) - expected_deg;
        assert!(off_deg.abs() < 11.4, "{to} {turn}: {off_deg}° off");
        assert!(points.last().unwrap().distance_m(fix(to)) < 0.1, "{to} {turn}");
        let frame = LocalFrame::new(fix("B1"));
        let (_, round) = points.split_last().unwrap();
        assert_eq!(round.is_empty(), expected_deg.abs() < 180.0, "{to} {turn}");
        let away = if expected_deg > 0.0 { -1.0 } else { 1.0 };
        assert!(round.iter().all(|p| frame.to_local(*p).n * away > -1.0), "{to} {turn}: {round:?}");
    }
}

#[test]
fn a_course_that_can_not_be_joined_is_told_and_its_leg_passed() {
    let variables = r#"<variable name="p" type="position" initial="35.52 -84.15"/>"#;
    // a value can't be near a pole, but what is computed from it can
    let legs =
        r#"<TF id="a" fix="B1"/><CF id="c" at="= offset(p, 0, 111600)" course="90"/><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::flying(&document_with(legs, variables, ""));
    rig.fly_to("a");
    let a_degree_from_the_pole = VariableValue::Position(LatLon::new(89.0, 0.0));
    rig.command(flight_exec::Command::SetVariable { name: "p".into(), value: a_degree_from_the_pole })
        .unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a z");
    let refused = |e: &Event| matches!(e, Event::PatternRefused { leg, reason } if leg.as_str() == "c" && reason.contains("can't be joined"));
    assert_eq!(rig.events.iter().filter(|e| refused(e)).count(), 1, "{:?}", rig.events);
}

fn holding(kind: &str, attributes: &str) -> String {
    format!(
        r#"<TF id="a" fix="B1"/><{kind} id="h" fix="B2" course="0" turn="right" {attributes}/><TF id="z" fix="A3"/>"#
    )
}

#[test]
fn a_holdings_legs_are_as_long_in_time_as_in_distance() {
    let [time, distance] = [r#"time="40" speed="25""#, r#"length="1000" speed="25""#]
        .map(|length| passages(&check(&holding("HF", length), "a h z"), "h").concat());
    assert_eq!(time, distance, "40 s at 25 m/s");
}

/// The gateway would refuse waypoints farther apart, entries and turns included.
#[test]
fn however_long_a_holding_its_waypoints_are_within_reach_of_each_other() {
    for (course, turn) in
        [(0, "right"), (0, "left"), (100, "right"), (100, "left"), (190, "left"), (280, "right")]
    {
        let legs = holding("HF", r#"length="60000""#)
            .replace(r#"course="0" turn="right""#, &format!(r#"course="{course}" turn="{turn}""#));
        let rig = check(&legs, "a h z");
        let points = passages(&rig, "h").concat();
        let farthest_m = points.windows(2).map(|w| w[0].distance_m(w[1])).fold(0.0, f64::max);
        assert!((0.9 * FARTHEST_M..=FARTHEST_M).contains(&farthest_m), "{course} {turn}: {farthest_m}");
    }
}

/// Northbound to the fix the racetrack lies in the east of it, southbound in the west.
#[test]
fn backwards_a_holding_keeps_its_fix_and_side_and_turns_its_course() {
    for (kind, attributes) in [("HF", r#"length="800""#), ("HM", r#"length="800" maxLaps="1""#)] {
        let body = holding(kind, attributes).replace(r#"<TF id="z" fix="A3"/>"#, r#"<TF id="b" fix="B3"/>"#);
        let legs = format!(
            r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="2">{body}</iterative><TF id="z" fix="A3"/>"#
        );
        let rig = check(&legs, "s a h b <l <b <h <a l a h b z");
        let frame = LocalFrame::new(fix("B2"));
        let passages = passages(&rig, "h");
        for (points, inbound_deg, side) in [(&passages[0], 0.0, 1.0), (&passages[1], 180.0, -1.0)] {
            let [.., before, end] = points[..] else { panic!("{kind}: {points:?}") };
            assert!(end.distance_m(fix("B2")) < 0.1, "{kind}");
            let off_deg = normalise_180(before.bearing_deg(end) - inbound_deg);
            assert!(off_deg.abs() < 1.0, "{kind} {inbound_deg}: {off_deg}");
            let beside_m = points.iter().map(|p| side * frame.to_local(*p).e).fold(0.0, f64::max);
            assert!(beside_m > 200.0, "{kind} {inbound_deg}: {beside_m} m beside");
        }
    }
}

/// Half round B1, from the south to the north by the east (left) or by the west (right).
#[test]
fn backwards_an_arc_turns_the_other_way_about_its_centre() {
    let centre = fix("B1");
    let (from, to) = (centre.destination(180.0, 600.0), centre.destination(0.0, 600.0));
    for (turn, side_deg, right) in [("left", 270.0, -180.0), ("right", 90.0, 180.0)] {
        let legs = format!(
            r#"<TF id="a" {}/><iterative id="l" form="reverse" count="2"><TF id="b" {}/><RF id="r" {} centreLat="{}" centreLon="{}" turn="{turn}"/>
               <TF id="c" {}/></iterative><TF id="z" fix="A3"/>"#,
            at(from.destination(side_deg, 2500.0)),
            at(from),
            at(to),
            centre.lat_deg,
            centre.lon_deg,
            at(to.destination(side_deg, 2500.0))
        );
        let rig = check(&legs, "a b r c <l <c <r <b l b r c z");
        let passages = passages(&rig, "r");
        for (points, begin, end, sweep_deg) in
            [(&passages[0], from, to, right), (&passages[1], to, from, -right)]
        {
            assert!(points.last().unwrap().distance_m(end) < 0.1);
            assert!(points.iter().all(|p| (-0.1..3.1).contains(&(centre.distance_m(*p) - 600.0))));
            let bearings =
                Vec::from_iter([begin].iter().chain(points.iter()).map(|p| centre.bearing_deg(*p)));
            let swept: f64 = bearings.windows(2).map(|b| normalise_180(b[1] - b[0])).sum();
            assert!((swept - sweep_deg).abs() < 1.0, "{turn}: {swept}");
        }
    }
}

/// From B1 to B2 the aircraft comes northbound.
#[test]
fn a_holding_without_a_course_lies_as_the_aircraft_arrives() {
    let [arriving, coded] =
        [holding("HF", r#"length="800""#).replace(r#"course="0" "#, ""), holding("HF", r#"length="800""#)]
            .map(|legs| passages(&check(&legs, "a h z"), "h").concat());
    assert_eq!(arriving.len(), coded.len());
    assert!(arriving.iter().zip(&coded).all(|(a, b)| a.distance_m(*b) < 0.1), "{arriving:?}");
}

/// Loops and intersections are walked through, not flown.
#[test]
fn control_legs_have_no_points() {
    use flight_exec::layout::expand::track::{Approach, expand};
    let legs = r#"<iterative id="l" form="forward" count="2"><TF id="a" fix="B1"/></iterative>
        <intersection id="x" default="on" decideBefore="9s"><branch id="on"/><branch id="back" next="l"/></intersection><TF id="z" fix="A3"/>"#;
    let rig = Rig::started(legs);
    let (world, here) = (rig.executor.world(), rig.executor.here());
    let (level, airspeed_mps) = (here.last.level, here.last.airspeed_mps);
    let approach = Approach { path: &here, level, airspeed_mps, reversed: None, continuation: None };
    for (leg, points) in [("l", 0), ("x", 0), ("z", 1)] {
        let leg = world.program.leg(&leg.into()).unwrap();
        assert_eq!(expand(leg, &approach, &world).unwrap().count(), Some(points));
    }
}

#[test]
fn a_holding_at_the_fix_where_the_path_is_does_not_fly_there_once_more() {
    for kind in [r#"HF"#, r#"HM"#] {
        let laps = if kind == "HM" { r#"maxLaps="1""# } else { "" };
        let rig = check(
            &format!(
                r#"<TF id="a" fix="B2"/><{kind} id="h" fix="B2" course="0" turn="right" length="800" {laps}/><TF id="z" fix="A3"/>"#
            ),
            "a h z",
        );
        let apart = rig.flown.windows(2).map(|w| w[0].position.distance_m(w[1].position));
        assert!(apart.fold(f64::INFINITY, f64::min) > 1.0, "{kind}: {:#?}", rig.flown);
    }
}

/// More tracks than are computed at once.
#[test]
fn a_long_scan_is_flown_back_as_it_was_flown_out() {
    let scan = r#"<scan id="s" spacing="2" heading="0"><area fix="C4" radius="900"/></scan>"#;
    let rig = check(
        &format!(
            r#"<iterative id="l" form="reverse" count="2"><TF id="a" fix="B1"/>{scan}</iterative><TF id="z" fix="A2"/>"#
        ),
        "a s <l <s <a l a s z",
    );
    let of_scan = passages(&rig, "s");
    let [out, back, again] = &of_scan[..] else { panic!("{} passages", of_scan.len()) };
    assert!(out.len() > 1200, "{}", out.len());
    // the way back begins where the way out ended, and leads to where it came from
    let back: Vec<_> = back.iter().rev().skip(1).chain(out.last()).copied().collect();
    let farthest =
        |a: &[LatLon], b: &[LatLon]| a.iter().zip(b).map(|(p, q)| p.distance_m(*q)).fold(0.0, f64::max);
    assert_eq!(back.len(), out.len());
    assert_eq!(again.len(), out.len());
    assert!(farthest(&back, out) < 0.01, "{}", farthest(&back, out));
    assert!(farthest(again, out) < 0.01, "{}", farthest(again, out));
}
