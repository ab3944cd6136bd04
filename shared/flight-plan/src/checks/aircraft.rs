//! `other-aircraft`: the plan was written for another aircraft.

use super::Inspection;
use crate::{Edit, Problem};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let (plan, aircraft) = (&view.plan.aircraft, &view.profile.name);
    if plan != aircraft {
        let message = format!(
            "this plan is for the aircraft `{plan}`, it is checked for `{aircraft}`: choose that aircraft or change the plan's"
        );
        let fix = Edit::SetAircraft(aircraft.clone());
        problems.push(Problem::warning("other-aircraft", message).fixed_by(fix));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, fixed, plan_with};

    #[test]
    fn a_plan_for_another_aircraft() {
        let plan = plan_with(r#"<IF id="a" fix="A"/>"#).replace("trainer", "glider");
        assert_eq!(codes(&plan), ["other-aircraft"]);
        fixed(&plan, "other-aircraft");
    }
}
