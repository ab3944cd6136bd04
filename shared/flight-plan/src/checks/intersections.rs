//! `unknown-branch`: the default is none of the branches; `no-default`: nobody decides, so the aircraft would hold and
//! ask; `bad-deadline`: decided after the intersection.

use super::Inspection;
use crate::{DecideBefore, Edit, LegKind, Problem};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for step in &view.steps {
        let leg = step.context.leg;
        let LegKind::Intersection { branches, default, decide_before } = &leg.kind else { continue };
        match default {
            Some(id) if !branches.iter().any(|b| b.id == *id) => {
                let message =
                    format!("the default `{id}` is no branch of this intersection: name one of them");
                problems.push(Problem::error("unknown-branch", message).of(&leg.id));
            }
            None if branches.len() > 1 => {
                let problem = Problem::warning(
                    "no-default",
                    "name a default branch: without one the aircraft holds here and asks",
                );
                let first = branches
                    .first()
                    .map(|b| Edit::SetDefault { leg: leg.id.clone(), branch: Some(b.id.clone()) });
                let problem = problem.of(&leg.id);
                problems.push(first.map_or(problem.clone(), |edit| problem.fixed_by(edit)));
            }
            _ => {}
        }
        let (DecideBefore::Time(ahead) | DecideBefore::Distance(ahead)) = decide_before;
        if *ahead < 0.0 {
            problems.push(Problem::error("bad-deadline", "make `decideBefore` 0 or more").of(&leg.id));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;

    #[test]
    fn defaults_and_deadlines() {
        let with = |attributes: &str| {
            format!(
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>
                <intersection id="i" {attributes}><branch id="x"/><branch id="y" next="c"/></intersection><TF id="c" fix="C"/>"#
            )
        };
        check_legs(&[
            (&with(r#"default="x" decideBefore="300m""#), &[]),
            (&with(r#"default="z""#), &["unknown-branch"]),
            (&with(""), &["no-default"]),
            (&with(r#"default="x" decideBefore="-1s""#), &["bad-deadline"]),
        ]);
    }
}
