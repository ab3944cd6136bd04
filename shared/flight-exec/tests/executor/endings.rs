//! How plans end: where they do, what is reported, and what comes when an end was none.

use crate::rig::{HOME, Rig, document, document_with, fix, program};
use flight_exec::{AircraftState, Command, Event, Input, Phase, Time, Token};
use flight_plan::{Cause, VariableValue};
use geometry::geodesy::normalise_180;

const GO: &str =
    r#"<variable name="go" type="bool" initial="true"/><variable name="n" type="number" initial="0"/>"#;

/// A plan that ends with its mission legs, without a landing.
fn ending_with(legs: &str) -> Rig {
    let text = document_with(legs, GO, "");
    Rig::flying(&text.replacen(r#"<stage id="land" type="land" runway="R"/>"#, "", 1))
}

fn go(rig: &mut Rig, go: bool) {
    rig.command(Command::SetVariable { name: "go".into(), value: VariableValue::Bool(go) }).unwrap();
}

fn finished(rig: &Rig) -> Vec<u64> {
    let of = |e: &Event| match e {
        Event::IterationFinished { finished, .. } => Some(*finished),
        _ => None,
    };
    rig.events.iter().filter_map(of).collect()
}

/// By default at its deadline, or decided: then it is asked for, and the end shows as no way further.
#[test]
fn a_decision_that_leads_to_the_end_is_told() {
    for (default, decided, by) in [("out", None, "default"), ("again", Some("out"), "operator")] {
        let mut rig = ending_with(&format!(
            r#"<TF id="a" fix="B1"/><TF id="b" fix="B2"/><intersection id="x" default="{default}" decideBefore="10s">
               <branch id="again" label="Again" next="a"/><branch id="out" label="Out"/></intersection>"#
        ));
        rig.fly_to("b");
        if let Some(branch) = decided {
            let request = rig.executor.status().decision.unwrap();
            let ways: Vec<usize> = request.options.iter().map(|o| o.preview.len()).collect();
            assert!(ways[0] > 1 && ways[1] == 1, "the place itself, and nothing beyond it: {ways:?}");
            rig.command(Command::Decide { leg: "x".into(), branch: branch.into() }).unwrap();
        }
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), "a b");
        let taken = rig.events.iter().filter_map(|e| match e {
            Event::DecisionTaken { branch, by, .. } => Some((branch.as_str(), by.as_str())),
            _ => None,
        });
        assert_eq!(Vec::from_iter(taken), [("out", by)]);
    }
}

#[test]
fn an_orbit_before_nothing_is_left_where_its_turns_end() {
    let mut rig = ending_with(
        r#"<TF id="a" fix="B1"/><orbit id="o" radius="300" turns="2" turn="left"><centre fix="B2"/></orbit>"#,
    );
    rig.fly_to_the_end();
    let bearings: Vec<f64> = rig
        .flown
        .iter()
        .filter(|w| w.leg.as_str() == "o")
        .map(|w| fix("B2").bearing_deg(w.position))
        .collect();
    let turned: f64 = bearings.windows(2).map(|b| normalise_180(b[1] - b[0])).sum();
    assert!((turned + 720.0).abs() < 0.1, "{turned}");
}

/// The loop was to go on; its end is marked where the pass being flown ends, not at a waypoint behind it.
#[test]
fn a_loop_that_ends_the_plan_earlier_than_laid_out_ends_it_where_its_pass_ends() {
    let mut rig = ending_with(
        r#"<iterative id="l" form="forward" until="battery &lt; 0.5"><TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative>"#,
    );
    rig.fly_to("b");
    rig.battery = 0.4;
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), finished(&rig)), ("a b", vec![1]));
    let last = rig.flown.last().unwrap();
    assert!(last.end_of_plan && last.position.distance_m(fix("B2")) < 0.1, "{last:?}");
}

