//! What must hold before a plan is flown: one rule a file, each with the codes it gives and its tests.
//!
//! The header of a rule names its codes in backticks; the tests hold them against the language reference and the faulty plans.
//! Procedures are checked as they are called.

mod actions;
mod aircraft;
mod altitudes;
mod called;
mod conditions;
mod courses;
mod emergency_coverage;
mod emergency_plans;
mod empty;
mod expression_bounds;
mod expressions;
mod extent;
mod gradients;
mod holdings;
mod home;
mod identifiers;
mod incremental_cache;
mod inspection;
mod intersections;
mod iteratives;
mod levels;
mod orbits;
mod order;
mod outliers;
mod path;
mod pattern_terrain;
mod pattern_turns;
mod patterns;
mod plan_context;
mod procedures;
mod references;
mod remedy;
mod returns;
mod rf;
mod runways;
mod scans;
mod segments;
mod spacings;
mod speeds;
mod stages;
mod step;
mod terrain_clearance;
mod trace;
mod tracks;
mod values;
mod variables;
mod zones;

#[cfg(test)]
pub(crate) mod testing;

pub use altitudes::LOWEST_AMSL_M;
pub use incremental_cache::IncrementalCache;
pub(crate) use inspection::Expressions;
pub use scans::untied;
pub use terrain_clearance::MARGIN_M as CLEARANCE_M;

use crate::ids::Ids;
use crate::{FlightPlan, Problem, mend_at_source};
use ::aircraft::Profile;
use incremental_cache::{Last, Recall};
use inspection::Inspection;
use std::borrow::Cow;
use std::sync::Arc;
use step::Step;
use terrain::Terrain;

/// A rule, by what it is about.
enum Rule {
    /// About the plan: everything that is not a leg, and relations between distant legs.
    Plan(fn(&Inspection, &mut Vec<Problem>)),
    /// About one leg. It reads the leg's step, the two before it and the one after it, so that an edit elsewhere changes nothing.
    Leg(fn(&Inspection, &Step, &mut Vec<Problem>)),
}

/// Every rule; the order is that of the problems.
const RULES: [Rule; 45] = {
    use Rule::{Leg, Plan};
    [
        Plan(outliers::check),
        Plan(empty::check),
        Plan(identifiers::check),
        Leg(identifiers::leg),
        Plan(references::check),
        Plan(values::check),
        Leg(values::leg),
        Plan(expressions::check),
        Leg(expressions::leg),
        Plan(expression_bounds::check),
        Leg(conditions::leg),
        Plan(variables::check),
        Plan(zones::check),
        Plan(aircraft::check),
        Plan(runways::check),
        Plan(stages::check),
        Plan(order::check),
        Leg(iteratives::check),
        Plan(intersections::undecided),
        Leg(intersections::check),
        Leg(tracks::check),
        Leg(returns::check),
        Leg(rf::check),
        Leg(segments::check),
        Leg(courses::check),
        Leg(holdings::check),
        Leg(orbits::check),
        Leg(scans::check),
        Leg(patterns::check),
        Leg(levels::check),
        Leg(spacings::check),
        Leg(pattern_turns::check),
        Leg(actions::check),
        Plan(speeds::check),
        Leg(speeds::leg),
        Leg(gradients::check),
        Plan(altitudes::check),
        Leg(altitudes::leg),
        Plan(home::check),
        Leg(home::leg),
        Leg(terrain_clearance::check),
        Leg(pattern_terrain::check),
        Plan(emergency_plans::check),
        Plan(emergency_coverage::check),
        Leg(emergency_coverage::leg),
    ]
};

/// Every problem of a plan for an aircraft over a terrain.
///
/// Calls are checked as the legs they expand to. Geometry that depends on variables is checked at their initial values.
pub fn check(plan: &FlightPlan, profile: &Profile, terrain: &dyn Terrain) -> Vec<Problem> {
    checked(plan, profile, terrain).problems
}

