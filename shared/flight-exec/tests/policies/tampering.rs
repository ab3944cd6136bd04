//! Can each policy be broken at all? Traces are tampered with where the policy applied, and it must notice.
#![expect(clippy::unit_arg, reason = "`Some(change)`: changed, one line each")]

use crate::policy::{self, Findings, Policy};
use crate::trace::{Moment, Seen, Stimulus, Trace};
use flight_exec::{
    Action, Answer, Branching, Command, Event, Input, IterationPlace, Output, Phase, PlacePointer, Refusal,
    RequestId, ResolvedAct, Time, Token, Waypoint,
};
use flight_plan::{Id, Place, Value, Variables};
use geometry::LatLon;

/// Changes a trace at a moment; `None`: not this one.
type Tamper = fn(&mut Trace, usize) -> Option<()>;

/// Sequences whose traces are tampered with, at most, and how often each policy must notice.
const SEQUENCES: u64 = 400;
const TIMES: usize = 2;

const TAMPERINGS: &[(&str, Tamper)] = &[
    // feeding
    ("tokens-grow", |t, at| first_fed(t, at).map(|w| w.token = Token(0))),
    ("batches-count-by-one", |t, at| last_fed(t, at).map(|w| w.token.0 += 5)),
    ("no-empty-feed", |t, at| say(t, at, Output::Feed { cancel_after: None, waypoints: Vec::new() })),
    ("cancels-what-was-fed", |t, at| say(t, at, cancel(Token(1_000_000)))),
    ("cancelled-stays-cancelled", cancelled_comes_back),
    ("ahead-is-the-buffer", |t, at| after(t, at).ahead.pop().map(drop)),
    ("a-waypoint-never-changes", |t, at| front(t, at).map(|w| w.altitude_amsl_m += 5.0)),
    ("one-cancellation-an-input", |t, at| say(t, at, cancel(Token(0)))),
    ("finite-and-on-earth", |t, at| first_fed(t, at).map(|w| w.position = LatLon::new(f64::NAN, 0.0))),
    ("within-the-envelope", |t, at| first_fed(t, at).map(|w| w.airspeed_mps = 500.0)),
    ("climbs-can-be-flown", a_leg_like_a_wall),
    ("legs-of-the-plan", |t, at| first_fed(t, at).map(|w| w.leg = nowhere())),
    ("take-off-first", |t, at| last_fed(t, at).map(|w| w.action = Action::TakeOff { heading_deg: 0.0 })),
    ("landing-last", |t, at| fed(t, at)?.iter_mut().find(|w| is_landing(w)).map(|w| w.end_of_plan = false)),
    ("muted-while-the-gateway-controls", |t, at| say(t, at, cancel(Token(0)))),
    ("muted-while-holding", |t, at| say(t, at, cancel(Token(0)))),
    ("fed-again-after-control", |t, at| unsay(t, at, is_feed)),
    ("fed-again-after-hold", |t, at| unsay(t, at, is_feed)),
    ("nothing-near-is-altered", |t, at| Some(after(t, at).ahead.clear())),
    ("idle-is-silent", |t, at| say(t, at, cancel(Token(0)))),
    // horizon
    ("never-dry", |t, at| Some(after(t, at).ahead.clear())),
    ("least-ahead", |t, at| Some(after(t, at).ahead.clear())),
    ("most-ahead", |t, at| Some(after(t, at).status.outstanding = 1000)),
    ("the-end-is-last", |t, at| {
        (after(t, at).ahead.len() > 1).then(|| after(t, at).ahead[0].end_of_plan = true)
    }),
    ("finished-after-the-end", |t, at| other_phase(t, at, Phase::Finished)),
    ("a-wait-is-at-an-intersection", |t, at| {
        fed(t, at)?.iter_mut().find(|w| is_loiter(w)).map(|w| w.leg = nowhere())
    }),
    ("waits-while-it-loiters", |t, at| other_phase(t, at, Phase::AwaitingDecision)),
    ("left-alone-it-ends", |t, at| Some(after(t, at).status.phase = Phase::Holding)),
    ("time-alone-once", |t, at| say(t, at, cancel(Token(0)))),
    ("deadlines-lie-ahead", |t, at| {
        (t.moments[at].now > Time::ZERO).then(|| after(t, at).deadline = Some(Time::ZERO))
    }),
    // place
    ("place-survives-hold", elsewhere),
    ("place-survives-resume", elsewhere),
    ("place-survives-refusal", elsewhere),
    ("place-survives-the-gateway", elsewhere),
    ("held-means-held", enter_a_leg),
    ("place-is-the-waypoint", |t, at| front(t, at).map(|w| w.leg = nowhere())),
    ("entered-is-steered-to", elsewhere),
    ("entered-by-progress", |t, at| Some(t.moments[at].stimulus = Stimulus::Input(Input::Tick))),
    ("entered-once", |t, at| repeat(t, at, |e| matches!(e, Event::LegEntered { .. }))),
    ("steered-to-is-announced", elsewhere),
    ("never-back", |t, at| (at > 9).then(|| after(t, at).status.current = Some(Token(0)))),
    ("way-made-grows", |t, at| after(t, at).status.place.as_mut().map(|p| p.distance_m = f64::NAN)),
    ("skip-leaves-the-leg", |t, at| Some(after(t, at).status.place = before(t, at).status.place.clone())),
    ("go-to-goes-there", |t, at| before(t, at).place().is_some().then(|| in_another_plan(t, at))?),
    ("progress-of-nobody-is-ignored", enter_a_leg),
    // loops
    ("iterations-without-gap", |t, at| arrive(t, at, 5).and(arrive(t, at, 9))),
    ("iteration-follows-arrival", |t, at| {
        entered(t, at)?.iterations.iter_mut().map(|i| i.iteration += 7).last()
    }),
    ("never-past-the-count", |t, at| arrival(t, at).map(|(_, finished)| *finished = 1000)),
    ("left-at-the-count", once_more),
    ("on-before-the-count", |t, at| entered(t, at).map(|p| p.iterations.clear())),
    ("count-of-the-plan", another_count),
    ("set-count-counts", |t, at| Some(after(t, at).status.place = None)),
    ("set-count-dies-with-the-loop", another_count),
    ("forward-goes-forward", |t, at| entered(t, at).map(|p| p.reverse = true)),
    ("turns-between-directions", |t, at| entered(t, at)?.iterations.last_mut().map(|i| i.reverse ^= true)),
    ("counts-are-checked", accept),
    // decisions
    ("asked-with-the-plans-options", |t, at| {
        event(t, at, |e| match e {
            Event::DecisionRequested(request) => Some(request.default = Some(nowhere())),
            _ => None,
        })
    }),
    ("asked-before-waiting", |t, at| Some(after(t, at).status.decision = None)),
    ("decided-by-the-deadline", |t, at| after(t, at).status.decision.as_mut().map(|d| d.time_left_s = 0.0)),
    ("decided-once-by-itself", |t, at| repeat(t, at, |e| matches!(e, Event::DecisionTaken { .. }))),
    ("taken-branches-exist", take_no_branch),
    ("the-default-is-the-plans", take_no_branch),
    ("a-condition-held", take_no_branch),
    ("operators-decide-by-command", |t, at| taken(t, at).map(|(_, _, by)| *by = "default".into())),
    ("the-operators-word-counts", overrule),
    ("flown-as-decided", the_other_branch),
    ("unknown-branches-are-refused", accept),
    ("waiting-has-no-answer-yet", |t, at| {
        let (phase, place) = (Phase::AwaitingDecision, before(t, at).status.place.clone());
        (after(t, at).status.phase, after(t, at).status.place) = (phase, place);
        Some(())
    }),
    // emergencies
    ("an-alarm-ends-on-a-runway", |t, at| {
        fed(t, at)?.iter_mut().find(|w| is_landing(w)).map(|w| w.action = Action::Fly)
    }),
    ("an-alarm-is-answered", |t, at| {
        unsay(t, at, |o| matches!(o, Output::Event(Event::EmergencyStarted { .. })))
    }),
    ("alarm-cancels-everything", |t, at| unsay(t, at, is_feed)),
    ("only-worse-causes", judge_severity_otherwise),
    ("emergency-plans-never-nest", |t, at| {
        event(t, at, |e| match e {
            Event::EmergencyStarted { from_leg, .. } => Some(*from_leg = Some("b-df".into())),
            _ => None,
        })
    }),
    ("most-specific-plan", |t, at| {
        event(t, at, |e| match e {
            Event::EmergencyStarted { plan, .. } => Some(*plan = nowhere()),
            _ => None,
        })
    }),
    ("in-force-is-told", |t, at| Some(after(t, at).status.emergency_in_force = Some(nowhere()))),
    ("alarm-ends-a-hold", |t, at| Some(after(t, at).status.phase = Phase::Holding)),
    ("back-by-command-only", |t, at| Some(t.moments[at].stimulus = Stimulus::Input(Input::Tick))),
    ("back-to-the-named-leg", in_another_plan),
    ("no-return-without-emergency", accept),
    // updates
    ("a-proposal-does-nothing", |t, at| say(t, at, cancel(Token(0)))),
    ("proposed-is-told", |t, at| Some(after(t, at).status.proposed = None)),
    ("the-report-is-true", |t, at| {
        answer(t, at).and_then(|a| match a {
            Ok(Answer::Proposal(report)) => Some(report.added.push(nowhere())),
            _ => None,
        })
    }),
    ("next-is-what-comes", |t, at| front(t, at).map(|w| w.leg = nowhere())),
    ("only-what-was-proposed", |t, at| accept(t, at)),
    ("swapped-whole", |t, at| Some(after(t, at).status.plan = Some("another".into()))),
    ("revisions-count-plans", |t, at| Some(after(t, at).status.revision += 1)),
    ("the-place-survives-an-update", elsewhere),
    ("the-entry-is-entered", |t, at| refuse_otherwise(t, at).or_else(|| lost(t, at))),
    ("superseded-is-gone", |t, at| front(t, at).map(|w| (w.leg, w.token) = (nowhere(), Token(u64::MAX)))),
    ("the-same-plan-changes-nothing", |t, at| say(t, at, cancel(Token(0)))),
    ("variables-carry-over", |t, at| Some(after(t, at).variables = Variables::default())),
    ("on-the-ground-it-waits", |t, at| Some(after(t, at).status.phase = Phase::Flying)),
    // actions
    ("acts-are-told", |t, at| unsay(t, at, |o| matches!(o, Output::Act { .. }))),
    ("acts-are-the-legs", |t, at| {
        event(t, at, |e| match e {
            Event::ActionDone { leg, .. } => Some(*leg = nowhere()),
            _ => None,
        })
    }),
    ("done-once-a-passage", |t, at| {
        let again = t.moments[at].outputs.iter().filter(|o| is_done(o)).cloned().collect::<Vec<_>>();
        Some(t.moments[at].outputs.extend(again))
    }),
    ("begun-with-its-leg", forget_what_was_done),
    ("done-by-its-end", forget_what_was_done),
    ("every-so-often", forget_what_was_done),
    ("nothing-is-done-by-the-way-while-muted", |t, at| {
        let act = ResolvedAct::Photo;
        say(t, at, Output::Event(Event::ActionDone { leg: nowhere(), passage: 0, act }))
    }),
    ("the-plan-writes-by-actions", |t, at| {
        unsay(t, at, |o| matches!(o, Output::Event(Event::VariableChanged { .. })))
    }),
    ("a-timed-wait-ends", |t, at| Some(t.moments[at].now += Time::from_secs(100))),
    ("a-timed-wait-is-flown", |t, at| Some(t.moments[at].now = Time::ZERO)),
    ("the-wait-left-is-told", |t, at| Some(after(t, at).status.wait_left_s = Some(99.0))),
    // holdings
    ("never-past-its-laps", |t, at| nothing_but_the_fix(t, at, 0)),
    ("released-at-its-fix", |t, at| nothing_but_the_fix(t, at, at)),
    ("left-for-a-reason", without_a_reason),
    // height and speed
    ("own-height-and-speed", |t, at| front(t, at).map(|w| w.airspeed_mps += 3.0)),
    ("own-height-and-speed", |t, at| front(t, at).map(|w| w.altitude_amsl_m += 100.0)),
    ("height-and-speed-of-now", |t, at| after(t, at).ahead.iter_mut().map(|w| w.airspeed_mps += 3.0).last()),
    ("height-and-speed-of-now", |t, at| {
        after(t, at).ahead.iter_mut().map(|w| w.altitude_amsl_m += 100.0).last()
    }),
    // restart
    ("same-after-restart", |t, at| say(t, at, Output::Hold)),
    ("status-survives-restart", |t, at| Some(after(t, at).status.revision += 1)),
    ("ahead-survives-restart", |t, at| after(t, at).ahead.pop().map(drop)),
    ("snapshot-of-a-snapshot", |t, at| restarted(t, at).map(|(same, _)| *same = false)),
    ("variables-survive-restart", |t, at| Some(after(t, at).variables = Variables::default())),
    ("no-token-twice-after-restart", |t, at| first_fed(t, at).map(|w| w.token = Token(0))),
    ("snapshots-know-their-plan", |t, at| restarted(t, at).map(|(_, refused)| *refused = false)),
    // answers
    ("one-answer-per-request", |t, at| unsay(t, at, |o| matches!(o, Output::Answer { .. }))),
    ("no-answer-without-a-request", |t, at| {
        say(t, at, Output::Answer { request: RequestId(7), result: Ok(Answer::Done) })
    }),
    ("refusals-advise", |t, at| refusal(t, at).map(|r| r.code.clear())),
    ("a-refusal-changes-nothing", |t, at| Some(after(t, at).status.revision += 1)),
    ("a-refusal-says-nothing-else", |t, at| say(t, at, Output::Hold)),
    ("phases-are-told", |t, at| unsay(t, at, |o| matches!(o, Output::Event(Event::PhaseChanged { .. })))),
    ("start-on-the-ground", |t, at| accept(t, at).or_else(|| refuse(t, at, "no"))),
    ("hold-once", |t, at| unsay(t, at, |o| *o == Output::Hold).or_else(|| say(t, at, Output::Hold))),
    ("an-abort-asks-for-safe-mode", |t, at| unsay(t, at, |o| *o == Output::Safe)),
    ("resume-a-hold", |t, at| accept(t, at).or_else(|| refuse(t, at, "no"))),
    ("writes-are-told", |t, at| unsay(t, at, |o| matches!(o, Output::Event(Event::VariableChanged { .. })))),
    ("bad-values-are-refused", |t, at| accept(t, at).or_else(|| refuse(t, at, "no"))),
    ("variables-change-by-command", |t, at| {
        let any = before(t, at).variables.iter().next().is_some();
        any.then(|| after(t, at).variables = Variables::default())
    }),
    ("a-refused-batch-holds", |t, at| unsay(t, at, |o| *o == Output::Hold)),
    ("garbage-is-ignored", |t, at| say(t, at, Output::Hold)),
    // the reference model
    ("flown-as-the-model-says", |t, at| entered(t, at).map(|p| p.leg = nowhere())),
    ("flown-as-the-model-says", |t, at| entered(t, at).map(|p| p.reverse ^= true)),
    ("flown-as-the-model-says", |t, at| arrival(t, at).map(|(_, finished)| *finished += 1)),
    ("flown-as-the-model-says", |t, at| entered(t, at)?.iterations.last_mut().map(|i| i.iteration += 1)),
];

