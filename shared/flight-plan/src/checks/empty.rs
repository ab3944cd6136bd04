//! `empty-plan`: there is nothing to fly.

use super::Inspection;
use crate::Problem;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    if view.plan.stages.is_empty() {
        problems.push(Problem::error("empty-plan", "add a stage to the main plan: there is nothing to fly"));
    } else if view.plan.stages.iter().all(|s| s.legs.is_empty()) {
        problems.push(Problem::error(
            "empty-plan",
            "add a leg to a stage: the aircraft would have nowhere to go",
        ));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document, plan_with};

    #[test]
    fn a_plan_without_stages_or_without_legs() {
        assert_eq!(codes(&document("")), ["empty-plan"]);
        assert_eq!(codes(&plan_with("")), ["empty-plan"]);
    }
}
