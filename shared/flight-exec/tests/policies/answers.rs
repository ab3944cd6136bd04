//! Requests and what comes back: one answer each, refusals without effect, nothing changed in silence.

use crate::policy::{Findings, Policy, policy};
use crate::trace::{Step, Trace};
use flight_exec::{Command, Event, Input, Output, Phase, RequestId};
use flight_plan::{Id, VariableValue};

pub const POLICIES: &[Policy] = &[
    policy("one-answer-per-request", "A request gets exactly one answer, in its own step.", one_answer),
    policy("no-answer-without-a-request", "Nothing is answered that nobody asked.", no_answer),
    policy(
        "refusals-advise",
        "A refusal has a code for programs and a sentence for people.",
        refusals_advise,
    ),
    policy("a-refusal-changes-nothing", "A refused command changes nothing.", refusal_changes_nothing),
    policy(
        "a-refusal-says-nothing-else",
        "A refused command feeds nothing, holds nothing and tells of nothing but an unanswered alarm.",
        refusal_is_quiet,
    ),
    policy("phases-are-told", "Every change of phase is told, and none that isn't.", phases_are_reported),
    policy(
        "start-on-the-ground",
        "A start is accepted with a plan and without a flight, or again before its take-off, and never else.",
        start,
    ),
    policy(
        "hold-once",
        "A hold is accepted while flying and not holding, and never else; the gateway is told.",
        hold,
    ),
    policy(
        "an-abort-asks-for-safe-mode",
        "An abort is never refused: the gateway is asked for Safe mode, which nothing else does, and a plan being flown holds.",
        abort,
    ),
    policy("resume-a-hold", "A resume is accepted while holding, and never else.", resume),
    policy(
        "writes-are-told",
        "An accepted write is told once with its value, and the variable has it.",
        writes_are_reported,
    ),
    policy(
        "bad-values-are-refused",
        "A value of the wrong type, out of bounds, or for no variable is refused.",
        bad_values,
    ),
    policy(
        "variables-change-by-command",
        "A variable changes by a write, an action or a new plan only, and has the value told last.",
        variables_change,
    ),
    policy(
        "a-refused-batch-holds",
        "A batch that the gateway refuses is told, and the aircraft holds.",
        refused_batch,
    ),
    policy(
        "garbage-is-ignored",
        "A report with numbers that are none, or off the Earth, changes nothing.",
        garbage,
    ),
];

fn request(input: &Input) -> Option<RequestId> {
    match input {
        Input::Command { request, .. } | Input::Propose { request, .. } => Some(*request),
        _ => None,
    }
}

fn answered<'a>(step: Step<'a>) -> Vec<RequestId> {
    let of = |o: &Output| match o {
        Output::Answer { request, .. } => Some(*request),
        _ => None,
    };
    step.moment.outputs.iter().filter_map(of).collect()
}

fn one_answer(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        if let Some(request) = step.input().and_then(request) {
            let answers = answered(step);
            found.expect(step, answers == [request], || format!("{request:?}: {answers:?}"));
        }
    }
}

fn no_answer(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.input().is_some_and(|i| request(i).is_none())) {
        found.expect(step, answered(step).is_empty(), || format!("{:?}", answered(step)));
    }
}

fn refusals_advise(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some((_, why)) = step.refused() else { continue };
        let code = !why.code.is_empty() && why.code.chars().all(|c| c.is_ascii_lowercase() || c == '-');
        found.expect(step, code && why.reason.split(' ').count() > 3, || format!("{why:?}"));
    }
}

fn refusal_changes_nothing(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.refused().is_some()) {
        let (b, a) = (step.before, step.after);
        let same = b.status == a.status && b.ahead == a.ahead && b.variables == a.variables;
        found.expect(step, same, || format!("{:?} changed something", step.command()));
    }
}

fn refusal_is_quiet(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.refused().is_some()) {
        let quiet = |o: &Output| {
            matches!(o, Output::Answer { .. } | Output::Event(Event::EmergencyUnanswered { .. }))
        };
        found.expect(step, step.moment.outputs.iter().all(quiet), || format!("{:?}", step.moment.outputs));
    }
}

fn phases_are_reported(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let told = step.events().filter_map(|e| match e {
            Event::PhaseChanged { phase } => Some(*phase),
            _ => None,
        });
        let told: Vec<Phase> = told.collect();
        let (before, after) = (step.before.status.phase, step.after.status.phase);
        if before != after || !told.is_empty() {
            let chained = told.iter().try_fold(before, |was, now| (was != *now).then_some(*now));
            found.expect(step, chained == Some(after), || format!("{before:?}, told {told:?}, {after:?}"));
        }
    }
}

fn start(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.command() == Some(&Command::Start)) {
        let waits = step.before.waits_for_take_off();
        let may = (!step.before.is_flying() || waits) && step.before.program.is_some();
        found.expect(step, may == step.accepted().is_some(), || format!("{:?}", step.before.status.phase));
    }
}

