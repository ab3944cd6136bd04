//! What must hold before a plan is flown: one rule a file.

use crate::{FlightPlan, Problem};
use aircraft::Profile;
use terrain::Terrain;

/// Every problem of a plan for an aircraft over a terrain; empty: nothing to complain about.
pub fn check(plan: &FlightPlan, _profile: &Profile, _terrain: &dyn Terrain) -> Vec<Problem> {
    expressions(plan)
}

fn expressions(plan: &FlightPlan) -> Vec<Problem> {
    let mut problems = Vec::new();
    for context in plan.all_legs() {
        context.leg.for_each_expression(&mut |source, _| {
            problems.extend(
                crate::expression::compile(source, plan)
                    .err()
                    .map(|e| Problem::error(e.code, e.to_string()).of(&context.leg.id)),
            );
        });
    }
    problems
}
