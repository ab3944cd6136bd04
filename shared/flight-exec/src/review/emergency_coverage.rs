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
    /// On these legs, which flights come to: a plan may have very many others.
    pub fn of<'a>(program: &Program, legs: impl IntoIterator<Item = &'a Id>) -> Self {
        let number: HashMap<&Id, usize> =
            program.flown().emergency_plans.iter().enumerate().map(|(i, e)| (&e.id, i)).collect();
        let mut by_leg = HashMap::new();
        for leg in legs {
            if !by_leg.contains_key(leg) {
                by_leg.insert(leg.clone(), Answers::on(leg, program, &number));
            }
        }
        Self { by_leg }
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

impl Answers {
    /// `number`: the index of each emergency plan.
    fn on(leg: &Id, program: &Program, number: &HashMap<&Id, usize>) -> Self {
        let answer = |cause| number.get(program.emergency_choice(leg, cause)?.plan_for(cause)?).copied();
        let mut powered: Vec<usize> = POWERED.iter().filter_map(|cause| answer(*cause)).collect();
        powered.sort_unstable();
        powered.dedup();
        let engine = answer(Cause::Engine).map(|plan| Engine { plan, named: names_engine(program, leg) });
        Self { engine, powered }
    }
}
