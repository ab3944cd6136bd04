//! Commands: each is done or refused with a reason, and answered once.

use crate::rig::{GROUND_M, HOME, Rig, document, fix, program};
use aircraft::Profile;
use flight_exec::{
    AircraftState, Command, Config, Event, Executor, Input, Output, Phase, Refusal, RequestId, Snapshot,
    Time, Token,
};
use flight_plan::Cause;
use std::sync::Arc;
use terrain::Flat;

const LEGS: &str = r#"<TF id="a" fix="A2"/><TF id="b" fix="B2"/><TF id="c" fix="C2"/><TF id="d" fix="C4"/>"#;

fn code(result: Result<(), flight_exec::Refusal>) -> String {
    result.err().map_or_else(|| "done".into(), |r| r.code)
}

#[test]
fn without_a_plan_everything_is_refused() {
    let mut rig = Rig::new();
    let leg = || "a".into();
    let cases = [
        (Command::Start, "no-plan"),
        (Command::Hold, "not-flying"),
        (Command::Resume, "not-holding"),
        (Command::SkipLeg, "not-flying"),
        (Command::GoTo { leg: leg() }, "not-flying"),
        (Command::SetCount { leg: leg(), count: 1 }, "not-flying"),
        (Command::Decide { leg: leg(), branch: leg() }, "not-flying"),
        (Command::Emergency { cause: Cause::Link, plan: None }, "not-flying"),
        (Command::ReturnToMain { leg: leg() }, "not-flying"),
        (Command::Commit { hash: "x".into(), entry: None }, "not-proposed"),
    ];
    for (command, expected) in cases {
        assert_eq!(code(rig.command(command.clone())), expected, "{command:?}");
    }
    assert_eq!(code(rig.set("x", 1.0)), "no-plan");
}

#[test]
fn a_misspelt_name_is_refused_with_the_one_that_was_meant() {
    let fork = r#"<intersection id="question"><branch id="one" next="first-leg"/></intersection>"#;
    let legs = format!(
        r#"{LEGS}{}{fork}<TF id="first-leg" fix="A2"/>"#,
        r#"<iterative id="circuit" form="forward" count="2"><TF id="round" fix="B2"/></iterative>"#
    );
    let mut rig = Rig::started(&legs);
    rig.fly_to("a");
    let mut reason = |command| rig.command(command).unwrap_err().reason;
    let emergency = |plan: &str| Command::Emergency { cause: Cause::Engine, plan: Some(plan.into()) };
    let cases = [
        (Command::GoTo { leg: "frist-leg".into() }, "; did you mean `first-leg`?"),
        (Command::SetCount { leg: "circut".into(), count: 3 }, "; did you mean `circuit`?"),
        (Command::Decide { leg: "questoin".into(), branch: "one".into() }, "; did you mean `question`?"),
        (emergency("othr"), "; did you mean `other`?"),
        // near to nothing, and near to a leg that does not fit
        (Command::GoTo { leg: "nowhere".into() }, "name one of its legs"),
        (Command::SetCount { leg: "frist-leg".into(), count: 3 }, "name one"),
    ];
    for (command, end) in cases {
        let reason = reason(command.clone());
        assert!(reason.ends_with(end), "{command:?}: {reason}");
    }
}

#[test]
fn skip_and_go_to_cancel_everything_and_go_direct() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    rig.command(Command::SkipLeg).unwrap();
    assert_eq!(rig.buffer[0].leg.as_str(), "c");
    assert!(rig.buffer[0].position.distance_m(fix("C2")) < 0.1);
    rig.fly_to("c");
    rig.command(Command::GoTo { leg: "a".into() }).unwrap();
    assert_eq!(code(rig.command(Command::GoTo { leg: "nowhere".into() })), "unknown-leg");
    assert_eq!(code(rig.command(Command::GoTo { leg: "b-df".into() })), "unknown-leg");
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c a b c d");
}