// ---- what can be changed ----------------------------------------------------------------------------------------

fn nowhere() -> Id {
    Id::new("nowhere")
}

fn after(t: &mut Trace, at: usize) -> &mut Seen {
    &mut t.moments[at].after
}

fn before(t: &mut Trace, at: usize) -> &mut Seen {
    match at.checked_sub(1) {
        Some(i) => &mut t.moments[i].after,
        None => &mut t.start,
    }
}

fn front(t: &mut Trace, at: usize) -> Option<&mut Waypoint> {
    after(t, at).ahead.first_mut()
}

fn fed(t: &mut Trace, at: usize) -> Option<&mut Vec<Waypoint>> {
    t.moments[at].outputs.iter_mut().find_map(|o| match o {
        Output::Feed { waypoints, .. } if !waypoints.is_empty() => Some(waypoints),
        _ => None,
    })
}

fn first_fed(t: &mut Trace, at: usize) -> Option<&mut Waypoint> {
    fed(t, at)?.first_mut()
}

/// The last of several.
fn last_fed(t: &mut Trace, at: usize) -> Option<&mut Waypoint> {
    fed(t, at).filter(|w| w.len() > 1)?.last_mut()
}

fn is_landing(waypoint: &Waypoint) -> bool {
    matches!(waypoint.action, Action::Land { .. })
}

