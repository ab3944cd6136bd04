//! Which emergency plan answers where.

use crate::rehearse::names_engine;
use flight_plan::{Cause, Id, Program};
use std::collections::HashMap;

/// Which emergency plans answer on which leg.
pub(super) struct EmergencyCoverage {
    by_leg: HashMap<Id, Answers>,
}

/// What answers on one leg.
struct Answers {
    engine: Option<Engine>,
    /// For the other causes, each once.
    powered: Vec<usize>,
}

/// What answers an engine failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Engine {
    /// The emergency plan.
    pub plan: usize,
    /// It is named for that cause; else it is the fallback, which was chosen for a flight with an engine.
    pub named: bool,
}

/// Every cause but an engine failure.
const POWERED: [Cause; 6] =
    [Cause::Operator, Cause::Payload, Cause::Traffic, Cause::Link, Cause::Gps, Cause::Energy];

impl EmergencyCoverage {
    pub fn of(program: &Program) -> Self {
        let number: HashMap<&Id, usize> =
            program.flown().emergency_plans.iter().enumerate().map(|(i, e)| (&e.id, i)).collect();
        let answer =
            |leg: &Id, cause| number.get(program.emergency_choice(leg, cause)?.plan_for(cause)?).copied();
        let stages = program.flown().stages.iter().map(|s| &s.id);
        let legs = program.flown().all_legs();
        let main = legs.iter().filter(|c| c.section == flight_plan::Section::Main).map(|c| &c.leg.id);
        let of = |leg: &Id| {
            let mut powered: Vec<usize> = POWERED.iter().filter_map(|cause| answer(leg, *cause)).collect();
            powered.sort_unstable();
            powered.dedup();
            let engine =
                answer(leg, Cause::Engine).map(|plan| Engine { plan, named: names_engine(program, leg) });
            (leg.clone(), Answers { engine, powered })
        };
        Self { by_leg: stages.chain(main).map(of).collect() }
    }

    /// The plan that is flown after an engine failure on a leg.
    pub fn engine(&self, leg: &Id) -> Option<Engine> {
        self.by_leg.get(leg)?.engine
    }

    /// The plans for the other causes, each once.
    pub fn powered(&self, leg: &Id) -> &[usize] {
        self.by_leg.get(leg).map_or(&[], |answers| &answers.powered)
    }

    /// All of them; one may come twice.
    pub fn plans(&self, leg: &Id) -> impl Iterator<Item = usize> + '_ {
        self.powered(leg).iter().copied().chain(self.engine(leg).map(|engine| engine.plan))
    }
}