/// Skipped before it is steered to, the first leg of a pass takes the arrival before it with it.
#[test]
fn an_arrival_skipped_together_with_the_leg_behind_it_is_told() {
    let mut rig = Rig::started(
        r#"<iterative id="l" form="forward" count="2"><TF id="a" fix="A2"/><TF id="b" fix="B2"/></iterative><TF id="z" fix="C4"/>"#,
    );
    rig.fly_to("b");
    for _ in 0..2 {
        rig.command(Command::SkipLeg).unwrap();
    }
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b b z");
    let arrivals = rig.events.iter().filter_map(|e| match e {
        Event::IterationFinished { finished, .. } => Some(*finished),
        _ => None,
    });
    assert_eq!(arrivals.collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn the_last_leg_can_not_be_skipped() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("land");
    assert_eq!(code(rig.command(Command::SkipLeg)), "last-leg");
    rig.fly_to_the_end();
}

#[test]
fn hold_and_resume_rejoin_where_the_hold_was_given() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("c");
    let held_at = fix("B2").destination(90.0, 500.0);
    rig.position = held_at;
    rig.report();
    rig.command(Command::Hold).unwrap();
    assert_eq!((rig.holds, rig.executor.status().phase), (1, Phase::Holding));
    assert_eq!(code(rig.command(Command::Hold)), "already-holding");
    rig.position = held_at.destination(0.0, 400.0);
    rig.report();
    rig.command(Command::Resume).unwrap();
    assert!(rig.buffer[0].position.distance_m(held_at) < 0.1);
    assert_eq!((rig.buffer[0].leg.as_str(), rig.buffer[1].leg.as_str()), ("c", "c"));
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c d", "the leg held on is entered once");
}

#[test]
fn a_refused_batch_holds_and_can_be_resumed() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    let first = rig.buffer[2].token;
    rig.step(Input::Rejected { first, reason: "too steep".into() });
    rig.buffer.truncate(2);
    assert_eq!((rig.holds, rig.executor.status().phase), (1, Phase::Holding));
    assert!(
        rig.events
            .iter()
            .any(|e| matches!(e, Event::WaypointsRejected { leg: Some(l), .. } if l.as_str() == "d"))
    );
    rig.command(Command::Resume).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c d");
}

#[test]
fn the_gateway_takes_control_and_gives_it_back() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    let feeds = rig.feeds;
    rig.step(Input::GatewayControls(true));
    rig.report();
    assert_eq!(rig.feeds, feeds);
    rig.buffer.clear();
    rig.step(Input::GatewayControls(false));
    assert_eq!(rig.feeds, feeds + 1);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c d");
}

#[test]
fn progress_of_unknown_waypoints_is_ignored() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    let before = rig.executor.status();
    for token in [0, 1, 9999] {
        rig.step(Input::Progress { current: Some(Token(token)) });
    }
    assert_eq!(rig.executor.status(), before);
}

/// A direct leg from nowhere would have no altitude to climb from.
#[test]
fn a_report_without_sound_numbers_is_ignored() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    let before = rig.executor.status();
    let (nowhere, high) = (geometry::LatLon::new(f64::NAN, 0.0), f64::INFINITY);
    let good = rig.state();
    for state in
        [AircraftState { position: nowhere, ..good }, AircraftState { altitude_amsl_m: high, ..good }]
    {
        rig.step(Input::Aircraft(state));
        assert_eq!(rig.executor.status(), before);
    }
    rig.command(Command::GoTo { leg: "c".into() }).unwrap();
    assert!(rig.buffer.iter().all(|w| w.altitude_amsl_m.is_finite()));
}

