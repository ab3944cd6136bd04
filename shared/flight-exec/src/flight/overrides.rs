//! What commands and time have changed of the plan: counts of loops, holdings released, waits.

use super::Offset;
use crate::layout::stretch::IssuedWaypoint;
use crate::value::LoopCount;
use flight_plan::Id;
use serde::{Deserialize, Serialize};

/// Most loops whose counts are set by command at a time.
const MAX_COUNTS: usize = 64;

/// Each of them ends with the passage or the activation that it belongs to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Overrides {
    counts: Vec<LoopCount>,
    /// See [`crate::layout::world::World::released`].
    released: Option<u64>,
    /// See [`crate::layout::world::World::waited`].
    waited: Option<u64>,
    wait: Option<Wait>,
}

/// Circling at the end of a leg for a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Wait {
    passage: u64,
    /// By the executor's clock.
    begun_s: f64,
    /// Likewise.
    due_s: f64,
}

impl Wait {
    pub fn due_s(&self) -> f64 {
        self.due_s
    }

    fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        let Self { passage, begun_s, due_s } = *self;
        offset.passage(passage, other.passage)
            && offset.instant(begun_s, other.begun_s)
            && offset.instant(due_s, other.due_s)
    }
}

impl Overrides {
    pub fn counts(&self) -> &[LoopCount] {
        &self.counts
    }

    /// Sets the count of an activation of a loop; what was set for the loop before is forgotten.
    pub fn set_count(&mut self, leg: Id, activation: u64, count: u64) {
        self.counts.retain(|c| c.leg != leg);
        self.counts.truncate(MAX_COUNTS - 1);
        self.counts.push(LoopCount { leg, activation: Some(activation), count });
    }

    /// Forgets the counts of loops that have been left.
    pub fn retain_counts(&mut self, is_kept: impl Fn(&Id) -> bool) {
        self.counts.retain(|c| is_kept(&c.leg));
    }

    /// The counts set for a loop are those of this activation.
    pub fn move_counts(&mut self, leg: &Id, to_activation: u64) {
        let counts = self.counts.iter_mut().filter(|c| c.leg == *leg);
        counts.filter_map(|c| c.activation.as_mut()).for_each(|of| *of = to_activation);
    }

    pub fn released(&self) -> Option<u64> {
        self.released
    }

    /// A holding is left at the next crossing of its fix.
    pub fn release(&mut self, passage: u64) {
        self.released = Some(passage);
    }

    pub fn waited(&self) -> Option<u64> {
        self.waited
    }

    pub fn wait(&self) -> Option<Wait> {
        self.wait
    }

    pub fn is_waiting_at(&self, passage: u64) -> bool {
        self.wait.is_some_and(|wait| wait.passage == passage)
    }

    /// Circles at the end of a passage for so many seconds from now.
    pub fn begin_wait(&mut self, passage: u64, now_s: f64, seconds: f64) {
        self.wait = Some(Wait { passage, begun_s: now_s, due_s: now_s + seconds });
    }

    /// The wait being flown takes so many seconds in all.
    pub fn set_wait(&mut self, seconds: f64) {
        if let Some(wait) = &mut self.wait {
            wait.due_s = wait.begun_s + seconds;
        }
    }

    /// A circle was flown long enough, or is not to be flown any longer.
    pub fn end_wait(&mut self) {
        self.waited = self.wait.take().map(|wait| wait.passage).or(self.waited);
    }

    /// The flight goes on elsewhere.
    pub fn abandon_wait(&mut self) {
        self.wait = None;
    }

    /// A wait is over when the aircraft steers to something else.
    pub fn settle_wait(&mut self, front: Option<&IssuedWaypoint>) {
        self.wait = self.wait.filter(|w| front.is_none_or(|h| h.is_loiter() && w.passage == h.passage));
    }

    pub fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        let Self { counts, released, waited, wait } = self;
        *counts == other.counts
            && offset.is_marked(*released, other.released)
            && offset.is_marked(*waited, other.waited)
            && super::both_or_none(wait, &other.wait, |a, b| a.is_equivalent(b, offset))
    }
}
