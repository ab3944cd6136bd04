//! Plans that change in flight: nothing half applied, the place kept.

use crate::answers::last_report;
use crate::holdings::says_stop;
use crate::horizon::waits;
use crate::place::iterations;
use crate::policy::{Findings, Policy, policy};
use crate::trace::{Step, Trace, kind, knows};
use flight_exec::{Answer, Command, Config, Event, Input, Phase, PlacePointer, ProposalReport};
use flight_plan::{Id, IterativeForm, LegKind, Program, Value, Variable};
use std::collections::BTreeSet;

pub const POLICIES: &[Policy] = &[
    policy(
        "a-proposal-does-nothing",
        "A proposal feeds nothing, enters nothing and changes nothing but what is proposed.",
        does_nothing,
    ),
    policy(
        "proposed-is-told",
        "After a proposal its hash is the one that may be committed.",
        proposed_is_reported,
    ),
    policy(
        "the-report-is-true",
        "Legs added and removed are those that only one of the plans has.",
        report_is_true,
    ),
    policy(
        "next-is-what-comes",
        "The leg and position that a report promises are those that a commit at once leads to.",
        next_is_what_comes,
    ),
    policy(
        "only-what-was-proposed",
        "Only the plan proposed last can be committed, and only once.",
        only_proposed,
    ),
    policy("swapped-whole", "A commit makes the whole plan the active one, or nothing of it.", swapped_whole),
    policy(
        "revisions-count-plans",
        "The revision counts the plans taken over, one by one, and nothing else does.",
        revisions,
    ),
    policy(
        "the-place-survives-an-update",
        "Where the leg being flown is one of the new plan too, the flight goes on there: leg, direction, iterations.",
        place_survives,
    ),
    policy(
        "the-entry-is-entered",
        "Where the leg is gone, the flight goes on at the entry named, and asks for one if none is.",
        entry_is_entered,
    ),
    policy(
        "superseded-is-gone",
        "Beyond the stopping distance no waypoint of a leg that the new plan hasn't is left.",
        superseded_is_gone,
    ),
    policy(
        "the-same-plan-changes-nothing",
        "Committing the plan that is being flown feeds nothing, when nothing else has changed.",
        same_plan,
    ),
    policy(
        "variables-carry-over",
        "Values that the new plan accepts are kept, the others start afresh.",
        variables_carry_over,
    ),
    policy(
        "on-the-ground-it-waits",
        "A plan committed without a flight waits for its start.",
        waits_for_start,
    ),
];

fn report<'a>(step: Step<'a>) -> Option<&'a ProposalReport> {
    step.answers().find_map(|a| match a {
        Ok(Answer::Proposal(report)) => Some(report.as_ref()),
        _ => None,
    })
}

fn proposals(trace: &Trace) -> impl Iterator<Item = (Step<'_>, &Program, &ProposalReport)> {
    trace.steps().filter_map(|s| match s.input()? {
        Input::Propose { program, .. } => Some((s, program.as_ref(), report(s)?)),
        _ => None,
    })
}

fn does_nothing(trace: &Trace, found: &mut Findings) {
    for (step, ..) in proposals(trace) {
        let (mut before, after) = (step.before.status.clone(), &step.after.status);
        before.proposed.clone_from(&after.proposed);
        let same = before == *after && step.moment.outputs.len() == 1;
        found.expect(step, same, || format!("{:?}", step.moment.outputs));
    }
}

fn proposed_is_reported(trace: &Trace, found: &mut Findings) {
    for (step, program, report) in proposals(trace) {
        let told =
            step.after.status.proposed.as_ref() == Some(program.hash()) && report.hash == *program.hash();
        found.expect(step, told, || format!("{:?}", step.after.status.proposed));
    }
}

fn names(program: Option<&Program>) -> BTreeSet<Id> {
    let Some(program) = program else { return BTreeSet::new() };
    let legs = program.flown().all_legs().into_iter().map(|c| c.leg.id.clone());
    legs.chain(program.flown().all_stages().map(|(_, s)| s.id.clone())).collect()
}

fn report_is_true(trace: &Trace, found: &mut Findings) {
    for (step, program, report) in proposals(trace) {
        let (old, new) = (names(step.before.program.as_deref()), names(Some(program)));
        let are = |told: &[Id], wanted: BTreeSet<&Id>| {
            told.len() == wanted.len() && told.iter().collect::<BTreeSet<_>>() == wanted
        };
        let added = are(&report.added, new.difference(&old).collect());
        let removed = are(&report.removed, old.difference(&new).collect());
        found.expect(step, added && removed && report.acceptable, || format!("{report:?}"));
    }
}

