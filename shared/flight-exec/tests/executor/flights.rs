//! Several flights in one plan: it lands, waits for a start, and goes on with what it knows.

use crate::rig::{HOME, Rig, document_with, program};
use flight_exec::{AircraftState, Command, Config, Event, Executor, Input, Phase, Token};
use flight_plan::Cause;
use std::sync::Arc;
use terrain::Flat;

/// Two flights: `first`, and behind the landing `second`.
fn two_flights(first: &str, second: &str) -> String {
    let variables = r#"<variable name="n" type="number" initial="0"/>"#;
    let land = r#"<stage id="land" type="land" runway="R"/>"#;
    let more = format!(
        r#"<stage id="land" type="land" runway="R" turnaroundEnergy="0.9" turnaroundTime="600"/>
           <stage id="to2" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
           <stage id="m2" type="mission" altitude="200" altitudeReference="agl">{second}</stage>
           <stage id="land2" type="land" runway="R"/>"#
    );
    document_with(first, variables, "").replacen(land, &more, 1)
}

const FIRST: &str =
    r#"<TF id="a" fix="B1"><action on="end"><set variable="n" to="= n + 1.0"/></action></TF>"#;
const SECOND: &str = r#"<TF id="b" fix="B2"/>"#;

fn phase(rig: &Rig) -> Phase {
    rig.executor.status().phase
}

fn stands(rig: &mut Rig) {
    (rig.position, rig.now) = (HOME, rig.now + flight_exec::Time::from_secs(60));
    let state = AircraftState { on_ground: true, ground_speed_mps: 0.0, airspeed_mps: 0.0, ..rig.state() };
    rig.step(Input::Aircraft(state));
}

/// After the first landing.
fn grounded() -> Rig {
    let mut rig = Rig::flying(&two_flights(FIRST, SECOND));
    while rig.fly_one() {}
    assert_eq!(phase(&rig), Phase::Grounded);
    stands(&mut rig);
    rig
}

fn n(rig: &Rig) -> Option<f64> {
    match rig.executor.variables().get(&"n".into()) {
        Some(flight_plan::VariableValue::Number(n)) => Some(*n),
        _ => None,
    }
}

#[test]
fn it_waits_on_the_ground_and_goes_on_with_its_values() {
    let mut rig = grounded();
    assert_eq!((rig.leg().as_str(), rig.buffer.len(), n(&rig)), ("to2", 0, Some(1.0)));
    let before = rig.feeds;
    stands(&mut rig);
    assert_eq!(rig.feeds, before, "nothing is handed out before the start");
    rig.command(Command::Start).unwrap();
    assert_eq!((phase(&rig), rig.leg().as_str()), (Phase::Flying, "to2"));
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), n(&rig)), ("a to2 b land2", Some(1.0)));
    assert!(rig.flown.is_sorted_by(|a, b| a.token < b.token));
}

#[test]
fn nothing_behind_the_landing_is_handed_out_before_it() {
    let mut rig = Rig::flying(&two_flights(FIRST, SECOND));
    rig.fly_to("a");
    let last = rig.buffer.back().unwrap();
    assert_eq!((last.leg.as_str(), last.end_of_plan), ("land", true));
}

#[test]
fn in_the_air_nothing_of_another_flight_is_flown_to() {
    let mut rig = Rig::flying(&two_flights(FIRST, SECOND));
    rig.fly_to("a");
    assert_eq!(rig.command(Command::GoTo { leg: "b".into() }).unwrap_err().code, "other-flight");
    rig.command(Command::SkipLeg).unwrap();
    rig.fly_to("land");
    assert_eq!(rig.command(Command::SkipLeg).unwrap_err().code, "last-leg");
    while rig.fly_one() {}
    stands(&mut rig);
    rig.command(Command::Start).unwrap();
    rig.fly_to("b");
    assert_eq!(rig.command(Command::GoTo { leg: "a".into() }).unwrap_err().code, "other-flight");
    rig.command(Command::GoTo { leg: "b".into() }).unwrap();
}

