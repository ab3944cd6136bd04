//! `emergency-not-enterable`: an emergency plan does not begin with a DF, so it can't be entered from anywhere;
//! `emergency-no-landing`: it does not end with a landing on its runway.

use super::Inspection;
use crate::{EmergencyPlan, LegKind, Problem, StageKind};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for plan in &view.plan.emergency_plans {
        let first = plan.stages.iter().find_map(|s| s.legs.first());
        if !first.is_some_and(|leg| matches!(leg.kind, LegKind::Df { .. })) {
            let message = "begin this emergency plan with a DF leg: it must be enterable from anywhere";
            problems.push(Problem::error("emergency-not-enterable", message).of(&plan.id));
        }
        if !lands(plan) {
            let message =
                format!("end this emergency plan with a land stage on its runway `{}`", plan.runway);
            problems.push(Problem::error("emergency-no-landing", message).of(&plan.id));
        }
    }
}

fn lands(plan: &EmergencyPlan) -> bool {
    plan.stages.last().is_some_and(|s| s.kind == StageKind::Land && s.runway.as_ref() == Some(&plan.runway))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document_with};

    #[test]
    fn emergency_plans_begin_anywhere_and_end_on_a_runway() {
        let df = r#"<stage id="e" type="arrival"><DF id="ed" fix="A"/></stage>"#;
        let tf = r#"<stage id="e" type="arrival"><TF id="ed" fix="A"/></stage>"#;
        let land = r#"<stage id="el" type="land" runway="R"/>"#;
        let cases: [(String, &[&str]); 4] = [
            (format!("{df}{land}"), &[]),
            (format!("{tf}{land}"), &["emergency-not-enterable"]),
            (df.into(), &["emergency-no-landing"]),
            (land.into(), &["emergency-not-enterable"]),
        ];
        for (stages, expected) in cases {
            let main = r#"<stage id="s" type="en-route" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/></stage>"#;
            let plan = format!(r#"<emergencyPlan id="home" runway="R">{stages}</emergencyPlan>"#);
            assert_eq!(codes(&document_with("", main, &plan)), expected, "{stages}");
        }
    }
}