#[test]
fn an_emergency_cancels_what_is_unflown_and_only_worse_ones_replace_it() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    assert_eq!(rig.executor.status().emergency_in_force.unwrap().as_str(), "back");
    rig.command(Command::Emergency { cause: Cause::Link, plan: None }).unwrap();
    assert!(rig.buffer[0].position.distance_m(fix("A1")) < 0.1, "direct to the first fix");
    rig.steer();
    let other = || Some("other".into());
    assert_eq!(
        code(rig.command(Command::Emergency { cause: Cause::Payload, plan: other() })),
        "not-more-severe"
    );
    assert_eq!(
        code(rig.command(Command::Emergency { cause: Cause::Link, plan: other() })),
        "not-more-severe"
    );
    assert_eq!(
        code(rig.command(Command::Emergency { cause: Cause::Engine, plan: Some("?".into()) })),
        "unknown-plan"
    );
    rig.command(Command::Emergency { cause: Cause::Engine, plan: other() }).unwrap();
    assert!(rig.buffer[0].position.distance_m(fix("B1")) < 0.1);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b b-df o-df o-land");
}

#[test]
fn returning_to_the_main_plan_is_a_command_that_names_a_leg() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    assert_eq!(code(rig.command(Command::ReturnToMain { leg: "c".into() })), "no-emergency");
    rig.command(Command::Emergency { cause: Cause::Link, plan: None }).unwrap();
    rig.steer();
    assert_eq!(code(rig.command(Command::ReturnToMain { leg: "b-df".into() })), "unknown-leg");
    rig.command(Command::ReturnToMain { leg: "c".into() }).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b b-df c d");
}

#[test]
fn the_most_specific_emergency_plan_wins() {
    let legs = r#"<TF id="a" fix="A2"/><TF id="b" fix="B2" emergency="other"/><TF id="c" fix="C2"/>"#;
    for (leg, first) in [("a", "b-df"), ("b", "o-df"), ("c", "b-df")] {
        let mut rig = Rig::started(legs);
        rig.fly_to(leg);
        rig.command(Command::Emergency { cause: Cause::Energy, plan: None }).unwrap();
        assert_eq!(rig.buffer[0].leg.as_str(), first);
    }
}