fn next_is_what_comes(trace: &Trace, found: &mut Findings) {
    for (step, _, report) in proposals(trace) {
        let later = (step.at + 1..trace.moments.len()).map(|at| trace.step(at));
        let at_once = later.take_while(|s| s.moment.now == step.moment.now);
        let asked = |s: &Step| matches!(s.input(), Some(Input::Command { .. } | Input::Propose { .. }));
        let commits = |s: &Step| {
            s.update().is_some() && matches!(s.command(), Some(Command::Commit { entry: None, .. }))
        };
        let Some(commit) = at_once.into_iter().find(asked).filter(commits) else { continue };
        let next = commit.after.ahead.first();
        let right = report.next_leg.as_ref() == next.map(|w| &w.leg)
            && report.next_position == next.map(|w| w.position)
            && !report.entry_needed;
        found.expect(commit, right, || format!("{report:?}, but {next:?}"));
    }
}

fn only_proposed(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Command::Commit { hash, .. }) = step.command() else { continue };
        if step.before.status.proposed.as_ref() != Some(hash) {
            let refused = step.refused().is_some_and(|(_, why)| why.code == "not-proposed");
            found.expect(step, refused, || format!("committed {hash}"));
        }
        if step.accepted().is_some() {
            found.expect(step, step.after.status.proposed.is_none(), || "may be committed again".into());
        }
    }
}

fn swapped_whole(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let told = step.events().any(|e| matches!(e, Event::PlanActivated { .. }));
        match step.command() {
            Some(Command::Commit { hash, .. }) if step.accepted().is_some() => {
                let swapped = step.after.status.plan.as_ref() == Some(hash) && told;
                found.expect(step, swapped, || format!("{:?}", step.after.status.plan));
            }
            Some(Command::Commit { .. }) => {
                let same = step.after.status.plan == step.before.status.plan && !told;
                found.expect(step, same, || format!("{:?}", step.after.status.plan));
            }
            _ => {}
        }
    }
}

fn revisions(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let told: Vec<_> = step
            .events()
            .filter_map(|e| match e {
                Event::PlanActivated { revision, .. } => Some(*revision),
                _ => None,
            })
            .collect();
        let (before, after) = (step.before.status.revision, step.after.status.revision);
        if !told.is_empty() || before != after {
            found.expect(step, told == [before + 1] && after == before + 1, || {
                format!("{before}, {told:?}, {after}")
            });
        }
    }
}

fn place_survives(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let (Some((old, new)), Command::Commit { entry: None, .. }) = (step.update(), command) else {
            continue;
        };
        let (Some(before), Some(after)) = (step.before.place(), step.after.place()) else { continue };
        let kind = |p: &Program| p.leg(&before.leg).map(|l| l.kind_name());
        // where an orbit is left depends on what follows: it may turn out to be flown already
        let laps = |p: &Program| most_laps(p, &before.leg).unwrap_or(f64::INFINITY);
        // and of a holding more laps may have been flown than it has by now
        let ends_early = kind(new) == Some("orbit") || laps(new) < laps(old);
        // nobody has to decide any more: the new plan does
        let is_decided = decides(step, &before.leg);
        let is_there = knows(new, &before.leg) && kind(old) == kind(new) && !ends_early && !is_decided;
        // laid out anew from its fix, one that is to be left by now ends there
        let is_released = is_left_by_condition(new, &before.leg) && says_stop(step.after);
        // nor is there anything to circle for
        let is_over = step.before.circles() && !waits(new, &before.leg);
        if !is_there || is_over || is_released || !step.is_begun() {
            continue;
        }
        // a loop of another form begins its directions anew
        let turned = form(old, before) != form(new, before);
        let (was, is) = (iterations(before), iterations(after));
        let same_count = |(id, n): (&&Id, &(u64, bool))| {
            is.get(*id).is_none_or(|now| if turned { now.0 == n.0 } else { now == n })
        };
        let counted = was.iter().all(same_count);
        let same = before.leg == after.leg && before.plan == after.plan && counted;
        found.expect(step, same, || format!("{before:?} became {after:?}"));
    }
}

