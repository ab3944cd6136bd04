//! `no-emergency-plan`: a leg for which no emergency plan is named, whatever the cause.

use super::Inspection;
use crate::{EmergencyChoice, Problem, Section};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let covers = |choice: &EmergencyChoice| choice.by_cause.iter().any(|(cause, _)| cause.is_none());
    if covers(&view.plan.emergency) {
        return;
    }
    for step in view.steps.iter().filter(|s| s.context.section == Section::Main) {
        let context = &step.context;
        let around = context.loops.iter().chain([&context.leg]).any(|l| covers(&l.emergency));
        if !around && !covers(&context.stage.emergency) && context.leg.body().is_empty() {
            let message = "name an emergency plan here, on the stage or on the main plan: without one the gateway decides alone";
            problems.push(Problem::warning("no-emergency-plan", message).of(&context.leg.id));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, plan_with};

    #[test]
    fn legs_without_an_alternate() {
        let legs =
            |a: &str, b: &str| plan_with(&format!(r#"<IF id="a" fix="A" {a}/><TF id="b" fix="B" {b}/>"#));
        let uncovered = |plan: String| codes(&plan.replace(r#"<mainPlan emergency="home">"#, "<mainPlan>"));
        let home = r#"emergency="home""#;
        assert_eq!(uncovered(legs("", "")), ["no-emergency-plan", "no-emergency-plan"]);
        assert_eq!(uncovered(legs(home, "")), ["no-emergency-plan"]);
        assert_eq!(uncovered(legs(home, home)), [""; 0]);
    }
}
