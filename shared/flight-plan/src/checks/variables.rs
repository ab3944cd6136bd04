//! `variable-bounds`: bounds that exclude each other, or an initial value outside of them; `bad-writer`: somebody who may
//! write it has a name that no service can have.

use super::Inspection;
use crate::{Edit, Problem, Thing, Variable, VariableValue};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for variable in &view.plan.variables {
        bounds(variable, problems);
        for writer in variable.writers.iter().filter(|w| !is_service(w.as_str())) {
            let name = writer.as_str().escape_debug();
            let message =
                format!("no service is called \"{name}\": use letters, digits, `-` and `_`, or `operator`");
            let fix = replaced(variable, |v| v.writers.retain(|w| is_service(w.as_str())));
            problems.push(Problem::error("bad-writer", message).of(&variable.name).fixed_by(fix));
        }
    }
}

fn bounds(variable: &Variable, problems: &mut Vec<Problem>) {
    let mut report = |message: String, fix: Option<Edit>| {
        let problem = Problem::error("variable-bounds", message).of(&variable.name);
        problems.push(problem.perhaps_fixed_by(fix));
    };
    let number = matches!(variable.initial, VariableValue::Number(_));
    let (min, max) = (variable.min, variable.max);
    if !number && (min.is_some() || max.is_some()) {
        let without = replaced(variable, |v| (v.min, v.max) = (None, None));
        report("remove `min` and `max`: only numbers have bounds".into(), Some(without));
    }
    if min.into_iter().chain(max).any(|bound| !bound.is_finite()) {
        report("write the bounds as finite numbers, or leave them out".into(), None);
    } else if min.zip(max).is_some_and(|(min, max)| min > max) {
        let swapped = replaced(variable, |v| (v.min, v.max) = (max, min));
        report("make `min` smaller than `max`".into(), Some(swapped).filter(|_| number));
    } else if let Err(error) = variable.accepts(&variable.initial) {
        report(format!("correct the initial value or the bounds: {error}"), within(variable));
    }
}

/// The nearest initial value that the bounds allow.
fn within(variable: &Variable) -> Option<Edit> {
    let initial = match &variable.initial {
        VariableValue::Number(x) if x.is_finite() => {
            let low = variable.min.unwrap_or(f64::MIN);
            VariableValue::Number(x.clamp(low, variable.max.unwrap_or(f64::MAX).max(low)))
        }
        VariableValue::Text(text) => VariableValue::Text(text.chars().take(variable.text_limit()).collect()),
        _ => return None,
    };
    Some(replaced(variable, |v| v.initial = initial))
}

fn replaced(variable: &Variable, change: impl FnOnce(&mut Variable)) -> Edit {
    let mut with = variable.clone();
    change(&mut with);
    Edit::Replace { id: variable.name.clone(), with: Box::new(Thing::Variable(with)) }
}

/// A name that is one word of a key of the contract.
fn is_service(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_'))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document_with, fixed};

    #[test]
    fn bounds_and_initial_values_agree() {
        let cases = [
            (r#"type="number" initial="5" min="0" max="10""#, false),
            (r#"type="number" initial="-1" min="0" max="10""#, true),
            (r#"type="number" initial="5" min="9" max="1""#, true),
            (r#"type="text" initial="abc" maxLength="3""#, false),
            (r#"type="text" initial="abcd" maxLength="3""#, true),
            (r#"type="bool" initial="true" min="0""#, true),
        ];
        for (variable, bad) in cases {
            let document = document_with(&format!(r#"<variable name="x" {variable}/>"#), "", "");
            let found = codes(&document).contains(&"variable-bounds");
            assert_eq!(found, bad, "{variable}");
            if bad {
                fixed(&document, "variable-bounds");
            }
        }
    }

    #[test]
    fn a_polygon_is_simple() {
        let ring = |corners: &str| {
            document_with(&format!(r#"<variable name="x" type="polygon" initial="{corners}"/>"#), "", "")
        };
        let bad = |corners: &str| codes(&ring(corners)).contains(&"variable-bounds");
        assert!(!bad("36.3 -84.2, 36.31 -84.2, 36.31 -84.19"));
        assert!(bad("36.3 -84.2, 36.31 -84.19, 36.31 -84.2, 36.3 -84.19"));
    }

    #[test]
    fn writers_are_services() {
        let with = |writers: &str| {
            let variable = format!(r#"<variable name="x" type="bool" initial="true" writers="{writers}"/>"#);
            document_with(&variable, "", "")
        };
        let bad = |writers: &str| codes(&with(writers)).contains(&"bad-writer");
        assert!(!bad("camera operator fire-watch_2"));
        assert!(bad("camera fire.watch"));
        fixed(&with("camera fire.watch"), "bad-writer");
    }
}
