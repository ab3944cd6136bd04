//! What somebody meant who misspelt a name.

use crate::{FlightPlan, Id};

/// Most names that are compared with a misspelt one.
const MAX_CANDIDATES: usize = 10_000;
/// Longest name that is compared, bytes.
const LONGEST: usize = 64;
/// One slip for so many letters, up to [`MAX_SLIPS`].
const LETTERS_A_SLIP: usize = 3;
const MAX_SLIPS: usize = 2;

/// The one name that is spelt nearly like `wanted`: a slip for three letters, two at most; `None` if there is no such
/// one, or if several are equally near.
pub fn meant<'a>(wanted: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = (wanted.len() / LETTERS_A_SLIP).min(MAX_SLIPS);
    let mut best: Option<(usize, &str)> = None;
    let mut alone = true;
    for name in known.take(MAX_CANDIDATES) {
        let Some(slips) = slips(wanted, name).filter(|n| *n <= allowed) else { continue };
        match best {
            Some((least, other)) if slips > least || name == other => {}
            Some((least, _)) if slips == least => alone = false,
            _ => (best, alone) = (Some((slips, name)), true),
        }
    }
    best.filter(|_| alone).map(|(_, name)| name)
}

/// The question behind a sentence about a name that nobody knows; nothing if no other one is near.
pub fn did_you_mean<'a>(wanted: &str, known: impl Iterator<Item = &'a str>) -> String {
    meant(wanted, known).map_or_else(String::new, question)
}

/// As [`did_you_mean`], about a leg or stage that a plan doesn't have: of those that fit.
pub fn did_you_mean_leg(plan: &FlightPlan, wanted: &Id, fits: impl Fn(&Id) -> bool) -> String {
    let legs = plan.all_legs();
    let ids = plan.all_stages().map(|(_, stage)| &stage.id).chain(legs.iter().map(|context| &context.leg.id));
    did_you_mean(wanted.as_str(), ids.filter(|id| fits(id)).map(Id::as_str))
}

/// Whether this one was meant.
pub fn question(name: &str) -> String {
    format!("; did you mean `{name}`?")
}

/// Letters to insert, remove, change, or swap with the next one (optimal string alignment: Damerau 1964, Levenshtein 1966); `None`
/// if that is surely too many.
fn slips(a: &str, b: &str) -> Option<usize> {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len().abs_diff(b.len()) > MAX_SLIPS || a.len().max(b.len()) > LONGEST {
        return None;
    }
    let (mut two_above, mut above): (Vec<usize>, Vec<usize>) = (Vec::new(), (0..=b.len()).collect());
    for (i, x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, y) in b.iter().enumerate() {
            let before =
                |letters: &[u8], at: usize| at.checked_sub(1).and_then(|at| letters.get(at).copied());
            let is_swap = before(a, i) == Some(*y) && before(b, j) == Some(*x);
            let swapped = j.checked_sub(1).filter(|_| is_swap).and_then(|j| two_above.get(j));
            let other = (above.get(j)? + usize::from(x != y)).min(row.last()? + 1).min(above.get(j + 1)? + 1);
            row.push(swapped.map_or(other, |slips| other.min(slips + 1)));
        }
        two_above = std::mem::replace(&mut above, row);
    }
    above.last().copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_only_near_spelling_is_meant() {
        let known = ["COVE", "RIDGE1", "RIDGE2", "north-strip", "A"];
        let cases = [
            ("COVA", Some("COVE")),
            ("CAVA", None),
            ("CVOE", Some("COVE")),
            ("COVES", Some("COVE")),
            ("norht-strip", Some("north-strip")),
            ("RIDGE3", None),
            ("RIDGE11", Some("RIDGE1")),
            ("B", None),
            ("", None),
        ];
        for (wanted, expected) in cases {
            let found = meant(wanted, known.into_iter());
            assert_eq!(found, expected, "{wanted}");
        }
    }

    #[test]
    fn the_question_is_asked_where_something_is_near() {
        let known = || ["trainer", "foam-wing"].into_iter();
        assert_eq!(did_you_mean("trainr", known()), "; did you mean `trainer`?");
        assert_eq!(did_you_mean("glider", known()), "");
    }

    #[test]
    fn slips_are_counted_as_everybody_counts_them() {
        for (a, b, n) in
            [("kitten", "sitting", 3), ("", "ab", 2), ("ab", "ab", 0), ("ab", "ba", 1), ("ca", "abc", 3)]
        {
            assert_eq!(slips(a, b), Some(n), "{a} {b}");
        }
        assert_eq!(slips("a", "abcd"), None);
    }
}
