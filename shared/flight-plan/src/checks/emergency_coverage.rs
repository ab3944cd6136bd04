//! `no-emergency-plan`: legs of a stage for which no emergency plan is named, for any cause; `duplicate-cause`: two
//! plans are named for one cause at one place.

use super::Inspection;
use super::step::Step;
use crate::{Edit, EmergencyChoice, Id, Problem};
use std::collections::HashSet;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    duplicates(&view.plan.emergency, None, problems);
    for (_, stage) in view.plan.all_stages() {
        duplicates(&stage.emergency, Some(&stage.id), problems);
    }
    problems.extend(bare_stages(view).iter().map(|stage| stage.problem(view)));
}

/// That of a leg itself.
pub(super) fn leg(_: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    duplicates(&step.leg.emergency, Some(&step.leg.id), problems);
}

/// A stage and those of its legs for which no emergency plan is named.
struct BareStage<'a> {
    stage: &'a Id,
    legs: Vec<&'a Id>,
}

fn bare_stages<'a>(view: &'a Inspection) -> Vec<BareStage<'a>> {
    let mut stages: Vec<BareStage> = Vec::new();
    if covers(&view.plan.emergency) {
        return stages;
    }
    for step in view.steps().iter().filter(|step| is_bare(step)) {
        let stage = &step.around.stage.id;
        match stages.last_mut().filter(|last| last.stage == stage) {
            Some(last) => last.legs.push(&step.leg.id),
            None => stages.push(BareStage { stage, legs: vec![&step.leg.id] }),
        }
    }
    stages
}

fn is_bare(step: &Step) -> bool {
    let (leg, around) = (&step.leg, &step.around);
    let mut choices =
        around.loops.iter().map(|l| &l.emergency).chain([&leg.emergency, &around.stage.emergency]);
    around.main && leg.body().is_empty() && !choices.any(covers)
}

fn covers(choice: &EmergencyChoice) -> bool {
    choice.by_cause.iter().any(|(cause, _)| cause.is_none())
}

impl BareStage<'_> {
    /// One problem for all of its legs: one emergency plan mends them all.
    fn problem(&self, view: &Inspection) -> Problem {
        let (place, legs, subject) = match self.legs.as_slice() {
            [only] => ("here, on the stage", String::new(), *only),
            legs => ("on this stage", format!(" on {} of its legs", legs.len()), self.stage),
        };
        let message = format!(
            "name an emergency plan {place} or on the main plan: without one the gateway decides alone{legs}"
        );
        Problem::warning("no-emergency-plan", message).of(subject).perhaps_fixed_by(only_plan(view))
    }
}

/// The plan's only emergency plan, for the whole document.
fn only_plan(view: &Inspection) -> Option<Edit> {
    let [only] = view.plan.emergency_plans.as_slice() else { return None };
    Some(Edit::SetEmergency { of: None, cause: None, plan: Some(only.id.clone()) })
}

fn duplicates(choice: &EmergencyChoice, of: Option<&Id>, problems: &mut Vec<Problem>) {
    let mut seen = HashSet::new();
    for (cause, plan) in &choice.by_cause {
        if seen.insert(cause) {
            continue;
        }
        let message = format!(
            "only the first emergency plan for a cause counts: remove `{plan}` or the one before it here, and name the other one on another leg"
        );
        let problem = Problem::warning("duplicate-cause", message);
        let problem = of.map_or(problem.clone(), |of| problem.of(of));
        let first = choice.by_cause.iter().find(|(c, _)| c == cause).map(|(_, plan)| plan.clone());
        problems.push(problem.fixed_by(Edit::SetEmergency { of: of.cloned(), cause: *cause, plan: first }));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, fixed, fixed_legs, plan_with};

    #[test]
    fn legs_without_an_alternate() {
        let legs =
            |a: &str, b: &str| plan_with(&format!(r#"<IF id="a" fix="A" {a}/><TF id="b" fix="B" {b}/>"#));
        let uncovered = |plan: String| plan.replace(r#"<mainPlan emergency="home">"#, "<mainPlan>");
        let home = r#"emergency="home""#;
        assert_eq!(codes(&uncovered(legs("", ""))), ["no-emergency-plan"]);
        assert_eq!(codes(&uncovered(legs(home, ""))), ["no-emergency-plan"]);
        assert_eq!(codes(&uncovered(legs(home, home))), [""; 0]);
        fixed(&uncovered(legs("", "")), "no-emergency-plan");
    }

    #[test]
    fn one_plan_for_a_cause() {
        let engine = r#"<emergency cause="engine" plan="home"/>"#;
        let legs = format!(r#"<IF id="a" fix="A">{engine}{engine}</IF>"#);
        check_legs(&[(&legs, &["duplicate-cause"])]);
        fixed_legs(&[(&legs, "duplicate-cause")]);
    }
}
