//! Loops: every iteration is flown and announced once, none is skipped.

use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Trace, kind};
use flight_exec::{Command, Event, PlacePointer};
use flight_plan::{Id, IterativeForm, LegKind, Value};
use std::collections::{BTreeMap, BTreeSet};

pub const POLICIES: &[Policy] = &[
    policy("iterations-without-gap", "Every loop iteration is announced once and none skipped.", without_gap),
    policy(
        "iteration-follows-arrival",
        "After arrival n a leg of the loop belongs to iteration n + 1.",
        follows_arrival,
    ),
    policy(
        "never-past-the-count",
        "No loop makes more passes than its count, unless the count was lowered under way.",
        never_past_the_count,
    ),
    policy("left-at-the-count", "A loop is left at the arrival that makes its count.", left_at_the_count),
    policy(
        "on-before-the-count",
        "Before its count, a loop without a condition goes on.",
        on_before_the_count,
    ),
    policy("count-of-the-plan", "The count told is the plan's, or the one that was set.", count_of_the_plan),
    policy("set-count-counts", "A count that is set is told as the loop's at once.", set_count_counts),
    policy(
        "set-count-dies-with-the-loop",
        "A count that was set is forgotten when its loop is left, however it is left.",
        set_count_dies,
    ),
    policy(
        "forward-goes-forward",
        "A forward loop in no reverse one is never flown backwards.",
        forward_goes_forward,
    ),
    policy(
        "turns-between-directions",
        "A reverse loop changes its direction in a full turn, and turns nowhere else.",
        turns_between,
    ),
    policy(
        "counts-are-checked",
        "A count for a loop that is not being flown, for a call, or of zero, is refused.",
        counts_are_checked,
    ),
];

struct Arrival<'a> {
    leg: &'a Id,
    finished: u64,
    of: Option<u64>,
}

fn arrival(event: &Event) -> Option<Arrival<'_>> {
    match event {
        Event::IterationFinished { leg, finished, of } => Some(Arrival { leg, finished: *finished, of: *of }),
        _ => None,
    }
}

/// The event, with every one that follows until the next jump or update.
fn undisturbed<'a>(trace: &'a Trace) -> Vec<Vec<(Step<'a>, &'a Event)>> {
    let mut runs = vec![Vec::new()];
    for step in trace.steps() {
        if step.is_jump() {
            runs.push(Vec::new());
        }
        runs.last_mut().unwrap().extend(step.events().map(|e| (step, e)));
    }
    runs
}

/// Each arrival with the leg that is entered next.
fn arrivals<'a>(trace: &'a Trace) -> Vec<(Step<'a>, Arrival<'a>, Option<&'a PlacePointer>)> {
    let mut all = Vec::new();
    for run in undisturbed(trace) {
        for (i, (step, event)) in run.iter().enumerate() {
            let next = run[i..].iter().find_map(|(_, e)| match e {
                Event::LegEntered { place } => Some(place),
                _ => None,
            });
            all.extend(arrival(event).map(|a| (*step, a, next)));
        }
    }
    all
}

fn without_gap(trace: &Trace, found: &mut Findings) {
    for run in undisturbed(trace) {
        let mut last: BTreeMap<&Id, u64> = BTreeMap::new();
        for (step, event) in run {
            let Some(Arrival { leg, finished, .. }) = arrival(event) else { continue };
            // a run may begin in the middle of a loop
            let follows = last.get(leg).is_none_or(|n| finished == n + 1 || finished == 1);
            found.expect(step, follows, || format!("{leg}: {finished} after {:?}", last.get(leg)));
            last.insert(leg, finished);
        }
    }
}

fn follows_arrival(trace: &Trace, found: &mut Findings) {
    for (step, Arrival { leg, finished, .. }, next) in arrivals(trace) {
        let Some(inside) = next.and_then(|p| p.iterations.iter().find(|i| i.leg == *leg)) else { continue };
        let right = inside.iteration == finished + 1 || inside.iteration == 1;
        found.expect(step, right, || format!("{leg}: arrival {finished}, then {inside:?}"));
    }
}

