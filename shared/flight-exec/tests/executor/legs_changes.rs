//! Who may change what in flight: writers of variables, decisions, proposals by revision, emergencies.

use crate::rig::{Rig, document, document_with, fix, program};
use flight_exec::{Answer, Command, Event, Input, Phase, ProposalReport, Refusal, RequestId, Time};
use flight_plan::{Cause, Problem, Program, VariableValue};
use std::sync::Arc;

const BASE: &str = r#"<TF id="a" fix="A2"/><TF id="b" fix="B2"/><TF id="c" fix="C2"/><TF id="d" fix="C4"/>"#;

fn code(result: Result<(), Refusal>) -> String {
    result.err().map_or_else(|| "done".into(), |r| r.code)
}

/// A command of somebody else than the operator.
fn command_by(rig: &mut Rig, by: &str, command: Command) -> Result<(), Refusal> {
    let input = Input::Command { request: RequestId(1), by: by.into(), command };
    rig.step(input).unwrap().map(drop)
}

#[test]
fn only_its_writers_write_a_variable_and_every_write_is_told_with_the_writer() {
    let variables = r#"<variable name="x" type="number" initial="0" max="9" writers="fire-service"/>
        <variable name="y" type="number" initial="0"/>"#;
    let mut rig = Rig::flying(&document_with(BASE, variables, ""));
    let set =
        |name: &str, n: f64| Command::SetVariable { name: name.into(), value: VariableValue::Number(n) };
    for (by, name, n, expected) in [
        ("operator", "x", 1.0, "not-a-writer"),
        ("fire-service", "x", 1.0, "done"),
        ("fire-service", "x", 10.0, "bad-variable"),
        ("operator", "y", 2.0, "done"),
        ("anybody", "y", 3.0, "done"),
        ("fire-service", "z", 3.0, "bad-variable"),
    ] {
        let before = rig.executor.variables().clone();
        assert_eq!(code(command_by(&mut rig, by, set(name, n))), expected, "{by} {name} {n}");
        assert_eq!(*rig.executor.variables() == before, expected != "done", "{by} {name} {n}");
    }
    let wrong = Command::SetVariable { name: "y".into(), value: VariableValue::Text("2".into()) };
    assert_eq!(code(command_by(&mut rig, "operator", wrong)), "bad-variable");
    let told: Vec<_> = rig
        .events
        .iter()
        .filter_map(|e| match e {
            Event::VariableChanged { name, by, .. } => Some(format!("{name} by {by}")),
            _ => None,
        })
        .collect();
    assert_eq!(told, ["x by fire-service", "y by operator", "y by anybody"]);
}

const FORK: &str = r#"<TF id="a" fix="A3"/><TF id="b" fix="B3"/>
    <intersection id="x" default="left" decideBefore="20s">
      <branch id="left" label="Left" next="l"/><branch id="right" label="Right" next="r"/>
    </intersection>
    <TF id="l" fix="B5" next="z"/><TF id="r" fix="C4" next="z"/><TF id="z" fix="A4"/>"#;

fn decide(leg: &str, branch: &str) -> Command {
    Command::Decide { leg: leg.into(), branch: branch.into() }
}

#[test]
fn a_decision_is_asked_for_with_a_preview_of_each_branch() {
    let mut rig = Rig::started(FORK);
    rig.fly_to("b");
    let asked = rig.events.iter().find_map(|e| match e {
        Event::DecisionRequested(request) => Some(request.clone()),
        _ => None,
    });
    let request = asked.or(rig.executor.status().decision).unwrap();
    for (option, second) in request.options.iter().zip(["B5", "C4"]) {
        let preview = &option.preview;
        assert!((2..=20).contains(&preview.len()), "{preview:?}");
        assert!(preview[0].distance_m(fix("B3")) < 0.1 && preview[1].distance_m(fix(second)) < 0.1);
        let length_m: f64 = preview.windows(2).rev().skip(1).map(|w| w[0].distance_m(w[1])).sum();
        assert!(length_m < 2000.0, "the last piece alone may lead beyond 2 km");
    }
    assert!(request.time_left_s > 0.0 && request.distance_left_m > 0.0);
    let before = rig.buffer.clone();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b l z", "asking changes nothing");
    assert!(before.iter().all(|w| w.leg.as_str() != "r"));
}

