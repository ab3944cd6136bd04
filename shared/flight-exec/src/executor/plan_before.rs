//! The plan before a commit in flight: it is gone on with if the gateway does not take the first waypoints of the new one.

use super::Executor;
use crate::api::{Command, Event, Input, Output, Token};
use crate::flight::Flight;
use flight_plan::Program;
use std::sync::Arc;

/// What was flown before a commit, for as long as it can be gone on with as if there had been none.
#[derive(Clone)]
pub(super) struct PlanBefore {
    program: Arc<Program>,
    flight: Flight,
    /// The first waypoint of the new plan.
    first: Token,
    /// What the aircraft steers to since, of what both plans have in common.
    current: Option<Token>,
}

impl PlanBefore {
    /// Of an executor about to take over another plan.
    pub fn of(executor: &Executor) -> Self {
        let (program, flight) = (executor.setup.program.clone(), executor.flight.clone());
        Self { program, flight, first: Token(0), current: None }
    }

    /// With what the commit has put out; `None`: it changes nothing of what is fed.
    pub fn until_taken(self, outputs: &[Output]) -> Option<Box<Self>> {
        let first = outputs.iter().find_map(|output| match output {
            Output::Feed { waypoints, .. } => waypoints.first().map(|waypoint| waypoint.token),
            _ => None,
        })?;
        Some(Box::new(Self { first, ..self }))
    }

    /// Whether it can still be gone on with after an input; what is common progress is taken down.
    fn outlives(&mut self, input: &Input) -> bool {
        match input {
            Input::Progress { current } => {
                self.current = current.or(self.current);
                current.is_some_and(|token| token < self.first)
            }
            Input::Command { command, .. } => matches!(command, Command::SetVariable { .. }),
            Input::GatewayControls(_) | Input::Landed | Input::NotLaunched => false,
            Input::Tick | Input::Aircraft(_) | Input::Propose { .. } | Input::Rejected { .. } => true,
        }
    }
}

impl Executor {
    /// The plan before is no way back any more: a snapshot does not have it, so whoever takes one gives it up.
    pub fn forget_plan_before(&mut self) {
        self.plan_before = None;
    }

    /// An input comes: the plan before may be no way back after it.
    pub(super) fn weigh_plan_before(&mut self, input: &Input) {
        if self.plan_before.as_mut().is_some_and(|before| !before.outlives(input)) {
            self.plan_before = None;
        }
    }

    /// The gateway refuses a batch that begins with `first`. If that is where the plan committed last begins, the plan before it
    /// flies on from where it is, with the values of now; true if so.
    pub(super) fn go_back_to_plan_before(&mut self, first: Token, out: &mut Vec<Output>) -> bool {
        let Some(before) = self.plan_before.take().filter(|before| first <= before.first) else {
            return false;
        };
        let PlanBefore { program, flight, current, .. } = *before;
        self.life.values.carry_over(&program.plan, out);
        let revision = self.life.revision.activate(self.is_under_way());
        out.push(Output::Event(Event::PlanActivated { hash: program.hash().clone(), revision }));
        self.setup.program = program;
        self.flight = flight;
        if current.is_some() {
            self.progress(current, out);
        }
        // some of it may have been merged into what was refused
        self.refeed(out);
        true
    }
}
