//! Actions: done when they are due, once a passage, by somebody to whom it is reported.

use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Trace, same_passage};
use flight_exec::{Command, Event, Input, Output, Phase, PlacePointer, ResolvedAct};
use flight_plan::{Act, Id, Leg, LegKind, Program, Trigger};
use std::collections::BTreeMap;
use std::mem::{Discriminant, discriminant};

pub const POLICIES: &[Policy] = &[
    policy(
        "acts-are-told",
        "What somebody else is to do is told as done with leg and passage, and nothing else is.",
        acts_are_reported,
    ),
    policy("acts-are-the-legs", "Only what a leg of the plan says is done.", acts_are_the_legs),
    policy(
        "done-once-a-passage",
        "On a passage an action is done once, whatever the direction and however often the path is laid out anew.",
        done_once,
    ),
    policy(
        "begun-with-its-leg",
        "What is due at a leg's start is done when it is entered.",
        begun_with_its_leg,
    ),
    policy(
        "done-by-its-end",
        "What is due at a leg's end has been done when the next one is entered, and not before the last waypoint.",
        done_by_its_end,
    ),
    policy(
        "every-so-often",
        "A repeated action is done as often as its distance goes into the way made.",
        every_so_often,
    ),
    policy(
        "nothing-is-done-by-the-way-while-muted",
        "While it holds, or the gateway controls, nothing is done but at waypoints that are told to be passed.",
        nothing_while_muted,
    ),
    policy(
        "the-plan-writes-by-actions",
        "A variable is written by the plan exactly when an action that sets it is done.",
        plan_writes,
    ),
    policy("a-timed-wait-ends", "A wait ends when its time is over.", wait_ends),
    policy("a-timed-wait-is-flown", "A wait that nobody cuts short lasts its time.", wait_is_flown),
    policy("the-wait-left-is-told", "How long it still circles is told exactly while it does.", wait_left),
];

fn done<'a>(step: Step<'a>) -> impl Iterator<Item = (&'a Id, u64, &'a ResolvedAct)> {
    step.events().filter_map(|e| match e {
        Event::ActionDone { leg, passage, act } => Some((leg, *passage, act)),
        _ => None,
    })
}

fn is_wait(act: &ResolvedAct) -> bool {
    matches!(act, ResolvedAct::Wait { .. })
}

fn acts_are_reported(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let asked = step.moment.outputs.iter().filter_map(|o| match o {
            Output::Act { leg, passage, act } => Some((leg, *passage, act)),
            _ => None,
        });
        let asked: Vec<_> = asked.collect();
        let told: Vec<_> = done(step).filter(|(.., act)| !is_wait(act)).collect();
        if !asked.is_empty() || !told.is_empty() {
            found.expect(step, asked == told, || format!("{asked:?} told as {told:?}"));
        }
    }
}

/// The plan's actions, written down once more: what an action of a leg looks like when it is done.
fn is_like(act: &Act, done: &ResolvedAct) -> bool {
    match (act, done) {
        (Act::Photo, ResolvedAct::Photo)
        | (Act::PhotoStop, ResolvedAct::PhotoStop)
        | (Act::VideoStart, ResolvedAct::VideoStart)
        | (Act::VideoStop, ResolvedAct::VideoStop) => true,
        (Act::PhotoSeries { .. }, ResolvedAct::PhotoSeries { every_m }) => *every_m == 40.0,
        (Act::Set { variable, .. }, ResolvedAct::Set { variable: written, .. }) => variable == written,
        (Act::Invoke { service, .. }, ResolvedAct::Invoke { service: called, .. }) => service == called,
        (Act::Wait { .. }, ResolvedAct::Wait { seconds }) => *seconds == 20.0,
        _ => false,
    }
}

/// At the instant of an update what is done may still be of the old plan, or already of the new one.
fn acts_are_the_legs(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        for (leg, _, act) in done(step) {
            let says = |seen: &Seen| {
                let leg = seen.program.as_deref().and_then(|p| p.leg(leg));
                leg.is_some_and(|l| l.actions.iter().any(|a| is_like(&a.act, act)))
            };
            found.expect(step, says(step.before) || says(step.after), || format!("{leg}: {act:?}"));
        }
    }
}

/// Which action of a leg it was: no leg has two of a kind, but that two variables may be written.
fn kind_of(act: &ResolvedAct) -> (Discriminant<ResolvedAct>, Option<&Id>) {
    let variable = match act {
        ResolvedAct::Set { variable, .. } => Some(variable),
        _ => None,
    };
    (discriminant(act), variable)
}

fn repeats(leg: &Leg, act: &ResolvedAct) -> bool {
    leg.actions.iter().any(|a| matches!(a.trigger, Trigger::Every(_)) && is_like(&a.act, act))
}

