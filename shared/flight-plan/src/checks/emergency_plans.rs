//! `emergency-not-enterable`: an emergency plan does not begin with a DF, so it can't be entered from anywhere;
//! `emergency-no-landing`: it does not end with a landing on its runway.

use super::Inspection;
use super::remedy::with_kind;
use crate::{
    Edit, EmergencyChoice, EmergencyPlan, Id, Leg, LegKind, Problem, Spot, Stage, StageKind, Turnaround,
};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for plan in &view.plan.emergency_plans {
        let first = plan.stages.iter().find_map(|s| s.legs.first());
        if !first.is_some_and(|leg| matches!(leg.kind, LegKind::Df { .. })) {
            let message = "begin this emergency plan with a DF leg: it must be enterable from anywhere";
            let problem = Problem::error("emergency-not-enterable", message).of(&plan.id);
            problems.push(problem.perhaps_fixed_by(first.and_then(|leg| direct(view, leg))));
        }
        if !lands(plan) {
            let message =
                format!("end this emergency plan with a land stage on its runway `{}`", plan.runway);
            let problem = Problem::error("emergency-no-landing", message).of(&plan.id);
            problems.push(problem.perhaps_fixed_by(landing(view, plan)));
        }
    }
}

/// The same leg as a DF, if it goes to a waypoint; before a holding, a DF to its fix.
fn direct(view: &Inspection, leg: &Leg) -> Option<Edit> {
    match &leg.kind {
        LegKind::If(to) | LegKind::Tf(to) | LegKind::Cf { to, .. } => {
            Some(with_kind(leg, LegKind::Df { to: to.clone(), turn: None }))
        }
        LegKind::Hf(holding) | LegKind::Ha(holding) | LegKind::Hm { holding, .. } => {
            let kind = LegKind::Df { to: holding.fix.clone(), turn: None };
            let id = view.plan.unique_id(&format!("{}-direct", leg.id));
            // what is done in the holding is not done on the way there
            let (name, actions, next) = (String::new(), Vec::new(), None);
            let leg_before = Leg { id, name, actions, next, kind, ..leg.clone() };
            Some(Edit::InsertLeg { leg: Box::new(leg_before), at: Spot::Before(leg.id.clone()) })
        }
        _ => None,
    }
}

fn lands(plan: &EmergencyPlan) -> bool {
    plan.stages.last().is_some_and(|s| s.kind == StageKind::Land && s.runway.as_ref() == Some(&plan.runway))
}

/// The runway for a land stage that names another one, a land stage where there is none.
fn landing(view: &Inspection, plan: &EmergencyPlan) -> Option<Edit> {
    if !view.runways.contains_key(&plan.runway) {
        return None;
    }
    if let Some(last) = plan.stages.last().filter(|s| s.kind == StageKind::Land) {
        return Some(Edit::SetRunway { of: last.id.clone(), runway: plan.runway.clone() });
    }
    let stage = Box::new(Stage {
        id: Id::new(&format!("{}-land", plan.id)),
        name: String::new(),
        kind: StageKind::Land,
        emergency: EmergencyChoice::default(),
        runway: Some(plan.runway.clone()),
        altitude: None,
        speed_mps: None,
        turnaround: Turnaround::default(),
        legs: Vec::new(),
    });
    Some(Edit::AppendStage { to: Some(plan.id.clone()), stage })
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document_with, fixed};

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
        let with = |stages: &str| {
            let main = r#"<stage id="s" type="en-route" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/></stage>"#;
            let plan = format!(r#"<emergencyPlan id="home" runway="R">{stages}</emergencyPlan>"#);
            document_with("", main, &plan)
        };
        for (stages, expected) in cases {
            assert_eq!(codes(&with(&stages)), expected, "{stages}");
        }
        fixed(&with(&format!("{tf}{land}")), "emergency-not-enterable");
        fixed(&with(df), "emergency-no-landing");
        let hold = r#"<stage id="e" type="arrival"><HA id="eh" fix="A" course="90" turn="left" length="900" altitude="400" altitudeReference="amsl"/></stage>"#;
        fixed(&with(&format!("{hold}{land}")), "emergency-not-enterable");
    }
}
