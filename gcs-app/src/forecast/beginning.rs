//! A plan with errors as far as it can be flown: cut off before the first part of it that is wrong.

use flight_plan::{FlightPlan, Id, IncrementalCache, Leg, Problem, Program, compile_again};
use std::collections::HashSet;
use std::sync::Arc;

/// It is cut so often at most: what is cut off may be what something before it needs.
const MOST: usize = 8;

/// The beginning of a plan that can be flown; `None`: nothing of it can, or what is wrong is not on its way.
pub(super) fn of(plan: &Arc<FlightPlan>, memory: &mut IncrementalCache) -> Option<Program> {
    let mut cut = plan.clone();
    for _ in 0..MOST {
        match compile_again(cut.clone(), memory) {
            Ok(program) => return Some(program),
            Err(problems) => cut = Arc::new(before_first_error(&cut, &problems)?),
        }
    }
    None
}

fn before_first_error(plan: &FlightPlan, problems: &[Problem]) -> Option<FlightPlan> {
    let errors = problems.iter().filter(|problem| problem.is_error());
    let faulty: HashSet<&Id> = errors.filter_map(|problem| problem.subject.as_ref()).collect();
    let mut stages = plan.stages.iter().enumerate();
    let (stage, leg) = stages.find_map(|(index, stage)| {
        let leg = stage.legs.iter().position(|leg| has_one_of(leg, &faulty));
        if faulty.contains(&stage.id) { Some((index, None)) } else { leg.map(|leg| (index, Some(leg))) }
    })?;
    let mut cut = plan.clone();
    cut.stages.truncate(stage + usize::from(leg.is_some()));
    if let (Some(leg), Some(last)) = (leg, cut.stages.last_mut()) {
        last.legs.truncate(leg);
    }
    (!cut.stages.is_empty()).then_some(cut)
}

/// It, or a leg in it.
fn has_one_of(leg: &Leg, faulty: &HashSet<&Id>) -> bool {
    faulty.contains(&leg.id) || leg.body().iter().any(|inner| has_one_of(inner, faulty))
}
