//! `unknown-branch`: the default is none of the branches; `no-default`: without a decision the aircraft would hold and
//! ask; `bad-deadline`: decided after the intersection.

use super::Inspection;
use super::remedy::changed;
use super::step::Step;
use crate::suggest::{meant, question};
use crate::{Branch, DecideBefore, Edit, Id, Leg, LegKind, Problem};

pub(super) fn check(_: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let LegKind::Intersection { branches, default, decide_before } = &leg.kind else { return };
    match default {
        Some(id) if !branches.iter().any(|b| b.id == *id) => {
            let near = meant(id.as_str(), branches.iter().map(|b| b.id.as_str()));
            let message = format!(
                "the default `{id}` is no branch of this intersection: name one of them{}",
                near.map_or_else(String::new, question)
            );
            let problem = Problem::error("unknown-branch", message).of(&leg.id);
            problems.push(problem.perhaps_fixed_by(near.map(|near| set_default(&leg.id, &near.into()))));
        }
        None if branches.len() > 1 => problems.push(undecided(leg, branches)),
        _ => {}
    }
    let (DecideBefore::Time(ahead) | DecideBefore::Distance(ahead)) = decide_before;
    if *ahead < 0.0 {
        let problem = Problem::error("bad-deadline", "make `decideBefore` 0 or more").of(&leg.id);
        problems.push(problem.perhaps_fixed_by(changed(leg, at_the_intersection)));
    }
}

fn undecided(leg: &Leg, branches: &[Branch]) -> Problem {
    let message = "name a default branch: without one the aircraft holds here and asks";
    let first = branches.first().map(|b| set_default(&leg.id, &b.id));
    Problem::warning("no-default", message).of(&leg.id).perhaps_fixed_by(first)
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
    use crate::checks::testing::{check_legs, fixed_legs};

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
}