/// As [`check`], for a plan that is checked repeatedly while it is edited: much faster if little has changed.
pub fn check_again(plan: &FlightPlan, cache: &mut IncrementalCache) -> Vec<Problem> {
    checked_again(plan, cache).problems
}

/// A checked plan, and the findings.
pub(crate) struct Checked {
    /// The plan with its calls instantiated; `None`: it has none.
    pub flown: Option<FlightPlan>,
    pub problems: Vec<Problem>,
    pub expressions: Arc<Expressions>,
    pub ids: Arc<Ids>,
}

pub(crate) fn checked(plan: &FlightPlan, profile: &Profile, terrain: &dyn Terrain) -> Checked {
    run_checks(plan, profile, terrain, None).0
}

pub(crate) fn checked_again(plan: &FlightPlan, cache: &mut IncrementalCache) -> Checked {
    let terrain = cache.terrain.clone();
    let (checked, last) = run_checks(plan, &cache.profile, terrain.as_ref(), Some(cache.last.take()));
    cache.last = last;
    checked
}

/// `last`: the last check, if there was one; `None`: keep nothing for a next one.
fn run_checks(
    plan: &FlightPlan,
    profile: &Profile,
    terrain: &dyn Terrain,
    last: Option<Option<Last>>,
) -> (Checked, Option<Last>) {
    let (flown, mut problems) = crate::procedure::instantiate(plan);
    procedures::check(plan, &mut problems);
    courses::bearings(plan, &mut problems);
    let again = last.is_some();
    let mut recall = Recall::of(last.flatten(), &flown);
    let mut inspection = Inspection::new(&flown, profile, terrain, &mut recall);
    if inspection.is_full() && recall.is_useful() {
        // expressions that no longer exist may have taken the room
        recall = Recall::default();
        inspection = Inspection::new(&flown, profile, terrain, &mut recall);
    }
    problems.extend(apply_rules(&mut inspection, &recall));
    values::near_pole_alone(&mut problems);
    outliers::alone(&inspection, &mut problems);
    if matches!(flown, Cow::Owned(_)) {
        called::written_only(plan, &inspection, &mut problems);
    }
    mend_at_source(plan, &mut problems);
    let (expressions, ids) = (inspection.expressions().clone(), inspection.ids.clone());
    let last = again.then(|| Last::of(inspection, recall));
    let flown = match flown {
        Cow::Owned(flown) => Some(flown),
        Cow::Borrowed(_) => None,
    };
    (Checked { flown, problems, expressions, ids }, last)
}

/// What each rule finds, in the order of the rules; for rules about one leg, what they found before if it still holds.
fn apply_rules(view: &mut Inspection, recall: &Recall) -> Vec<Problem> {
    let mut said: [Vec<Problem>; RULES.len()] = std::array::from_fn(|_| Vec::new());
    for (rule, said) in RULES.iter().zip(&mut said) {
        if let Rule::Plan(check) = rule {
            check(view, said);
        }
    }
    for number in 0..view.steps().len() {
        let Some(step) = view.steps().get(number) else { break };
        if !recall.holds(number, step, view.steps()) {
            let found = rules_about(view, step);
            view.keep(number, found);
        }
        for (rule, problem) in view.steps().get(number).iter().flat_map(|step| &step.found) {
            said.get_mut(*rule).into_iter().for_each(|said| said.push(problem.clone()));
        }
    }
    said.into_iter().flatten().collect()
}

fn rules_about(view: &Inspection, step: &Step) -> Vec<(usize, Problem)> {
    let (mut found, mut said) = (Vec::new(), Vec::new());
    for (number, rule) in RULES.iter().enumerate() {
        if let Rule::Leg(check) = rule {
            check(view, step, &mut said);
            if !said.is_empty() {
                found.extend(said.drain(..).map(|problem| (number, problem)));
            }
        }
    }
    found
}