/// Loops whose count was set by command so far.
fn set_counts(trace: &Trace, until: usize) -> impl Iterator<Item = (&Id, u64)> {
    trace.accepted().take_while(move |(s, _)| s.at < until).filter_map(|(_, c)| match c {
        Command::SetCount { leg, count } => Some((leg, *count)),
        _ => None,
    })
}

fn was_lowered(trace: &Trace, step: Step, leg: &Id) -> bool {
    let constant = step.after.program.as_deref().is_some_and(|p| constant_count(p, leg).is_some());
    let updated = trace.steps().take(step.at).filter(|s| s.update().is_some()).count() > 0;
    !constant || updated || set_counts(trace, step.at).any(|(id, _)| id == leg)
}

fn never_past_the_count(trace: &Trace, found: &mut Findings) {
    for (step, Arrival { leg, finished, of }, _) in arrivals(trace) {
        if let Some(of) = of.filter(|_| !was_lowered(trace, step, leg)) {
            found.expect(step, finished <= of, || format!("{leg}: {finished} of {of}"));
        }
    }
}

fn is_within(place: &PlacePointer, leg: &Id, iteration: u64) -> bool {
    place.iterations.iter().any(|i| i.leg == *leg && i.iteration == iteration)
}

fn left_at_the_count(trace: &Trace, found: &mut Findings) {
    for (step, Arrival { leg, finished, of }, next) in arrivals(trace) {
        if let (Some(of), Some(next)) = (of.filter(|of| finished >= *of), next) {
            let left = !is_within(next, leg, finished + 1);
            found.expect(step, left, || format!("{leg}: {finished} of {of}, then {next:?}"));
        }
    }
}

fn on_before_the_count(trace: &Trace, found: &mut Findings) {
    for (step, Arrival { leg, finished, of }, next) in arrivals(trace) {
        let looped = step.after.program.as_deref().and_then(|p| kind(p, leg));
        let Some(LegKind::Iterative { until: None, .. }) = looped else { continue };
        if let (true, Some(next)) = (of.is_some_and(|of| finished < of), next) {
            let on = is_within(next, leg, finished + 1);
            found.expect(step, on, || format!("{leg}: {finished} of {of:?}, then {next:?}"));
        }
    }
}

fn constant_count(program: &flight_plan::Program, leg: &Id) -> Option<u64> {
    match kind(program, leg)? {
        LegKind::Iterative { count: Some(Value::Constant(n)), .. } => Some(*n as u64),
        _ => None,
    }
}

fn count_of_the_plan(trace: &Trace, found: &mut Findings) {
    for (step, place) in trace.entered() {
        let updated = trace.steps().take(step.at).any(|s| s.update().is_some());
        for around in place.iterations.iter().filter(|_| !updated) {
            let Some(own) = step.after.program.as_deref().and_then(|p| constant_count(p, &around.leg)) else {
                continue;
            };
            let mut set = set_counts(trace, step.at).filter(|(id, _)| **id == around.leg).map(|(_, n)| n);
            let right = around.of == Some(own) || set.any(|n| around.of == Some(n));
            found.expect(step, right, || format!("{around:?}, the plan says {own}"));
        }
    }
}

fn set_count_counts(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let Command::SetCount { leg, count } = command else { continue };
        let around = |seen: &Seen| seen.place()?.iterations.iter().find(|i| i.leg == *leg).cloned();
        let (was, is) = (around(step.before), around(step.after));
        // a pass that has not begun, beyond the new count, is not flown any more
        let left = is.is_none() && was.is_some_and(|i| i.iteration > *count) && !step.is_begun();
        found.expect(step, left || is.as_ref().is_some_and(|i| i.of == Some(*count)), || {
            format!("{leg} set to {count}: {is:?}")
        });
    }
}