fn hold(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.command() == Some(&Command::Hold)) {
        let may = step.before.is_flying() && step.before.status.phase != Phase::Holding;
        let told = step.moment.outputs.contains(&Output::Hold);
        let holds = step.after.status.phase == Phase::Holding;
        let right =
            if may { told && holds && step.accepted().is_some() } else { !told && step.refused().is_some() };
        found.expect(step, right, || format!("{:?}", step.moment.outputs));
    }
}

fn abort(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let asks = step.moment.outputs.iter().filter(|o| **o == Output::Safe).count();
        if step.command() != Some(&Command::AbortToSafe) {
            if asks > 0 {
                found.expect(step, false, || "asks for Safe mode".into());
            }
            continue;
        }
        let (before, after) = (step.before, step.after.status.phase);
        let phase = if before.is_flying() { Phase::Holding } else { before.status.phase };
        let right = asks == 1 && step.accepted().is_some() && after == phase;
        found.expect(step, right, || format!("{after:?}, {:?}", step.moment.outputs));
    }
}

fn resume(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.command() == Some(&Command::Resume)) {
        let may = step.before.status.phase == Phase::Holding;
        let goes_on = matches!(step.after.status.phase, Phase::Flying | Phase::AwaitingDecision);
        let right = if may { goes_on && step.accepted().is_some() } else { step.refused().is_some() };
        found.expect(step, right, || format!("{:?}", step.moment.outputs));
    }
}

fn writes_are_reported(trace: &Trace, found: &mut Findings) {
    for (step, command) in trace.accepted() {
        let Command::SetVariable { name, value } = command else { continue };
        let by_operator = |e: &&Event| matches!(e, Event::VariableChanged { by, .. } if **by == *"operator");
        let told = step.events().filter(by_operator);
        let right = told.eq([&Event::VariableChanged {
            name: name.clone(),
            value: value.clone(),
            by: "operator".into(),
        }]);
        // the plan may write the same variable in the same instant
        let has = step.after.variables.get(name) == Some(value) || last_report(step, name) != Some(value);
        found.expect(step, right && has, || format!("{name}: {:?}", step.moment.outputs));
    }
}

/// The bounds of the test's plans, written down once more.
fn is_good(name: &str, value: &VariableValue) -> bool {
    match (name, value) {
        ("r", VariableValue::Number(r)) => (10.0..=1500.0).contains(r),
        ("n", VariableValue::Number(n)) => (1.0..=4.0).contains(n),
        ("stop", VariableValue::Bool(_)) => true,
        ("note", VariableValue::Text(text)) => text.len() <= 8,
        _ => false,
    }
}

fn bad_values(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.before.program.is_some()) {
        let Some(Command::SetVariable { name, value }) = step.command() else { continue };
        let good = is_good(name.as_str(), value);
        found.expect(step, good == step.accepted().is_some(), || format!("{name} = {value:?}"));
    }
}

fn variables_change(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        if matches!(step.accepted(), Some(Command::Commit { .. })) {
            continue;
        }
        let (before, after) = (&step.before.variables, &step.after.variables);
        let told = |name: &Id| last_report(step, name).or(before.get(name));
        let same = before.iter().chain(after.iter()).all(|(name, _)| told(name) == after.get(name));
        found.expect(step, same, || format!("{:?}", step.moment.stimulus));
    }
}

/// The value of a variable that a step reports last.
pub fn last_report<'a>(step: Step<'a>, variable: &Id) -> Option<&'a VariableValue> {
    let values = step.events().filter_map(|e| match e {
        Event::VariableChanged { name, value, .. } => Some((name, value)),
        _ => None,
    });
    values.filter(|(name, _)| *name == variable).last().map(|(_, value)| value)
}

fn refused_batch(trace: &Trace, found: &mut Findings) {
    for step in trace.steps().filter(|s| s.before.is_flying()) {
        let Some(Input::Rejected { first, reason }) = step.input() else { continue };
        if !step.before.tokens().contains(first) {
            continue;
        }
        let told = step
            .events()
            .any(|e| matches!(e, Event::WaypointsRejected { reason: r, .. } if r.starts_with(reason)));
        if step.goes_back() {
            found.expect(step, told && !step.moment.outputs.contains(&Output::Hold), || "it holds".into());
            continue;
        }
        let holds = step.after.status.phase == Phase::Holding && step.moment.outputs.contains(&Output::Hold);
        found.expect(step, told && holds, || format!("{:?}", step.moment.outputs));
    }
}

fn is_garbage(state: &flight_exec::AircraftState) -> bool {
    let numbers = [
        state.altitude_amsl_m,
        state.track_deg,
        state.ground_speed_mps,
        state.airspeed_mps,
        state.battery,
        state.wind_east_mps,
        state.wind_north_mps,
    ];
    !state.position.is_valid() || numbers.iter().any(|n| !n.is_finite())
}

fn garbage(trace: &Trace, found: &mut Findings) {
    for step in trace.steps() {
        let Some(Input::Aircraft(state)) = step.input() else { continue };
        if is_garbage(state) {
            let same = step.before.status == step.after.status && step.moment.outputs.is_empty();
            found.expect(step, same, || format!("{:?}", step.after.status));
        }
    }
}
