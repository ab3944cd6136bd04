//! `zero-length`: a loop, or a branch of an intersection, that leads again to where the aircraft already is. Nothing is flown then:
//! at a loop the aircraft holds instead (a warning); by a branch taken by default the autopilot would get the same waypoint over and
//! over (of another branch: a warning).

use super::Inspection;
use super::step::Step;
use crate::{Act, Branch, Edit, Id, IterativeForm, Leg, LegKind, Place, Problem, Value};
use std::sync::Arc;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    match &step.leg.kind {
        LegKind::Iterative { .. } => problems.extend(next_pass(view, &step.leg)),
        LegKind::Intersection { branches, default, .. } => {
            back(view, step, branches, default.as_ref(), problems)
        }
        _ => {}
    }
}

fn next_pass(view: &Inspection, leg: &Leg) -> Option<Problem> {
    let LegKind::Iterative { form: IterativeForm::Forward, count, until, body, .. } = &leg.kind else {
        return None;
    };
    let again = match count {
        Some(count) => view.number(count).is_some_and(|n| n > 1.0),
        None => until.is_some(),
    };
    let message = "put another leg into this loop, or hold there with HM: from the second pass on it ends where it begins, and nothing is flown";
    let problem = Problem::warning("zero-length", message).of(&leg.id);
    let fix = until.is_none().then(|| once(leg));
    (again && is_one_place(body)).then(|| problem.perhaps_fixed_by(fix))
}

/// Branches to the leg behind which their intersection is.
fn back(
    view: &Inspection,
    step: &Step,
    branches: &[Branch],
    default: Option<&Id>,
    problems: &mut Vec<Problem>,
) {
    let before = view.before(step).map(|before| &before.leg);
    let Some(before) = before.filter(|leg| only_place(leg).is_some()) else { return };
    for branch in branches.iter().filter(|b| b.next.as_ref() == Some(&before.id)) {
        let message = format!(
            "let the branch `{}` lead to another leg, or hold there with HM: `{}` ends where this fork is, and nothing would be flown",
            branch.id, before.id
        );
        let problem = if default == Some(&branch.id) { Problem::error } else { Problem::warning };
        problems.push(problem("zero-length", message).of(&step.leg.id));
    }
}

fn once(leg: &Leg) -> Edit {
    Edit::SetCount { leg: leg.id.clone(), count: Some(Value::Constant(1.0)) }
}

/// Whoever has flown these legs flies nothing when they are to be flown again.
fn is_one_place(legs: &[Arc<Leg>]) -> bool {
    let mut places = legs.iter().map(|leg| only_place(leg));
    let first = places.next().flatten();
    first.is_some() && places.all(|place| place == first)
}

/// The place to which a leg leads straight from anywhere, if it is the same each time and the leg does not wait there.
fn only_place(leg: &Leg) -> Option<&Place> {
    let (LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, turn: None }) = &leg.kind else { return None };
    let waits = leg.actions.iter().any(|action| matches!(action.act, Act::Wait { .. }));
    let moves = matches!(to.place, Place::Position(Value::Expression(_)));
    (!waits && !moves).then_some(&to.place)
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document_with, fixed_legs};

    const NOTHING: &[&str] = &["zero-length"];

    fn looped(attributes: &str, body: &str) -> String {
        format!(r#"<IF id="a" fix="A"/><iterative id="l" {attributes}>{body}</iterative>"#)
    }

    #[test]
    fn a_loop_goes_somewhere_in_each_pass() {
        let (b, c) = (r#"<TF id="b" fix="B"/>"#, r#"<TF id="c" fix="C"/>"#);
        let forward = |more: &str| format!(r#"form="forward" {more}"#);
        let wait = r#"<TF id="b" fix="B"><action on="end"><wait seconds="60"/></action></TF>"#;
        check_legs(&[
            (&looped(&forward(r#"count="3""#), b), NOTHING),
            (&looped(&forward(r#"count="1000000""#), b), NOTHING),
            (&looped(&forward(r#"until="battery &lt; 0.9""#), b), NOTHING),
            (&looped(&forward(r#"until="battery &lt; 0.9""#), r#"<DF id="b" fix="B"/>"#), NOTHING),
            (&looped(&forward(r#"count="1""#), b), &[]),
            (&looped(r#"form="reverse" count="3""#, b), &[]),
            (&looped(&forward(r#"count="3""#), &format!("{b}{c}")), &[]),
            (&looped(&forward(r#"count="3""#), wait), &[]),
        ]);
        fixed_legs(&[(&looped(&forward(r#"count="3""#), b), "zero-length")]);
    }

    #[test]
    fn a_place_that_may_move_is_another_one_each_time() {
        let variables = r#"<variable name="where" type="position" initial="36.3 -84.17"/>"#;
        let body = looped(r#"form="forward" until="battery &lt; 0.5""#, r#"<TF id="b" at="= where"/>"#);
        let stages =
            format!(r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl">{body}</stage>"#);
        assert!(!codes(&document_with(variables, &stages, "")).contains(&"zero-length"));
    }

    #[test]
    fn a_branch_leads_away_from_its_intersection() {
        let fork = |next: &str, between: &str| {
            format!(
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>{between}<intersection id="i" default="back">
                <branch id="back" next="{next}"/><branch id="on" when="battery &lt; 0.9"/></intersection><TF id="c" fix="C"/>"#
            )
        };
        let hold = r#"<HM id="h" fix="B" turn="left" length="600" maxLaps="1"/>"#;
        let merge = r#"<intersection id="m"><branch id="only"/></intersection>"#;
        check_legs(&[
            (&fork("b", ""), NOTHING),
            (&fork("b", merge), NOTHING),
            (&fork("a", ""), &[]),
            (&fork("b", hold), &[]),
        ]);
    }

    #[test]
    fn what_happens_without_a_decision_is_forbidden() {
        let fork = |default: &str| {
            let legs = format!(
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"/><intersection id="i" default="{default}">
                <branch id="back" next="b"/><branch id="on"/></intersection><TF id="c" fix="C"/>"#
            );
            let plan = crate::read(crate::checks::testing::plan_with(&legs)).plan;
            let found = crate::check(&plan, &aircraft::Profile::default(), &terrain::Flat(300.0));
            found.iter().filter(|p| p.code == "zero-length").map(crate::Problem::is_error).collect::<Vec<_>>()
        };
        assert_eq!((fork("back"), fork("on")), (vec![true], vec![false]));
    }
}
