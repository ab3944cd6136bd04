//! Courses to and from fixes, and holdings that are left by a condition, a command or a number of laps.

use crate::rig::{GROUND_M, Rig, check, document_with, fix};
use flight_exec::{Command, Event, Time};
use flight_plan::VariableValue;
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// Positions of each passage of a leg, in order.
fn passages(rig: &Rig, leg: &str) -> Vec<Vec<LatLon>> {
    let runs = rig.flown.chunk_by(|a, b| a.leg == b.leg);
    let of_leg = runs.filter(|run| run[0].leg.as_str() == leg);
    of_leg.map(|run| run.iter().map(|w| w.position).collect()).collect()
}

#[test]
fn a_course_to_fix_is_joined_and_ends_on_its_course() {
    for (course_deg, aside_deg) in [(0.0, 30.0), (45.0, -25.0), (135.0, 10.0), (200.0, 0.0), (290.0, -40.0)] {
        let from = fix("C4").destination(course_deg + 180.0 + aside_deg, 6000.0);
        let legs = format!(
            r#"<TF id="a" lat="{}" lon="{}"/><CF id="c" fix="C4" course="{course_deg}"/><TF id="z" fix="A3"/>"#,
            from.lat_deg, from.lon_deg
        );
        let rig = check(&legs, "a c z");
        let points = passages(&rig, "c").concat();
        let [.., before, end] = points[..] else { panic!("{points:?}") };
        assert!(end.distance_m(fix("C4")) < 0.1);
        let off_deg = normalise_180(before.bearing_deg(end) - course_deg);
        assert!(off_deg.abs() < 0.5, "{course_deg}: {off_deg}");
    }
}

/// Another speed has other turns, but they are behind.
#[test]
fn after_a_hold_on_its_course_nothing_of_a_course_to_fix_is_flown_twice() {
    for holds in [1, 2] {
        let from = fix("C4").destination(90.0 + 180.0 + 30.0, 6000.0);
        let legs = format!(
            r#"<TF id="a" lat="{}" lon="{}"/><CF id="c" fix="C4" course="90" speed="= v"/><TF id="z" fix="A3"/>"#,
            from.lat_deg, from.lon_deg
        );
        let speed = r#"<variable name="v" type="number" initial="20" min="18" max="30"/>"#;
        let mut rig = Rig::flying(&document_with(&legs, speed, ""));
        rig.fly_to("c");
        while rig.buffer[0].position.distance_m(fix("C4")) > 1.0 {
            rig.fly_one();
        }
        for _ in 0..holds {
            rig.position = fix("C4").destination(270.0, 1000.0);
            rig.report();
            rig.command(Command::Hold).unwrap();
            rig.command(Command::Resume).unwrap();
        }
        rig.set("v", 28.0).unwrap();
        let ahead: Vec<_> = rig.buffer.iter().filter(|w| w.leg.as_str() == "c").collect();
        assert!(
            ahead.len() >= 2 && ahead.iter().all(|w| w.position.distance_m(fix("C4")) < 1001.0),
            "{ahead:?}"
        );
        assert_eq!(ahead[ahead.len() - 1].airspeed_mps, 28.0);
    }
}

#[test]
fn backwards_a_course_to_fix_is_a_track_to_where_it_came_from() {
    let legs = r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="2">
        <TF id="a" fix="B1"/><CF id="c" fix="C4" course="90"/></iterative><TF id="z" fix="A3"/>"#;
    let rig = check(legs, "s a c <l <c <a l a c z");
    let [out, back, again] = &passages(&rig, "c")[..] else { panic!() };
    assert_eq!(back.len(), 1);
    assert!(back[0].distance_m(fix("B1")) < 0.1);
    // the second time it comes out of a turn-round, on another course
    assert!(out.len() > 1 && again.len() > 1);
}

const CLIMB: &str = r#"<TF id="a" fix="B1"/><FA id="f" fix="B2" course="80" altitude="800" altitudeReference="amsl"/>
    <TF id="z" fix="A3"/>"#;

