//! Lines on standard output and standard error, fit to be read: names from a file can't steer the terminal.

/// `println!` that gives an error where the line can't be written; a reader that has gone away (`legwork expand PLAN | head`) is
/// no failure.
macro_rules! say {
    ($($line:tt)*) => { stdio::line(format_args!("{}", flight_plan::legible(&format!($($line)*)))) };
}

/// `eprintln!` of what may hold anybody's words.
macro_rules! complain {
    ($($line:tt)*) => { eprintln!("{}", flight_plan::legible(&format!($($line)*))) };
}

/// A JSON document; what can't be seen in its texts is written as JSON escapes.
pub fn json(value: &serde_json::Value) -> String {
    seen(&format!("{value:#}"))
}

/// [`json`] in one line.
pub fn json_line(value: &serde_json::Value) -> String {
    seen(&value.to_string())
}

fn seen(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '\n' => out.push('\n'),
            // only texts have them, so that an escape is allowed
            unseen if flight_plan::legible::is_unseen(unseen) => {
                let units = unseen.encode_utf16(&mut [0; 2]).to_vec();
                out.extend(units.iter().map(|unit| format!("\\u{unit:04x}")));
            }
            plain => out.push(plain),
        }
    }
    out
}

/// [`json`] on standard output.
///
/// # Errors
/// It can't be written.
pub fn document(value: &serde_json::Value) -> std::io::Result<()> {
    stdio::line(format_args!("{}", json(value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn document_keeps_its_content_and_shows_nothing_that_can_not_be_seen() {
        let value = serde_json::json!({"a\u{202e}": ["b\u{9b}\u{e0001}\n", 1.5]});
        let text = json(&value);
        assert!(!json_line(&value).chars().any(flight_plan::legible::is_unseen));
        assert!(!text.chars().any(|c| c != '\n' && flight_plan::legible::is_unseen(c)), "{text:?}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
