//! `bad-id`: an identifier is missing or has a character that it may not have; `duplicate-id`: it is there twice.

use super::Inspection;
use crate::{Edit, Id, LegKind, Problem, expression};
use std::collections::HashSet;

/// Longest identifier, bytes.
const LONGEST: usize = 64;
/// Most numbers that are tried for a free identifier.
const MOST_NUMBERS: usize = 1000;
/// Most identifiers for which another one is looked for.
const MOST_RENAMED: usize = 64;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let plan = view.plan;
    let ids = plan.fixes.iter().map(|f| &f.id).chain(plan.runways.iter().map(|r| &r.id));
    let ids = ids.chain(plan.zones.iter().map(|z| &z.id));
    let ids = ids.chain(plan.procedures.iter().map(|p| &p.id));
    let ids = ids.chain(plan.emergency_plans.iter().map(|e| &e.id));
    let ids = ids.chain(plan.all_stages().map(|(_, s)| &s.id));
    unique(ids.chain(view.steps.iter().map(|s| &s.context.leg.id)), problems);
    unique(plan.variables.iter().map(|v| &v.name), problems);
    plan.variables.iter().for_each(|v| variable_name(&v.name, problems));
    for step in &view.steps {
        if let LegKind::Intersection { branches, .. } = &step.context.leg.kind {
            unique(branches.iter().map(|b| &b.id), problems);
        }
    }
}

fn unique<'a>(ids: impl Iterator<Item = &'a Id>, problems: &mut Vec<Problem>) {
    let mut seen = HashSet::new();
    let mut twice = Vec::new();
    for id in ids {
        if !is_identifier(id.as_str()) {
            let message = format!(
                "give this an id of 1 to {LONGEST} letters, digits, `-`, `_` or `.`, not \"{}\"",
                id.as_str().escape_debug()
            );
            problems.push(Problem::error("bad-id", message).of(id));
        }
        if !seen.insert(id) {
            twice.push(id);
        }
    }
    for (index, id) in twice.into_iter().enumerate() {
        let message = format!("rename one of those that are called `{id}`");
        let free = || free(id, |other| seen.contains(other));
        let free = (index < MOST_RENAMED).then(free).flatten();
        let fix = free.map(|to| Edit::Distinguish { id: id.clone(), to });
        problems.push(Problem::error("duplicate-id", message).of(id).perhaps_fixed_by(fix));
    }
}

/// An identifier that nobody has, made of one that somebody has. Variables may not have a `-`.
fn free(id: &Id, taken: impl Fn(&Id) -> bool) -> Option<Id> {
    let numbered = |n: usize| Id::new(&format!("{id}_{n}"));
    (2..MOST_NUMBERS).map(numbered).find(|id| !taken(id)).filter(|id| is_identifier(id.as_str()))
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
    use crate::checks::testing::{check_legs, codes, document_with, fixed_legs};

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
    fn the_last_of_several_is_renamed() {
        fixed_legs(&[
            (r#"<IF id="a" fix="A"/><TF id="a" fix="B"/>"#, "duplicate-id"),
            (r#"<IF id="way" fix="A"/><TF id="b" fix="B"/>"#, "duplicate-id"),
        ]);
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