fn is_loiter(waypoint: &Waypoint) -> bool {
    matches!(waypoint.action, Action::Loiter { .. })
}

fn is_feed(output: &Output) -> bool {
    matches!(output, Output::Feed { .. })
}

fn cancel(token: Token) -> Output {
    Output::Feed { cancel_after: Some(token), waypoints: Vec::new() }
}

fn say(t: &mut Trace, at: usize, output: Output) -> Option<()> {
    t.moments[at].outputs.push(output);
    Some(())
}

fn unsay(t: &mut Trace, at: usize, what: impl Fn(&Output) -> bool) -> Option<()> {
    let outputs = &mut t.moments[at].outputs;
    let all = outputs.len();
    outputs.retain(|o| !what(o));
    (outputs.len() < all).then_some(())
}

fn repeat(t: &mut Trace, at: usize, what: impl Fn(&Event) -> bool) -> Option<()> {
    let outputs = &mut t.moments[at].outputs;
    let spot = outputs.iter().rposition(|o| matches!(o, Output::Event(e) if what(e)))?;
    outputs.insert(spot, outputs[spot].clone());
    Some(())
}

/// What `pick` makes of the last event that it knows.
fn event<'t, T>(t: &'t mut Trace, at: usize, pick: impl FnMut(&'t mut Event) -> Option<T>) -> Option<T> {
    let events = t.moments[at].outputs.iter_mut().rev().filter_map(|o| match o {
        Output::Event(event) => Some(event),
        _ => None,
    });
    events.into_iter().find_map(pick)
}

