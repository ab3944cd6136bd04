//! `unknown-fix`, `unknown-runway`, `unknown-emergency-plan`, `unknown-leg`, `unknown-variable`: something is named
//! that is not there. (Procedures: where they are instantiated.)

use super::Inspection;
use crate::suggest::{meant, question};
use crate::uses::Part;
use crate::{Act, Edit, EmergencyChoice, Fix, Id, Leg, LegAction, LegKind, Place, Problem, Thing, Value};
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

/// A fix that is made is so far from the only place around it, metres.
const BESIDE_M: f64 = 500.0;
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
            let made = self.made(id, of).map(Box::new);
            if let Some(problem) = self.problems.last_mut() {
                problem.fix = problem.fix.take().or(made);
            }
        }
    }

    /// The edit that adds a fix nobody meant another one by: between the places around the leg, or beside the only one that is known,
    /// from where it is moved.
    fn made(&self, id: &Id, of: &Id) -> Option<Edit> {
        let plan = self.view.plan;
        let context = plan.leg(of)?;
        let place = |leg: &Arc<Leg>| match leg.place()? {
            Place::Fix(id) => self.view.fixes.get(id).copied(),
            Place::Position(Value::Constant(at)) => Some(*at),
            Place::Position(_) => None,
        };
        let (before, behind) = context.siblings.split_at_checked(context.index)?;
        let before = before.iter().rev().find_map(place);
        let behind = behind.iter().find_map(place);
        let position = match (before, behind) {
            (Some(from), Some(to)) if from.distance_m(to) > BESIDE_M => {
                from.destination(from.bearing_deg(to), from.distance_m(to) / 2.0)
            }
            (at, other) => at.or(other).or_else(|| Some(plan.home()?.threshold))?.destination(0.0, BESIDE_M),
        };
        Some(Edit::Add(Box::new(Thing::Fix(Fix {
            id: id.clone(),
            position,
            name: String::new(),
            description: String::new(),
        }))))
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
        let near = self.near(id, list.iter().map(|l| &l.id));
        let message = format!(
            "`next` names `{id}`, which is no leg of the same list: name a leg of this stage or loop{}",
            asked(near.as_ref())
        );
        let problem = Problem::error("unknown-leg", message).of(&leg.id);
        self.problems.push(problem.perhaps_fixed_by(corrected(id, Some(&leg.id), near)));
    }

    fn report<'k>(
        &mut self,
        code: &'static str,
        what: &str,
        id: &Id,
        of: Option<&Id>,
        known: impl Iterator<Item = &'k Id>,
    ) {
        let near = self.near(id, known);
        let message = format!("there is no {what} `{id}`: add it or name another{}", asked(near.as_ref()));
        let problem = Problem::error(code, message);
        let problem = of.map_or(problem.clone(), |of| problem.of(of));
        self.problems.push(problem.perhaps_fixed_by(corrected(id, of, near)));
    }

    /// What was probably meant.
    fn near<'k>(&mut self, id: &Id, known: impl Iterator<Item = &'k Id>) -> Option<Id> {
        self.left = self.left.checked_sub(1)?;
        meant(id.as_str(), known.map(Id::as_str)).map(Id::new)
    }
}

fn asked(near: Option<&Id>) -> String {
    near.map_or_else(String::new, |near| question(near.as_str()))
}