#[test]
fn between_flights_there_is_no_emergency_and_no_leg() {
    let mut rig = grounded();
    let emergency = Command::Emergency { cause: Cause::Operator, plan: None };
    for command in [emergency, Command::Hold, Command::SkipLeg, Command::GoTo { leg: "b".into() }] {
        let refusal = rig.command(command).unwrap_err();
        assert!(refusal.code == "not-flying" && refusal.reason.contains("start the next one"), "{refusal}");
    }
    assert_eq!(phase(&rig), Phase::Grounded);
}

#[test]
fn a_plan_that_comes_on_the_ground_is_gone_on_with() {
    let mut rig = grounded();
    rig.update(&program(&two_flights(FIRST, r#"<TF id="c" fix="C2"/>"#))).unwrap();
    assert_eq!((phase(&rig), rig.leg().as_str()), (Phase::Grounded, "to2"));
    rig.command(Command::Start).unwrap();
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), n(&rig)), ("a to2 c land2", Some(1.0)));
}

#[test]
fn a_plan_without_the_next_flight_asks_for_the_one_to_begin() {
    let mut rig = grounded();
    let other = program(&two_flights(FIRST, SECOND).replace("to2", "again"));
    assert!(rig.propose(&other).entry_needed);
    assert_eq!(rig.update(&other).unwrap_err().code, "entry-needed");
    let commit = |entry: &str| Command::Commit { hash: other.hash().clone(), entry: Some(entry.into()) };
    assert_eq!(rig.command(commit("b")).unwrap_err().code, "entry-needed");
    rig.command(commit("again")).unwrap();
    rig.command(Command::Start).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a again b land2");
}

/// The arming was refused, or somebody held it.
#[test]
fn a_later_flight_that_did_not_take_off_is_started_again() {
    let mut rig = grounded();
    rig.command(Command::Start).unwrap();
    rig.command(Command::Hold).unwrap();
    stands(&mut rig);
    rig.command(Command::Start).unwrap();
    assert_eq!((rig.leg().as_str(), n(&rig)), ("to2", Some(1.0)));
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a to2 b land2");
}

#[test]
fn a_flight_that_did_not_take_off_stands_where_it_stood_before() {
    let mut rig = grounded();
    rig.command(Command::Start).unwrap();
    assert!(!rig.buffer.is_empty());
    rig.step(Input::NotLaunched);
    assert_eq!(
        (phase(&rig), rig.leg().as_str(), rig.buffer.len(), n(&rig)),
        (Phase::Grounded, "to2", 0, Some(1.0))
    );
    rig.command(Command::Start).unwrap();
    rig.fly_to("b");
    rig.step(Input::NotLaunched);
    assert_eq!(phase(&rig), Phase::Flying, "it comes too late");
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a to2 b land2");
}

#[test]
fn the_first_flight_that_did_not_take_off_is_not_begun() {
    let mut rig = Rig::new();
    rig.update(&program(&two_flights(FIRST, SECOND))).unwrap();
    stands(&mut rig);
    rig.command(Command::Start).unwrap();
    rig.step(Input::NotLaunched);
    assert_eq!((phase(&rig), rig.buffer.len()), (Phase::Idle, 0));
}

#[test]
fn rewound_between_flights_it_begins_anew() {
    let mut rig = grounded();
    rig.command(Command::Rewind).unwrap();
    assert_eq!(phase(&rig), Phase::Idle);
    rig.command(Command::Start).unwrap();
    assert_eq!((rig.leg().as_str(), n(&rig)), ("to", Some(0.0)));
}

