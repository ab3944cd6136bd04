//! `runway-too-short`: the aircraft needs a longer one; `bad-heading`: outside 0..360.

use super::Inspection;
use super::remedy::normal_deg;
use crate::{Edit, Problem, Runway, Thing};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for runway in &view.plan.runways {
        let needed_m = view.profile.min_runway_m;
        if runway.length_m < needed_m {
            let message = format!(
                "choose another runway: this one has {:.0} m, the aircraft needs {needed_m:.0} m",
                runway.length_m
            );
            problems.push(Problem::error("runway-too-short", message).of(&runway.id));
        }
        if runway.heading_deg.is_finite() && !(0.0..=360.0).contains(&runway.heading_deg) {
            let message = "write the runway's heading as degrees true in 0..360";
            let problem = Problem::error("bad-heading", message).of(&runway.id);
            problems.push(problem.perhaps_fixed_by(normalised(runway)));
        }
    }
}

fn normalised(runway: &Runway) -> Option<Edit> {
    let with = Runway { heading_deg: normal_deg(runway.heading_deg)?, ..runway.clone() };
    Some(Edit::Replace { id: runway.id.clone(), with: Box::new(Thing::Runway(with)) })
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, fixed, plan_with};

    #[test]
    fn a_runway_that_is_too_short_or_points_nowhere() {
        let plan = plan_with(r#"<IF id="a" fix="A"/>"#);
        assert_eq!(codes(&plan.replace(r#"length="500""#, r#"length="100""#)), ["runway-too-short"]);
        let turned = plan.replace(r#"heading="90""#, r#"heading="450""#);
        assert_eq!(codes(&turned), ["bad-heading"]);
        fixed(&turned, "bad-heading");
    }
}
