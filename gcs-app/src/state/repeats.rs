//! Events that are received again. A new link begins with what the publisher still remembers: what was
//! received over the last one must not be logged twice.

use std::collections::{BTreeSet, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Events remembered: more than a publisher does.
const CAPACITY: usize = 4096;
/// A source whose clock went back further than this began anew, seconds.
const RESTARTED_S: f64 = 5.0;

/// One event: its number, its time and its text. Two events that agree in all of them look the same
/// to the reader of the log as well.
type Key = (u32, u64, u64);

/// What was received of one stream of events.
#[derive(Debug, Default)]
pub struct Repeats {
    seen: BTreeSet<Key>,
    order: VecDeque<Key>,
    /// Received over links that are closed: only these can come again.
    earlier: BTreeSet<Key>,
    latest_s: Option<f64>,
}

impl Repeats {
    /// What comes from now on may repeat what was received until now.
    pub fn begin_link(&mut self) {
        self.earlier.clone_from(&self.seen);
    }

    /// Notes an event; false if an earlier link brought it already.
    pub fn is_new(&mut self, sequence: u32, time_s: f64, text: &str) -> bool {
        let key = (sequence, time_s.to_bits(), hash(text));
        if self.earlier.contains(&key) {
            return false;
        }
        if self.latest_s.is_some_and(|latest| time_s < latest - RESTARTED_S) {
            // another flight: nothing of it was received before
            *self = Self::default();
        }
        self.latest_s = Some(time_s);
        self.remember(key);
        true
    }

    fn remember(&mut self, key: Key) {
        if !self.seen.insert(key) {
            return;
        }
        self.order.push_back(key);
        if self.order.len() > CAPACITY
            && let Some(oldest) = self.order.pop_front()
        {
            self.seen.remove(&oldest);
        }
    }
}

fn hash(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_new_link_repeats_is_not_new() {
        let mut repeats = Repeats::default();
        let flight = [(0, 1.0, "take-off"), (1, 9.0, "leg a"), (2, 30.0, "leg b")];
        let mut receive = |events: &[(u32, f64, &str)], again: bool| -> Vec<bool> {
            if again {
                repeats.begin_link();
            }
            events.iter().map(|(n, t, text)| repeats.is_new(*n, *t, text)).collect()
        };
        assert_eq!(receive(&flight, false), [true; 3]);
        assert_eq!(receive(&flight, true), [false; 3]);
        assert_eq!(receive(&[(3, 40.0, "leg c")], false), [true]);
        assert_eq!(receive(&flight, true), [false; 3], "a third time");
        // another flight of the same vehicle counts from the beginning
        assert_eq!(receive(&[(0, 1.5, "take-off"), (1, 9.5, "leg a")], true), [true; 2]);
    }

    #[test]
    fn one_link_may_say_the_same_twice() {
        let mut repeats = Repeats::default();
        assert!(repeats.is_new(0, 1.0, "again") && repeats.is_new(0, 1.0, "again"));
    }

    #[test]
    fn memory_is_bounded() {
        let mut repeats = Repeats::default();
        for i in 0..20_000 {
            repeats.is_new(i, f64::from(i), "x");
        }
        repeats.begin_link();
        assert_eq!(
            (repeats.order.len(), repeats.seen.len(), repeats.earlier.len()),
            (CAPACITY, CAPACITY, CAPACITY)
        );
    }
}
