//! Emergencies: an alarm always ends on a runway or in Safe.

use crate::place::emergency_flown;
use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Trace};
use flight_exec::{Action, Command, Event, Phase, Token};
use flight_plan::{Cause, EmergencyChoice, Id, Program};

pub const POLICIES: &[Policy] = &[
    policy(
        "an-alarm-ends-on-a-runway",
        "The waypoints of an emergency plan end with a landing on its runway.",
        ends_on_a_runway,
    ),
    policy(
        "an-alarm-is-answered",
        "An alarm starts an emergency plan, goes on with a worse one, or is left to Safe and said so.",
        is_answered,
    ),
    policy(
        "alarm-cancels-everything",
        "An emergency cancels every waypoint that was fed and not flown, and feeds those of its plan.",
        cancels_everything,
    ),
    policy("only-worse-causes", "During an emergency only a more severe cause changes anything.", only_worse),
    policy(
        "emergency-plans-never-nest",
        "A more severe emergency replaces the one being flown; coming back leads to the main plan.",
        never_nest,
    ),
    policy(
        "most-specific-plan",
        "The emergency plan is the named one, or the most specific one of the leg for the cause.",
        most_specific,
    ),
    policy(
        "in-force-is-told",
        "The plan told to be in force is the one that the leg has.",
        emergency_coverage,
    ),
    policy("alarm-ends-a-hold", "An emergency doesn't wait for a resume.", ends_a_hold),
    policy(
        "back-by-command-only",
        "Out of an emergency plan leads a command, a new start, or its runway.",
        back_by_command,
    ),
    policy(
        "back-to-the-named-leg",
        "Coming back leads to the main plan, at the leg the operator names.",
        back_to_the_leg,
    ),
    policy("no-return-without-emergency", "Nobody returns from an emergency that there is not.", no_return),
];

fn started(step: Step<'_>) -> Option<(Cause, &Id, Option<&Id>)> {
    step.events().find_map(|e| match e {
        Event::EmergencyStarted { cause, plan, from_leg } => Some((*cause, plan, from_leg.as_ref())),
        _ => None,
    })
}

/// The cause of the emergency being flown before a step.
fn running(trace: &Trace, until: usize) -> Option<Cause> {
    let mut cause = None;
    for step in trace.steps().take(until) {
        cause = started(step).map(|(cause, ..)| cause).or(cause);
        let over = matches!(step.accepted(), Some(Command::ReturnToMain { .. } | Command::Start));
        let in_main = step.after.place().is_some() && emergency_flown(step.after).is_none();
        if over || in_main || !step.after.is_flying() {
            cause = None;
        }
    }
    cause
}

fn ends_on_a_runway(trace: &Trace, found: &mut Findings) {
    for (step, _, waypoints) in trace.feeds() {
        let (Some(plan), Some(program)) = (emergency_flown(step.after), &step.after.program) else {
            continue;
        };
        let Some(last) = waypoints.iter().find(|w| w.end_of_plan) else { continue };
        let threshold = program.plan.emergency_plan(plan).and_then(|p| program.plan.runway(&p.runway));
        let there = threshold.is_some_and(|r| r.threshold.distance_m(last.position) < 1.0);
        let lands = matches!(last.action, Action::Land { .. });
        found.expect(step, there && lands, || format!("{plan} ends at {last:?}"));
    }
}

fn is_answered(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.before.is_flying()) {
        let Some(Command::Emergency { cause, .. }) = step.command() else { continue };
        let unanswered =
            step.events().any(|e| matches!(e, Event::EmergencyUnanswered { cause: of, .. } if of == cause));
        let answered = match step.refused() {
            None => started(step).is_some_and(|(c, plan, _)| c == *cause && flies(step.after, plan)),
            // the document's own answer is there wherever the flight is
            Some((_, why)) if why.code == "no-emergency-plan" => unanswered && !answers(step.before, *cause),
            Some(_) => !unanswered,
        };
        found.expect(step, answered, || format!("{:?}", step.moment.outputs));
    }
}

/// Where nothing at all is ahead (refused, or not fed while the gateway controls) there is no place to report.
fn flies(seen: &Seen, plan: &Id) -> bool {
    let there = seen.place().is_none() || emergency_flown(seen) == Some(plan);
    there && seen.status.emergency.as_ref() == Some(plan)
}

/// The document names a plan for this cause anywhere in the main plan.
fn answers(seen: &Seen, cause: Cause) -> bool {
    seen.program.as_ref().is_some_and(|p| p.plan.emergency.plan_for(cause).is_some())
}

fn cancels_everything(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let Command::Emergency { .. } = command else { continue };
        let switched = emergency_flown(step.before) != emergency_flown(step.after);
        if !switched || step.after.gateway_controls {
            continue;
        }
        let (Some(plan), Some(program)) = (emergency_flown(step.after), &step.after.program) else {
            continue;
        };
        let index = program.plan.emergency_plans.iter().position(|p| p.id == *plan);
        let whole = step.feeds().next().is_some_and(|(cancel, _)| cancel == Some(Token(0)));
        let own = |leg: &Id| program.path(leg).is_some_and(|p| p.emergency_plan == index);
        let pure = step.after.buffer.iter().all(|w| own(&w.leg)) || is_refused_next(step);
        found.expect(step, whole && pure, || format!("{plan}: {:?}", step.after.buffer));
    }
}