/// Actions that an update has changed are other actions.
fn done_once(trace: &Trace, found: &mut Findings) {
    let mut seen = BTreeMap::new();
    for step in trace.steps() {
        if step.update().is_some() {
            seen.clear();
        }
        for (leg, passage, act) in done(step) {
            let Some(own) = step.after.program.as_deref().and_then(|p| p.leg(leg)) else { continue };
            if !repeats(own, act) {
                let kinds: &mut Vec<_> = seen.entry((leg, passage)).or_default();
                found.expect(step, !kinds.contains(&kind_of(act)), || {
                    format!("{leg} {passage}: {act:?} again")
                });
                kinds.push(kind_of(act));
            }
        }
    }
}

/// What was reported of a leg's actions: done, or why not.
fn reports_of(step: Step, leg: &Id, wanted: &Act) -> usize {
    let refused = |e: &&Event| matches!(e, Event::ActionRefused { leg: of, .. } if of == leg);
    let alike = done(step).filter(|(of, _, act)| *of == leg && is_like(wanted, act)).count();
    alike + step.events().filter(refused).count()
}

fn flies(leg: &Leg) -> bool {
    !matches!(leg.kind, LegKind::Iterative { .. } | LegKind::Intersection { .. }) && leg.kind_name() != "IF"
}

fn actions_at<'a>(leg: &'a Leg, trigger: &'a Trigger) -> impl Iterator<Item = &'a Act> {
    leg.actions.iter().filter(move |a| a.trigger == *trigger).map(|a| &a.act)
}

fn begun_with_its_leg(trace: &Trace, found: &mut Findings) {
    for (step, place) in trace.entered() {
        let Some(leg) = step.after.program.as_deref().and_then(|p| p.leg(&place.leg)) else { continue };
        if !flies(leg) || updated_since_jump(step) {
            continue;
        }
        for act in actions_at(leg, &Trigger::Start) {
            found.expect(step, reports_of(step, &leg.id, act) > 0, || {
                format!("{} entered without {act:?}", leg.id)
            });
        }
    }
}

/// A passage may have been begun in a plan that was replaced.
pub fn updated_since_jump(step: Step) -> bool {
    let mut back = (0..=step.at).rev().map(|at| step.trace.step(at)).take_while(|s| !is_leap(s));
    back.any(|s| s.update().is_some())
}

/// To skip a holding only releases it: what was ahead stays.
fn is_leap(step: &Step) -> bool {
    let front = |seen: &Seen| seen.ahead.first().map(|w| w.token);
    step.is_jump() && step.update().is_none() && front(step.before) != front(step.after)
}

/// Two legs entered one after the other, nobody having interfered: the first one, and the steps from one to the other.
fn left_by_itself(trace: &Trace) -> Vec<(&PlacePointer, std::ops::RangeInclusive<usize>)> {
    let mut legs = Vec::new();
    let mut last: Option<(usize, &PlacePointer)> = None;
    for step in trace.steps() {
        if step.is_jump() {
            last = None;
        }
        for place in step.entered() {
            if let Some((at, before)) =
                last.replace((step.at, place)).filter(|(_, b)| !same_passage(b, place))
            {
                legs.push((before, at..=step.at));
            }
        }
    }
    legs
}

/// Several legs may be passed in one step, when progress is reported late.
fn done_by_its_end(trace: &Trace, found: &mut Findings) {
    for (place, steps) in left_by_itself(trace) {
        let last = trace.step(*steps.end());
        let Some(leg) = last.after.program.as_deref().and_then(|p| p.leg(&place.leg)) else { continue };
        if !flies(leg) {
            continue;
        }
        let changed = was_another_kind(last, leg);
        for act in actions_at(leg, &Trigger::End).filter(|act| !changed || !matches!(act, Act::Wait { .. })) {
            let told: usize = steps.clone().map(|at| reports_of(trace.step(at), &leg.id, act)).sum();
            found.expect(last, told > 0, || format!("{} was left without {act:?}", leg.id));
        }
    }
}

/// Since the last leap the leg was of another kind while waypoints of it were ahead: where those are near, they are kept, and it is
/// at its end without any of its own.
fn was_another_kind(step: Step, leg: &Leg) -> bool {
    let back = (0..=step.at).rev().map(|at| step.trace.step(at)).take_while(|s| !is_leap(s));
    let mut updates = back.filter_map(|s| Some((s, s.update()?.0)));
    let kind = |program: &Program| program.leg(&leg.id).map(|l| l.kind_name());
    updates
        .any(|(s, old)| kind(old) != Some(leg.kind_name()) && s.before.ahead.iter().any(|w| w.leg == leg.id))
}

/// By what is flown: the aircraft reports where it is, and is where it steers to when that is passed.
fn every_so_often(trace: &Trace, found: &mut Findings) {
    for (place, steps) in left_by_itself(trace) {
        let last = trace.step(*steps.end());
        let Some(leg) = last.after.program.as_deref().and_then(|p| p.leg(&place.leg)) else { continue };
        let repeated = leg.actions.iter().find(|a| matches!(a.trigger, Trigger::Every(_)));
        let Some(action) = repeated.filter(|_| flies(leg)) else { continue };
        let made = |at: &usize| trace.step(*at).before.place().filter(|p| same_passage(p, place));
        let way_m = steps.clone().filter_map(|at| made(&at).map(|p| p.distance_m)).fold(0.0, f64::max);
        let told: usize = steps.clone().map(|at| reports_of(trace.step(at), &leg.id, &action.act)).sum();
        // what lies before the last waypoint has been passed; the aircraft may have been nearer than was reported
        let least = (way_m / 400.0).floor() as usize;
        if least == 0 {
            continue;
        }
        found.expect(last, told >= least, || format!("{}: {told} times in {way_m:.0} m", leg.id));
    }
}

