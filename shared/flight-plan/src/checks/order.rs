//! `unreachable-leg`: no path leads to a leg; `endless-loop`: `next` leads back and never out again.

use super::Inspection;
use crate::{Edit, Leg, LegKind, Problem};
use std::collections::HashMap;
use std::sync::Arc;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    // a leg that names no successor leads to the next one
    view.lists.iter().for_each(|legs| list(legs, problems));
}

/// One list: a graph whose nodes are its legs and, last, its end.
fn list(legs: &[Arc<Leg>], problems: &mut Vec<Problem>) {
    let index: HashMap<&str, usize> = legs.iter().enumerate().map(|(i, l)| (l.id.as_str(), i)).collect();
    let forward: Vec<Vec<usize>> =
        legs.iter().enumerate().map(|(i, leg)| successors(i, leg, &index)).collect();
    let mut backward = vec![Vec::new(); legs.len() + 1];
    for (from, successors) in forward.iter().enumerate() {
        successors
            .iter()
            .filter_map(|to| backward.get_mut(*to).map(|b: &mut Vec<usize>| b.push(from)))
            .count();
    }
    let reached = reach(0, &forward, legs.len() + 1);
    let leaves = reach(legs.len(), &backward, legs.len() + 1);
    for ((leg, reached), leaves) in legs.iter().zip(&reached).zip(&leaves) {
        if !reached {
            let message = "no path leads to this leg: remove it, or name it in a `next` or a branch";
            let fix = Edit::DeleteLeg { leg: leg.id.clone() };
            problems.push(Problem::warning("unreachable-leg", message).of(&leg.id).fixed_by(fix));
        } else if !leaves {
            let message = "`next` leads back here for ever: add a branch that leads out, or use an iterative leg with a count or condition";
            problems.push(Problem::error("endless-loop", message).of(&leg.id));
        }
    }
}

fn successors(index: usize, leg: &Leg, known: &HashMap<&str, usize>) -> Vec<usize> {
    // another rule reports an unknown target: here it counts as the leg that follows
    let target = |next: &Option<crate::Id>| {
        next.as_ref().and_then(|id| known.get(id.as_str()).copied()).unwrap_or(index + 1)
    };
    match &leg.kind {
        LegKind::Intersection { branches, .. } if !branches.is_empty() => {
            branches.iter().map(|b| target(&b.next)).collect()
        }
        _ => vec![target(&leg.next)],
    }
}

fn reach(from: usize, edges: &[Vec<usize>], nodes: usize) -> Vec<bool> {
    let mut reached = vec![false; nodes];
    let mut open = vec![from];
    while let Some(node) = open.pop() {
        if reached.get_mut(node).is_some_and(|r| !std::mem::replace(r, true)) {
            open.extend(edges.get(node).into_iter().flatten());
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

    #[test]
    fn what_nobody_reaches_is_removed() {
        let legs = r#"<IF id="a" fix="A" next="c"/><TF id="b" fix="B"/><TF id="c" fix="C"/>"#;
        fixed_legs(&[(legs, "unreachable-leg")]);
    }

    #[test]
    fn jumps_that_skip_or_never_end() {
        check_legs(&[
            (
                r#"<IF id="a" fix="A" next="c"/><TF id="b" fix="B"/><TF id="c" fix="C"/>"#,
                &["unreachable-leg"],
            ),
            (r#"<IF id="a" fix="A"/><TF id="b" fix="B" next="a"/>"#, &["endless-loop", "endless-loop"]),
            (
                r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>
                   <intersection id="i" default="on"><branch id="back" next="a"/><branch id="on"/></intersection><TF id="c" fix="C"/>"#,
                &[],
            ),
        ]);
    }
}
