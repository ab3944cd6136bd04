//! Remedies for legs that calls make: they are made where such a leg is written, in its procedure.

use super::Inspection;
use super::step::Step;
use crate::{Edit, Id, Problem};
use std::collections::HashMap;

/// Makes edits of legs that come from calls edits of the procedure's legs; what can't be one is no remedy, for the plan as written
/// has no such legs. A call moves and turns places and courses: of these only the checked leg knows what helps.
pub(super) fn written_only(inspection: &Inspection, problems: &mut [Problem]) {
    let made: HashMap<&Id, Id> =
        inspection.steps().iter().filter_map(|step| Some((&step.leg.id, written(step)?))).collect();
    for problem in problems {
        let is_made = problem.subject.as_ref().is_some_and(|id| made.contains_key(id));
        let fix = problem.fix.take().and_then(|fix| in_procedures(&fix, &made, is_made));
        problem.fix = fix.map(Box::new);
    }
}

/// As what a leg is written in its procedure: behind the innermost call around it and a dot. `None`: no call makes it.
fn written(step: &Step) -> Option<Id> {
    let leg = step.leg.id.as_str();
    let behind = |around: &Id| leg.strip_prefix(around.as_str())?.strip_prefix('.');
    let shortest =
        step.around.loops.iter().filter_map(|around| behind(&around.id)).min_by_key(|rest| rest.len());
    shortest.map(Id::new)
}

/// `is_made`: the problem is of a leg that a call makes.
fn in_procedures(fix: &Edit, made: &HashMap<&Id, Id>, is_made: bool) -> Option<Edit> {
    let written = |id: &Id| made.get(id).unwrap_or(id).clone();
    match fix.clone() {
        Edit::SetAltitude { of, altitude } => Some(Edit::SetAltitude { of: written(&of), altitude }),
        Edit::SetSpeed { of, speed_mps } => Some(Edit::SetSpeed { of: written(&of), speed_mps }),
        Edit::SetFlyOver { leg, fly_over } => Some(Edit::SetFlyOver { leg: written(&leg), fly_over }),
        Edit::SetCount { leg, count } => Some(Edit::SetCount { leg: written(&leg), count }),
        Edit::All(edits) => {
            let edits = edits.iter().map(|edit| in_procedures(edit, made, is_made));
            edits.collect::<Option<_>>().map(Edit::All)
        }
        other => (!is_made).then_some(other),
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{fixed, plan_with};
    use crate::{FlightPlan, Id};

    fn called(procedures: &str, legs: &str) -> String {
        let plan = plan_with(&format!(r#"<IF id="a" fix="A"/>{legs}<TF id="b" fix="B"/>"#));
        plan.replace("<mainPlan", &format!("<procedures>{procedures}</procedures><mainPlan"))
    }

    fn altitude_m(plan: &FlightPlan, leg: &str) -> Option<crate::Value<f64>> {
        plan.any_leg(&Id::new(leg)).unwrap().altitude.as_ref().map(|altitude| altitude.metres.clone())
    }

    #[test]
    fn a_leg_of_a_procedure_is_mended_there() {
        let low = r#"<procedure id="look"><TF id="low" lat="36.3" lon="-84.185" altitude="250" altitudeReference="amsl"/></procedure>"#;
        let outer = r#"<procedure id="outer"><iterative id="twice" count="2"><call id="in" procedure="look"/>
            <TF id="back" lat="36.3" lon="-84.195"/></iterative></procedure>"#;
        for (procedures, call) in [(low.to_owned(), "look"), (format!("{low}{outer}"), "outer")] {
            let call = format!(r#"<call id="c" procedure="{call}"/>"#);
            let mended = fixed(&called(&procedures, &call), "below-terrain");
            assert_eq!(altitude_m(&mended, "low"), Some(crate::Value::Constant(350.0)), "{call}");
        }
    }
}