fn entered(t: &mut Trace, at: usize) -> Option<&mut PlacePointer> {
    event(t, at, |e| match e {
        Event::LegEntered { place } => Some(place),
        _ => None,
    })
}

fn arrival(t: &mut Trace, at: usize) -> Option<(Id, &mut u64)> {
    event(t, at, |e| match e {
        Event::IterationFinished { leg, finished, .. } => Some((leg.clone(), finished)),
        _ => None,
    })
}

fn taken(t: &mut Trace, at: usize) -> Option<(&Id, &mut Id, &mut String)> {
    event(t, at, |e| match e {
        Event::DecisionTaken { leg, branch, by } => Some((&*leg, branch, by)),
        _ => None,
    })
}

fn restarted(t: &mut Trace, at: usize) -> Option<(&mut bool, &mut bool)> {
    match &mut t.moments[at].stimulus {
        Stimulus::Restarted { same_snapshot, foreign_refused } => Some((same_snapshot, foreign_refused)),
        Stimulus::Input(_) => None,
    }
}

fn answer(t: &mut Trace, at: usize) -> Option<&mut Result<Answer, Refusal>> {
    t.moments[at].outputs.iter_mut().find_map(|o| match o {
        Output::Answer { result, .. } => Some(result),
        _ => None,
    })
}

