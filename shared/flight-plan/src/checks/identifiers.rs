//! `bad-id`: an identifier is missing or has a character that it may not have; `duplicate-id`: it is there twice.

use super::Inspection;
use super::step::Step;
use crate::{Edit, Id, LegKind, Problem, expression};
use std::collections::HashSet;

/// Longest identifier, bytes.
const LONGEST: usize = 64;
/// Most numbers that are tried for a free identifier.
const MAX_NUMBERS: usize = 1000;
/// Most identifiers for which another one is looked for.
const MAX_RENAMED: usize = 64;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let variables = view.plan.variables.iter().map(|v| &v.name);
    view.ids.others().chain(variables.clone()).for_each(|id| well_formed(id, problems));
    twice(view.ids.twice(), |id| view.ids.contains(id), problems);
    unique(variables, problems);
    view.plan.variables.iter().for_each(|v| variable_name(&v.name, problems));
}

/// A leg's own identifier, and those of its branches.
pub(super) fn leg(_: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    well_formed(&step.leg.id, problems);
    if let LegKind::Intersection { branches, .. } = &step.leg.kind {
        let mut of_branches = Vec::new();
        branches.iter().for_each(|b| well_formed(&b.id, &mut of_branches));
        unique(branches.iter().map(|b| &b.id), &mut of_branches);
        // branches have no place in the document that is known by their identifiers, and may be called like legs
        problems.extend(of_branches.into_iter().map(|problem| of_branch(problem, &step.leg.id)));
    }
}

fn well_formed(id: &Id, problems: &mut Vec<Problem>) {
    if !is_identifier(id.as_str()) {
        let message = format!(
            "give this an id of 1 to {LONGEST} letters, digits, `-`, `_` or `.`, not \"{}\"",
            id.as_str().escape_debug()
        );
        problems.push(Problem::error("bad-id", message).of(id));
    }
}

/// What is wrong with a branch's identifier, as a problem of its intersection.
fn of_branch(problem: Problem, intersection: &Id) -> Problem {
    let message = format!("of a branch: {}", problem.message);
    Problem { message, ..problem }.of(intersection)
}

fn unique<'a>(ids: impl Iterator<Item = &'a Id>, problems: &mut Vec<Problem>) {
    let mut seen = HashSet::new();
    let again: Vec<Id> = ids.filter(|id| !seen.insert(*id)).cloned().collect();
    twice(&again, |id| seen.contains(id), problems);
}

fn twice(again: &[Id], taken: impl Fn(&Id) -> bool, problems: &mut Vec<Problem>) {
    for (index, id) in again.iter().enumerate() {
        let message = format!("rename one of those that are called `{id}`");
        let free = (index < MAX_RENAMED).then(|| free(id, &taken)).flatten();
        let fix = free.map(|to| Edit::Distinguish { id: id.clone(), to });
        problems.push(Problem::error("duplicate-id", message).of(id).perhaps_fixed_by(fix));
    }
}

/// A new identifier, derived from an existing one. Variables may not have a `-`.
fn free(id: &Id, taken: impl Fn(&Id) -> bool) -> Option<Id> {
    let numbered = |n: usize| Id::new(&format!("{id}_{n}"));
    (2..MAX_NUMBERS).map(numbered).find(|id| !taken(id)).filter(|id| is_identifier(id.as_str()))
}

fn is_identifier(id: &str) -> bool {
    let allowed = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_' | b'.');
    (1..=LONGEST).contains(&id.len()) && id.bytes().all(allowed)
}

/// Variables are names of the expression language too.
fn variable_name(name: &Id, problems: &mut Vec<Problem>) {
    if !expression::is_variable_name(name.as_str()) {
        let message = format!(
            "rename the variable `{name}`: letters, digits and `_`, no digit first, no word of the expression language"
        );
        problems.push(Problem::error("bad-id", message).of(name));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document_with, fixed, fixed_legs, plan_with};
    use crate::{check, read};
    use aircraft::Profile;
    use terrain::Flat;

    #[test]
    fn duplicate_and_malformed_ids() {
        check_legs(&[
            (r#"<IF id="a" fix="A"/><TF id="a" fix="B"/>"#, &["duplicate-id"]),
            (r#"<IF id="way" fix="A"/><TF id="b" fix="B"/>"#, &["duplicate-id"]),
            (r#"<IF id="a b" fix="A"/>"#, &["bad-id"]),
            (r#"<IF id="" fix="A"/>"#, &["bad-id"]),
        ]);
    }

    #[test]
    fn a_branch_is_found_at_its_intersection() {
        let fork = |first: &str, second: &str| {
            plan_with(&format!(
                r#"<IF id="a" fix="A"/><intersection id="i" default="{first}"><branch id="{first}" next="c"/><branch id="{second}"/></intersection><TF id="b" fix="B"/><TF id="c" fix="C"/>"#
            ))
        };
        assert_eq!(codes(&fork("x", "y")), [""; 0]);
        for (document, code) in [(fork("x", "x"), "duplicate-id"), (fork("x", "y z"), "bad-id")] {
            let reading = read(&document);
            let mut problems = check(&reading.plan, &Profile::default(), &Flat(300.0));
            reading.places.locate(&mut problems);
            let [problem] = &problems[..] else { panic!("{problems:?}") };
            assert_eq!((problem.code, problem.location), (code, reading.places.get(&"i".into())));
            assert!(problem.location.is_some());
        }
        fixed(&fork("x", "x"), "duplicate-id");
    }

    #[test]
    fn the_last_of_several_is_renamed() {
        fixed_legs(&[
            (r#"<IF id="a" fix="A"/><TF id="a" fix="B"/>"#, "duplicate-id"),
            (r#"<IF id="way" fix="A"/><TF id="b" fix="B"/>"#, "duplicate-id"),
        ]);
    }

    #[test]
    fn legs_of_procedures_have_identifiers_of_their_own() {
        let plan = |id: &str| {
            let legs = r#"<IF id="a" fix="A"/><TF id="b" fix="B"/><call id="c" procedure="p"/>"#;
            let procedure =
                format!(r#"<procedures><procedure id="p"><TF id="{id}" fix="C"/></procedure></procedures>"#);
            plan_with(legs).replace("<mainPlan", &format!("{procedure}<mainPlan"))
        };
        assert_eq!(codes(&plan("x")), [""; 0]);
        for taken in ["a", "way", "A"] {
            assert_eq!(codes(&plan(taken)), ["duplicate-id"], "{taken}");
            fixed(&plan(taken), "duplicate-id");
        }
    }

    #[test]
    fn variable_names_are_words_of_the_language() {
        for (name, bad) in [
            ("x", false),
            ("fire_radius", false),
            ("a-b", true),
            ("1a", true),
            ("altitude", true),
            ("true", true),
        ] {
            let variables = format!(r#"<variable name="{name}" type="bool" initial="true"/>"#);
            let stages = r#"<stage id="s" type="en-route" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/></stage>"#;
            let found = codes(&document_with(&variables, stages, "")).contains(&"bad-id");
            assert_eq!(found, bad, "{name}");
        }
    }
}
