//! Search by a few letters: `svas` finds `Save as…`.

/// How well a text answers a query, more is better; `None` if it doesn't. Its letters must be in the text in their
/// order; those that begin a word or follow the letter before count more. Spaces of the query mean nothing.
pub fn score(query: &str, text: &str) -> Option<i32> {
    let text: Vec<char> = text.to_lowercase().chars().collect();
    let letters: Vec<char> = query.to_lowercase().chars().filter(|c| !c.is_whitespace()).collect();
    if let Some(exact) = words(&text, &letters) {
        return Some(exact);
    }
    let (mut score, mut at, mut last) = (0, 0, None);
    for letter in letters {
        let found = at + text.get(at..)?.iter().position(|c| *c == letter)?;
        let begins = starts_word(&text, found);
        let follows = last.is_some_and(|last| last + 1 == found);
        score += 1 + i32::from(follows) * 4 + i32::from(begins) * 3;
        (at, last) = (found + 1, Some(found));
    }
    Some(score)
}

/// The score of a text in which the letters are side by side: better than any in which they are scattered.
fn words(text: &[char], letters: &[char]) -> Option<i32> {
    if letters.is_empty() {
        return Some(0);
    }
    let joined: Vec<(usize, char)> =
        text.iter().copied().enumerate().filter(|(_, c)| !c.is_whitespace()).collect();
    let matches = joined.windows(letters.len()).filter(|window| window.iter().map(|(_, c)| c).eq(letters));
    let best = matches.map(|window| window.first().is_some_and(|(at, _)| starts_word(text, *at))).max()?;
    Some(1000 + i32::from(best) * 1000 - text.len() as i32)
}

fn starts_word(text: &[char], at: usize) -> bool {
    at == 0 || text.get(at - 1).is_some_and(|before| !before.is_alphanumeric())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
            let mut found: Vec<(i32, &str)> =
                texts.iter().filter_map(|text| Some((-score(query, text)?, *text))).collect();
            found.sort_by_key(|(score, _)| *score);
            assert_eq!(found.into_iter().map(|(_, text)| text).collect::<Vec<_>>(), expected, "{query}");
        }
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
