//! Lists of identifiers, between which there is only space, and in which there may be space, too.

use std::collections::HashSet;

/// Most words of an identifier.
const MAX_WORDS: usize = 8;

/// Words with one space between them.
pub fn spaced(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The identifiers in a list: at each word the longest that is known, else the word alone.
pub fn listed(text: &str, known: &HashSet<String>) -> Vec<String> {
    let words: Vec<&str> = text.split([' ', '\t', '\n', '\r', ',']).filter(|word| !word.is_empty()).collect();
    let mut rest = words.as_slice();
    let mut found = Vec::new();
    while let Some((word, behind)) = rest.split_first() {
        let longest = (1..=MAX_WORDS.min(rest.len())).rev().find_map(|count| {
            let (these, behind) = rest.split_at(count);
            let name = these.join(" ");
            known.contains(&name).then_some((name, behind))
        });
        let (name, behind) = longest.unwrap_or_else(|| ((*word).to_owned(), behind));
        found.push(name);
        rest = behind;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_with_spaces_are_found_whole() {
        let known = ["leg 1", "leg 1 b", "leg"].map(str::to_owned).into();
        assert_eq!(listed(" leg 1  leg 1 b\n leg other ", &known), ["leg 1", "leg 1 b", "leg", "other"]);
        assert_eq!((listed("", &known), spaced(" a \n b ")), (vec![], "a b".to_owned()));
    }
}
