//! How far ahead, and how it ends.

use crate::policy::{Findings, Policy, policy};
use crate::trace::{Step, Trace, kind};
use flight_exec::{Action, Command, Config, Event, Input, Phase, Waypoint};
use flight_plan::{Act, Id, LegAction, LegKind, Program};

pub const POLICIES: &[Policy] = &[
    policy("never-dry", "While flying the buffer never runs dry without the end mark.", never_dry),
    policy(
        "least-ahead",
        "There are never fewer waypoints ahead than the gateway wants, unless an end or a wait is among them.",
        least_ahead,
    ),
    policy("most-ahead", "The horizon is bounded.", most_ahead),
    policy("the-end-is-last", "end_of_plan is on the last waypoint and nothing follows it.", the_end_is_last),
    policy(
        "finished-after-the-end",
        "The flight is finished when the waypoint with the end mark was flown, and only then.",
        finished_after_the_end,
    ),
    policy(
        "a-wait-is-at-an-intersection",
        "A loiter is the last waypoint, and belongs to an intersection, or to a leg with a wait at its end.",
        a_wait,
    ),
    policy(
        "waits-while-it-loiters",
        "It awaits a decision exactly while it steers to a loiter at an intersection.",
        waits_while_it_loiters,
    ),
    policy("left-alone-it-ends", "Left alone, and helped where it asks, every flight ends.", left_alone),
    policy(
        "time-alone-once",
        "Looked at twice in the same instant, it finds nothing to do the second time.",
        time_alone_once,
    ),
    policy("deadlines-lie-ahead", "A deadline is never in the past.", deadlines_lie_ahead),
];

fn ends_or_waits(waypoint: &Waypoint) -> bool {
    waypoint.end_of_plan || matches!(waypoint.action, Action::Loiter { .. })
}

fn never_dry(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.after.is_fed()) {
        let last = step.after.ahead.last();
        // one waypoint more than the one steered to, or it is an end
        let goes_on = step.after.ahead.len() > 1 || last.is_some_and(ends_or_waits);
        found.expect(step, goes_on, || format!("{last:?} is all there is"));
    }
}

fn least_ahead(trace: &Trace, found: &mut Findings) {
    let least = Config::default().least_waypoints;
    for step in trace.steps().filter(|s| s.after.is_fed()) {
        let ahead = &step.after.ahead;
        let enough = ahead.len() >= least || ahead.last().is_some_and(ends_or_waits);
        found.expect(step, enough, || format!("{} waypoints ahead", ahead.len()));
    }
}

/// A resume may put one more in front: where the hold was given.
fn most_ahead(trace: &Trace, found: &mut Findings) {
    let mut most = Config::default().horizon_waypoints;
    for step in trace.steps() {
        most += usize::from(step.accepted() == Some(&Command::Resume));
        let ahead = step.after.status.outstanding;
        found.expect(step, ahead <= most, || format!("{ahead} waypoints ahead"));
    }
}

fn the_end_is_last(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.after.is_fed()) {
        if let Some((_, before)) = step.after.ahead.split_last() {
            let early = before.iter().find(|w| w.end_of_plan);
            found.expect(step, early.is_none(), || format!("{early:?} is not the last"));
        }
    }
}

fn finished_after_the_end(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| matches!(s.input(), Some(Input::Progress { current: None }))) {
        let Some(last) = step.before.ahead.last().filter(|_| step.before.is_flying()) else { continue };
        let over = if flies_again(step, &last.leg) { Phase::Grounded } else { Phase::Finished };
        let finished = step.after.status.phase == over;
        found.expect(step, finished == last.end_of_plan, || {
            format!("{last:?} was flown: {:?}", step.after.status.phase)
        });
    }
}

/// Behind the flight of this leg the plan has another one.
fn flies_again(step: Step, leg: &Id) -> bool {
    let path = step.before.program.as_deref().and_then(|program| Some((program, program.path(leg)?)));
    path.is_some_and(|(program, path)| {
        path.emergency_plan.is_none() && program.plan.flights().any(|first| first > path.stage)
    })
}

fn a_wait(trace: &Trace, found: &mut Findings) {
    for (step, _, waypoints) in trace.feeds() {
        let Some(program) = &step.after.program else { continue };
        for (i, wait) in
            waypoints.iter().enumerate().filter(|(_, w)| matches!(w.action, Action::Loiter { .. }))
        {
            let asks_or_waits = asks(program, &wait.leg) || waits(program, &wait.leg);
            let there = asks_or_waits && i + 1 == waypoints.len();
            found.expect(step, there, || format!("{wait:?}"));
        }
    }
}

fn waits_while_it_loiters(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.after.is_fed() && !s.after.ahead.is_empty()) {
        let Some(program) = &step.after.program else { continue };
        let front = &step.after.ahead[0];
        let loiters = matches!(front.action, Action::Loiter { .. }) && !waits(program, &front.leg);
        let awaits = step.after.status.phase == Phase::AwaitingDecision;
        found.expect(step, loiters == awaits, || format!("{:?}", step.after.status.phase));
    }
}

fn asks(program: &Program, leg: &Id) -> bool {
    matches!(kind(program, leg), Some(LegKind::Intersection { .. }))
}

/// A leg at whose end is circled for a time.
pub fn waits(program: &Program, leg: &Id) -> bool {
    let wait = |a: &LegAction| matches!(a.act, Act::Wait { .. });
    !asks(program, leg) && program.leg(leg).is_some_and(|l| l.actions.iter().any(wait))
}

fn left_alone(trace: &Trace, found: &mut Findings) {
    let Some(step) = trace.steps().last() else { return };
    let phase = step.after.status.phase;
    found.expect(step, matches!(phase, Phase::Finished | Phase::Idle), || format!("{phase:?}"));
}

fn time_alone_once(trace: &Trace, found: &mut Findings) {
    let mut last = None;
    for step in trace.steps() {
        let again = last == Some(step.moment.now) && matches!(step.input(), Some(Input::Tick));
        if again && step.at > 0 {
            // a batch that was refused is reported in the same instant
            // nor is everything that is to be done every so often after a leap done in one step
            let late = |e: &Event| {
                matches!(
                    e,
                    Event::DecisionRequested(_) | Event::ActionDone { .. } | Event::VariableChanged { .. }
                )
            };
            let told = step.events().any(|e| !late(e));
            let quiet = step.feeds().next().is_none() && !told;
            found.expect(step, quiet, || format!("{:?}", step.moment.outputs));
        }
        last = Some(step.moment.now);
    }
}

fn deadlines_lie_ahead(trace: &Trace, found: &mut Findings) {
    let mut latest = flight_exec::Time::ZERO;
    for step in trace.steps() {
        latest = latest.max(step.moment.now);
        if let Some(due) = step.after.deadline.filter(|_| step.input().is_some()) {
            found.expect(step, due >= latest, || format!("{due:?} at {latest:?}"));
        }
    }
}