fn nothing_while_muted(trace: &Trace, found: &mut Findings) {
    let muted = |seen: &Seen| seen.status.phase == Phase::Holding || seen.gateway_controls;
    for step in trace.steps().filter(|s| muted(s.before) && muted(s.after)) {
        if !matches!(step.input(), Some(Input::Progress { .. })) {
            let act = done(step).next();
            found.expect(step, act.is_none(), || format!("{act:?}"));
        }
    }
}

fn plan_writes(trace: &Trace, found: &mut Findings) {
    // a start gives variables their initial values
    for step in trace.steps().filter(|s| s.accepted() != Some(&Command::Start)) {
        let written = step.events().filter_map(|e| match e {
            Event::VariableChanged { name, value, by } if **by == *"plan" => Some((name, value)),
            _ => None,
        });
        let set = done(step).filter_map(|(.., act)| match act {
            ResolvedAct::Set { variable, value } => Some((variable, value)),
            _ => None,
        });
        let (written, set): (Vec<_>, Vec<_>) = (written.collect(), set.collect());
        if !written.is_empty() || !set.is_empty() {
            found.expect(step, written == set, || format!("{written:?} for {set:?}"));
        }
    }
}

// ---- waits ------------------------------------------------------------------------------------------------------

fn wait_begun(step: Step<'_>) -> Option<(&Id, u64, f64)> {
    done(step).find_map(|(leg, passage, act)| match act {
        ResolvedAct::Wait { seconds } => Some((leg, passage, *seconds)),
        _ => None,
    })
}

/// A wait with the steps until the first that doesn't circle any more, or that leads to a circle which is another one.
fn waits(trace: &Trace) -> Vec<(f64, f64, Vec<Step<'_>>)> {
    let begun = trace.steps().filter_map(|s| wait_begun(s).map(|(.., seconds)| (s, seconds)));
    let begun = begun.filter(|(s, _)| s.after.circles());
    let with_end = begun.map(|(step, seconds)| {
        let later = (step.at + 1..trace.moments.len()).map(|at| trace.step(at));
        let mut over = false;
        let elsewhere = |s: &Step| s.is_jump() && !s.keeps_its_leg();
        let ends = |s: &Step| !s.after.circles() || wait_begun(*s).is_some() || elsewhere(s);
        let until = later.take_while(|s| !std::mem::replace(&mut over, ends(s)));
        (step.moment.now.as_secs_f64(), seconds, until.collect())
    });
    with_end.collect()
}

fn wait_ends(trace: &Trace, found: &mut Findings) {
    for (begin_s, seconds, steps) in waits(trace) {
        for step in steps.into_iter().filter(|s| s.input().is_some() && s.after.circles()) {
            let waited_s = step.moment.now.as_secs_f64() - begin_s;
            // a time that goes back is not time that has passed
            found.expect(step, waited_s < seconds + 1.0 || wait_begun(step).is_some(), || {
                format!("circles for {waited_s:.1} s instead of {seconds} s")
            });
        }
    }
}

fn wait_is_flown(trace: &Trace, found: &mut Findings) {
    for (begin_s, seconds, steps) in waits(trace) {
        let Some(last) = steps.last().filter(|s| !s.after.circles()) else { continue };
        let interfered = |s: &Step| {
            // a commit that is gone back on at once circles again at the next moment
            s.is_jump()
                || s.is_undone()
                || matches!(s.input(), Some(Input::Rejected { .. } | Input::Progress { .. }))
        };
        if !steps.iter().any(interfered) {
            let waited_s = last.moment.now.as_secs_f64() - begin_s;
            // the clock goes on where time went back
            found.expect(*last, waited_s > seconds - 1.0, || {
                format!("circled for {waited_s:.1} s instead of {seconds} s")
            });
        }
    }
}

/// It begins when the gateway steers to the circle: one that an update puts in its place is another one.
fn wait_left(trace: &Trace, found: &mut Findings) {
    let mut steered = None;
    for step in trace.steps().filter(|s| s.after.is_flying() && !s.after.ahead.is_empty()) {
        if let Some(Input::Progress { current }) = step.input() {
            // a number of nobody may come to be somebody's
            steered = current.filter(|token| step.before.tokens().contains(token));
        }
        let begun = step.is_begun_now() && steered == step.after.status.current;
        let left_s = step.after.status.wait_left_s;
        if left_s.is_some() || (step.after.circles() && begun) {
            let sound = left_s.is_some_and(|s| (0.0..20.001).contains(&s)) && step.after.circles();
            found.expect(step, sound, || format!("{left_s:?} left, {:?}", step.accepted()));
        }
    }
}
