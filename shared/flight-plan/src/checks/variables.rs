//! `variable-bounds`: bounds that exclude each other, or an initial value outside of them.

use super::Inspection;
use crate::{Problem, VariableValue};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for variable in &view.plan.variables {
        let mut report =
            |message: String| problems.push(Problem::error("variable-bounds", message).of(&variable.name));
        let number = matches!(variable.initial, VariableValue::Number(_));
        if !number && (variable.min.is_some() || variable.max.is_some()) {
            report("remove `min` and `max`: only numbers have bounds".into());
        }
        if variable.min.zip(variable.max).is_some_and(|(min, max)| min > max) {
            report("make `min` smaller than `max`".into());
        } else if let Err(error) = variable.accepts(&variable.initial) {
            report(format!("correct the initial value or the bounds: {error}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document_with};

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
            let variables = format!(r#"<variable name="x" {variable}/>"#);
            let found = codes(&document_with(&variables, "", "")).contains(&"variable-bounds");
            assert_eq!(found, bad, "{variable}");
        }
    }
}
