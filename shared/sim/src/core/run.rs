//! Walking through the mission: the active item is a copy, jumps are followed, what is done in
//! passing is done in passing.

use super::item::{Item, Kind};
use std::collections::HashMap;

/// How the mission stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Not started since it was set, or stopped before its end.
    Stopped,
    /// Being flown.
    Running,
    /// Its items ran out.
    Complete,
}

/// The place in the mission.
#[derive(Debug)]
pub struct Run {
    /// How it stands.
    pub phase: Phase,
    /// Sequence number of the item being flown, or to be flown when it starts.
    pub current: u16,
    /// The item being flown, as it was when it became active: overwriting it in the list changes nothing.
    pub active: Option<Item>,
    jumps_done: HashMap<u16, i32>,
}

/// What lies behind an item.
#[derive(Debug, Default, PartialEq)]
pub struct Walk {
    /// Done in passing, with their sequence numbers.
    pub passed: Vec<(u16, Item)>,
    /// The next item to be flown and its sequence number; `None`: the list ran out.
    pub next: Option<(u16, Item)>,
}

impl Default for Run {
    /// At the start of a mission.
    fn default() -> Self {
        Self { phase: Phase::Stopped, current: 0, active: None, jumps_done: HashMap::new() }
    }
}

impl Run {
    /// Walks on from item `from` to the next one that is flown, and makes that the active one.
    /// `first`: the first item that is flown.
    pub fn advance(&mut self, items: &[Item], from: u16, first: u16) -> Walk {
        let mut jumps = std::mem::take(&mut self.jumps_done);
        let walk = walk(items, from, first, &mut jumps);
        self.jumps_done = jumps;
        match &walk.next {
            Some((seq, item)) => {
                self.current = *seq;
                self.active = Some(item.clone());
                self.phase = Phase::Running;
            }
            None => {
                self.active = None;
                self.phase = Phase::Complete;
            }
        }
        walk
    }

    /// The item that would be flown after the active one, as the list is now.
    pub fn upcoming(&self, items: &[Item], first: u16) -> Option<Item> {
        let mut jumps = self.jumps_done.clone();
        walk(items, self.current.saturating_add(1), first, &mut jumps).next.map(|(_, item)| item)
    }

    /// Forgets where it was.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

fn walk(items: &[Item], from: u16, first: u16, jumps_done: &mut HashMap<u16, i32>) -> Walk {
    let mut walk = Walk::default();
    let mut seq = from.max(first);
    // a list of nothing but jumps would walk for ever
    for _ in 0..2 * items.len() {
        let Some(item) = items.get(usize::from(seq)) else {
            break;
        };
        if item.is_navigation() {
            walk.next = Some((seq, item.clone()));
            break;
        }
        seq = match item.kind {
            Kind::Jump { to, repeat } => {
                let done = jumps_done.entry(seq).or_default();
                if repeat < 0 || *done < repeat {
                    *done = done.saturating_add(1);
                    to.max(first)
                } else {
                    seq.saturating_add(1)
                }
            }
            _ => {
                walk.passed.push((seq, item.clone()));
                seq.saturating_add(1)
            }
        };
    }
    walk
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    /// `w` waypoint, `s` speed, `j<to>x<repeat>` jump; the first is home.
    fn mission(text: &str) -> Vec<Item> {
        let mut item = Item::home(LatLon::new(36.0, -84.0), 300.0);
        text.split(' ')
            .map(|word| {
                item.kind = match word.split_at(1) {
                    ("s", _) => Kind::Speed { mps: 20.0 },
                    ("j", rest) => {
                        let (to, repeat) = rest.split_once('x').unwrap_or((rest, "-1"));
                        Kind::Jump { to: to.parse().unwrap_or(0), repeat: repeat.parse().unwrap_or(0) }
                    }
                    _ => Kind::Waypoint { over: false, acceptance_m: None },
                };
                item.clone()
            })
            .collect()
    }

    fn flown(text: &str, most: usize) -> Vec<u16> {
        let items = mission(text);
        let mut run = Run::default();
        let mut flown = Vec::new();
        let mut from = 1;
        while flown.len() < most {
            let upcoming = run.upcoming(&items, 1).map(|i| i.wire.seq);
            let walk = run.advance(&items, from, 1);
            if run.current > 0 && from > 1 {
                assert_eq!(walk.next.as_ref().map(|(_, i)| i.wire.seq), upcoming);
            }
            let Some((seq, _)) = walk.next else { break };
            flown.push(seq);
            from = seq + 1;
        }
        flown
    }

    #[test]
    fn items_are_flown_in_order_with_jumps() {
        let cases: [(&str, &[u16]); 6] = [
            ("h w w w", &[1, 2, 3]),
            ("h w s w", &[1, 3]),
            ("h w w j1x2 w", &[1, 2, 1, 2, 1, 2, 4]),
            ("h w w w j2", &[1, 2, 3, 2, 3, 2, 3, 2]),
            ("h", &[]),
            ("h j1", &[]),
        ];
        for (text, expected) in cases {
            assert_eq!(flown(text, 8), expected, "{text}");
        }
    }

    #[test]
    fn the_end_of_the_list_completes_the_mission() {
        let items = mission("h w");
        let mut run = Run::default();
        run.advance(&items, 1, 1);
        assert_eq!((run.phase, run.current), (Phase::Running, 1));
        run.advance(&items, 2, 1);
        assert_eq!((run.phase, run.active), (Phase::Complete, None));
    }
}