#[test]
fn a_loop_that_ends_the_plan_is_looked_at_again_until_it_ends() {
    let mut rig = ending_with(
        r#"<iterative id="l" form="forward" until="go"><TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative>"#,
    );
    rig.fly_to("b");
    assert!(rig.buffer[0].end_of_plan);
    let due = rig.executor.deadline().unwrap();
    assert!(due - rig.now <= Time::from_millis(1001), "nothing else is due");
    go(&mut rig, false);
    assert!(!rig.buffer[0].end_of_plan, "it goes on");
    rig.fly_to("a");
    go(&mut rig, true);
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), finished(&rig)), ("a b a b", vec![1, 2]));
}

/// Within the debouncing time of another change the loop's end isn't known to be none: the aircraft has flown its last waypoint.
#[test]
fn an_end_that_is_reached_stays_one() {
    let mut rig = ending_with(
        r#"<iterative id="l" form="forward" until="go"><TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative>"#,
    );
    rig.fly_to("b");
    rig.now += Time::from_secs(60);
    rig.position = fix("B2");
    rig.report();
    rig.set("n", 1.0).unwrap();
    rig.now += Time::from_millis(100);
    go(&mut rig, false);
    rig.buffer.clear();
    rig.step(Input::Progress { current: None });
    assert_eq!(rig.executor.status().phase, Phase::Finished);
    assert!(finished(&rig).is_empty(), "no arrival that counts");
    assert!(rig.buffer.is_empty());
}

/// The gateway has nothing left although the plan isn't over: what was ahead counts as flown, and the way goes on behind it.
#[test]
fn run_dry_the_plan_goes_on_behind_what_was_handed_out() {
    let fixes = ["B1", "C1", "D1", "D2", "C2", "B2", "B3", "C3", "D3", "D4"];
    let legs: String = (0..)
        .zip(fixes)
        .map(|(i, f)| format!(r#"<TF id="t{i}" fix="{f}"><action on="end"><photo/></action></TF>"#))
        .collect();
    let mut rig = Rig::started(&legs);
    rig.fly_to("t1");
    let last = rig.buffer.back().unwrap().clone();
    assert!(!last.end_of_plan);
    rig.position = last.position;
    rig.buffer.clear();
    rig.step(Input::Progress { current: None });
    assert_eq!(rig.executor.status().phase, Phase::Flying);
    assert!(
        rig.buffer.front().is_some_and(|w| w.token > last.token && w.leg != last.leg),
        "{:?}",
        rig.buffer
    );
    rig.flown.push(last);
    rig.fly_to_the_end();
    let photos: Vec<&str> = rig.acts.iter().map(|(leg, ..)| leg.as_str()).collect();
    assert_eq!(photos, ["t0", "t1", "t2", "t3", "t4", "t5", "t6", "t7", "t8", "t9"]);
}

#[test]
fn a_refusal_of_what_is_no_longer_ahead_is_told_and_changes_nothing() {
    let mut rig = Rig::started(r#"<TF id="a" fix="B1"/><TF id="b" fix="B2"/>"#);
    rig.fly_to("b");
    let (before, buffer) = (rig.executor.status(), rig.buffer.clone());
    rig.step(Input::Rejected { first: Token(9999), reason: "late".into() });
    assert!(rig.events.contains(&Event::WaypointsRejected { leg: None, reason: "late".into() }));
    assert_eq!((rig.executor.status(), rig.buffer.clone(), rig.holds), (before, buffer, 0));
}

/// A pass flies `t` and `u`, or nothing at all once the battery is low.
const IDLE: &str = r#"<iterative id="l" form="forward" count="1000000">
    <intersection id="x" default="fly" decideBefore="0s"><branch id="fly" label="Fly" next="t"/>
      <branch id="idle" label="Idle" next="i" when="battery &lt; 0.5"/></intersection>
    <TF id="t" fix="B1"/><TF id="u" fix="B2"/><IF id="i" fix="B2"/></iterative>"#;

fn at_the_end_of_a_pass(report: impl Fn(&Rig) -> AircraftState) -> Rig {
    let mut rig = Rig::started(IDLE);
    rig.fly_to("u");
    rig.position = fix("B2").destination(180.0, 30.0);
    rig.now += Time::from_secs(80);
    rig.report();
    rig.now += Time::from_millis(100);
    let state = report(&rig);
    rig.step(Input::Aircraft(state));
    rig
}

fn stalled(rig: &Rig) -> bool {
    let stalls = |e: &Event| matches!(e, Event::PatternRefused { leg, reason } if leg.as_str() == "l" && reason.contains("flies no waypoint"));
    rig.events.iter().any(stalls)
}

#[test]
fn a_loop_that_flies_nothing_any_more_when_the_aircraft_arrives_holds_it() {
    let mut rig = at_the_end_of_a_pass(|rig| AircraftState { battery: 0.4, ..rig.state() });
    assert!(!stalled(&rig), "conditions are read once a second");
    let next = rig.buffer[1].clone();
    assert_eq!(next.leg.as_str(), "t");
    rig.step(Input::Progress { current: Some(next.token) });
    assert!(stalled(&rig));
    assert_eq!((rig.holds, rig.executor.status().phase), (1, Phase::Holding));
    assert_eq!(rig.command(Command::Resume).unwrap_err().code, "nothing-to-fly");
    assert_eq!((rig.holds, rig.executor.status().phase), (2, Phase::Holding));
    rig.battery = 1.0;
    rig.report();
    rig.command(Command::Resume).unwrap();
    assert_eq!(rig.executor.status().phase, Phase::Flying);
    rig.fly_to("u");
}

#[test]
fn a_loop_that_flies_nothing_any_more_ahead_is_told_while_its_pass_is_flown() {
    let mut rig = at_the_end_of_a_pass(Rig::state);
    rig.battery = 0.4;
    rig.now += Time::from_secs(2);
    rig.report();
    assert!(stalled(&rig));
    assert_eq!((rig.holds, rig.buffer.len(), rig.leg().as_str()), (0, 1, "u"));
}

/// Out of the inner loop and round the outer one are two choices where there was one.
#[test]
fn an_inner_loop_left_on_the_last_metre_is_left_together_with_the_pass_around_it() {
    let legs = r#"<iterative id="out" form="forward" count="2"><iterative id="in" form="forward" until="battery &lt; 0.5">
        <TF id="c" fix="C1"/><TF id="d" fix="C2"/></iterative></iterative><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::started(legs);
    rig.fly_to("d");
    rig.battery = 0.4;
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), finished(&rig)), ("c d c d z", vec![1, 1, 1, 2]));
}