/// Entered anew (first iteration, after being outside of it), a loop has the plan's count.
/// One that was set on the way to a loop, before a leg of it was entered, is that of the loop as it is entered then.
fn set_count_dies(trace: &Trace, found: &mut Findings) {
    let mut set: BTreeMap<&Id, u64> = BTreeMap::new();
    let mut left: BTreeMap<&Id, u64> = BTreeMap::new();
    let mut on_the_way: BTreeSet<&Id> = BTreeSet::new();
    let mut last: Option<&PlacePointer> = None;
    let is_around = |place: &PlacePointer, id: &Id| place.iterations.iter().any(|i| i.leg == *id);
    for step in trace.steps() {
        if step.update().is_some() || step.accepted() == Some(&Command::Start) {
            (set, left) = Default::default();
        }
        for place in step.entered() {
            on_the_way.retain(|id| !is_around(place, id));
            let is_left = |id: &&Id| !is_around(place, id) && !on_the_way.contains(*id);
            let gone: Vec<_> = set.keys().copied().filter(is_left).collect();
            left.extend(gone.into_iter().filter_map(|id| set.remove_entry(id)));
            for around in &place.iterations {
                let Some((_, n)) = left.remove_entry(&around.leg) else { continue };
                let own = step.after.program.as_deref().and_then(|p| constant_count(p, &around.leg));
                if own.is_some_and(|own| own != n) {
                    found.expect(step, around.of == own, || {
                        format!("{around:?}: {n} was set in an activation before")
                    });
                }
            }
            last = Some(place);
        }
        if let Some(Command::SetCount { leg, count }) = step.accepted() {
            left.remove(leg);
            set.insert(leg, *count);
            if !last.is_some_and(|place| is_around(place, leg)) {
                on_the_way.insert(leg);
            }
        }
    }
}

fn forward_goes_forward(trace: &Trace, found: &mut Findings) {
    for (step, place) in trace.entered().filter(|(_, p)| !p.iterations.is_empty()) {
        let Some(program) = step.after.program.as_deref() else { continue };
        let reverse = |id: &Id| {
            matches!(kind(program, id), Some(LegKind::Iterative { form: IterativeForm::Reverse, .. }))
        };
        if place.iterations.iter().all(|i| program.leg(&i.leg).is_some() && !reverse(&i.leg)) {
            found.expect(step, !place.reverse, || format!("{place:?}"));
        }
    }
}

/// Two legs entered one after the other in the same loops, in opposite directions: the second is the turn.
fn turns_between(trace: &Trace, found: &mut Findings) {
    for run in undisturbed(trace) {
        let entered = run.into_iter().filter_map(|(s, e)| match e {
            Event::LegEntered { place } => Some((s, place)),
            _ => None,
        });
        let entered: Vec<_> = entered.collect();
        for pair in entered.windows(2) {
            let ((_, a), (step, b)) = (&pair[0], &pair[1]);
            let (Some(inner), Some(before)) = (b.iterations.last(), a.iterations.last()) else { continue };
            let same = inner.leg == before.leg && a.iterations.len() == b.iterations.len();
            let outer = a.iterations.len() - 1;
            if !same || a.iterations[..outer] != b.iterations[..outer] {
                continue;
            }
            let turns = b.leg == inner.leg;
            found.expect(*step, turns == (inner.reverse != before.reverse), || format!("{a:?}, then {b:?}"));
        }
    }
}

fn counts_are_checked(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Command::SetCount { leg, count }) = step.command() else { continue };
        let flown = step.before.is_flying()
            && step.before.place().is_some_and(|p| p.iterations.iter().any(|i| i.leg == *leg));
        let once = |p: &flight_plan::Program| {
            matches!(kind(p, leg), Some(LegKind::Iterative { form: IterativeForm::Once, .. }))
        };
        let called = step.before.program.as_deref().is_some_and(once);
        if *count == 0 || !flown || called {
            found.expect(step, step.refused().is_some(), || format!("{leg} set to {count}"));
        }
    }
}