#[test]
fn a_track_until_an_altitude_is_left_when_it_is_really_reached() {
    for (altitude_amsl_m, points) in [(800.0, 1..=2), (500.0, 40..=40)] {
        let mut rig = Rig::started(CLIMB);
        rig.fly_to("f");
        rig.altitude_amsl_m = Some(altitude_amsl_m);
        while rig.leg() == "f" && passages(&rig, "f").concat().len() < 40 {
            rig.fly_one();
        }
        let flown = passages(&rig, "f").concat();
        assert!(points.contains(&flown.len()), "{altitude_amsl_m}: {}", flown.len());
        for (i, p) in flown.iter().enumerate().skip(1) {
            assert!((fix("B2").distance_m(*p) - 500.0 * i as f64).abs() < 0.1);
            assert!((fix("B2").bearing_deg(*p) - 80.0).abs() < 0.01);
        }
        rig.altitude_amsl_m = Some(800.0);
        rig.fly_to_the_end();
        assert!(passages(&rig, "f").concat().len() <= flown.len() + 1, "left at the next point");
    }
}

#[test]
fn a_track_until_an_altitude_also_descends() {
    let legs = CLIMB.replace(r#"altitude="800""#, r#"altitude="420""#);
    let rig = check(&legs, "a f z");
    let lowest = rig.flown.iter().rfind(|w| w.leg.as_str() == "f").unwrap();
    assert!((lowest.altitude_amsl_m - 420.0).abs() < 30.0 && lowest.altitude_amsl_m > GROUND_M);
}

#[test]
fn an_altitude_that_is_never_reached_is_given_up_in_the_end() {
    let mut rig = Rig::started(CLIMB);
    rig.fly_to("f");
    rig.altitude_amsl_m = Some(400.0);
    rig.fly_to("z");
    let farthest = passages(&rig, "f").concat().iter().map(|p| fix("B2").distance_m(*p)).fold(0.0, f64::max);
    assert!((farthest - 100_000.0).abs() < 10.0, "{farthest}");
}

#[test]
fn backwards_a_track_until_an_altitude_leads_over_its_fix() {
    let legs = r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="2"><TF id="a" fix="B1"/>
        <FA id="f" fix="B2" course="80" altitude="1500" altitudeReference="amsl"/></iterative><TF id="z" fix="A3"/>"#;
    let rig = check(legs, "s a f <l <f <a l a f z");
    let [out, back, ..] = &passages(&rig, "f")[..] else { panic!("{:?}", rig.legs()) };
    assert!(out.len() > 1, "it goes on behind its fix: {out:?}");
    assert_eq!(back.len(), 2);
    assert!(back[0].distance_m(fix("B2")) < 0.1 && back[1].distance_m(fix("B1")) < 0.1);
}

/// The way back to its fix is none.
#[test]
fn backwards_a_track_whose_altitude_was_reached_at_its_fix_leads_on_from_there() {
    let legs = r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="2"><TF id="a" fix="B1"/>
        <FA id="f" fix="B2" course="80" altitude="500" altitudeReference="amsl"/><TF id="t" fix="C3"/></iterative>
        <TF id="z" fix="A3"/>"#;
    let rig = check(legs, "s a f t <l <t <f <a l a f t z");
    let back = &passages(&rig, "f")[1];
    assert!(back.len() == 1 && back[0].distance_m(fix("B1")) < 0.1, "{back:?}");
}

const GO: &str =
    r#"<variable name="go" type="bool" initial="false"/><variable name="n" type="number" initial="0"/>"#;

fn holding(attributes: &str) -> Rig {
    let legs = format!(
        r#"<TF id="a" fix="B1"/><HM id="h" fix="B2" course="0" turn="right" length="600" {attributes}/><TF id="z" fix="A3"/>"#
    );
    let mut rig = Rig::flying(&document_with(&legs, GO, ""));
    rig.fly_to("h");
    rig
}

fn crossings(rig: &Rig) -> usize {
    passages(rig, "h").concat().iter().filter(|p| p.distance_m(fix("B2")) < 0.1).count()
}

#[test]
fn a_holding_ends_after_its_laps() {
    for laps in [1, 3] {
        let mut rig = holding(&format!(r#"maxLaps="{laps}""#));
        rig.fly_to_the_end();
        assert_eq!(crossings(&rig), laps + 1, "over the fix, then {laps} laps");
    }
}

#[test]
fn a_holding_ends_at_the_first_crossing_after_its_condition_holds() {
    let mut rig = holding(r#"until="go""#);
    while crossings(&rig) < 4 {
        rig.fly_one();
    }
    rig.fly_one();
    rig.command(Command::SetVariable { name: "go".into(), value: VariableValue::Bool(true) }).unwrap();
    rig.fly_to_the_end();
    assert_eq!(crossings(&rig), 5);
    assert_eq!(rig.legs(), "a h z");
}

#[test]
fn a_condition_that_holds_already_lets_it_pass() {
    let mut rig = holding(r#"until="n &lt; 1.0""#);
    rig.fly_to_the_end();
    assert_eq!(crossings(&rig), 1);
}

#[test]
fn released_a_holding_is_left_at_the_next_crossing_and_asked_again_at_once() {
    for asked in [1, 2] {
        let mut rig = holding("");
        while crossings(&rig) < 3 {
            rig.fly_one();
        }
        rig.fly_one();
        for _ in 0..asked {
            rig.command(Command::SkipLeg).unwrap();
        }
        rig.steer();
        assert_eq!(rig.leg(), if asked == 1 { "h" } else { "z" });
        rig.fly_to_the_end();
        assert_eq!(crossings(&rig), if asked == 1 { 4 } else { 3 });
    }
}

/// A division by zero at run time: reported once, and the condition counts as false.
#[test]
fn a_condition_without_a_value_is_told_and_does_not_hold() {
    // outside loops the iteration is 0
    let mut rig = holding(r#"until="10 / iteration &gt; 1" maxLaps="4""#);
    rig.fly_to_the_end();
    assert_eq!(crossings(&rig), 5);
    let told: Vec<_> = rig
        .events
        .iter()
        .filter_map(|e| match e {
            Event::ExpressionFailed { leg, reason } => Some((leg.as_str(), reason.as_str())),
            _ => None,
        })
        .collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].0 == "h" && told[0].1.contains("division by zero"), "{told:?}");
}

/// Six kilometres of its twelve are flown when the fix moves aside by twenty metres: it is intercepted ahead.
#[test]
fn a_course_that_moves_on_the_way_is_joined_from_where_the_aircraft_is() {
    for (name, fix_at) in [
        ("behind a turn", fix("C1").destination(45.0, 1500.0).destination(90.0, 12_000.0)),
        ("straight in", fix("C1").destination(90.0, 12_000.0)),
    ] {
        let variables = r#"<variable name="n" type="number" initial="0" min="-100" max="100"/>"#;
        let legs = format!(
            r#"<TF id="a" fix="B1"/><TF id="s" fix="C1"/>
            <CF id="c" at="= offset(lat_lon({}, {}), 0.0, n)" course="90"/><TF id="z" fix="A3"/>"#,
            fix_at.lat_deg, fix_at.lon_deg
        );
        let mut rig = Rig::flying(&document_with(&legs, variables, ""));
        rig.fly_to("c");
        while rig.position.distance_m(rig.buffer[0].position) < 7000.0 {
            assert!(rig.fly_one(), "{name}");
        }
        let course_deg = rig.position.bearing_deg(rig.buffer[0].position);
        rig.position = rig.position.destination(course_deg, 6000.0);
        rig.now += Time::from_secs(240);
        rig.report();
        let before_m = rig.executor.here().distance_m;
        rig.set("n", 20.0).unwrap();
        rig.now += Time::from_secs(30);
        rig.report();
        rig.steer();
        let off_deg = normalise_180(rig.position.bearing_deg(rig.buffer[0].position) - course_deg);
        assert!(off_deg.abs() < 60.0, "{name}: {off_deg}° off");
        assert!((rig.executor.here().distance_m - before_m).abs() < 1.0, "{name}");
    }
}
