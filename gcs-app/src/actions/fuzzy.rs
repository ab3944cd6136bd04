//! Search by a few letters: `svas` finds `Save as…`.

/// How well a text answers a query; the better, the greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Score {
    /// The letters are side by side: better than any text in which they are scattered.
    pub is_whole: bool,
    points: i32,
}

impl Score {
    /// Of a word that is another one for what is meant.
    pub fn of_another(self) -> Self {
        Self { points: self.points - 500, ..self }
    }
}

/// How well a text answers a query; `None` if it doesn't. Its letters must be in the text in their order; those that begin a word
/// or follow the letter before count more. Spaces of the query mean nothing.
pub fn score(query: &str, text: &str) -> Option<Score> {
    if let Some(whole) = words(query, text) {
        return Some(whole);
    }
    let (text, letters) = (lower(text), letters(query));
    let (mut points, mut at, mut last) = (0, 0, None);
    for letter in letters {
        let found = at + text.get(at..)?.iter().position(|c| *c == letter)?;
        let begins = starts_word(&text, found);
        let follows = last.is_some_and(|last| last + 1 == found);
        points += 1 + i32::from(follows) * 4 + i32::from(begins) * 3;
        (at, last) = (found + 1, Some(found));
    }
    Some(Score { is_whole: false, points })
}

/// As [`score`], of a name in a group: one that begins with the query, or has it as a whole word, comes before one that only the
/// group answers for.
pub fn score_named(query: &str, group: &str, name: &str) -> Option<Score> {
    let score = score(query, &format!("{group} {name}"))?;
    let (sought, name) = (query.trim().to_lowercase(), name.to_lowercase());
    let mut words = name.split(|c: char| !c.is_alphanumeric());
    let is_its_own = !sought.is_empty() && (name.starts_with(&sought) || words.any(|word| word == sought));
    Some(Score { points: score.points + if is_its_own { 1000 } else { 0 }, ..score })
}

/// As [`score`], where the letters are side by side.
pub fn words(query: &str, text: &str) -> Option<Score> {
    let (text, letters) = (lower(text), letters(query));
    if letters.is_empty() {
        return Some(Score { is_whole: true, points: 0 });
    }
    let joined: Vec<(usize, char)> =
        text.iter().copied().enumerate().filter(|(_, c)| !c.is_whitespace()).collect();
    let matches = joined.windows(letters.len()).filter(|window| window.iter().map(|(_, c)| c).eq(&letters));
    let best = matches.map(|window| window.first().is_some_and(|(at, _)| starts_word(&text, *at))).max()?;
    Some(Score { is_whole: true, points: i32::from(best) * 1000 - text.len() as i32 })
}

fn lower(text: &str) -> Vec<char> {
    text.to_lowercase().chars().collect()
}

fn letters(query: &str) -> Vec<char> {
    lower(query).into_iter().filter(|c| !c.is_whitespace()).collect()
}

fn starts_word(text: &[char], at: usize) -> bool {
    at == 0 || text.get(at - 1).is_some_and(|before| !before.is_alphanumeric())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cmp::Reverse;

    #[test]
    fn whole_words_are_better_than_parts_and_parts_better_than_letters() {
        let texts =
            ["File Save", "File Save as…", "View Show the whole plan", "Edit unsaved", "Flight Resume"];
        for (query, expected) in [
            ("save", vec!["File Save", "File Save as…", "Edit unsaved"]),
            ("svas", vec!["File Save as…"]),
            ("whole pl", vec!["View Show the whole plan"]),
            ("xyz", vec![]),
        ] {
            let mut found: Vec<(Reverse<Score>, &str)> =
                texts.iter().filter_map(|text| Some((Reverse(score(query, text)?), *text))).collect();
            found.sort_by_key(|(score, _)| *score);
            assert_eq!(found.into_iter().map(|(_, text)| text).collect::<Vec<_>>(), expected, "{query}");
        }
    }

    #[test]
    fn a_name_answers_before_the_group_that_it_is_in() {
        let mut found =
            [("Maps", "Graticule"), ("Maps", "Maps and elevations…"), ("Edit", "Redraw the maps")];
        found.sort_by_key(|(group, name)| Reverse(score_named("maps", group, name)));
        assert_eq!(found.map(|(_, name)| name), ["Redraw the maps", "Maps and elevations…", "Graticule"]);
        assert_eq!(score_named("maps", "Edit", "Undo"), None);
    }

    proptest! {
        #[test]
        fn any_subsequence_is_found_and_other_letters_are_not(
            text in "[a-zÄ ]{1,30}", keep in prop::collection::vec(any::<bool>(), 30)
        ) {
            let query: String = text.chars().zip(&keep).filter(|(_, keep)| **keep).map(|(c, _)| c).collect();
            prop_assert!(score(&query, &text).is_some());
            prop_assert_eq!(score(&format!("{query}7"), &text), None);
        }
    }
}