fn most_laps(program: &Program, leg: &Id) -> Option<f64> {
    match &program.leg(leg)?.kind {
        LegKind::Hm { max_laps: Some(Value::Constant(laps)), .. } => Some(*laps),
        _ => None,
    }
}

fn is_left_by_condition(program: &Program, leg: &Id) -> bool {
    matches!(kind(program, leg), Some(LegKind::Hm { until: Some(_), .. }))
}

/// The choice that was waited for is made in this step, by a condition or a default.
fn decides(step: Step, leg: &Id) -> bool {
    step.events().any(|e| matches!(e, Event::DecisionTaken { leg: l, .. } if l == leg))
}

fn form(program: &Program, place: &PlacePointer) -> Vec<Option<IterativeForm>> {
    let of = |id: &Id| match kind(program, id)? {
        LegKind::Iterative { form, .. } => Some(*form),
        _ => None,
    };
    place.iterations.iter().map(|i| of(&i.leg)).collect()
}

fn entry_is_entered(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Command::Commit { entry, hash }) = step.command() else { continue };
        if !step.before.is_flying() || step.before.status.proposed.as_ref() != Some(hash) {
            continue;
        }
        match (step.refused(), entry) {
            (Some((_, why)), None) => found.expect(step, why.code == "entry-needed", || why.to_string()),
            (None, Some(entry)) => {
                let place = step.after.place();
                let there = place.is_some_and(|p| {
                    p.leg == *entry || p.stage == *entry || p.iterations.iter().any(|i| i.leg == *entry)
                });
                found.expect(step, there, || format!("{entry} led to {place:?}"));
            }
            _ => {}
        }
    }
}

/// What the update left where it was (the token is the same) may be of the old plan, nothing else.
fn superseded_is_gone(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some((_, new)) = step.update().filter(|_| step.after.is_fed()) else { continue };
        let before: BTreeSet<_> = step.before.tokens().into_iter().collect();
        let mut beyond = false;
        for waypoint in &step.after.ahead {
            let kept = before.contains(&waypoint.token);
            beyond |= !kept;
            let own = knows(new, &waypoint.leg);
            found.expect(step, own || (kept && !beyond), || format!("{waypoint:?}"));
        }
    }
}

/// Whatever was decided or written since the leg was entered may change its end (an orbit is left towards what follows).
fn same_plan(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let (Some((old, new)), Command::Commit { entry: None, .. }) = (step.update(), command) else {
            continue;
        };
        let entered = trace.entered().map(|(s, _)| s.at).take_while(|at| *at < step.at).last().unwrap_or(0);
        let quiet = |c: &Command| matches!(c, Command::Commit { .. });
        let undisturbed =
            trace.accepted().filter(|(s, _)| (entered..step.at).contains(&s.at)).all(|(_, c)| quiet(c));
        // what was written is taken into account a little later
        let since_s = step.moment.now.as_secs_f64() - Config::default().debounce_s - 0.001;
        let is_recent = |s: &Step| s.at >= entered || s.moment.now.as_secs_f64() >= since_s;
        let written = (0..step.at)
            .map(|at| trace.step(at))
            .filter(is_recent)
            .any(|s| s.events().any(|e| matches!(e, Event::VariableChanged { .. })));
        if old.hash() == new.hash() && step.before.is_fed() && undisturbed && !written {
            let same = step.feeds().next().is_none() && step.before.tokens() == step.after.tokens();
            found.expect(step, same, || format!("{:?}", step.moment.outputs));
        }
    }
}

fn variables_carry_over(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let (Command::Commit { .. }, Some(new)) = (command, &step.after.program) else { continue };
        let kept = |v: &Variable| {
            let old = step.before.variables.get(&v.name).filter(|old| v.accepts(old).is_ok());
            // an action may write it at once
            let written = last_report(step, &v.name);
            step.after.variables.get(&v.name) == Some(written.or(old).unwrap_or(&v.initial))
        };
        found.expect(step, new.plan.variables.iter().all(kept), || format!("{:?}", step.after.variables));
    }
}

fn waits_for_start(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        if matches!(command, Command::Commit { .. }) && !step.before.is_flying() {
            // between two flights it stays there
            let waits =
                if step.before.status.phase == Phase::Grounded { Phase::Grounded } else { Phase::Idle };
            let idle = step.after.status.phase == waits && step.after.status.outstanding == 0;
            found.expect(step, idle, || format!("{:?}", step.after.status));
        }
    }
}
