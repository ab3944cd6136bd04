//! Intersections: asked in time, decided in time, flown as decided.

use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Trace, kind};
use flight_exec::{Command, DecisionRequest, Event, Phase};
use flight_plan::{Branch, Id, LegKind, Program, VariableValue};
use std::collections::BTreeMap;

pub const POLICIES: &[Policy] = &[
    policy(
        "asked-with-the-plans-options",
        "A question carries the plan's branches and its default.",
        plans_options,
    ),
    policy(
        "asked-before-waiting",
        "Nobody waits at an intersection without having asked.",
        asked_before_waiting,
    ),
    policy("decided-by-the-deadline", "A decision is taken no later than its deadline.", by_the_deadline),
    policy(
        "decided-once-by-itself",
        "What nobody decides is decided once for each crossing.",
        once_by_itself,
    ),
    policy("taken-branches-exist", "Only branches of the plan are taken.", branches_exist),
    policy("the-default-is-the-plans", "A default that is taken is the plan's.", default_is_the_plans),
    policy("a-condition-held", "A branch taken by its condition has one that held.", condition_held),
    policy(
        "operators-decide-by-command",
        "`operator` decides in answer to a command, and every decision accepted is told.",
        by_command,
    ),
    policy(
        "the-operators-word-counts",
        "Neither default nor condition overrules a decision of the operator for the same crossing.",
        operators_word,
    ),
    policy("flown-as-decided", "The branch that is flown is the one decided last.", flown_as_decided),
    policy(
        "unknown-branches-are-refused",
        "A decision for what is no intersection, or no branch of it, is refused.",
        unknown_refused,
    ),
    policy(
        "waiting-has-no-answer-yet",
        "Who waits for a decision goes on as soon as there is one.",
        waiting_ends,
    ),
];

fn fork<'a>(program: &'a Program, leg: &Id) -> Option<(&'a [Branch], Option<&'a Id>)> {
    match kind(program, leg)? {
        LegKind::Intersection { branches, default, .. } => Some((branches, default.as_ref())),
        _ => None,
    }
}

fn seen_fork<'a>(seen: &'a Seen, leg: &Id) -> Option<(&'a [Branch], Option<&'a Id>)> {
    fork(seen.program.as_deref()?, leg)
}

fn taken(event: &Event) -> Option<(&Id, &Id, &str)> {
    match event {
        Event::DecisionTaken { leg, branch, by } => Some((leg, branch, by)),
        _ => None,
    }
}

fn plans_options(trace: &Trace, found: &mut Findings) {
    for (step, event) in trace.events() {
        let Event::DecisionRequested(request) = event else { continue };
        let DecisionRequest { leg, options, default, .. } = request;
        let right = seen_fork(step.after, leg).is_some_and(|(branches, own)| {
            let names = branches.iter().map(|b| &b.id);
            names.eq(options.iter().map(|o| &o.branch)) && own == default.as_ref()
        });
        found.expect(step, right, || format!("{request:?}"));
    }
}

fn asked_before_waiting(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        if step.after.status.phase == Phase::AwaitingDecision
            && step.before.status.phase != Phase::AwaitingDecision
        {
            let asked = step.after.status.decision.is_some();
            found.expect(step, asked, || "waits, and asks nothing".into());
        }
    }
}

/// Without a default and without a condition that holds nobody can decide: it waits instead.
fn by_the_deadline(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.after.is_fed() && s.input().is_some()) {
        let Some(request) = &step.after.status.decision else { continue };
        if request.default.is_some() {
            found.expect(step, request.time_left_s > 0.0, || format!("{request:?}"));
        }
    }
}

/// Between two crossings (a leg entered beyond it, or a jump) default and condition speak once.
fn once_by_itself(trace: &Trace, found: &mut Findings) {
    let mut spoken: Vec<&Id> = Vec::new();
    for step in trace.steps() {
        if step.is_jump() {
            spoken.clear();
        }
        for event in step.events() {
            if let Event::LegEntered { place } = event {
                spoken.retain(|fork| !leads_to(step.after, fork, &place.leg));
            }
            if let Some((leg, _, by)) = taken(event).filter(|(_, _, by)| *by != "operator") {
                found.expect(step, !spoken.contains(&leg), || format!("{leg} by {by} again"));
                spoken.push(leg);
            }
        }
    }
}

fn leads_to(seen: &Seen, leg: &Id, next: &Id) -> bool {
    seen_fork(seen, leg).is_none_or(|(branches, _)| branches.iter().any(|b| b.next.as_ref() == Some(next)))
}

fn branches_exist(trace: &Trace, found: &mut Findings) {
    for (step, event) in trace.events() {
        let Some((leg, branch, _)) = taken(event) else { continue };
        let exists =
            seen_fork(step.after, leg).is_some_and(|(branches, _)| branches.iter().any(|b| b.id == *branch));
        found.expect(step, exists, || format!("{leg} has no {branch}"));
    }
}

