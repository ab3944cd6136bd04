//! A number that could not be read: its text is kept in its place, as a text of the expression language. That is never a
//! number, so the plan is refused until somebody gives one, and nothing that was written is lost.

use crate::Value;

/// In the place of a number that is not there at all, or was written by us without one.
const NONE: &str = "NaN";

/// What is kept of a text that is no number.
pub(crate) fn kept(text: &str) -> Value<f64> {
    match text.trim() {
        "" | NONE => Value::Constant(f64::NAN),
        text => {
            let quoted = text.replace('\\', r"\\").replace('\'', r"\'");
            Value::Expression(format!("'{quoted}'").into())
        }
    }
}

/// The text that stands in the place of a number, if an expression is only that.
pub fn unread_number(source: &str) -> Option<String> {
    let inside = source.strip_prefix('\'')?.strip_suffix('\'')?;
    let mut text = String::with_capacity(inside.len());
    let mut characters = inside.chars();
    while let Some(character) = characters.next() {
        match character {
            '\'' => return None,
            '\\' => text.push(characters.next()?),
            plain => text.push(plain),
        }
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::testing::{message_of, plan_with};
    use crate::{read, write};
    use proptest::prelude::*;

    fn orbit(radius: &str) -> String {
        format!(
            r#"<IF id="a" fix="A"/><orbit id="o" radius="{radius}" turn="left"><centre fix="A"/></orbit>"#
        )
    }

    /// It was NaN: no plan with one is equal to itself, and what stood there was lost.
    #[test]
    fn what_stood_there_is_kept_and_told_with_its_name() {
        let plan = read(plan_with(&orbit("250ft"))).plan;
        assert_eq!(plan, plan.clone(), "it is equal to itself");
        let told = message_of(&orbit("250ft"), "bad-value");
        assert!(told.contains("`radius`") && told.contains("\"250ft\""), "{told}");
    }

    /// It is the same in a file that is written, and nothing of it is lost there.
    #[test]
    fn it_is_written_as_it_stood() {
        for text in ["250ft", "it's", r"1\2", "a = b", "12 m", "<&\">"] {
            let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
            let reading = read(plan_with(&orbit(&escaped)));
            assert_eq!((reading.problems.len(), reading.losses().count()), (1, 0), "{text}");
            let written = write(&reading.plan);
            assert!(!written.contains("= '"), "{written}");
            let again = read(&written);
            assert_eq!((again.plan, again.problems.len()), (reading.plan, 1), "{text}");
        }
        // what is a text to the expression language, or would be read as something else, stays a formula
        for formula in ["= '12'", "= '= 3'", "= ' x'", "= 'NaN'", "= 'a' + 'b'"] {
            assert!(write(&read(plan_with(&orbit(formula))).plan).contains(formula), "{formula}");
        }
    }

    #[test]
    fn whatever_an_expression_could_mean_is_no_number() {
        for text in ["10 + 2", "a", "it's", r"1\2", "1e999", "'"] {
            assert!(message_of(&orbit(text), "bad-value").contains("`radius`"), "{text}");
        }
        for formula in ["'a' + 'b'", "'a", "1", r"'a\'", ""] {
            assert_eq!(unread_number(formula), None, "{formula}");
        }
    }

    proptest! {
        #[test]
        fn the_text_comes_back(text in "\\PC{1,20}") {
            let text = text.trim();
            if let Value::Expression(source) = kept(text) {
                prop_assert_eq!(unread_number(&source), Some(text.to_owned()));
            }
        }
    }
}