fn refusal(t: &mut Trace, at: usize) -> Option<&mut Refusal> {
    answer(t, at)?.as_mut().err()
}

// ---- and how ------------------------------------------------------------------------------------------------------

fn cancelled_comes_back(t: &mut Trace, at: usize) -> Option<()> {
    let everything = t.step(at).feeds().any(|(cancel, _)| cancel == Some(Token(0)));
    let old = before(t, at).ahead.first().filter(|_| everything)?.clone();
    let was_fed = (0..at).any(|i| t.step(i).feeds().any(|(_, w)| w.iter().any(|w| w.token == old.token)));
    was_fed.then(|| after(t, at).ahead.push(old))
}

fn a_leg_like_a_wall(t: &mut Trace, at: usize) -> Option<()> {
    let waypoints = fed(t, at)?;
    let flown = |w: &Waypoint| w.action == Action::Fly;
    let alike = |w: &[Waypoint]| w[0].leg == w[1].leg && flown(&w[0]) && flown(&w[1]);
    let spot = waypoints.windows(2).position(alike)?;
    waypoints[spot + 1].altitude_amsl_m += 5000.0;
    Some(())
}

fn other_phase(t: &mut Trace, at: usize, phase: Phase) -> Option<()> {
    let status = &mut after(t, at).status;
    status.phase = if status.phase == phase { Phase::Flying } else { phase };
    Some(())
}

