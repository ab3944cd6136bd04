//! The latest events of a stream that has no place of its own in the window.

use super::{Aged, Repeats};
use crate::link::{Numbered, Rows};
use std::collections::VecDeque;

/// Events kept of a stream.
const CAPACITY: usize = 5;

/// The latest events of a stream, the newest last.
#[derive(Debug, Default)]
pub struct RecentEvents {
    latest: VecDeque<Aged<Rows>>,
    repeats: Repeats,
}

impl RecentEvents {
    /// What comes from now on may repeat what was received until now.
    pub fn begin_link(&mut self) {
        self.repeats.begin_link();
    }

    /// Keeps an event, unless an earlier link brought it already.
    pub fn add(&mut self, event: Numbered<Rows>, now_s: f64) {
        let Numbered { sequence, event } = event;
        if !self.repeats.is_new(sequence, event.time_s, &text(&event.value)) {
            return;
        }
        if self.latest.len() >= CAPACITY {
            self.latest.pop_front();
        }
        self.latest.push_back(Aged::new(event, now_s));
    }

    /// Each with its fields on one line, the newest first.
    pub fn lines(&self) -> impl Iterator<Item = (String, &Aged<Rows>)> {
        self.latest.iter().rev().map(|event| (text(&event.value), event))
    }
}

fn text(rows: &Rows) -> String {
    let field = |(name, text): &(String, String)| {
        if name.is_empty() { text.clone() } else { format!("{name}: {text}") }
    };
    rows.iter().map(field).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use usal::contract::Stamped;

    fn photo(number: u32) -> Numbered<Rows> {
        let value = vec![("photo".into(), number.to_string()), (String::new(), "sharp".into())];
        Numbered { sequence: number, event: Stamped { time_s: f64::from(number), validity_s: 1.0, value } }
    }

    #[test]
    fn the_newest_events_are_kept_and_none_twice() {
        let mut recent = RecentEvents::default();
        (0..8).for_each(|number| recent.add(photo(number), 100.0));
        recent.begin_link();
        (5..9).for_each(|number| recent.add(photo(number), 200.0));
        let lines: Vec<String> = recent.lines().map(|(text, _)| text).collect();
        assert_eq!(lines, [8, 7, 6, 5, 4].map(|number| format!("photo: {number}, sharp")));
        assert_eq!(
            recent.lines().map(|(_, e)| e.received_s).collect::<Vec<_>>(),
            [200., 100., 100., 100., 100.]
        );
    }
}
