//! Problems as they stand in a text of another program, for people.

/// A text in which problems stand as they are displayed (`35:7: error [too-steep] o2: climb earlier`), without what is for
/// programs: severity, code and place. Their subjects are quoted as identifiers are elsewhere: `` `o2`: climb earlier ``.
pub fn in_words(text: &str) -> String {
    let mut told = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(head) = heads(rest).min_by_key(|head| head.before.len()) {
        told.push_str(head.before);
        if let Some(subject) = head.subject {
            told.extend(["`", subject, "`: "]);
        }
        rest = head.message;
    }
    told.push_str(rest);
    told
}

/// What stands before a message.
struct Head<'a> {
    /// Before the problem.
    before: &'a str,
    subject: Option<&'a str>,
    /// The message, and what stands behind it.
    message: &'a str,
}

/// The first problem of each severity.
fn heads(text: &str) -> impl Iterator<Item = Head<'_>> {
    let of = |severity| text.match_indices(severity).find_map(|(at, _)| head(text, at, severity));
    ["error [", "warning ["].into_iter().filter_map(of)
}

fn head<'a>(text: &'a str, at: usize, severity: &str) -> Option<Head<'a>> {
    let before = text.get(..at).filter(|before| before.is_empty() || before.ends_with(' '))?;
    let (code, rest) = text.get(at + severity.len()..)?.split_once("] ")?;
    if code.is_empty() || !code.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-') {
        return None;
    }
    let (subject, message) = match rest.split_once(": ") {
        Some((subject, message)) if is_id(subject) => (Some(subject), message),
        _ => (None, rest),
    };
    Some(Head { before: without_place(before), subject, message })
}

fn is_id(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_.".contains(&b))
}

/// Without the `35:7: ` at its end.
fn without_place(before: &str) -> &str {
    let place = || {
        let rest = before.strip_suffix(": ")?;
        let rest = rest.trim_end_matches(|c: char| c.is_ascii_digit()).strip_suffix(':')?;
        Some(rest.trim_end_matches(|c: char| c.is_ascii_digit()))
    };
    place().filter(|rest| rest.is_empty() || rest.ends_with(' ')).unwrap_or(before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Location, Problem};

    #[test]
    fn what_is_for_programs_is_left_out_wherever_a_problem_stands() {
        for (text, told) in [
            (
                "35:7: error [too-steep] o2: climb earlier: it is 20 % too steep; error [energy] land it; and 3 more",
                "`o2`: climb earlier: it is 20 % too steep; land it; and 3 more",
            ),
            (
                "Propose plan: refused, 5:1: warning [low-clearance] west.up: fly higher",
                "Propose plan: refused, `west.up`: fly higher",
            ),
            ("the flight is over; propose it again", "the flight is over; propose it again"),
            ("no [brackets] here: none", "no [brackets] here: none"),
            ("terror [of] the error [ ] none", "terror [of] the error [ ] none"),
            ("at 12: error [a] b", "at 12: b"),
        ] {
            assert_eq!(in_words(text), told);
        }
    }

    #[test]
    fn every_problem_is_told_as_its_subject_and_message() {
        let plain = Problem::warning("glide-out-of-reach", "turn back earlier");
        let of_leg = plain.clone().of(&"a_1.b-2".into());
        let placed = of_leg.clone().at(Location { line: 12, column: 3 });
        for (problem, told) in [
            (plain, "turn back earlier"),
            (of_leg, "`a_1.b-2`: turn back earlier"),
            (placed, "`a_1.b-2`: turn back earlier"),
        ] {
            assert_eq!(in_words(&problem.to_string()), told);
        }
    }
}
