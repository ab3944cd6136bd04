//! Holdings: left at their fix, and for a reason.

use crate::actions::updated_since_jump;
use crate::policy::{Findings, Policy, policy};
use crate::trace::{Seen, Step, Trace, same_passage};
use flight_exec::{Action, Command, Input, PlacePointer};
use flight_plan::{LegKind, Program, Value, VariableValue};

pub const POLICIES: &[Policy] = &[
    policy(
        "never-past-its-laps",
        "A holding with a number of laps is left when they are flown.",
        never_past_its_laps,
    ),
    policy(
        "released-at-its-fix",
        "A holding that was released is left at the next crossing of its fix.",
        released_at_its_fix,
    ),
    policy(
        "left-for-a-reason",
        "A holding until released is left by a command, by its condition or by its laps, and by nothing else.",
        left_for_a_reason,
    ),
];

/// On its entry and first lap a holding's fix is passed so often: on arrival, maybe at the end of a parallel or teardrop entry, at the
/// end of the lap.
const ENTRY: f64 = 3.0;

/// The one condition that the plans' holdings are left by.
pub fn says_stop(seen: &Seen) -> bool {
    seen.variables.get(&"stop".into()) == Some(&VariableValue::Bool(true))
}

/// A holding until released, as the plan has it: whether it has a condition, and its laps.
fn holding(program: &Program, place: &PlacePointer) -> Option<(bool, Option<f64>)> {
    match &program.leg(&place.leg)?.kind {
        LegKind::Hm { until, max_laps, .. } => {
            let laps = max_laps.as_ref().and_then(|n| match n {
                Value::Constant(n) => Some(*n),
                Value::Expression(_) => None,
            });
            Some((until.is_some(), laps))
        }
        _ => None,
    }
}

/// A passage of a holding, from its entry to the first step of another leg (or the last one of all).
struct Held<'a> {
    place: &'a PlacePointer,
    program: &'a Program,
    entered: Step<'a>,
    steps: Vec<Step<'a>>,
}

fn passages(trace: &Trace) -> Vec<Held<'_>> {
    let held = |(entered, place): (Step<'_>, &'_ PlacePointer)| {
        let step = trace.step(entered.at);
        let program = trace.moments[step.at].after.program.as_deref()?;
        let place = trace.moments[step.at].after.place().filter(|p| same_passage(p, place))?;
        holding(program, place)?;
        let later = (step.at + 1..trace.moments.len()).map(|at| trace.step(at));
        let mut over = false;
        let gone = |s: &Step| s.after.place().is_none_or(|p| !same_passage(p, place));
        // what is skipped is left, but for a holding that is released
        let leaps = |s: &Step| s.is_jump() && s.accepted() != Some(&Command::SkipLeg);
        let steps = later.take_while(|s| !std::mem::replace(&mut over, gone(s) || leaps(s)));
        Some(Held { place, program, entered: step, steps: steps.collect() })
    };
    trace.entered().filter_map(held).collect()
}

impl<'a> Held<'a> {
    /// How many of the waypoints at its fix the aircraft was told to be past in a step: several, if progress was lost.
    fn fixes_passed(&self, step: &Step) -> usize {
        let Some(Input::Progress { current: Some(_) }) = step.input() else { return 0 };
        let fix = self.program.leg(&self.place.leg).and_then(|l| l.place());
        let fix = fix.and_then(|p| match p {
            flight_plan::Place::Position(Value::Constant(p)) => Some(*p),
            _ => None,
        });
        let at_fix = |w: &&flight_exec::Waypoint| {
            w.leg == self.place.leg
                && w.action == Action::Fly
                && fix.is_some_and(|f| f.distance_m(w.position) < 1.0)
        };
        let current = step.after.status.current;
        let passed = step.before.ahead.iter().take_while(|w| Some(w.token) != current);
        if step.before.status.current == current { 0 } else { passed.filter(at_fix).count() }
    }

    /// Steps in which the aircraft was told to be past the fix.
    fn crossings(&self) -> impl Iterator<Item = Step<'a>> {
        self.steps.iter().copied().filter(|s| self.fixes_passed(s) > 0)
    }

    /// Perhaps before it was entered.
    fn was_released(&self) -> bool {
        let trace = self.steps.first().map(|s| s.trace);
        let here = |s: &Step| s.before.place().is_some_and(|p| same_passage(p, self.place));
        let mut skips = trace.into_iter().flat_map(Trace::accepted);
        skips.any(|(s, c)| *c == Command::SkipLeg && here(&s))
    }
}

fn never_past_its_laps(trace: &Trace, found: &mut Findings) {
    for held in passages(trace) {
        let Some((_, Some(laps))) = holding(held.program, held.place) else { continue };
        let crossings = held.crossings().count() as f64;
        if let Some(last) = held.steps.last().filter(|_| crossings > 0.0) {
            found.expect(*last, crossings <= laps + ENTRY, || {
                format!("{crossings} crossings of {}, {laps} laps", held.place.leg)
            });
        }
    }
}

fn released_at_its_fix(trace: &Trace, found: &mut Findings) {
    for held in passages(trace) {
        let mut laps = held.crossings().map(|s| s.at).collect::<Vec<_>>();
        let Some(skip) = held.steps.iter().find(|s| s.accepted() == Some(&Command::SkipLeg)) else {
            continue;
        };
        laps.retain(|at| *at > skip.at);
        found.expect(*skip, laps.len() as f64 <= ENTRY, || {
            format!("{} crossings after {}", laps.len(), held.place.leg)
        });
    }
}

fn left_for_a_reason(trace: &Trace, found: &mut Findings) {
    for held in passages(trace) {
        let Some(last) = held.steps.last().filter(|s| !s.is_jump() && s.entered().next().is_some()) else {
            continue;
        };
        let Some((until, laps)) = holding(held.program, held.place) else { continue };
        // a leg that was of another kind ends as that did
        let updated = updated_since_jump(*last);
        let stopped = until && held.steps.iter().any(|s| says_stop(s.before) || says_stop(s.after));
        let steps = held.steps.iter().chain([&held.entered]);
        let passed: usize = steps.map(|step| held.fixes_passed(step)).sum();
        let flown = laps.is_some_and(|n| passed as f64 >= n);
        if !updated {
            found.expect(*last, held.was_released() || stopped || flown, || {
                format!("{} was left", held.place.leg)
            });
        }
    }
}
