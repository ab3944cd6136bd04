//! `unknown-fix`, `unknown-runway`, `unknown-emergency-plan`, `unknown-leg`, `unknown-variable`: something is named
//! that is not there. (Procedures: where they are instantiated.)

use super::Inspection;
use super::suggest::meant;
use crate::uses::Part;
use crate::{Act, Edit, EmergencyChoice, Id, Leg, LegAction, LegKind, Place, Problem};
use std::collections::HashSet;
use std::sync::Arc;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let plan = view.plan;
    let mut found = Found { view, left: MAX_SUGGESTIONS, problems };
    found.emergencies(&plan.emergency, None);
    for emergency in &plan.emergency_plans {
        found.runway(&emergency.runway, &emergency.id);
    }
    for (_, stage) in plan.all_stages() {
        found.emergencies(&stage.emergency, Some(&stage.id));
        stage.runway.iter().for_each(|id| found.runway(id, &stage.id));
    }
    for step in view.steps().iter().filter(|step| step.marks.strangers) {
        found.leg(&step.leg);
    }
    view.lists.iter().for_each(|list| found.list(list));
}

/// A leg names a fix, variable or emergency plan that is not there.
pub(super) fn has_strangers(view: &Inspection, leg: &Leg) -> bool {
    let mut strange = leg.emergency.by_cause.iter().any(|(_, id)| !view.emergency_plans.contains(id));
    leg.for_each_part(&mut |part| {
        strange |= matches!(part, Part::Place(Place::Fix(id)) if !view.fixes.contains_key(id));
    });
    let set = |action: &LegAction| matches!(&action.act, Act::Set { variable, .. } if view.plan.variable(variable).is_none());
    strange || leg.actions.iter().any(set)
}

/// Most misspelt names for which another one is looked for.
const MAX_SUGGESTIONS: usize = 64;

struct Found<'a, 'p> {
    view: &'a Inspection<'a>,
    /// Names that may still be compared with others.
    left: usize,
    problems: &'p mut Vec<Problem>,
}

impl<'a> Found<'a, '_> {
    fn leg(&mut self, leg: &Leg) {
        self.emergencies(&leg.emergency, Some(&leg.id));
        leg.for_each_part(&mut |part| {
            if let Part::Place(Place::Fix(id)) = part {
                self.fix(id, &leg.id);
            }
        });
        for action in &leg.actions {
            if let Act::Set { variable, .. } = &action.act
                && self.view.plan.variable(variable).is_none()
            {
                let known = self.view.plan.variables.iter().map(|v| &v.name);
                self.report("unknown-variable", "variable", variable, Some(&leg.id), known);
            }
        }
    }

    fn emergencies(&mut self, choice: &EmergencyChoice, of: Option<&Id>) {
        for (_, id) in choice.by_cause.iter().filter(|(_, id)| !self.view.emergency_plans.contains(id)) {
            let known = self.view.plan.emergency_plans.iter().map(|e| &e.id);
            self.report("unknown-emergency-plan", "emergency plan", id, of, known);
        }
    }

    fn runway(&mut self, id: &Id, of: &Id) {
        if !self.view.runways.contains_key(id) {
            let known = self.view.plan.runways.iter().map(|r| &r.id);
            self.report("unknown-runway", "runway", id, Some(of), known);
        }
    }

    fn fix(&mut self, id: &Id, of: &Id) {
        if !self.view.fixes.contains_key(id) {
            self.report("unknown-fix", "fix", id, Some(of), self.view.plan.fixes.iter().map(|f| &f.id));
        }
    }

    /// What follows what in a list.
    fn list(&mut self, list: &[Arc<Leg>]) {
        let known: HashSet<&Id> = list.iter().map(|leg| &leg.id).collect();
        for leg in list {
            let branches = match &leg.kind {
                LegKind::Intersection { branches, .. } => branches.as_slice(),
                _ => &[],
            };
            let named = leg.next.iter().chain(branches.iter().filter_map(|b| b.next.as_ref()));
            named.filter(|id| !known.contains(id)).for_each(|id| self.next(list, leg, id));
        }
    }

    fn next(&mut self, list: &[Arc<Leg>], leg: &Leg, id: &Id) {
        let message = format!(
            "`next` names `{id}`, which is no leg of the same list: name a leg of this stage or loop"
        );
        let problem = Problem::error("unknown-leg", message).of(&leg.id);
        let fix = self.corrected(id, Some(&leg.id), list.iter().map(|l| &l.id));
        self.problems.push(problem.perhaps_fixed_by(fix));
    }

    fn report<'k>(
        &mut self,
        code: &'static str,
        what: &str,
        id: &Id,
        of: Option<&Id>,
        known: impl Iterator<Item = &'k Id>,
    ) {
        let message = format!("there is no {what} `{id}`: add it or name another");
        let problem = Problem::error(code, message);
        let problem = of.map_or(problem.clone(), |of| problem.of(of));
        let fix = self.corrected(id, of, known);
        self.problems.push(problem.perhaps_fixed_by(fix));
    }

    /// The edit that names what was probably meant.
    fn corrected<'k>(
        &mut self,
        id: &Id,
        of: Option<&Id>,
        known: impl Iterator<Item = &'k Id>,
    ) -> Option<Edit> {
        self.left = self.left.checked_sub(1)?;
        let to = meant(id, known)?.clone();
        Some(Edit::Refer { of: of.cloned(), from: id.clone(), to })
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

    #[test]
    fn names_of_things_that_are_not_there() {
        check_legs(&[
            (r#"<IF id="a" fix="Z"/>"#, &["unknown-fix"]),
            (r#"<IF id="a" fix="A" emergency="nowhere"/>"#, &["unknown-emergency-plan"]),
            (
                r#"<IF id="a" fix="A"><emergency cause="engine" plan="nowhere"/></IF>"#,
                &["unknown-emergency-plan"],
            ),
            (r#"<IF id="a" fix="A" next="z"/><TF id="b" fix="B"/>"#, &["unknown-leg"]),
            (
                r#"<trackLine id="t" spacing="300"><route><point fix="A"/><point fix="Z"/></route></trackLine>"#,
                &["unknown-fix"],
            ),
            (
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"><action on="abeam" fix="Z"><photo/></action></TF>"#,
                &["unknown-fix"],
            ),
            (
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"><action on="end"><set variable="z" to="= 1.0"/></action></TF>"#,
                &["unknown-variable"],
            ),
        ]);
    }

    #[test]
    fn next_must_not_leave_its_list() {
        let legs = r#"<IF id="a" fix="A"/>
            <iterative id="loop" form="forward" count="2"><TF id="b" fix="B"/><TF id="c" fix="C" next="a"/></iterative>"#;
        check_legs(&[(legs, &["unknown-leg"])]);
    }

    #[test]
    fn a_slip_of_the_pen_is_corrected() {
        fixed_legs(&[
            (r#"<IF id="a" fix="GATE8"/>"#, "unknown-fix"),
            (r#"<IF id="a" fix="A" emergency="homr"/>"#, "unknown-emergency-plan"),
            (r#"<IF id="a" fix="A" next="bett"/><TF id="beta" fix="B"/><TF id="c" fix="C"/>"#, "unknown-leg"),
        ]);
    }
}