fn elsewhere(t: &mut Trace, at: usize) -> Option<()> {
    after(t, at).status.place.as_mut().map(|p| p.leg = nowhere())
}

/// Nor in the stage, nor in a loop.
fn lost(t: &mut Trace, at: usize) -> Option<()> {
    let place = after(t, at).status.place.as_mut()?;
    (place.leg, place.stage) = (nowhere(), nowhere());
    place.iterations.clear();
    Some(())
}

fn in_another_plan(t: &mut Trace, at: usize) -> Option<()> {
    after(t, at).status.place.as_mut().map(|p| p.plan = Branching::Emergency(nowhere()))
}

fn enter_a_leg(t: &mut Trace, at: usize) -> Option<()> {
    let place = before(t, at).status.place.clone()?;
    say(t, at, Output::Event(Event::LegEntered { place }))
}

fn arrive(t: &mut Trace, at: usize, finished: u64) -> Option<()> {
    say(t, at, Output::Event(Event::IterationFinished { leg: nowhere(), finished, of: None }))
}

fn once_more(t: &mut Trace, at: usize) -> Option<()> {
    let (leg, finished) = arrival(t, at)?;
    let iteration = *finished + 1;
    entered(t, at).map(|p| p.iterations.push(IterationPlace { leg, iteration, of: None, reverse: false }))
}

fn another_count(t: &mut Trace, at: usize) -> Option<()> {
    let places = t.moments[at].outputs.iter_mut().filter_map(|o| match o {
        Output::Event(Event::LegEntered { place }) => Some(place),
        _ => None,
    });
    places.flat_map(|p| &mut p.iterations).map(|i| i.of = Some(999)).last()
}

fn take_no_branch(t: &mut Trace, at: usize) -> Option<()> {
    taken(t, at).map(|(_, branch, _)| *branch = nowhere())
}

fn overrule(t: &mut Trace, at: usize) -> Option<()> {
    let asked = before(t, at).status.decision.as_ref().map(|d| d.leg.clone())?;
    let (leg, branch, by) = taken(t, at)?;
    let (leg, branch) = (leg.clone(), branch.clone());
    if by != "operator" || leg != asked {
        return None;
    }
    say(t, at, Output::Event(Event::DecisionTaken { leg, branch, by: "default".into() }))
}

/// The plans' branches lead to `-d` and to `-e`.
fn the_other_branch(t: &mut Trace, at: usize) -> Option<()> {
    let place = entered(t, at).filter(|p| !p.reverse)?;
    let (stem, end) = place.leg.as_str().rsplit_once('-')?;
    let other = match end {
        "d" => "e",
        "e" => "d",
        _ => return None,
    };
    place.leg = Id::new(&format!("{stem}-{other}"));
    Some(())
}

fn accept(t: &mut Trace, at: usize) -> Option<()> {
    answer(t, at).filter(|a| a.is_err()).map(|a| *a = Ok(Answer::Done))
}

fn refuse(t: &mut Trace, at: usize, code: &str) -> Option<()> {
    let why = Refusal { code: code.into(), reason: "for no reason at all".into() };
    answer(t, at).filter(|a| a.is_ok()).map(|a| *a = Err(why))
}

fn judge_severity_otherwise(t: &mut Trace, at: usize) -> Option<()> {
    if refusal(t, at).is_some_and(|r| r.code == "not-more-severe") {
        return accept(t, at);
    }
    refusal(t, at).map(|r| r.code = "not-more-severe".into()).or_else(|| refuse(t, at, "not-more-severe"))
}