/// The edit that names what was probably meant.
fn corrected(id: &Id, of: Option<&Id>, near: Option<Id>) -> Option<Edit> {
    Some(Edit::Refer { of: of.cloned(), from: id.clone(), to: near? })
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, document_with, fixed_legs, message_of};
    use crate::{check, read};
    use aircraft::Profile;
    use terrain::Flat;

    /// Two letters that changed places are one slip.
    #[test]
    fn a_misspelt_fix_is_asked_about_and_named_by_its_remedy() {
        let watch = r#"<fix id="WATCH" lat="36.31" lon="-84.18"/></fixes>"#;
        for wrong in ["WACTH", "WTCH", "WATCHH"] {
            let legs = format!(r#"<IF id="a" fix="{wrong}"/>"#);
            let document = crate::checks::testing::plan_with(&legs).replacen("</fixes>", watch, 1);
            let plan = read(&document).plan;
            let found = check(&plan, &Profile::default(), &Flat(300.0));
            let problem = found.iter().find(|problem| problem.code == "unknown-fix").unwrap();
            assert!(problem.message.ends_with("; did you mean `WATCH`?"), "{problem}");
            let mended = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
            let left = check(&mended, &Profile::default(), &Flat(300.0));
            assert!(left.iter().all(|problem| problem.code != "unknown-fix"), "{left:?}");
        }
    }

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

    /// Where no name is near: the plan could be mended by typing only.
    #[test]
    fn a_fix_that_nothing_is_named_like_is_made_beside_the_legs_around() {
        fixed_legs(&[
            (r#"<IF id="a" fix="A"/><TF id="b" fix="LAKE"/><TF id="c" fix="C"/>"#, "unknown-fix"),
            (r#"<IF id="a" fix="LAKE"/>"#, "unknown-fix"),
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

    /// Whatever is named: what is spelt nearly like it is asked for.
    #[test]
    fn who_misspells_a_name_is_asked_for_the_nearest() {
        let leg = |legs: &str, code| message_of(legs, code);
        let cases = [
            (leg(r#"<IF id="a" fix="GATA"/>"#, "unknown-fix"), "GATE"),
            (leg(r#"<IF id="a" fix="A" emergency="hone"/>"#, "unknown-emergency-plan"), "home"),
            (leg(r#"<IF id="a" fix="A" next="seconds"/><TF id="second" fix="B"/>"#, "unknown-leg"), "second"),
            (
                leg(
                    r#"<IF id="a" fix="A"/><intersection id="i" default="nortth"><branch id="north" next="n"/><branch id="south" next="n"/></intersection><TF id="n" fix="B"/>"#,
                    "unknown-branch",
                ),
                "north",
            ),
            (
                leg(
                    r#"<IF id="a" fix="A"/><HM id="h" fix="A" turn="left" length="600" until="batterys &lt; 0.5"/>"#,
                    "unknown-name",
                ),
                "battery",
            ),
            (
                leg(
                    r#"<IF id="a" fix="A"/><HM id="h" fix="A" turn="left" length="600" until="distance_to('GATA') &lt; 90.0"/>"#,
                    "unknown-name",
                ),
                "GATE",
            ),
            (
                leg(
                    r#"<IF id="a" fix="A"/><HM id="h" fix="A" turn="left" length="600" until="distance_two(position) &lt; 90.0"/>"#,
                    "unknown-name",
                ),
                "distance_to",
            ),
        ];
        for (message, near) in cases {
            assert!(message.contains(&format!("; did you mean `{near}`?")), "{message}");
        }
    }

    #[test]
    fn who_misspells_a_variable_a_runway_or_a_procedure_is_asked_too() {
        let variables = r#"<variable name="spacing" type="number" initial="2"/></variables>
            <procedures><procedure id="box"><TF id="t" fix="B"/></procedure></procedures><variables>"#;
        let variables = variables.replace("<variables>", "");
        let stages = r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"><action on="end"><set variable="spacings" to="= 1.0"/></action></IF>
            <call id="c" procedure="boxx"/></stage><stage id="l" type="land" runway="RUNWAY"/>"#;
        let document = document_with("", stages, "")
            .replace("<variables></variables>", &format!("<variables>{variables}"))
            .replace(r#"<runway id="R""#, r#"<runway id="RUNWAI""#)
            .replace(r#"emergency="home""#, "");
        let reading = read(&document);
        assert_eq!(reading.problems, []);
        let found = check(&reading.plan, &Profile::default(), &Flat(300.0));
        for (code, near) in
            [("unknown-variable", "spacing"), ("unknown-procedure", "box"), ("unknown-runway", "RUNWAI")]
        {
            let problem = found.iter().find(|p| p.code == code).unwrap();
            assert!(problem.message.ends_with(&format!("did you mean `{near}`?")), "{problem}");
        }
    }
}
