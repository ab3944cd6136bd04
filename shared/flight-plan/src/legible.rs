//! Text for people that holds what anybody may have written: nothing in it can steer a terminal, change the order of what is
//! read, or flood the line. Every message goes through [`legible`].

use std::borrow::Cow;
use std::fmt::Write;

/// More digits than a number of ours can have are never printed.
pub const MAX_DIGITS: usize = 17;
/// Digits that remain of such a number.
const KEPT_DIGITS: usize = 6;

/// The text as it may be shown: characters that can't be seen or that move others are written as escapes (`\n`, `\u{202e}`), and a
/// number of more than [`MAX_DIGITS`] digits in short (`-5.93320e20`). What is fit to be shown is not copied.
pub fn legible(text: &str) -> Cow<'_, str> {
    match has_long_number(text) || text.chars().any(is_unseen) {
        true => Cow::Owned(escaped(&with_short_numbers(text))),
        false => Cow::Borrowed(text),
    }
}

/// It controls the terminal, can't be seen, or changes the direction or the place of other characters.
pub fn is_unseen(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(character, '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        let written = match character {
            '\n' | '\r' | '\t' => write!(out, "{}", character.escape_default()),
            unseen if is_unseen(unseen) => write!(out, "{}", unseen.escape_unicode()),
            plain => write!(out, "{plain}"),
        };
        debug_assert!(written.is_ok(), "a text takes everything");
    }
    out
}

fn has_long_number(text: &str) -> bool {
    text.split(|c: char| !is_of_number(c)).any(|run| digits(run) > MAX_DIGITS)
}

/// A run of digits and points that belongs to no word, path or identifier is a number.
fn with_short_numbers(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let (mut rest, mut before) = (text, None);
    while let Some(start) = rest.find(is_of_number) {
        let (plain, from) = rest.split_at(start);
        let (run, after) = from.split_at(from.find(|c| !is_of_number(c)).unwrap_or(from.len()));
        let number = run.trim_end_matches('.');
        let within =
            plain.chars().next_back().or(before).is_some_and(is_of_word) || after.starts_with(is_of_word);
        out.push_str(plain);
        match number.parse::<f64>() {
            Ok(value) if !within && digits(number) > MAX_DIGITS => {
                out.push_str(&short(value));
                out.push_str(&run[number.len()..]);
            }
            _ => out.push_str(run),
        }
        before = run.chars().next_back();
        rest = after;
    }
    out + rest
}

fn short(value: f64) -> String {
    format!("{value:.digits$e}", digits = KEPT_DIGITS - 1)
}

fn digits(run: &str) -> usize {
    run.bytes().filter(u8::is_ascii_digit).count()
}

fn is_of_number(c: char) -> bool {
    c.is_ascii_digit() || c == '.'
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '/' | '\\')
}

/// Two numbers with as many decimals, one or more, as it takes to see that they differ.
pub fn told_apart(a: f64, b: f64) -> (String, String) {
    /// More say nothing of an aircraft.
    const MOST: usize = 6;
    let shown = |decimals: usize| (format!("{a:.decimals$}"), format!("{b:.decimals$}"));
    let differ = (1..MOST).map(shown).find(|(a, b)| a != b);
    differ.unwrap_or_else(|| shown(MOST))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_fit_to_be_shown_stays_as_it_is() {
        for text in
            ["", "leg a: 1.5 km", "Zürich – Genève, 36.327322 −84.159836", "0.1234567890123456", "e2e 1e300"]
        {
            assert!(matches!(legible(text), Cow::Borrowed(_)), "{text}");
        }
        // an identifier and a path are no numbers
        for text in ["DSC_20261123080000123456 is there", "/tmp/20261123080000123456.xml"] {
            assert_eq!(legible(text), text);
        }
    }

    #[test]
    fn what_steers_the_reader_is_written_out() {
        assert_eq!(legible("a\u{202e}b\u{1b}[2Jc\nd\u{85}"), "a\\u{202e}b\\u{1b}[2Jc\\nd\\u{85}");
    }

    #[test]
    fn endless_numbers_are_short() {
        assert_eq!(legible("-593320254080585800000 m is too low."), "-5.93320e20 m is too low.");
        assert_eq!(legible("needs 0.000000012345678901234 m."), "needs 1.23457e-8 m.");
        assert_eq!(legible(&format!("at most {:.0}", 1e300)), "at most 1.00000e300");
        assert_eq!(legible(&format!("{:.1}, {:.3}", f64::MAX, -1e40)), "1.79769e308, -1.00000e40");
    }

    proptest! {
        #[test]
        fn whatever_is_written_is_legible(text in "\\PC{0,40}|(?s:.){0,60}", x in any::<f64>()) {
            let shown = legible(&format!("{text} {x} m, {x:.3}")).into_owned();
            prop_assert!(!shown.chars().any(is_unseen), "{shown:?}");
            prop_assert_eq!(&*legible(&shown), &shown, "once is enough");
            let own = legible(&format!("{x} {x:.1}")).into_owned();
            prop_assert!(own.split(|c: char| !is_of_number(c)).all(|run| digits(run) <= MAX_DIGITS), "{}", own);
        }
    }

    #[test]
    fn numbers_that_differ_are_seen_to_differ() {
        let told = |a, b| told_apart(a, b);
        assert_eq!(told(4.04, 4.0), ("4.04".into(), "4.00".into()));
        assert_eq!(told(7.25, 4.0), ("7.2".into(), "4.0".into()));
        assert_eq!(told(4.0, 4.0).0, "4.000000");
    }
}