#[test]
fn an_emergency_plan_of_a_later_flight_ends_the_plan() {
    let mut rig = grounded();
    rig.command(Command::Start).unwrap();
    rig.fly_to("b");
    rig.command(Command::Emergency { cause: Cause::Operator, plan: None }).unwrap();
    rig.fly_to("b-df");
    assert_eq!(rig.command(Command::ReturnToMain { leg: "a".into() }).unwrap_err().code, "other-flight");
    rig.fly_to_the_end();
}

#[test]
fn a_snapshot_stands_between_the_same_flights() {
    let mut restored = grounded();
    let rig = &restored;
    let snapshot = rig.executor.snapshot();
    let plan = rig.executor.program().cloned();
    let terrain = Arc::new(Flat(crate::rig::GROUND_M));
    restored.executor =
        Executor::restore(Config::default(), terrain, Default::default(), plan, snapshot).unwrap();
    assert_eq!((phase(&restored), restored.leg().as_str()), (Phase::Grounded, "to2"));
    stands(&mut restored);
    restored.command(Command::Start).unwrap();
    restored.fly_to_the_end();
    assert_eq!(restored.legs(), "a to2 b land2");
}

/// Counts of intersections and what is done once go on; the gateway may report late.
#[test]
fn reports_on_the_ground_change_nothing() {
    let mut rig = grounded();
    rig.step(Input::Progress { current: Some(Token(1)) });
    rig.step(Input::Progress { current: None });
    rig.step(Input::Landed);
    rig.step(Input::GatewayControls(true));
    rig.step(Input::GatewayControls(false));
    assert_eq!((phase(&rig), rig.buffer.len()), (Phase::Grounded, 0));
    let grounded = |e: &&Event| matches!(e, Event::PhaseChanged { phase: Phase::Grounded });
    assert_eq!(rig.events.iter().filter(grounded).count(), 1);
}

