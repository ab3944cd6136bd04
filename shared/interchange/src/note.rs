//! What was assumed, and what could not be carried over.

use flight_plan::legible;
use serde::Serialize;
use std::collections::BTreeMap;

/// Most notes that are listed one by one; what comes after them is counted.
const MOST: usize = 2000;

/// Something that somebody who relies on a conversion should know.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Note {
    /// Short and stable, for programs and tests: `command-not-carried`, `flattened`, …
    pub code: &'static str,
    /// Where in the source: `line 7`, `item 4`, `placemark Camp`, a leg's identifier.
    pub place: String,
    /// For people: what became of it.
    pub message: String,
}

impl std::fmt::Display for Note {
    /// `place: [code] message`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: [{}] {}", self.place, self.code, self.message)
    }
}

/// Collects notes: those that say the same of many places become one.
#[derive(Debug, Default)]
pub struct Notes {
    list: Vec<Note>,
    /// Index and number of what was said with [`Notes::again`].
    repeated: BTreeMap<(&'static str, String), (usize, usize)>,
    beyond: usize,
}

impl Notes {
    /// One more.
    pub fn push(&mut self, code: &'static str, place: impl Into<String>, message: impl Into<String>) {
        if self.list.len() < MOST {
            let (place, message) = (place.into(), message.into());
            let place = legible(&place).into_owned();
            self.list.push(Note { code, place, message: legible(&message).into_owned() });
        } else {
            self.beyond += 1;
        }
    }

    /// One more, or another time what was said before.
    pub fn again(&mut self, code: &'static str, place: impl Into<String>, message: &str) {
        let index = self.list.len();
        let said = self.repeated.entry((code, message.to_owned())).or_insert((index, 0));
        said.1 += 1;
        if said.1 == 1 {
            self.push(code, place, message);
        }
    }

    /// The list.
    pub fn into_vec(mut self) -> Vec<Note> {
        for ((code, _), (index, times)) in self.repeated {
            if let Some(note) = self.list.get_mut(index).filter(|n| n.code == code && times > 1) {
                note.message += &format!(" ({times} times, here first)");
            }
        }
        if self.beyond > 0 {
            let message = format!("{} more notes are not listed", self.beyond);
            self.list.push(Note { code: "more-notes", place: "file".into(), message });
        }
        self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_of_many_places_is_said_once() {
        let mut notes = Notes::default();
        notes.again("a", "line 1", "lost");
        notes.push("b", "line 2", "kept");
        (0..9).for_each(|n| notes.again("a", format!("line {n}"), "lost"));
        let list = notes.into_vec();
        assert_eq!(list.len(), 2);
        assert_eq!(list[0].to_string(), "line 1: [a] lost (10 times, here first)");
    }

    #[test]
    fn a_flood_of_notes_is_counted() {
        let mut notes = Notes::default();
        (0..MOST + 5).for_each(|n| notes.push("a", format!("{n}"), "x"));
        let list = notes.into_vec();
        assert_eq!((list.len(), list[MOST].message.as_str()), (MOST + 1, "5 more notes are not listed"));
    }
}
