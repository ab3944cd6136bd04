//! `no-loop-end`: neither count nor condition; `bad-count`: a count below 1 or not whole; `empty-loop`: nothing to repeat.

use super::Inspection;
use super::step::Step;
use crate::{Edit, Id, LegKind, Problem, Value};

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let LegKind::Iterative { count, until, body, .. } = &leg.kind else { return };
    if count.is_none() && until.is_none() {
        let message = "give this loop a `count` or an `until` condition: it would never end";
        problems.push(Problem::error("no-loop-end", message).of(&leg.id).fixed_by(counted(&leg.id, 1.0)));
    }
    if let Some(n) = count.as_ref().and_then(|c| view.number(c)).filter(|n| *n < 1.0 || n.fract() != 0.0) {
        let message = format!("make the count a whole number of at least 1, not {n}");
        let fix = counted(&leg.id, n.round().max(1.0));
        problems.push(Problem::error("bad-count", message).of(&leg.id).fixed_by(fix));
    }
    if body.is_empty() {
        let fix = Edit::DeleteLeg { leg: leg.id.clone() };
        let message = "put legs into this loop or remove it";
        problems.push(Problem::error("empty-loop", message).of(&leg.id).fixed_by(fix));
    }
}

fn counted(leg: &Id, count: f64) -> Edit {
    Edit::SetCount { leg: leg.clone(), count: Some(Value::Constant(count)) }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

    fn with(attributes: &str, body: &str) -> String {
        format!(r#"<IF id="a" fix="A"/><iterative id="l" form="forward" {attributes}>{body}</iterative>"#)
    }

    #[test]
    fn loops_that_never_end_or_do_nothing() {
        let body = r#"<TF id="b" fix="B"/><TF id="c" fix="C"/>"#;
        check_legs(&[
            (&with(r#"count="1""#, body), &[]),
            (&with(r#"until="battery &lt; 0.5""#, body), &[]),
            (&with("", body), &["no-loop-end"]),
            (&with(r#"count="0""#, body), &["bad-count"]),
            (&with(r#"count="2.5""#, body), &["bad-count"]),
            (&with(r#"count="2""#, ""), &["empty-loop"]),
        ]);
        fixed_legs(&[
            (&with("", body), "no-loop-end"),
            (&with(r#"count="0""#, body), "bad-count"),
            (&with(r#"count="2.5""#, body), "bad-count"),
            (&with(r#"count="2""#, ""), "empty-loop"),
        ]);
    }
}
