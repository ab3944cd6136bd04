//! Which emergency plan answers where.

use flight_plan::{Cause, Id, Program};
use std::collections::HashMap;

/// Which emergency plans answer on which leg.
pub(super) struct InForce {
    /// By leg: the plan for an engine failure, and those for the other causes.
    by_leg: HashMap<Id, (Option<usize>, Vec<usize>)>,
}

/// Every cause but an engine failure.
const POWERED: [Cause; 6] =
    [Cause::Operator, Cause::Payload, Cause::Traffic, Cause::Link, Cause::Gps, Cause::Energy];

impl InForce {
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
            let engine = answer(leg, Cause::Engine).filter(|_| names_engine(program, leg));
            (leg.clone(), (engine, powered))
        };
        Self { by_leg: stages.chain(main).map(of).collect() }
    }

    /// The plan that is named for an engine failure on a leg. (A fallback answers one too, but promises no glide: over
    /// most of the earth there is no runway within the glide of a low flight.)
    pub fn engine(&self, leg: &Id) -> Option<usize> {
        self.by_leg.get(leg)?.0
    }

    /// The plans for the other causes, each once.
    pub fn powered(&self, leg: &Id) -> &[usize] {
        self.by_leg.get(leg).map_or(&[], |(_, plans)| plans)
    }

    /// All of them; one may come twice.
    pub fn plans(&self, leg: &Id) -> impl Iterator<Item = usize> + '_ {
        self.powered(leg).iter().copied().chain(self.engine(leg))
    }
}

/// The association that answers an engine failure on a leg names that cause.
fn names_engine(program: &Program, leg: &Id) -> bool {
    let choice = program.emergency_choice(leg, Cause::Engine);
    choice.is_some_and(|choice| choice.by_cause.iter().any(|(cause, _)| *cause == Some(Cause::Engine)))
}
