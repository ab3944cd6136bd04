//! What the reference model reads: what was reported of the path, and what people did to it, in order.

use crate::trace::{Step, Trace};
use flight_exec::{Branching, Command, Event, Phase, PlacePointer};
use flight_plan::{Id, Program, VariableValue};

#[derive(Debug, Clone)]
pub enum Observed<'a> {
    Entered(&'a PlacePointer),
    /// With every value that `stop` and `n` had on the last two legs: choices are made ahead, and read again until the
    /// stopping distance.
    Arrived {
        leg: &'a Id,
        finished: u64,
        of: Option<u64>,
        stop: Vec<bool>,
        n: Vec<u64>,
    },
    Taken(&'a Id, &'a Id),
    Counted(&'a Id, u64),
    CannotBeFlown(&'a Id),
    /// Skipped, maybe before it was entered.
    Skipped {
        leg: Option<&'a Id>,
        announced: bool,
    },
    Jump(Jump<'a>),
    Finished,
}

#[derive(Debug, Clone, Copy)]
pub enum Jump<'a> {
    Start(&'a Program),
    /// Another flight of the plan, from the stage with which it begins.
    StartNext(&'a Program, &'a Id),
    GoTo(&'a Id),
    Emergency(&'a Id),
    Return(&'a Id),
    /// Another plan, entered at a leg.
    Enter(&'a Program, &'a Id),
    /// Another plan, gone on with where the aircraft is, on a leg or on the way to it; `simply`: nothing but the leg being flown was kept.
    GoOn {
        program: &'a Program,
        leg: &'a Id,
        entered: bool,
        simply: bool,
    },
}

/// Everything there is to read in a trace.
pub fn record(trace: &Trace) -> Vec<(Step<'_>, Observed<'_>)> {
    let mut tape = Vec::new();
    let mut entries: Vec<usize> = Vec::new();
    let mut last_entered = None;
    let mut alternate = None;
    for step in trace.steps() {
        for event in step.events() {
            let window = entries.len().checked_sub(2).map_or(0, |i| entries[i]);
            tape.extend(observe(event, step, window).map(|s| (step, s)));
            if let Event::LegEntered { place } = event {
                entries.push(step.at);
                last_entered = Some(place);
            }
        }
        let order = order(step, last_entered, alternate);
        alternate = flown_alternate(step, alternate);
        // the same passage may be gone to once more: then it is to be entered again
        let goes_on = matches!(order, Some(Observed::Jump(Jump::GoOn { .. }))) && step.keeps_its_leg();
        if step.is_jump() && !goes_on {
            last_entered = None;
        }
        tape.extend(order.map(|s| (step, s)));
    }
    tape
}

fn observe<'a>(event: &'a Event, step: Step<'a>, window: usize) -> Option<Observed<'a>> {
    Some(match event {
        Event::LegEntered { place } => Observed::Entered(place),
        Event::IterationFinished { leg, finished, of } => {
            let (stop, n) = values(step, window);
            Observed::Arrived { leg, finished: *finished, of: *of, stop, n }
        }
        Event::DecisionTaken { leg, branch, .. } => Observed::Taken(leg, branch),
        Event::PatternRefused { leg, .. } => Observed::CannotBeFlown(leg),
        // the plan is over, or one of its flights
        Event::PhaseChanged { phase: Phase::Finished | Phase::Grounded } => Observed::Finished,
        _ => return None,
    })
}

fn values(step: Step, window: usize) -> (Vec<bool>, Vec<u64>) {
    let seen = (window..=step.at).flat_map(|at| {
        let step = step.trace.step(at);
        [step.before, step.after]
    });
    let (mut stop, mut n) = (Vec::new(), Vec::new());
    for seen in seen {
        if let Some(VariableValue::Bool(b)) = seen.variables.get(&"stop".into()) {
            stop.push(*b);
        }
        if let Some(VariableValue::Number(x)) = seen.variables.get(&"n".into()) {
            n.push(*x as u64);
        }
    }
    stop.dedup();
    n.dedup();
    (stop, n)
}

/// The emergency plan that is flown, also while nothing of it is ahead.
fn flown_alternate<'a>(step: Step<'a>, before: Option<&'a Id>) -> Option<&'a Id> {
    let started = step.events().find_map(|e| match e {
        Event::EmergencyStarted { plan, .. } => Some(plan),
        _ => None,
    });
    let over = matches!(step.accepted(), Some(Command::ReturnToMain { .. } | Command::Start));
    let in_main = step.after.place().is_some_and(|p| p.plan == Branching::Main);
    started.or(before.filter(|_| !over && !in_main && step.after.is_flying()))
}

fn order<'a>(
    step: Step<'a>,
    last_entered: Option<&PlacePointer>,
    alternate: Option<&Id>,
) -> Option<Observed<'a>> {
    let program = step.after.program.as_deref()?;
    let announced = || {
        let place = step.before.place();
        place.zip(last_entered).is_some_and(|(a, b)| crate::trace::same_passage(a, b))
    };
    Some(match step.accepted()? {
        Command::Start => {
            let stage = step.after.place().map(|place| &place.stage);
            let first = program.plan.stages.first().map(|stage| &stage.id);
            Observed::Jump(match stage.filter(|stage| Some(*stage) != first) {
                Some(stage) if begins_a_flight(program, stage) => Jump::StartNext(program, stage),
                _ => Jump::Start(program),
            })
        }
        Command::GoTo { leg } => Observed::Jump(Jump::GoTo(leg)),
        Command::ReturnToMain { leg } => Observed::Jump(Jump::Return(leg)),
        Command::SkipLeg => {
            Observed::Skipped { leg: step.before.place().map(|p| &p.leg), announced: announced() }
        }
        Command::SetCount { leg, count } => Observed::Counted(leg, *count),
        Command::Emergency { .. } => {
            let plan = flown_alternate(step, None)?;
            return (alternate != Some(plan)).then_some(Observed::Jump(Jump::Emergency(plan)));
        }
        Command::Commit { entry, .. } if step.before.is_flying() && !step.is_undone() => {
            let current = step.before.place().map(|p| &p.leg);
            Observed::Jump(match (entry, current) {
                (Some(entry), current) if Some(entry) != current => Jump::Enter(program, entry),
                (_, leg) => {
                    let entered = announced();
                    Jump::GoOn { program, leg: leg?, entered, simply: entered && keeps_one_leg(step) }
                }
            })
        }
        _ => return None,
    })
}

fn begins_a_flight(program: &Program, stage: &Id) -> bool {
    let stages = &program.plan.stages;
    program.plan.flights().any(|first| stages.get(first).is_some_and(|s| s.id == *stage))
}

/// Nothing but waypoints of the leg being flown were kept, and it is the same kind of leg.
fn keeps_one_leg(step: Step) -> bool {
    let Some(place) = step.before.place().filter(|_| step.keeps_its_leg()) else { return false };
    let tokens = step.after.tokens();
    step.before.ahead.iter().filter(|w| tokens.contains(&w.token)).all(|w| w.leg == place.leg)
}
