//! Remedies for legs that calls make: they are made where such a leg is written, in its procedure.

use super::Inspection;
use super::step::Step;
use crate::{Edit, FlightPlan, Id, Leg, Problem, Value};
use std::collections::HashMap;

/// A leg that a call makes.
struct Made {
    /// As what it is written in its procedure.
    written: Id,
    /// The innermost call that makes it.
    call: Id,
    /// The loops of the procedure that are around it, as what they are written, the nearest first.
    loops: Vec<Id>,
}

/// Makes edits of legs that come from calls edits of the procedure's legs; what can't be one is no remedy, for the plan as written
/// has no such legs. A call moves and turns places and courses: of these only the checked leg knows what helps.
pub(super) fn written_only(plan: &FlightPlan, inspection: &Inspection, problems: &mut [Problem]) {
    let made: HashMap<&Id, Made> =
        inspection.steps().iter().filter_map(|step| Some((&step.leg.id, Made::of(step)?))).collect();
    let writing = Writing { plan, made };
    for problem in problems {
        let is_made = problem.subject.as_ref().is_some_and(|id| writing.made.contains_key(id));
        let fix = problem.fix.take().and_then(|fix| writing.edit(&fix, is_made));
        problem.fix = fix.map(Box::new);
    }
}

impl Made {
    /// Its name is that of the call, a dot, and what it is written as. `None`: no call makes it.
    fn of(step: &Step) -> Option<Self> {
        let leg = step.leg.id.as_str();
        let behind = |around: &Id| leg.strip_prefix(around.as_str())?.strip_prefix('.').map(Id::new);
        let made = step.around.loops.iter().filter_map(|around| Some((behind(&around.id)?, &around.id)));
        let (written, call) = made.min_by_key(|(written, _)| written.as_str().len())?;
        let of_call =
            |around: &Id| around.as_str().strip_prefix(call.as_str())?.strip_prefix('.').map(Id::new);
        let loops = step.around.loops.iter().rev().filter_map(|around| of_call(&around.id)).collect();
        Some(Self { written, call: call.clone(), loops })
    }
}

/// Where the legs of the checked plan are written.
struct Writing<'a> {
    plan: &'a FlightPlan,
    made: HashMap<&'a Id, Made>,
}

impl Writing<'_> {
    /// `is_made`: the problem is of a leg that a call makes.
    fn edit(&self, fix: &Edit, is_made: bool) -> Option<Edit> {
        match fix.clone() {
            Edit::SetAltitude { of, altitude } => {
                let own = |leg: &Leg| leg.altitude.as_ref().map(|own| own.metres.clone());
                Some(Edit::SetAltitude { of: self.valued(&of, own)?, altitude })
            }
            Edit::SetSpeed { of, speed_mps } => {
                let own = |leg: &Leg| leg.speed_mps.clone();
                Some(Edit::SetSpeed { of: self.valued(&of, own)?, speed_mps })
            }
            Edit::SetFlyOver { leg, fly_over } => {
                Some(Edit::SetFlyOver { leg: self.written(&leg).clone(), fly_over })
            }
            Edit::SetCount { leg, count } => Some(Edit::SetCount { leg: self.written(&leg).clone(), count }),
            Edit::All(edits) => {
                let edits: Vec<Edit> =
                    edits.iter().map(|edit| self.edit(edit, is_made)).collect::<Option<_>>()?;
                let edits = each_once(edits);
                are_of_each_once(&edits).then_some(Edit::All(edits))
            }
            other => (!is_made).then_some(other),
        }
    }

    fn written<'b>(&'b self, id: &'b Id) -> &'b Id {
        self.made.get(id).map_or(id, |made| &made.written)
    }

    /// Where a value of this leg is changed: in the procedure, if a number stands there, at the leg or a loop around it; at the
    /// call, if the leg inherits it from there, for that is nothing to the other calls. `None`: it follows from a formula, or
    /// another call makes the call.
    fn valued(&self, id: &Id, own: impl Fn(&Leg) -> Option<Value<f64>>) -> Option<Id> {
        let Some(made) = self.made.get(id) else { return Some(id.clone()) };
        for written in std::iter::once(&made.written).chain(&made.loops) {
            match own(self.plan.any_leg(written)?) {
                Some(Value::Constant(_)) => return Some(written.clone()),
                Some(Value::Expression(_)) => return None,
                None => {}
            }
        }
        self.plan.leg(&made.call).map(|context| context.leg.id.clone())
    }
}

