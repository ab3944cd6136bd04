//! `unused-procedure`: nothing calls it; `empty-procedure`: it has no legs. Looks at the plan as it is written, with its
//! calls; the calls themselves are checked where they are instantiated.

use crate::{Edit, FlightPlan, Id, Leg, LegKind, Problem};
use std::collections::HashSet;
use std::sync::Arc;

pub(super) fn check(plan: &FlightPlan, problems: &mut Vec<Problem>) {
    let mut called = HashSet::new();
    plan.all_stages().for_each(|(_, stage)| calls(&stage.legs, &mut called));
    plan.procedures.iter().for_each(|procedure| calls(&procedure.legs, &mut called));
    for procedure in &plan.procedures {
        let removed = || Edit::Remove { id: procedure.id.clone() };
        if procedure.legs.is_empty() {
            let problem = Problem::error("empty-procedure", "put legs into this procedure or remove it");
            let fix = (!called.contains(&procedure.id)).then(removed);
            problems.push(problem.of(&procedure.id).perhaps_fixed_by(fix));
        } else if !called.contains(&procedure.id) {
            let problem = Problem::warning("unused-procedure", "call this procedure or remove it");
            problems.push(problem.of(&procedure.id).fixed_by(removed()));
        }
    }
}

fn calls<'a>(legs: &'a [Arc<Leg>], called: &mut HashSet<&'a Id>) {
    for leg in legs {
        if let LegKind::Call(call) = &leg.kind {
            called.insert(&call.procedure);
        }
        calls(leg.body(), called);
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, fixed, plan_with};

    fn with(procedures: &str, legs: &str) -> String {
        let plan = plan_with(&format!(r#"<IF id="a" fix="A"/>{legs}"#));
        plan.replace("<mainPlan", &format!("<procedures>{procedures}</procedures><mainPlan"))
    }

    #[test]
    fn procedures_have_legs_and_callers() {
        let (gate, call) = (
            r#"<procedure id="gate"><TF id="in" fix="B"/></procedure>"#,
            r#"<call id="c" procedure="gate"/>"#,
        );
        assert_eq!(codes(&with(gate, call)), [""; 0]);
        assert_eq!(codes(&with(gate, "")), ["unused-procedure"]);
        assert_eq!(codes(&with(r#"<procedure id="gate"/>"#, "")), ["empty-procedure"]);
        fixed(&with(gate, ""), "unused-procedure");
        fixed(&with(r#"<procedure id="gate"/>"#, ""), "empty-procedure");
    }
}
