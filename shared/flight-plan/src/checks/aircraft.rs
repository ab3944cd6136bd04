//! `other-aircraft`: the plan was written for another aircraft.

use super::Inspection;
use crate::Problem;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let (plan, aircraft) = (&view.plan.aircraft, &view.profile.name);
    if plan != aircraft {
        let message = format!(
            "this plan is for the aircraft `{plan}`, it is checked for `{aircraft}`: choose that aircraft or change the plan's"
        );
        problems.push(Problem::warning("other-aircraft", message));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, plan_with};

    #[test]
    fn a_plan_for_another_aircraft() {
        let plan = plan_with(r#"<IF id="a" fix="A"/>"#);
        assert_eq!(codes(&plan.replace("trainer", "glider")), ["other-aircraft"]);
    }
}