/// What is to be done twice is done once: two legs may inherit from one place.
fn each_once(edits: Vec<Edit>) -> Vec<Edit> {
    let mut once: Vec<Edit> = Vec::new();
    for edit in edits {
        if !once.contains(&edit) {
            once.push(edit);
        }
    }
    once
}

/// No two edits set a value of the same: legs of one call are not raised by different amounts there.
fn are_of_each_once(edits: &[Edit]) -> bool {
    let set = |edit: &Edit| match edit {
        Edit::SetAltitude { of, .. } | Edit::SetSpeed { of, .. } => Some(of.clone()),
        _ => None,
    };
    edits.iter().enumerate().all(|(n, edit)| {
        set(edit).is_none_or(|of| edits.iter().take(n).all(|former| set(former).as_ref() != Some(&of)))
    })
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

    const LOOK: &str = r#"<procedure id="look"><parameter name="height"/>{leg}</procedure>"#;
    const CALLS: &str = r#"<call id="west" procedure="look" altitude="250" altitudeReference="amsl">
        <argument name="height" value="= 250.0"/></call>
        <call id="east" procedure="look" altitude="600" altitudeReference="amsl"><argument name="height" value="= 600.0"/></call>"#;

    #[test]
    fn what_one_call_says_is_mended_at_that_call() {
        let inherits = LOOK.replace("{leg}", r#"<TF id="low" lat="36.3" lon="-84.185"/>"#);
        let mended = fixed(&called(&inherits, CALLS), "below-terrain");
        let raised = ["west", "east", "low"].map(|leg| altitude_m(&mended, leg));
        let at = |metres| Some(crate::Value::Constant(metres));
        assert_eq!(raised, [at(350.0), at(600.0), None]);
    }

    #[test]
    fn what_a_loop_of_the_procedure_says_is_mended_at_that_loop() {
        let low = r#"<iterative id="twice" count="2" altitude="250" altitudeReference="amsl">
            <TF id="low" lat="36.3" lon="-84.185"/></iterative><TF id="far" lat="36.3" lon="-84.19"/>"#;
        let mended = fixed(&called(&LOOK.replace("{leg}", low), CALLS), "below-terrain");
        let raised = ["twice", "low", "far", "west"].map(|leg| altitude_m(&mended, leg));
        let at = |metres| Some(crate::Value::Constant(metres));
        assert_eq!(raised, [at(350.0), None, None, at(250.0)]);
    }

    #[test]
    fn two_legs_that_inherit_from_one_call_are_mended_together() {
        let set = |metres| {
            let altitude = crate::Altitude {
                metres: crate::Value::Constant(metres),
                reference: crate::AltitudeReference::Amsl,
            };
            crate::Edit::SetAltitude { of: "west".into(), altitude: Some(altitude) }
        };
        assert_eq!(super::each_once(vec![set(350.0), set(350.0)]), [set(350.0)]);
        assert!(!super::are_of_each_once(&super::each_once(vec![set(350.0), set(400.0)])));
    }

    #[test]
    fn a_formula_of_a_procedure_is_mended_for_no_single_call() {
        let leg = r#"<TF id="low" lat="36.3" lon="-84.185" altitude="= height" altitudeReference="amsl"/>"#;
        let reading = crate::read(called(&LOOK.replace("{leg}", leg), CALLS));
        assert_eq!(reading.problems, []);
        let found = crate::check(&reading.plan, &aircraft::Profile::default(), &terrain::Flat(300.0));
        let low = found.iter().find(|problem| problem.code == "below-terrain").unwrap();
        assert_eq!((low.subject.clone(), low.fix.clone()), (Some("west.low".into()), None));
    }
}
