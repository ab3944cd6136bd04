//! Names and whole numbers in CEL source, found token by token: text and other numbers are left alone.

use std::borrow::Cow;
use std::cell::RefCell;

/// `source` with names and whole numbers replaced by other expressions. Members (`a.name`) and functions (`name(…)`) are no names,
/// exponents no numbers; what is put in is set in brackets unless it is one word or number or stands alone.
pub fn substitute<'a>(source: &'a str, replacement: &dyn Fn(&str) -> Option<&'a str>) -> Cow<'a, str> {
    if let Some(whole) = replacement(source.trim()) {
        return whole.into();
    }
    let mut out = String::new();
    let (mut rest, mut copied, mut after_dot, mut exponent) = (source, 0, false, Exponent::None);
    while let Some(token) = next(rest) {
        let from = source.len() - rest.len();
        rest = rest.get(token.len()..).unwrap_or("");
        let called = rest.trim_start().starts_with('(');
        let is_whole = exponent != Exponent::Sign && is_number(token) && !rest.starts_with('.');
        if !after_dot
            && (is_whole || (!called && is_word(token)))
            && let Some(new) = replacement(token)
        {
            out.push_str(source.get(copied..from).unwrap_or(""));
            push(&mut out, new);
            copied = from + token.len();
        }
        if !token.trim().is_empty() {
            after_dot = token == ".";
            exponent = exponent.after(token);
        }
    }
    if copied == 0 {
        return source.into();
    }
    out.push_str(source.get(copied..).unwrap_or(""));
    out.into()
}

/// The names and whole numbers in a source that are wanted; some perhaps again.
pub fn mentioned(source: &str, wanted: &dyn Fn(&str) -> bool) -> Vec<String> {
    let found = RefCell::new(Vec::new());
    substitute(source, &|word| {
        found.borrow_mut().extend(wanted(word).then(|| word.to_owned()));
        None
    });
    found.into_inner()
}

fn push(out: &mut String, expression: &str) {
    if expression.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'.')) {
        out.push_str(expression);
    } else {
        out.push('(');
        out.push_str(expression);
        out.push(')');
    }
}

fn is_number(token: &str) -> bool {
    token.bytes().all(|b| b.is_ascii_digit())
}

/// How much of an exponent with a sign (`1.5e-3`) has been seen: it is several tokens.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Exponent {
    None,
    Begun,
    Sign,
}

impl Exponent {
    fn after(self, token: &str) -> Self {
        let is_begun = token.starts_with(|c: char| c.is_ascii_digit()) && token.ends_with(['e', 'E']);
        match token {
            _ if is_begun => Self::Begun,
            "+" | "-" if self == Self::Begun => Self::Sign,
            _ => Self::None,
        }
    }
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && !token.ends_with(['\'', '"'])
}

/// The first token of a text: a word, a number, a string with its prefix, or one other character.
fn next(text: &str) -> Option<&str> {
    let first = text.chars().next()?;
    let while_word =
        |text: &str| text.bytes().take_while(|b| b.is_ascii_alphanumeric() || *b == b'_').count();
    let length = match first {
        '\'' | '"' => string(text, false),
        'a'..='z' | 'A'..='Z' | '_' => {
            let word = while_word(text);
            let prefix = text.get(..word).unwrap_or("").to_ascii_lowercase();
            let behind = text.get(word..).unwrap_or("");
            if matches!(prefix.as_str(), "r" | "b" | "br" | "rb") && behind.starts_with(['\'', '"']) {
                word + string(behind, prefix.contains('r'))
            } else {
                word
            }
        }
        // `1e5`, `0x1f` and `5u` are one token; the sign of an exponent may stand apart from it, it is no word
        '0'..='9' => while_word(text),
        other => other.len_utf8(),
    };
    text.get(..length)
}

/// Bytes of the string that a text begins with, quotes included; of one without an end, all of it.
fn string(text: &str, raw: bool) -> usize {
    let quote = text.get(..1).unwrap_or("");
    let triple = quote.repeat(3);
    let end = if text.starts_with(&triple) { triple.as_str() } else { quote };
    let mut at = end.len();
    while let Some(rest) = text.get(at..) {
        if rest.starts_with(end) {
            return at + end.len();
        }
        let Some(c) = rest.chars().next() else { break };
        at += c.len_utf8();
        if c == '\\' && !raw {
            at += text.get(at..).and_then(|rest| rest.chars().next()).map_or(0, char::len_utf8);
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_replaced_and_nothing_else() {
        let cases = [
            ("p", "x + 1.0"),
            (" p ", "x + 1.0"),
            ("2.0 * p", "2.0 * (x + 1.0)"),
            ("p*p", "(x + 1.0)*(x + 1.0)"),
            ("q + pp + p_", "y + pp + p_"),
            ("p(1) + a.p + a . p", "p(1) + a.p + a . p"),
            ("word == 'p' || \"it's p\" == q", "word == 'p' || \"it's p\" == y"),
            (r"'\'p' + q + r'\' + q", r"'\'p' + y + r'\' + y"),
            ("'''p ' p''' + q + b'p'", "'''p ' p''' + y + b'p'"),
            ("1e5 + 0xp + 5p + q", "1e5 + 0xp + 5p + y"),
            ("'p", "'p"),
            ("q + 3 * 30 + 3.0 + 0.3 + 3e3 + 1.5e-3 + 3", "y + 3.0 * 30 + 3.0 + 0.3 + 3e3 + 1.5e-3 + 3.0"),
            ("é + q + '漢\\", "é + y + '漢\\"),
        ];
        let replacement = |name: &str| match name {
            "p" => Some("x + 1.0"),
            "q" => Some("y"),
            "3" => Some("3.0"),
            _ => None,
        };
        for (source, expected) in cases {
            assert_eq!(substitute(source, &replacement), expected, "{source}");
        }
    }
}
