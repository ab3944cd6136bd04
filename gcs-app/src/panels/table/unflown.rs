//! Legs that the preview does not fly: other ways on from forks, emergency plans, procedures.

use super::rows::{Aside, Row};
use crate::command::Selection;
use crate::forecast::Forecast;
use flight_plan::{FlightPlan, Id, Leg, Section};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A leg of the main plan that stands before this passage.
pub(super) struct Beside<'p> {
    pub before: usize,
    pub leg: &'p Id,
    pub stage: &'p Id,
}

/// What is flown, and where it is flown last.
pub(super) struct Flown<'a>(HashMap<&'a str, usize>);

impl<'a> Flown<'a> {
    pub fn of(forecast: &'a Forecast, plan: &FlightPlan) -> Self {
        let own: HashSet<&Id> = plan.all_legs().iter().map(|context| &context.leg.id).collect();
        let mut last = HashMap::new();
        for (index, passage) in forecast.passages.iter().enumerate() {
            let flown = passage.leg.as_str();
            last.insert(flown, index);
            if !own.contains(&passage.leg) {
                // made by a call: `call.leg` flies both
                let parts = flown.match_indices('.');
                for (dot, _) in parts {
                    last.extend(
                        [flown.get(..dot), flown.get(dot + 1..)].into_iter().flatten().map(|id| (id, index)),
                    );
                }
            }
        }
        Self(last)
    }

    fn last(&self, leg: &Id) -> Option<usize> {
        self.0.get(leg.as_str()).copied()
    }
}

/// Legs of the main plan that are not flown, each behind the leg that is before it in the plan.
pub(super) fn beside<'p>(plan: &'p FlightPlan, flown: &Flown<'_>) -> Vec<Beside<'p>> {
    let mut found = Vec::new();
    let mut before = 0;
    for context in plan.all_legs().into_iter().filter(|context| context.section == Section::Main) {
        match flown.last(&context.leg.id) {
            Some(last) => before = last + 1,
            None if is_around_others(context.leg) => {}
            None => found.push(Beside { before, leg: &context.leg.id, stage: &context.stage.id }),
        }
    }
    // of legs that are flown again and again the last passage counts
    found.sort_by_key(|beside| beside.before);
    found
}

/// What is around other legs is flown as these.
pub(super) fn is_around_others(leg: &Leg) -> bool {
    leg.as_loop().is_some() || leg.as_fork().is_some()
}

/// The legs of emergency plans and procedures that are not flown, below what they belong to.
pub(super) fn elsewhere(plan: &FlightPlan, flown: &Flown<'_>) -> Vec<Row> {
    let mut rows = Vec::new();
    for emergency in &plan.emergency_plans {
        rows.push(Row::Heading(Selection::Emergency(emergency.id.clone())));
        for stage in &emergency.stages {
            rows.push(Row::Heading(Selection::Stage(stage.id.clone())));
            // what has no legs is flown by the stage itself
            let own = [&stage.id].into_iter().filter(|_| stage.legs.is_empty());
            let legs = own.chain(unflown(&stage.legs, flown));
            rows.extend(legs.map(|leg| Row::Aside(leg.clone(), stage.id.clone(), Aside::Emergency)));
        }
    }
    for procedure in &plan.procedures {
        let legs = unflown(&procedure.legs, flown);
        if !legs.is_empty() {
            rows.push(Row::Heading(Selection::Procedure(procedure.id.clone())));
            rows.extend(
                legs.into_iter().map(|leg| Row::Aside(leg.clone(), procedure.id.clone(), Aside::Procedure)),
            );
        }
    }
    rows
}

fn unflown<'p>(legs: &'p [Arc<Leg>], flown: &Flown<'_>) -> Vec<&'p Id> {
    let of_leg = |leg: &'p Arc<Leg>| {
        let is_itself = !is_around_others(leg) && flown.last(&leg.id).is_none();
        let own = is_itself.then_some(&leg.id);
        own.into_iter().chain(unflown(leg.body(), flown))
    };
    legs.iter().flat_map(of_leg).collect()
}
