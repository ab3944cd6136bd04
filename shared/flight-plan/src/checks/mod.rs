//! What must hold before a plan is flown: one rule a file, each with the codes it gives and its tests.

mod actions;
mod aircraft;
mod altitudes;
mod courses;
mod emergency_coverage;
mod emergency_plans;
mod empty;
mod expression_bounds;
mod expressions;
mod gradients;
mod holdings;
mod home;
mod identifiers;
mod inspection;
mod intersections;
mod iteratives;
mod memory;
mod orbits;
mod order;
mod patterns;
mod procedures;
mod references;
mod remedy;
mod rf;
mod runways;
mod scans;
mod segments;
mod spacings;
mod speeds;
mod stages;
mod suggest;
mod terrain_clearance;
mod tracks;
mod values;
mod variables;
mod zones;

#[cfg(test)]
mod testing;

pub use memory::Memory;

use crate::{FlightPlan, Id, Problem};
use ::aircraft::Profile;
use inspection::{Inspection, Step};
use std::borrow::Cow;
use std::collections::HashSet;
use terrain::Terrain;

type Rule = fn(&Inspection, &mut Vec<Problem>);

/// Every rule; the order is that of the problems.
const RULES: [Rule; 31] = [
    empty::check,
    identifiers::check,
    references::check,
    values::check,
    expressions::check,
    expression_bounds::check,
    variables::check,
    zones::check,
    aircraft::check,
    runways::check,
    stages::check,
    order::check,
    iteratives::check,
    intersections::check,
    tracks::check,
    rf::check,
    segments::check,
    courses::check,
    holdings::check,
    orbits::check,
    scans::check,
    patterns::check,
    spacings::check,
    actions::check,
    speeds::check,
    gradients::check,
    altitudes::check,
    home::check,
    terrain_clearance::check,
    emergency_plans::check,
    emergency_coverage::check,
];

/// Every problem of a plan for an aircraft over a terrain; empty: nothing to complain about.
///
/// Calls are checked as the legs they stand for. Geometry that depends on variables is checked at their initial values.
pub fn check(plan: &FlightPlan, profile: &Profile, terrain: &dyn Terrain) -> Vec<Problem> {
    check_again(plan, profile, terrain, &mut Memory::default())
}

/// As [`check`], for a plan that is checked again and again while it is edited: much quicker where little has changed.
pub fn check_again(
    plan: &FlightPlan,
    profile: &Profile,
    terrain: &dyn Terrain,
    memory: &mut Memory,
) -> Vec<Problem> {
    checked(plan, profile, terrain, memory).1
}

/// The plan with its calls instantiated, and every problem of it (see [`check`]).
pub(crate) fn checked<'p>(
    plan: &'p FlightPlan,
    profile: &Profile,
    terrain: &dyn Terrain,
    memory: &mut Memory,
) -> (Cow<'p, FlightPlan>, Vec<Problem>) {
    let (flown, mut problems) = crate::procedure::instantiate(plan);
    procedures::check(plan, &mut problems);
    let inspection = Inspection::new(&flown, profile, terrain, memory);
    RULES.iter().for_each(|rule| rule(&inspection, &mut problems));
    if matches!(flown, Cow::Owned(_)) {
        written_only(&inspection, &mut problems);
    }
    drop(inspection);
    (flown, problems)
}

/// Takes away the fixes of legs that calls have made: the plan as it is written has no such legs to edit.
fn written_only(inspection: &Inspection, problems: &mut [Problem]) {
    let made = |step: &&Step| {
        let leg = step.context.leg.id.as_str();
        step.context
            .loops
            .iter()
            .any(|l| leg.strip_prefix(l.id.as_str()).is_some_and(|rest| rest.starts_with('.')))
    };
    let made: HashSet<&Id> = inspection.steps.iter().filter(made).map(|s| &s.context.leg.id).collect();
    for problem in problems.iter_mut().filter(|p| p.fix.is_some()) {
        if problem.subject.as_ref().is_some_and(|id| made.contains(id)) {
            problem.fix = None;
        }
    }
}