#[test]
fn an_emergency_without_a_plan_is_left_to_the_gateway() {
    let mut rig = Rig::flying(&document(LEGS).replace(r#" emergency="back""#, ""));
    rig.fly_to("b");
    assert_eq!(code(rig.command(Command::Emergency { cause: Cause::Gps, plan: None })), "no-emergency-plan");
    let left = |e: &Event| matches!(e, Event::EmergencyUnanswered { cause: Cause::Gps, plan: None, code, .. } if code == "no-emergency-plan");
    assert!(rig.events.iter().any(left), "{:?}", rig.events);
    rig.fly_to_the_end();
}

/// Nothing is issued any more, and the place is none: the plan's own answer is there all the same.
#[test]
fn an_emergency_after_a_refused_batch_finds_its_plan() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    rig.command(Command::GoTo { leg: "c".into() }).unwrap();
    let first = rig.buffer[0].token;
    rig.step(Input::Rejected { first, reason: "too steep".into() });
    assert_eq!(rig.executor.status().emergency_in_force.unwrap().as_str(), "back");
    rig.command(Command::Emergency { cause: Cause::Energy, plan: None }).unwrap();
    rig.buffer.retain(|w| w.leg.as_str().starts_with('b'));
    assert_eq!(rig.buffer[0].leg.as_str(), "b-df");
}

/// What is too near to be taken back may be of a leg that the new plan doesn't have.
#[test]
fn an_emergency_on_a_leg_of_the_old_plan_finds_its_plan() {
    let near = fix("B2").destination(45.0, 100.0);
    let n = format!(r#"<TF id="n" lat="{}" lon="{}"/><TF id="c""#, near.lat_deg, near.lon_deg);
    let mut rig = Rig::started(&LEGS.replace(r#"<TF id="c""#, &n));
    rig.fly_to("b");
    rig.position = fix("B2").destination(270.0, 20.0);
    rig.report();
    rig.update(&program(&document(LEGS))).unwrap();
    rig.fly_one();
    assert_eq!(rig.leg(), "n");
    assert_eq!(rig.executor.status().emergency_in_force.unwrap().as_str(), "back");
    rig.command(Command::Emergency { cause: Cause::Energy, plan: None }).unwrap();
    assert_eq!(rig.buffer[0].leg.as_str(), "b-df");
}

#[test]
fn a_new_flight_does_not_begin_with_the_variables_of_the_last() {
    let variables = r#"<variable name="stop" type="bool" initial="false"/>"#;
    let legs = r#"<TF id="a" fix="A2"/><iterative id="l" form="forward" count="2" until="stop"><TF id="b" fix="B2"/><TF id="c" fix="C2"/></iterative>"#;
    let mut rig = Rig::flying(&crate::rig::document_with(legs, variables, ""));
    rig.fly_to("b");
    let stop =
        |value| Command::SetVariable { name: "stop".into(), value: flight_plan::VariableValue::Bool(value) };
    rig.command(stop(true)).unwrap();
    rig.fly_to_the_end();
    rig.events.clear();
    rig.position = crate::rig::HOME;
    rig.flown.clear();
    rig.command(Command::Start).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c b c");
    // what is written between two flights is for the next one
    rig.command(stop(true)).unwrap();
    rig.events.clear();
    rig.position = crate::rig::HOME;
    rig.flown.clear();
    rig.command(Command::Start).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c");
}

/// On the runway nothing can be flown to yet; in the air nobody takes off.
#[test]
fn taking_off_is_neither_skipped_on_the_ground_nor_begun_in_the_air() {
    let mut rig = Rig::started(LEGS);
    rig.steer();
    let mut state = rig.state();
    state.on_ground = true;
    rig.step(Input::Aircraft(state));
    for command in [Command::SkipLeg, Command::GoTo { leg: "b".into() }] {
        assert_eq!(code(rig.command(command.clone())), "on-ground", "{command:?}");
    }
    state.on_ground = false;
    rig.step(Input::Aircraft(state));
    rig.command(Command::SkipLeg).unwrap();
    rig.fly_to("b");
    assert_eq!(code(rig.command(Command::GoTo { leg: "to".into() })), "in-the-air");
    rig.fly_to_the_end();
}

/// Kills the executor at every waypoint and compares what the restored one does with what the first one does.
#[test]
fn killed_and_restored_anywhere_it_flies_the_same() {
    let legs = r#"<TF id="a" fix="B1"/>
        <iterative id="l" form="reverse" count="2"><TF id="b" fix="B2"/>
          <scan id="s" spacing="300" heading="0" overshoot="50"><area fix="C4" radius="500"/></scan>
        </iterative><TF id="z" fix="A3"/>"#;
    let plan = program(&document(legs));
    let mut rig = Rig::flying(&document(legs));
    let mut places = 0;
    while rig.fly_one() {
        let mut bytes = Vec::new();
        ciborium::into_writer(&rig.executor.snapshot(), &mut bytes).unwrap();
        let snapshot: Snapshot = ciborium::from_reader(bytes.as_slice()).unwrap();
        let mut twin = rig.clone();
        twin.executor = Executor::restore(
            flight_exec::Config::default(),
            std::sync::Arc::new(terrain::Flat(crate::rig::GROUND_M)),
            aircraft::Profile::default(),
            Some(plan.clone()),
            snapshot,
        )
        .unwrap();
        assert_eq!(twin.executor.status(), rig.executor.status());
        let mut first = rig.clone();
        for _ in 0..6 {
            assert_eq!(twin.fly_one(), first.fly_one());
        }
        assert_eq!((&twin.flown, &twin.events), (&first.flown, &first.events));
        assert!(bytes.len() < 200_000, "a snapshot of {} bytes", bytes.len());
        places += 1;
    }
    assert!(places > 20);
}

#[test]
fn a_snapshot_of_another_plan_is_refused() {
    let rig = Rig::started(LEGS);
    let restored = Executor::restore(
        flight_exec::Config::default(),
        std::sync::Arc::new(terrain::Flat(0.0)),
        aircraft::Profile::default(),
        None,
        rig.executor.snapshot(),
    );
    assert!(restored.is_err_and(|e| e.to_string().contains("load that plan")));
}

#[test]
fn each_deadline_lies_ahead() {
    let legs = r#"<TF id="a" fix="B1"/><iterative id="l" form="forward" count="3"><TF id="b" fix="B2"/><TF id="c" fix="C2"/></iterative>"#;
    let mut rig = Rig::started(legs);
    rig.fly_one();
    let mut out = Vec::new();
    for _ in 0..20 {
        let due = rig.executor.deadline().unwrap();
        assert!(due > rig.now);
        rig.now = due;
        rig.executor.step(due, Input::Tick, &mut out);
    }
    assert!(!out.iter().any(|o| matches!(o, Output::Feed { .. })));
}

#[test]
fn an_abort_asks_for_safe_mode_and_the_plan_holds_until_it_is_resumed() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    rig.command(Command::AbortToSafe).unwrap();
    assert_eq!((rig.aborts, rig.holds, rig.executor.status().phase), (1, 0, Phase::Holding));
    rig.step(Input::GatewayControls(true));
    rig.step(Input::GatewayControls(false));
    assert_eq!(rig.executor.status().phase, Phase::Holding, "the gateway gave control back, nobody resumed");
    rig.command(Command::Resume).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c d");
    rig.command(Command::AbortToSafe).unwrap();
    assert_eq!((rig.aborts, rig.executor.status().phase), (2, Phase::Finished), "without a flight as well");
}

/// After a restart on the ground the plan may be in the middle: it is rewound, and flown from its start.
#[test]
fn on_the_ground_the_plan_is_rewound_and_starts_anew() {
    let mut rig = Rig::new();
    assert_eq!(rig.command(Command::Rewind).unwrap_err().code, "no-plan");
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    assert_eq!(rig.command(Command::Rewind).unwrap_err().code, "in-the-air");
    rig.command(Command::Hold).unwrap();
    let mut state = rig.state();
    state.on_ground = true;
    rig.step(Input::Aircraft(state));
    assert_eq!(rig.command(Command::Start).unwrap_err().code, "already-flying");
    rig.command(Command::Rewind).unwrap();
    let status = rig.executor.status();
    assert_eq!((status.phase, status.place, status.outstanding), (Phase::Idle, None, 0));
    assert!(rig.buffer.is_empty(), "what was fed is taken back");
    let last = rig.executor.last_token();
    rig.position = HOME;
    rig.flown.clear();
    rig.report();
    rig.command(Command::Start).unwrap();
    assert!(rig.buffer.iter().all(|w| w.token > last), "no token is used twice");
    rig.flown.clear();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b a b c d");
}

#[test]
fn looking_ahead_tells_what_a_command_leaves_out_and_does_nothing() {
    let mut rig = Rig::started(LEGS);
    rig.fly_to("b");
    rig.report();
    let before = rig.executor.snapshot();
    let look = |command: Option<&Command>| {
        flight_exec::foresee(&rig.executor, "operator", command, flight_exec::Conditions::default())
    };
    let ids = |ids: &[flight_plan::Id]| ids.iter().map(|id| id.to_string()).collect::<Vec<_>>().join(" ");
    let as_is = look(None).unwrap();
    assert!(as_is.left_out.is_empty() && as_is.landed && as_is.time_s > 60.0, "{as_is:?}");
    assert!(as_is.path.len() <= 401 && as_is.clearance_m.is_some_and(|m| m > 50.0), "{as_is:?}");
    let skipped = look(Some(&Command::SkipLeg)).unwrap();
    assert_eq!((ids(&skipped.left_out).as_str(), skipped.next_leg), ("b", Some("c".into())));
    let gone = look(Some(&Command::GoTo { leg: "d".into() })).unwrap();
    assert_eq!((ids(&gone.left_out).as_str(), gone.next_leg), ("b c", Some("d".into())));
    assert!(gone.time_s < as_is.time_s, "{} < {}", gone.time_s, as_is.time_s);
    assert_eq!(look(Some(&Command::GoTo { leg: "nowhere".into() })).unwrap_err().code, "unknown-leg");
    assert_eq!(rig.executor.snapshot(), before);
}

/// The place where a hold was given is as high as the waypoint behind it was then, and holds come one after the other.
#[test]
fn a_descent_that_an_update_brings_during_a_hold_begins_where_the_hold_before_was_given() {
    let plan = |metres: u32| {
        document(&format!(
            r#"<TF id="a" fix="B1"/><TF id="p" fix="B2" altitude="{metres}" altitudeReference="amsl"/><TF id="z" fix="A3"/>"#
        ))
    };
    let mut rig = Rig::flying(&plan(600));
    rig.fly_to("p");
    rig.position = fix("B2").destination(180.0, 300.0);
    rig.now += Time::from_secs(68);
    rig.report();
    for _ in 0..2 {
        rig.command(Command::Hold).unwrap();
        rig.command(Command::Resume).unwrap();
    }
    rig.command(Command::Hold).unwrap();
    rig.update(&program(&plan(400))).unwrap();
    rig.command(Command::Resume).unwrap();
    let heights: Vec<f64> = rig.buffer.iter().take(2).map(|w| w.altitude_amsl_m).collect();
    let descent_m = Profile::default().max_descent_mps * 300.0 / rig.buffer[1].airspeed_mps + 10.0;
    assert!((20.0..=descent_m).contains(&(heights[0] - heights[1])), "{heights:?}, {descent_m}");
}

/// The leg had not begun when the hold was given: it is laid out from where it is joined, and climbed to from the hold.
#[test]
fn after_a_hold_a_climb_that_an_update_brings_begins_where_the_hold_was_given() {
    let plan = |metres: u32| {
        document(&format!(
            r#"<TF id="a" fix="B1"/><FA id="p" fix="B2" course="90" altitude="{metres}" altitudeReference="amsl"/><TF id="z" fix="A3"/>"#
        ))
    };
    let mut rig = Rig::flying(&plan(500));
    rig.fly_to("p");
    rig.position = fix("B2").destination(180.0, 600.0);
    rig.report();
    rig.command(Command::Hold).unwrap();
    rig.command(Command::Resume).unwrap();
    rig.update(&program(&plan(900))).unwrap();
    let (held, fixed) = (&rig.buffer[0], &rig.buffer[1]);
    assert!(held.position.distance_m(rig.position) < 0.1 && fixed.position.distance_m(fix("B2")) < 0.1);
    let climb_m = fixed.altitude_amsl_m - held.altitude_amsl_m;
    let most_m = Profile::default().max_climb_mps * 600.0 / fixed.airspeed_mps;
    assert!((most_m..=most_m + 10.0).contains(&climb_m), "{climb_m} m, {most_m} m in steady climb");
}

/// The way made counts from the hold on: a leg that an update lays out near the one before is not taken for one just ahead.
#[test]
fn after_a_hold_what_an_update_brings_can_be_taken_back_by_the_next() {
    let plan = |leg: &str| document(&format!(r#"<TF id="a" fix="B1"/>{leg}<TF id="z" fix="A3"/>"#));
    let (far, near) = (
        plan(r#"<TF id="k" fix="B5"/>"#),
        plan(r#"<orbit id="k" radius="500" turns="1" turn="left"><centre fix="B2"/></orbit>"#),
    );
    let mut rig = Rig::flying(&far);
    rig.fly_to("k");
    rig.position = fix("B5").destination(180.0, 1000.0);
    rig.report();
    rig.command(Command::Hold).unwrap();
    rig.command(Command::Resume).unwrap();
    rig.update(&program(&near)).unwrap();
    rig.update(&program(&far)).unwrap();
    let ways: Vec<_> = rig.buffer.iter().take(3).map(|w| (w.leg.as_str(), w.position)).collect();
    let there = |i: usize, leg: &str, position| ways[i].0 == leg && position == ways[i].1;
    assert!(there(0, "k", rig.position) && there(1, "k", fix("B5")) && there(2, "z", fix("A3")), "{ways:?}");
}

/// What is answered to a start of an aircraft that stands so far beside the runway, metres, and so much off its heading, degrees.
fn standing(rig: &mut Rig, aside_m: f64, off_deg: Option<f64>) -> Result<(), Refusal> {
    let runway = program(&document(r#"<TF id="a" fix="B1"/>"#)).plan.home().unwrap().clone();
    let on_it = runway.threshold.destination(runway.heading_deg, 100.0);
    rig.position = on_it.destination(runway.heading_deg + 90.0, aside_m);
    let heading_deg = off_deg.map(|deg| runway.heading_deg + deg);
    rig.step(Input::Aircraft(AircraftState { heading_deg, ..rig.state() }));
    rig.command(Command::Start)
}

fn not_started() -> Rig {
    let mut rig = Rig::new();
    rig.update(&program(&document(r#"<TF id="a" fix="B1"/>"#))).unwrap();
    rig
}

/// A plan of Tennessee took off in Munich, and flew west; one stood in a field beside the runway, and took off across the country.
#[test]
fn nobody_takes_off_elsewhere_than_from_the_runway_of_the_plan() {
    for (aside_m, off_deg, words) in [
        (2400.0, None, "2.4 km from runway `R`, from which the plan takes off: bring it there"),
        (400.0, Some(-48.0), "400 m from runway `R`, from which the plan takes off, and 48° off its heading"),
        (60.0, Some(0.0), "60 m from"),
    ] {
        let refusal = standing(&mut not_started(), aside_m, off_deg).unwrap_err();
        assert!(refusal.code == "not-at-the-runway" && refusal.reason.contains(words), "{refusal}");
    }
    standing(&mut not_started(), 20.0, Some(0.0)).unwrap();
}

/// After an engine failure it had landed from the other end, and took off over that again.
#[test]
fn nobody_takes_off_the_wrong_way_along_a_runway() {
    let refusal = standing(&mut not_started(), 0.0, Some(178.0)).unwrap_err();
    assert!(refusal.code == "wrong-way" && refusal.reason.contains("178° off"), "{refusal}");
    assert!(standing(&mut not_started(), 0.0, Some(-58.0)).is_err());
    for off_deg in [None, Some(-352.0), Some(40.0)] {
        standing(&mut not_started(), 0.0, off_deg).unwrap();
    }
}

/// Without a compass the heading may be any: an aircraft that was turned was refused on, for ever.
#[test]
fn who_starts_again_within_a_minute_means_it() {
    for (aside_m, off_deg) in [(0.0, 128.0), (400.0, 0.0), (400.0, 48.0)] {
        let mut rig = not_started();
        let refusal = standing(&mut rig, aside_m, Some(off_deg)).unwrap_err();
        assert!(
            refusal.reason.ends_with("or start again within a minute to do so all the same"),
            "{refusal}"
        );
        rig.now += Time::from_secs(90);
        standing(&mut rig, aside_m, Some(off_deg)).expect_err("he may not have meant that one");
        rig.now += Time::from_secs(30);
        let other = Command::Start;
        let request = RequestId(1000);
        let answer = rig.step(Input::Command { request, by: "somebody else".into(), command: other });
        assert!(matches!(answer, Some(Err(_))), "{answer:?}");
        rig.command(Command::Start).expect_err("he was not the last one who was told");
        rig.command(Command::Start).unwrap();
    }
}

#[test]
fn what_rises_upright_starts_however_it_is_turned_also_from_beside_the_runway() {
    let profile = Profile { rises_upright: true, ..Profile::default() };
    let mut rig = Rig::new();
    rig.executor = Executor::new(Config::default(), Arc::new(Flat(GROUND_M)), profile);
    rig.update(&program(&document(r#"<TF id="a" fix="B1"/>"#))).unwrap();
    standing(&mut rig, 2400.0, Some(180.0)).expect_err("it is far away");
    rig.now += Time::from_secs(90);
    standing(&mut rig, 300.0, Some(180.0)).unwrap();
}