/// Before the first report nobody knows how far it is to the waypoint steered to.
#[test]
fn before_the_first_report_the_waypoint_steered_to_stays() {
    let text = document_with(
        r#"<TF id="a" at="= offset(p, 90.0, n)"/><TF id="b" at="= offset(p, 0.0, n + 3000.0)"/>"#,
        &format!(r#"{GO}<variable name="p" type="position" initial="36.52 -84.15"/>"#),
        "",
    );
    let take_off = r#"<stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>"#;
    let mut rig = Rig::new();
    rig.update(&program(&text.replacen(take_off, "", 1))).unwrap();
    rig.command(Command::Start).unwrap();
    let before = rig.buffer.clone();
    rig.set("n", 1000.0).unwrap();
    assert_eq!(rig.buffer[0], before[0]);
    assert_ne!(rig.buffer[1].position, before[1].position);
}

#[test]
fn numbering_goes_on_after_what_the_gateway_has_seen() {
    let mut rig = Rig::new();
    rig.executor.number_after(Token(1000));
    rig.executor.number_after(Token(10));
    rig.update(&program(&document(r#"<TF id="a" fix="B1"/>"#))).unwrap();
    rig.command(Command::Start).unwrap();
    assert_eq!(rig.buffer[0].token, Token(1001));
    assert_eq!(rig.executor.last_token(), rig.buffer.back().unwrap().token);
}

/// The approach entry, the leg before, and whether the landing goes there.
#[test]
fn a_landing_begins_at_the_approach_entry_unless_that_is_passed() {
    let before = |metres: f64, aside_m: f64| HOME.destination(270.0, metres).destination(0.0, aside_m);
    let aside = before(2500.0, 800.0);
    for (from, entry, goes) in [
        (fix("C4"), before(2500.0, 0.0), true),
        (fix("C4"), aside, true),
        (before(6000.0, 0.0), aside, true),
        (aside, aside, false),
        (before(1500.0, 0.0), before(2500.0, 0.0), false),
        (before(1500.0, 1200.0), before(2500.0, 0.0), true),
    ] {
        let at = |p: geometry::LatLon| format!(r#"lat="{}" lon="{}""#, p.lat_deg, p.lon_deg);
        let legs = format!(r#"<TF id="a" fix="B3"/><TF id="z" {}/>"#, at(from));
        let runway = format!(r#"priority="1" approachEntry="{} {}""#, entry.lat_deg, entry.lon_deg);
        let mut rig = Rig::flying(&document(&legs).replace(r#"priority="1""#, &runway));
        rig.fly_to_the_end();
        let landing: Vec<_> = rig.flown.iter().filter(|w| w.leg.as_str() == "land").collect();
        let first = landing[0];
        assert_eq!(first.position.distance_m(entry) < 1.0, goes, "{from:?} {entry:?}: {landing:#?}");
        let gate = landing[landing.len() - 2];
        assert!((gate.position.distance_m(HOME) - 700.0).abs() < 1.0, "then comes the final: {landing:#?}");
    }
}

#[test]
fn fuel_is_the_tank_s_and_without_one_the_battery_s() {
    let legs = r#"<iterative id="l" form="forward" count="9" until="fuel &lt; 0.5"><TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative>"#;
    for (battery, fuel, passes) in [(1.0, Some(0.4), 1), (0.4, None, 1), (0.4, Some(0.6), 9)] {
        let mut rig = Rig::started(legs);
        (rig.battery, rig.fuel) = (battery, fuel);
        rig.fly_to_the_end();
        assert_eq!(rig.legs().matches('a').count(), passes, "{battery} {fuel:?}");
    }
}

/// By the pilot, or by Safe mode.
#[test]
fn brought_down_by_somebody_else_nothing_ahead_happens_and_it_may_start_again() {
    let legs = r#"<TF id="a" fix="A3"/><TF id="b" fix="B3"><action on="start"><invoke service="s" operation="o"/></action></TF>
        <TF id="c" fix="C3"/>"#;
    let mut rig = Rig::started(legs);
    rig.fly_to("a");
    let (told, acts) = (rig.legs(), rig.acts.len());
    rig.propose(&program(&document(legs)));
    rig.step(Input::GatewayControls(true));
    rig.step(Input::Landed);
    rig.step(Input::GatewayControls(false));
    assert_eq!((rig.legs(), rig.acts.len()), (told, acts));
    assert_eq!(rig.executor.status().phase, Phase::Finished);
    rig.buffer.clear();
    rig.flown.clear();
    rig.command(Command::Start).unwrap();
    rig.fly_to_the_end();
}

/// It was reviewed from where the aircraft was.
#[test]
fn proposal_of_the_flight_is_forgotten_when_that_is_over() {
    let mut rig = Rig::started(r#"<TF id="a" fix="A3"/>"#);
    rig.fly_to("a");
    let other = program(&document(r#"<TF id="b" fix="B3"/>"#));
    rig.propose(&other);
    rig.fly_to_the_end();
    let commit = Command::Commit { hash: other.hash().clone(), entry: None };
    assert_eq!(rig.command(commit).unwrap_err().code, "not-proposed");
}

#[test]
fn before_the_take_off_there_is_no_emergency_and_no_other_leg_is_entered() {
    let mut rig = Rig::started(r#"<TF id="a" fix="A3"/>"#);
    let emergency = Command::Emergency { cause: Cause::Operator, plan: None };
    assert_eq!(rig.command(emergency).unwrap_err().code, "on-ground");
    let other = program(&document(r#"<TF id="b" fix="B3"/>"#));
    rig.propose(&other);
    let enter = Command::Commit { hash: other.hash().clone(), entry: Some("b".into()) };
    assert_eq!(rig.command(enter).unwrap_err().code, "on-ground");
    // held there, or the arming refused: it is started again
    rig.command(Command::Hold).unwrap();
    rig.command(Command::Start).unwrap();
    rig.fly_to_the_end();
}
