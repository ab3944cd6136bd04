//! What bookmarks have in common, written once: the state of fifty waypoints ahead in a loop of a thousand legs is as large as that of
//! one of them.

use crate::layout::cursor::{Cursor, LoopFrame};
use crate::layout::expand::Expansion;
use crate::layout::expand::trail::Trail;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Patterns and trails, each once; of trails that go on from each other, the longest.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Shared {
    expansions: Vec<Arc<Expansion>>,
    trails: Vec<Trail>,
}

/// What a bookmark has of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Holding {
    /// The pattern it is in.
    expansion: Option<usize>,
    /// Of each loop around it.
    loops: Vec<InLoop>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct InLoop {
    /// The first so many legs of a trail: which, and how many.
    trail: Option<(usize, usize)>,
    /// The patterns flown last, by the index of their leg.
    patterns: Vec<(usize, usize)>,
}

impl Shared {
    /// Keeps what a bookmark has.
    pub fn take(&mut self, cursor: &Cursor) -> Holding {
        let expansion = cursor.expansion.as_ref().map(|e| self.expansion(e));
        Holding { expansion, loops: cursor.loops.iter().map(|frame| self.in_loop(frame)).collect() }
    }

    /// Gives a bookmark what it had; `None`: there is no such thing.
    pub fn give_back(&self, holding: &Holding, cursor: &mut Cursor) -> Option<()> {
        let expansion = |index: usize| self.expansions.get(index).cloned();
        cursor.expansion = match holding.expansion {
            Some(index) => Some(expansion(index)?),
            None => None,
        };
        if holding.loops.len() != cursor.loops.len() {
            return None;
        }
        for (frame, held) in cursor.loops.iter_mut().zip(&holding.loops) {
            if let Some((index, legs)) = held.trail {
                frame.trail = self.trails.get(index)?.first(legs)?;
            }
            let pattern = |(leg, index): &(usize, usize)| Some((*leg, expansion(*index)?));
            frame.patterns = held.patterns.iter().map(pattern).collect::<Option<_>>()?;
        }
        Some(())
    }

    fn in_loop(&mut self, frame: &LoopFrame) -> InLoop {
        let mut patterns: Vec<_> = frame.patterns.iter().collect();
        // the map has no order of its own
        patterns.sort_unstable_by_key(|(leg, _)| **leg);
        let patterns = patterns.into_iter().map(|(leg, e)| (*leg, self.expansion(e))).collect();
        InLoop { trail: self.trail(&frame.trail), patterns }
    }

    fn expansion(&mut self, expansion: &Arc<Expansion>) -> usize {
        place_of(&mut self.expansions, |e| Arc::ptr_eq(e, expansion), expansion)
    }

    fn trail(&mut self, trail: &Trail) -> Option<(usize, usize)> {
        if trail.is_empty() {
            return None;
        }
        let index = place_of(&mut self.trails, |t| t.begins(trail) || trail.begins(t), trail);
        if let Some(known) = self.trails.get_mut(index).filter(|known| known.len() < trail.len()) {
            *known = trail.clone();
        }
        Some((index, trail.len()))
    }
}

/// Where a thing is in a list, at its end if it is new.
fn place_of<T: Clone>(list: &mut Vec<T>, is_it: impl FnMut(&T) -> bool, thing: &T) -> usize {
    list.iter().position(is_it).unwrap_or_else(|| {
        list.push(thing.clone());
        list.len() - 1
    })
}