/// The second flight takes off from a field that is 150 m higher, and counts its altitudes from there.
fn from_a_higher_field() -> String {
    let (field, home) = (r#"<runway id="R""#, r#"altitude="200" altitudeReference="home""#);
    let second = format!(r#"<TF id="b" fix="B2" {home}/>"#);
    let higher = format!(
        r#"<runway id="S" lat="36.5" lon="-84.2" elevation="450" heading="90" length="600" priority="2"/>{field}"#
    );
    two_flights(&format!(r#"<TF id="a" fix="B1" {home}/>"#), &second)
        .replacen(field, &higher, 1)
        .replace(r#"id="to2" type="take-off" runway="R""#, r#"id="to2" type="take-off" runway="S""#)
        .replace(
            r#"fix="A1" altitude="150" altitudeReference="agl""#,
            r#"fix="A1" altitude="150" altitudeReference="home""#,
        )
}

fn altitude_m(rig: &Rig, leg: &str) -> f64 {
    rig.buffer.iter().find(|w| w.leg.as_str() == leg).expect(leg).altitude_amsl_m
}

#[test]
fn home_is_the_field_that_the_present_flight_took_off_from() {
    let mut rig = Rig::flying(&from_a_higher_field());
    assert_eq!(altitude_m(&rig, "a"), 500.0);
    while rig.fly_one() {}
    stands(&mut rig);
    rig.command(Command::Start).unwrap();
    assert_eq!(altitude_m(&rig, "b"), 650.0);
    rig.command(Command::Emergency { cause: Cause::Operator, plan: None }).unwrap_err();
    rig.fly_to("b");
    rig.command(Command::GoTo { leg: "b".into() }).unwrap();
    assert_eq!(altitude_m(&rig, "b"), 650.0);
    rig.command(Command::Emergency { cause: Cause::Operator, plan: None }).unwrap();
    assert_eq!(altitude_m(&rig, "b-df"), 600.0, "the way out of this flight");
}

#[test]
fn home_stays_that_field_in_a_new_plan_and_after_a_restart() {
    let mut rig = Rig::flying(&from_a_higher_field());
    while rig.fly_one() {}
    stands(&mut rig);
    rig.command(Command::Start).unwrap();
    rig.fly_to("b");
    let longer = r#"<TF id="c" fix="C2" altitude="210" altitudeReference="home"/></stage>
           <stage id="land2""#;
    let document = from_a_higher_field().replacen("</stage>\n           <stage id=\"land2\"", longer, 1);
    rig.update(&program(&document)).unwrap();
    assert_eq!((altitude_m(&rig, "b"), altitude_m(&rig, "c")), (650.0, 660.0));
    let plan = rig.executor.program().cloned();
    let terrain = Arc::new(Flat(crate::rig::GROUND_M));
    let snapshot = rig.executor.snapshot();
    rig.executor = Executor::restore(Config::default(), terrain, Default::default(), plan, snapshot).unwrap();
    rig.command(Command::Emergency { cause: Cause::Operator, plan: None }).unwrap();
    assert_eq!(altitude_m(&rig, "b-df"), 600.0);
}

/// Another field in its place would be hundreds of metres off.
#[test]
fn a_plan_without_the_field_that_the_flight_took_off_from_is_refused_in_an_emergency() {
    let mut rig = Rig::flying(&from_a_higher_field());
    while rig.fly_one() {}
    stands(&mut rig);
    rig.command(Command::Start).unwrap();
    rig.fly_to("b");
    rig.command(Command::Emergency { cause: Cause::Operator, plan: None }).unwrap();
    let renamed =
        from_a_higher_field().replace(r#"id="S""#, r#"id="T""#).replace(r#"runway="S""#, r#"runway="T""#);
    let refusal = rig.update(&program(&renamed)).unwrap_err();
    assert!(refusal.code == "home-gone" && refusal.reason.contains("`S`"), "{refusal}");
    assert_eq!(altitude_m(&rig, "b-df"), 600.0, "the plan before is flown on");
}

/// Of the first flight nobody names it: it is the plan's first.
#[test]
fn in_an_emergency_of_the_first_flight_a_plan_with_another_first_field_is_refused() {
    let mut rig = Rig::flying(&from_a_higher_field());
    rig.fly_to("a");
    rig.command(Command::Emergency { cause: Cause::Operator, plan: None }).unwrap();
    let other =
        from_a_higher_field().replacen(r#"type="take-off" runway="R""#, r#"type="take-off" runway="S""#, 1);
    let refusal = rig.update(&program(&other)).unwrap_err();
    assert!(refusal.code == "home-gone" && refusal.reason.contains("`R`"), "{refusal}");
}

/// A plan of other identifiers may be entered anywhere; where it knows the present flight, only in that.
#[test]
fn in_the_air_a_new_plan_is_not_entered_in_another_flight() {
    let mut rig = Rig::flying(&two_flights(FIRST, SECOND));
    rig.fly_to("a");
    let other = program(&two_flights(r#"<TF id="c" fix="C1"/>"#, SECOND));
    let commit = |rig: &mut Rig, program: &Arc<flight_plan::Program>, entry: &str| {
        rig.propose(program);
        rig.command(Command::Commit { hash: program.hash().clone(), entry: Some(entry.into()) })
    };
    let refusal = commit(&mut rig, &other, "b").unwrap_err();
    assert!(refusal.code == "other-flight" && refusal.reason.contains("a landing is between"), "{refusal}");
    assert_eq!(rig.leg().as_str(), "a", "the plan before is flown on");
    commit(&mut rig, &other, "c").unwrap();
    let renamed = two_flights(r#"<TF id="d" fix="C1"/>"#, r#"<TF id="e" fix="B2"/>"#);
    let renamed = ["to", "m", "land"].iter().fold(renamed, |text, id| {
        text.replace(&format!(r#"<stage id="{id}""#), &format!(r#"<stage id="x-{id}""#))
    });
    commit(&mut rig, &program(&renamed), "e").unwrap();
    rig.fly_to_the_end();
}