#[test]
fn a_decision_may_come_before_it_is_asked_for_and_names_who_took_it() {
    let mut rig = Rig::started(FORK);
    rig.fly_to("a");
    command_by(&mut rig, "fire-service", decide("x", "right")).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b r z");
    let by: Vec<_> = rig
        .events
        .iter()
        .filter_map(|e| match e {
            Event::DecisionTaken { by, .. } => Some(by.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(by, ["fire-service"]);
}

#[test]
fn a_decision_for_a_past_intersection_is_refused_unless_the_way_leads_there_again() {
    let mut rig = Rig::started(FORK);
    rig.fly_to("z");
    assert_eq!(code(rig.command(decide("x", "right"))), "not-ahead");
    let looped = format!(r#"<iterative id="i" form="forward" count="3">{FORK}</iterative>"#);
    let mut rig = Rig::started(&looped);
    rig.fly_to("z");
    assert_eq!(code(rig.command(decide("x", "right"))), "done");
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b l z a b r z a b l z");
    let jumping = format!(
        r#"{FORK}<intersection id="y" default="out" decideBefore="1s"><branch id="again" label="Again" next="a"/>
           <branch id="out" label="Out" next="e"/></intersection><TF id="e" fix="A2"/>"#
    );
    let mut rig = Rig::started(&jumping);
    rig.fly_to("z");
    assert_eq!(code(rig.command(decide("x", "right"))), "done");
    rig.command(decide("y", "again")).unwrap();
    rig.fly_to("r");
    let mut rig = Rig::started(FORK);
    rig.fly_to("a");
    rig.command(Command::Emergency { cause: Cause::Link, plan: None }).unwrap();
    assert_eq!(code(rig.command(decide("x", "right"))), "not-ahead", "it is in another plan now");
}

fn propose(
    rig: &mut Rig,
    program: &Arc<Program>,
    based_on: Option<u64>,
    objections: Vec<Problem>,
) -> Result<ProposalReport, Refusal> {
    let input = Input::Propose { request: RequestId(1), program: program.clone(), based_on, objections };
    match rig.step(input).unwrap()? {
        Answer::Proposal(report) => Ok(*report),
        other => panic!("{other:?}"),
    }
}

fn changed(from: &str, to: &str) -> Arc<Program> {
    program(&document(&BASE.replace(from, to)))
}

#[test]
fn of_two_proposals_based_on_the_same_revision_the_later_commit_is_refused() {
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    let revision = rig.executor.status().revision;
    let (one, other) = (changed("C4", "D4"), changed("C4", "E4"));
    propose(&mut rig, &one, Some(revision), Vec::new()).unwrap();
    propose(&mut rig, &other, Some(revision), Vec::new()).unwrap();
    let commit = |p: &Program| Command::Commit { hash: p.hash().clone(), entry: None };
    assert_eq!(code(rig.command(commit(&one))), "not-proposed", "another one was proposed since");
    rig.command(commit(&other)).unwrap();
    let refused = propose(&mut rig, &one, Some(revision), Vec::new()).unwrap_err();
    assert_eq!(refused.code, "stale-revision");
    assert_eq!(code(rig.command(commit(&one))), "not-proposed");
    propose(&mut rig, &one, Some(revision + 1), Vec::new()).unwrap();
    rig.command(commit(&one)).unwrap();
}

#[test]
fn an_objection_of_the_shell_forbids_the_commit_a_warning_does_not() {
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    let plan = changed("C4", "D4");
    for (problem, acceptable, expected) in [
        (Problem::error("outside-keep-in", "leg d leaves the keep-in zone: move it"), false, "not-proposed"),
        (Problem::warning("near-keep-out", "leg d comes near"), true, "done"),
    ] {
        let message = problem.to_string();
        let report = propose(&mut rig, &plan, None, vec![problem]).unwrap();
        assert_eq!(report.acceptable, acceptable);
        assert!(report.problems.contains(&message));
        let commit = Command::Commit { hash: plan.hash().clone(), entry: None };
        assert_eq!(code(rig.command(commit)), expected);
    }
}

#[test]
fn a_proposal_tells_when_the_way_would_change() {
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    rig.position = fix("B2").destination(270.0, 1000.0);
    rig.report();
    let report = propose(&mut rig, &changed("C4", "D4"), None, Vec::new()).unwrap();
    // legs, stages and everything of the emergency plans but d
    assert_eq!((report.changed.len(), report.unchanged), (1, 3 + 3 + 2 * 3));
    assert_eq!(report.next_leg.unwrap().as_str(), "b");
    let close = |value: Option<f64>, wanted: f64| (value.unwrap() - wanted).abs() < 1.0;
    assert!(close(report.next_in_m, 1000.0) && close(report.next_in_s, 40.0));
    assert!(close(report.differs_in_m, 3000.0) && close(report.differs_in_s, 120.0));
    let same = propose(&mut rig, &changed(r#"id="c" "#, r#"id="c" name="C" "#), None, Vec::new()).unwrap();
    assert_eq!((same.differs_in_m, same.changed.len()), (None, 1));
}

#[test]
fn an_emergency_escalates_and_the_main_plan_goes_on_where_it_is_told_to() {
    let by_cause = r#"emergency="back"><emergency cause="engine" plan="other"/"#;
    let text = document(BASE).replace(r#"<mainPlan emergency="back""#, &format!("<mainPlan {by_cause}"));
    let mut rig = Rig::flying(&text);
    rig.fly_to("b");
    let emergency = |cause, plan: Option<&str>| Command::Emergency { cause, plan: plan.map(Into::into) };
    rig.command(Command::Hold).unwrap();
    rig.command(emergency(Cause::Link, None)).unwrap();
    assert_eq!(rig.executor.status().phase, Phase::Flying, "an emergency doesn't wait for a resume");
    rig.steer();
    assert_eq!(rig.leg(), "b-df");
    for (command, expected) in [
        (emergency(Cause::Link, None), "not-more-severe"),
        (emergency(Cause::Payload, Some("other")), "not-more-severe"),
        (emergency(Cause::Engine, Some("nowhere")), "unknown-plan"),
        (emergency(Cause::Energy, None), "done"),
        (emergency(Cause::Engine, None), "done"),
    ] {
        assert_eq!(code(rig.command(command.clone())), expected, "{command:?}");
    }
    rig.steer();
    assert_eq!(rig.leg(), "o-df");
    assert_eq!(code(rig.command(Command::ReturnToMain { leg: "o-df".into() })), "unknown-leg");
    rig.command(Command::ReturnToMain { leg: "d".into() }).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b b-df o-df d");
}

#[test]
fn a_variable_written_in_flight_never_alters_what_is_nearer_than_the_stopping_distance() {
    let variables = r#"<variable name="r" type="number" initial="500" min="10" max="3000"/>"#;
    let legs = r#"<TF id="a" fix="B1"/><crissCross id="s" spacing="200" heading="0"><area fix="C4" radius="= r"/></crissCross><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::flying(&document_with(legs, variables, ""));
    rig.fly_to("s");
    for i in 0..12 {
        rig.fly_one();
        let front = rig.buffer[0].clone();
        let near_m = rig.position.distance_m(front.position);
        // a second's flight before the waypoint, and then anything
        rig.position =
            front.position.destination(rig.position.bearing_deg(front.position) + 180.0, near_m.min(25.0));
        rig.now += Time::from_secs(2);
        rig.report();
        let near: Vec<_> = rig.buffer.iter().take(1).cloned().collect();
        rig.set("r", 400.0 + 100.0 * f64::from(i % 5)).unwrap();
        assert_eq!(rig.buffer.iter().take(1).cloned().collect::<Vec<_>>(), near);
    }
    rig.fly_to_the_end();
}
