//! What must hold before a plan is flown: one rule a file, each with the codes it gives and its tests.

mod aircraft;
mod altitudes;
mod emergency_coverage;
mod emergency_plans;
mod empty;
mod expressions;
mod gradients;
mod holdings;
mod identifiers;
mod inspection;
mod intersections;
mod iteratives;
mod orbits;
mod order;
mod references;
mod rf;
mod runways;
mod scans;
mod segments;
mod speeds;
mod stages;
mod terrain_clearance;
mod values;
mod variables;

#[cfg(test)]
mod testing;

use crate::{FlightPlan, Problem};
use ::aircraft::Profile;
use inspection::Inspection;
use terrain::Terrain;

type Rule = fn(&Inspection, &mut Vec<Problem>);

/// Every rule; the order is that of the problems.
const RULES: [Rule; 23] = [
    empty::check,
    identifiers::check,
    references::check,
    values::check,
    expressions::check,
    variables::check,
    aircraft::check,
    runways::check,
    stages::check,
    order::check,
    iteratives::check,
    intersections::check,
    rf::check,
    segments::check,
    holdings::check,
    orbits::check,
    scans::check,
    speeds::check,
    gradients::check,
    altitudes::check,
    terrain_clearance::check,
    emergency_plans::check,
    emergency_coverage::check,
];

/// Every problem of a plan for an aircraft over a terrain; empty: nothing to complain about.
///
/// Calls are checked as the legs they stand for. Geometry that depends on variables is checked at their initial values.
pub fn check(plan: &FlightPlan, profile: &Profile, terrain: &dyn Terrain) -> Vec<Problem> {
    let (flown, mut problems) = crate::procedure::instantiate(plan);
    problems.extend(check_flown(&flown, profile, terrain));
    problems
}

/// As [`check`], of a plan whose calls have been instantiated.
pub(crate) fn check_flown(plan: &FlightPlan, profile: &Profile, terrain: &dyn Terrain) -> Vec<Problem> {
    let inspection = Inspection::new(plan, profile, terrain);
    let mut problems = Vec::new();
    RULES.iter().for_each(|rule| rule(&inspection, &mut problems));
    problems
}