/// The gateway refuses this very batch: its buffer is as it was.
fn is_refused_next(step: Step) -> bool {
    let next = step.trace.moments.get(step.at + 1).map(|m| &m.stimulus);
    matches!(next, Some(crate::trace::Stimulus::Input(flight_exec::Input::Rejected { .. })))
}

fn only_worse(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Command::Emergency { cause, .. }) = step.command() else { continue };
        let Some(running) = running(trace, step.at).filter(|_| step.before.is_flying()) else { continue };
        let refused = step.refused().is_some_and(|(_, why)| why.code == "not-more-severe");
        found.expect(step, refused == (*cause <= running), || format!("{cause:?} during {running:?}"));
    }
}

/// From one emergency plan to another the leg it was first raised on stays the main plan's.
fn never_nest(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some((_, plan, Some(from))) = started(step) else { continue };
        let Some(program) = step.before.program.as_deref() else { continue };
        let of_main = program.path(from).is_none_or(|p| p.emergency_plan.is_none());
        found.expect(step, of_main, || format!("{plan} raised on {from}"));
    }
}

/// Written down once more, from the document: leg, loops from the inside out, stage, document; the cause before the fallback.
fn resolve<'a>(program: &'a Program, leg: &Id, cause: Cause) -> Option<&'a Id> {
    let named = |choice: &'a EmergencyChoice| {
        let of =
            |wanted: Option<Cause>| choice.by_cause.iter().find(|(c, _)| *c == wanted).map(|(_, plan)| plan);
        of(Some(cause)).or(of(None))
    };
    let context = program.flown().leg(leg);
    let legs = context.iter().flat_map(|c| [c.leg].into_iter().chain(c.loops.iter().rev().copied()));
    let legs = Vec::from_iter(legs.map(|l| &l.emergency));
    let stage = context.as_ref().map(|c| c.stage).or(program.flown().stage(leg)).map(|s| &s.emergency);
    legs.into_iter().chain(stage).chain([&program.plan.emergency]).find_map(named)
}

fn most_specific(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Command::Emergency { cause, plan: wanted }) = step.command() else { continue };
        let (Some((_, plan, from)), Some(program)) = (started(step), step.before.program.as_deref()) else {
            continue;
        };
        let expected = wanted.as_ref().or_else(|| resolve(program, from?, *cause));
        found.expect(step, expected == Some(plan), || format!("{plan} instead of {expected:?}"));
        if running(trace, step.at).is_none() {
            let here = step.before.place().map(|p| &p.leg);
            let told = here.filter(|leg| program.path(leg).is_some());
            found.expect(step, told.is_none() || from == told, || {
                format!("raised on {from:?}, flown was {here:?}")
            });
        }
    }
}

fn emergency_coverage(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.after.is_flying() && emergency_flown(s.after).is_none()) {
        let (Some(program), Some(place)) = (step.after.program.as_deref(), step.after.place()) else {
            continue;
        };
        let told = step.after.status.emergency_in_force.as_ref();
        // what is near when the plan changes may belong to the old one
        if program.path(&place.leg).is_none() {
            let answered = told.is_some() || !answers(step.after, Cause::Operator);
            found.expect(step, answered, || format!("nothing is in force on {}", place.leg));
            continue;
        }
        let expected = resolve(program, &place.leg, Cause::Operator);
        found.expect(step, told == expected, || format!("{told:?} instead of {expected:?} on {}", place.leg));
    }
}

fn ends_a_hold(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let Command::Emergency { .. } = command else { continue };
        if step.before.status.phase == Phase::Holding {
            let phase = step.after.status.phase;
            found.expect(step, phase == Phase::Flying, || format!("{phase:?}"));
        }
    }
}

fn back_by_command(trace: &Trace, found: &mut Findings) {
    let in_main = |seen: &Seen| seen.place().is_some() && emergency_flown(seen).is_none();
    for step in trace.steps() {
        let Some(plan) = emergency_flown(step.before).filter(|_| in_main(step.after)) else { continue };
        let by_command = matches!(
            step.accepted(),
            Some(Command::ReturnToMain { .. } | Command::Start | Command::Commit { .. })
        );
        found.expect(step, by_command, || format!("{plan} was left by {:?}", step.moment.stimulus));
    }
}

fn back_to_the_leg(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let Command::ReturnToMain { leg } = command else { continue };
        let (Some(place), Some(program)) = (step.after.place(), step.after.program.as_deref()) else {
            continue;
        };
        let inside = place.iterations.iter().any(|i| i.leg == *leg) || place.stage == *leg;
        let flies_nothing = program
            .leg(leg)
            .is_some_and(|l| crate::model::may_fly_nothing(l) || l.kind_name() == "intersection");
        let refused = step.events().any(|e| matches!(e, Event::PatternRefused { .. }));
        let passed = flies_nothing || refused;
        let there = emergency_flown(step.after).is_none() && (place.leg == *leg || inside || passed);
        found.expect(step, there, || format!("{leg} led to {place:?}"));
    }
}

fn no_return(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Command::ReturnToMain { .. }) = step.command() else { continue };
        if running(trace, step.at).is_none() {
            found.expect(step, step.refused().is_some(), || "returned".into());
        }
    }
}