fn refuse_otherwise(t: &mut Trace, at: usize) -> Option<()> {
    refusal(t, at).map(|r| r.code = "another".into())
}

fn is_done(output: &Output) -> bool {
    matches!(output, Output::Event(Event::ActionDone { .. } | Event::ActionRefused { .. }))
}

fn forget_what_was_done(t: &mut Trace, _: usize) -> Option<()> {
    Some(t.moments.iter_mut().for_each(|m| m.outputs.retain(|o| !is_done(o))))
}

/// Every waypoint of the leg is its fix, where several of them are still to be flown.
fn nothing_but_the_fix(t: &mut Trace, at: usize, from: usize) -> Option<()> {
    let leg = before(t, at).place()?.leg.clone();
    let program = t.moments[at].after.program.clone()?;
    let Some(Place::Position(Value::Constant(fix))) = program.leg(&leg)?.place() else { return None };
    let on_it = |m: &Moment| m.after.place().is_some_and(|p| p.leg == leg);
    let mut told = 0;
    for moment in t.moments[from..].iter_mut().take_while(|m| from == 0 || on_it(m)) {
        told +=
            usize::from(matches!(moment.stimulus, Stimulus::Input(Input::Progress { .. })) && on_it(moment));
        moment.after.ahead.iter_mut().filter(|w| w.leg == leg).for_each(|w| w.position = *fix);
    }
    (told > 7).then_some(())
}

/// Neither condition nor command nor laps.
fn without_a_reason(t: &mut Trace, _: usize) -> Option<()> {
    // an update is a reason as well
    if t.steps().any(|s| s.update().is_some()) {
        return None;
    }
    for moment in &mut t.moments {
        moment.after.variables = Variables::default();
        moment.after.ahead.iter_mut().for_each(|w| w.position = LatLon::new(0.0, 0.0));
        if matches!(&moment.stimulus, Stimulus::Input(Input::Command { command: Command::SkipLeg, .. })) {
            moment.stimulus = Stimulus::Input(Input::Tick);
        }
    }
    Some(())
}

// ---- the test -----------------------------------------------------------------------------------------------------

/// Whether a policy that held notices a change; `None`: there was nothing to change here.
fn notices(policy: &Policy, tamper: Tamper, trace: &Trace, at: usize) -> Option<bool> {
    let mut tampered = trace.clone();
    tamper(&mut tampered, at)?;
    let mut found = Findings::default();
    (policy.check)(&tampered, &mut found);
    Some(!found.broken.is_empty())
}

/// The moments of a trace at which a policy applied, each once.
fn moments(policy: &Policy, trace: &Trace) -> Vec<usize> {
    let mut found = Findings::default();
    (policy.check)(trace, &mut found);
    found.applied.dedup();
    found.applied
}

#[test]
fn every_policy_notices_what_is_tampered_with() {
    let mut open: Vec<_> = TAMPERINGS.iter().map(|(name, tamper)| (*name, *tamper, 0)).collect();
    for seed in 0..SEQUENCES {
        let trace = crate::flight::fly(seed, usize::MAX);
        for (name, tamper, noticed) in &mut open {
            let policy = policy::all().find(|p| p.name == *name).unwrap();
            let tried = moments(policy, &trace)
                .into_iter()
                .find_map(|at| Some((at, notices(policy, *tamper, &trace, at)?)));
            if let Some((at, caught)) = tried {
                assert!(caught, "{name} does not notice what was done to moment {at} of sequence {seed}");
                *noticed += 1;
            }
        }
        open.retain(|(_, _, noticed)| *noticed < TIMES);
        if open.is_empty() {
            break;
        }
    }
    let never: Vec<_> = open.iter().filter(|(_, _, noticed)| *noticed == 0).map(|(name, ..)| name).collect();
    assert!(never.is_empty(), "never tried: {never:?}");
}

#[test]
fn every_policy_is_tampered_with() {
    let tampered = |p: &&Policy| TAMPERINGS.iter().any(|(name, _)| *name == p.name);
    let missing: Vec<_> = policy::all().filter(|p| !tampered(p)).map(|p| p.name).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
