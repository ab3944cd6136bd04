//! Identifiers made from other programs' names.

use flight_plan::Id;
use std::collections::{HashMap, HashSet};

/// Longest identifier that the plan language knows, characters; some are kept for a number behind it.
const LONGEST: usize = 56;

/// Gives identifiers that are unique in a document.
#[derive(Debug, Default)]
pub struct Names {
    taken: HashSet<String>,
    /// Where the numbers behind a name go on, so that a thousand equal names cost no million comparisons.
    next: HashMap<String, usize>,
}

impl Names {
    /// An identifier that resembles `preferred` and was not given before; `other` where nothing of it can be used.
    pub fn take(&mut self, preferred: &str, other: &str) -> Id {
        let usable = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let clean: String = preferred.trim().chars().take(LONGEST).map(usable).collect();
        let clean = clean.trim_matches('-');
        let base = if clean.chars().any(char::is_alphanumeric) { clean } else { other };
        if self.taken.insert(base.to_owned()) {
            return Id::new(base);
        }
        let number = self.next.entry(base.to_owned()).or_insert(2);
        loop {
            let name = format!("{base}-{number}");
            *number += 1;
            if self.taken.insert(name.clone()) {
                return Id::new(&name);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cleaned_and_unique() {
        let mut names = Names::default();
        let cases = [
            ("Camp", "Camp"),
            ("Camp", "Camp-2"),
            ("Camp-2", "Camp-2-2"),
            ("Camp", "Camp-3"),
            ("Höhe 3", "H-he-3"),
            ("山", "fix"),
            ("", "fix-2"),
        ];
        for (preferred, expected) in cases {
            assert_eq!(names.take(preferred, "fix").as_str(), expected, "{preferred}");
        }
        assert!(names.take(&"x".repeat(1000), "fix").as_str().len() <= 64);
    }
}
