//! `unknown-branch`: the default is none of the branches; `no-default`: without a decision the aircraft would hold and
//! ask; `bad-deadline`: decided after the intersection.

use super::Inspection;
use super::remedy::changed;
use super::step::Step;
use crate::suggest::{meant, question};
use crate::{Branch, DecideBefore, Edit, Id, Leg, LegKind, Problem};
use std::collections::HashSet;
use std::sync::Arc;

pub(super) fn check(_: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let LegKind::Intersection { branches, default, decide_before } = &leg.kind else { return };
    match default {
        Some(id) if !branches.iter().any(|b| b.id == *id) => {
            let near = meant(id.as_str(), branches.iter().map(|b| b.id.as_str()));
            let message = format!(
                "the default `{id}` is no branch of this fork: name one of them{}",
                near.map_or_else(String::new, question)
            );
            let problem = Problem::error("unknown-branch", message).of(&leg.id);
            problems.push(problem.perhaps_fixed_by(near.map(|near| set_default(&leg.id, &near.into()))));
        }
        _ => {}
    }
    let (DecideBefore::Time(ahead) | DecideBefore::Distance(ahead)) = decide_before;
    if *ahead < 0.0 {
        let problem = Problem::error("bad-deadline", "make `decideBefore` 0 or more").of(&leg.id);
        problems.push(problem.perhaps_fixed_by(changed(leg, at_the_intersection)));
    }
}

/// Those without a default: what it may be is seen from the legs that the branches lead to.
pub(super) fn undecided(view: &Inspection, problems: &mut Vec<Problem>) {
    for list in &view.lists {
        let mut holdings: Option<HashSet<&Id>> = None;
        for (index, leg) in list.iter().enumerate() {
            let Some(fork) = leg.as_fork().filter(|fork| fork.default.is_none() && fork.branches.len() > 1)
            else {
                continue;
            };
            let holdings =
                holdings.get_or_insert_with(|| list.iter().filter(holds).map(|leg| &leg.id).collect());
            let behind = list.get(index + 1).map(|leg| &leg.id);
            let waits =
                |branch: &&Branch| branch.next.as_ref().or(behind).is_some_and(|to| holdings.contains(to));
            let default = fork.branches.iter().find(waits).or(fork.branches.first());
            let message = "name a default branch: without one the aircraft holds here and asks";
            let fix = default.map(|branch| set_default(&leg.id, &branch.id));
            problems.push(Problem::warning("no-default", message).of(&leg.id).perhaps_fixed_by(fix));
        }
    }
}

/// Nothing is begun by it that somebody should have decided.
fn holds(leg: &&Arc<Leg>) -> bool {
    matches!(leg.kind, LegKind::Hf(_) | LegKind::Ha(_) | LegKind::Hm { .. } | LegKind::Orbit { .. })
}

fn set_default(leg: &Id, branch: &Id) -> Edit {
    Edit::SetDefault { leg: leg.clone(), branch: Some(branch.clone()) }
}

fn at_the_intersection(kind: &mut LegKind) -> Option<()> {
    let LegKind::Intersection { decide_before, .. } = kind else { return None };
    let (DecideBefore::Time(ahead) | DecideBefore::Distance(ahead)) = decide_before;
    *ahead = 0.0;
    Some(())
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs, plan_with};
    use crate::{Edit, check, read};

    #[test]
    fn defaults_and_deadlines() {
        let with = |attributes: &str| {
            format!(
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>
                <intersection id="i" {attributes}><branch id="left"/><branch id="right" next="c"/></intersection><TF id="c" fix="C"/>"#
            )
        };
        check_legs(&[
            (&with(r#"default="left" decideBefore="300m""#), &[]),
            (&with(r#"default="z""#), &["unknown-branch"]),
            (&with(""), &["no-default"]),
            (&with(r#"default="left" decideBefore="-1s""#), &["bad-deadline"]),
        ]);
        fixed_legs(&[
            (&with(r#"default="rigt""#), "unknown-branch"),
            (&with(""), "no-default"),
            (&with(r#"default="left" decideBefore="-1s""#), "bad-deadline"),
        ]);
    }

    /// Whoever takes the remedy does not begin the approach by it.
    #[test]
    fn the_default_that_is_offered_waits_if_a_branch_does() {
        let offered = |second: &str| {
            let legs = format!(
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>
                <intersection id="ask"><branch id="go" next="c"/><branch id="wait" {second}/></intersection>
                <HM id="hold" fix="B" turn="right" length="500" maxLaps="1" next="ask"/><TF id="c" fix="C"/><TF id="d" fix="A"/>"#
            );
            let plan = read(plan_with(&legs)).plan;
            let problems = check(&plan, &aircraft::Profile::default(), &terrain::Flat(300.0));
            let problem = problems.into_iter().find(|p| p.code == "no-default").unwrap();
            match problem.fix.as_deref() {
                Some(Edit::SetDefault { branch: Some(branch), .. }) => branch.to_string(),
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(offered(r#"next="hold""#), "wait");
        assert_eq!(offered(""), "wait");
        assert_eq!(offered(r#"next="d""#), "go");
    }
}