fn default_is_the_plans(trace: &Trace, found: &mut Findings) {
    for (step, event) in trace.events() {
        let Some((leg, branch, "default")) = taken(event) else { continue };
        let own = seen_fork(step.after, leg).and_then(|(_, default)| default);
        found.expect(step, own == Some(branch), || format!("{branch}, the plan says {own:?}"));
    }
}

/// The plans' only condition is `r > 900`. It is read when the way is laid out and again every second until the stopping
/// distance: it must have held at some time before.
fn condition_held(trace: &Trace, found: &mut Findings) {
    let wide =
        |seen: &Seen| matches!(seen.variables.get(&"r".into()), Some(VariableValue::Number(r)) if *r > 900.0);
    let mut held = false;
    for step in trace.steps() {
        held |= wide(step.before) || wide(step.after);
        for event in step.events() {
            let Some((leg, branch, "condition")) = taken(event) else { continue };
            let conditional = seen_fork(step.after, leg)
                .is_some_and(|(branches, _)| branches.iter().any(|b| b.id == *branch && b.when.is_some()));
            found.expect(step, conditional && held, || format!("{leg} by the condition of {branch}"));
        }
    }
}

fn by_command(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let told = step.events().filter_map(taken).find(|(_, _, by)| *by == "operator");
        let asked = match step.accepted() {
            Some(Command::Decide { leg, branch }) => Some((leg, branch, "operator")),
            _ => None,
        };
        if told.is_some() || asked.is_some() {
            found.expect(step, told == asked, || format!("{asked:?} was told as {told:?}"));
        }
    }
}

fn operators_word(trace: &Trace, found: &mut Findings) {
    let mut word: Vec<&Id> = Vec::new();
    for step in trace.steps() {
        if step.is_jump() {
            word.clear();
        }
        for event in step.events() {
            if let Event::LegEntered { place } = event {
                word.retain(|fork| !leads_to(step.after, fork, &place.leg));
            }
            let Some((leg, _, by)) = taken(event) else { continue };
            let overruled = by != "operator" && word.contains(&leg);
            found.expect(step, !overruled, || format!("{leg} by {by}"));
            if by == "operator" && is_pending(step, leg) {
                word.push(leg);
            }
        }
    }
}

/// The question is open: the decision is for the crossing that comes next.
fn is_pending(step: Step, leg: &Id) -> bool {
    step.before.status.decision.as_ref().is_some_and(|d| d.leg == *leg)
}

/// A branch's leg that is entered neither by a jump nor from another branch's leg is entered from the intersection.
fn flown_as_decided(trace: &Trace, found: &mut Findings) {
    let mut decided: BTreeMap<&Id, &Id> = BTreeMap::new();
    let mut before: Option<&Id> = None;
    for step in trace.steps() {
        if step.is_jump() {
            (decided, before) = Default::default();
        }
        for event in step.events() {
            if let Some((leg, branch, _)) = taken(event) {
                decided.insert(leg, branch);
            }
            let Event::LegEntered { place } = event else { continue };
            let from = before.replace(&place.leg);
            let crossed = |leg: &Id| {
                let merges = from.is_none_or(|from| leads_to(step.after, leg, from));
                leads_to(step.after, leg, &place.leg) && !merges && !place.reverse
            };
            let Some(leg) = decided.keys().copied().find(|leg| crossed(leg)) else { continue };
            let (Some(branch), Some((branches, _))) = (decided.remove(leg), seen_fork(step.after, leg))
            else {
                continue;
            };
            let next = branches.iter().find(|b| b.id == *branch).and_then(|b| b.next.as_ref());
            found.expect(step, next == Some(&place.leg), || {
                format!("{leg}: decided {branch}, flown {}", place.leg)
            });
        }
    }
}

fn unknown_refused(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Command::Decide { leg, branch }) = step.command() else { continue };
        let known =
            seen_fork(step.before, leg).is_some_and(|(branches, _)| branches.iter().any(|b| b.id == *branch));
        if !known || !step.before.is_flying() {
            found.expect(step, step.refused().is_some(), || format!("{leg} {branch}"));
        }
    }
}

fn waiting_ends(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let Command::Decide { leg, .. } = command else { continue };
        let waits = |seen: &Seen| seen.is_fed() && seen.status.phase == Phase::AwaitingDecision;
        if waits(step.before) && step.before.place().is_some_and(|p| p.leg == *leg) {
            let still = waits(step.after) && step.after.place().is_some_and(|p| p.leg == *leg);
            found.expect(step, !still, || format!("{leg} was decided, and it waits"));
        }
    }
}
