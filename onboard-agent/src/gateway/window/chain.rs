//! The waypoints that are still to be flown, by position.

use super::ring;
use crate::gateway::order::Item;
use std::collections::VecDeque;
use usal::contract::{Action, Token, Waypoint};

/// The buffer never holds more waypoints.
pub const CAPACITY: usize = 256;

/// The chain: entry `i` is at position `first + i`.
#[derive(Debug, Clone, Default)]
pub struct Chain {
    entries: VecDeque<Waypoint>,
    first: u64,
    /// The first entry was cancelled while the aircraft steered to it: it is left as soon as the
    /// autopilot can be made to jump to the entry after it.
    left_behind: bool,
    /// The entry before `first`, for the end loiter's place.
    passed: Option<Item>,
}

impl Chain {
    /// A chain whose first waypoint is being steered to.
    pub fn resumed(first: u64, waypoints: Vec<Waypoint>) -> Self {
        Self { entries: waypoints.into(), first, left_behind: false, passed: None }
    }

    /// Position being steered to.
    pub fn first(&self) -> u64 {
        self.first
    }

    /// Position behind the last waypoint: the end loiter's.
    pub fn end(&self) -> u64 {
        self.first + self.entries.len() as u64
    }

    /// Nothing left to fly.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// How many more waypoints can be taken, after cancelling.
    pub fn room(&self, cancel_after: Option<Token>) -> usize {
        let kept = match cancel_after {
            Some(token) => self.entries.iter().filter(|w| w.token <= token).count() + 1,
            None => self.entries.len(),
        };
        CAPACITY.saturating_sub(kept)
    }

    /// Waypoints in the buffer, without one that is being left behind.
    pub fn waypoints(&self) -> impl Iterator<Item = &Waypoint> {
        self.entries.iter().skip(usize::from(self.left_behind))
    }

    /// The waypoint being steered to.
    pub fn active(&self) -> Option<&Waypoint> {
        self.entries.front()
    }

    /// The one after it.
    pub fn second(&self) -> Option<&Waypoint> {
        self.entries.get(1)
    }

    /// The last.
    pub fn last(&self) -> Option<&Waypoint> {
        self.waypoints().last()
    }

    /// The waypoint that a feed with this `cancel_after` would follow on.
    pub fn predecessor(&self, cancel_after: Option<Token>) -> Option<&Waypoint> {
        match cancel_after {
            Some(token) => self.waypoints().filter(|w| w.token <= token).last(),
            None => self.last(),
        }
    }

    /// The waypoint at a position.
    pub fn at(&self, position: u64) -> Option<&Waypoint> {
        let index = position.checked_sub(self.first)?;
        self.entries.get(usize::try_from(index).ok()?)
    }

    /// What comes before a position.
    pub fn before(&self, position: u64) -> Option<Item> {
        match position.checked_sub(1).and_then(|p| self.at(p)) {
            Some(waypoint) => Some(ring::item(waypoint)),
            None => self.passed,
        }
    }

    /// The position holds the cancelled waypoint that the aircraft still steers to.
    pub fn is_left_behind(&self, position: u64) -> bool {
        self.left_behind && position == self.first
    }

    /// Where the aircraft is to jump to.
    pub fn jump(&self) -> Option<u64> {
        (self.left_behind && self.entries.len() > 1).then_some(self.first + 1)
    }

    /// Cancel and append. `flying`: the autopilot steers to the first entry, which then can't just
    /// vanish.
    pub fn feed(&mut self, cancel_after: Option<Token>, waypoints: Vec<Waypoint>, flying: bool) {
        if let Some(token) = cancel_after {
            self.cancel(token, flying);
        }
        self.entries.extend(waypoints);
    }

    fn cancel(&mut self, after: Token, flying: bool) {
        let keep = self.entries.iter().take_while(|w| w.token <= after && w.token.0 > 0).count();
        if keep > 0 && !(self.left_behind && keep == 1) {
            self.entries.truncate(keep);
            return;
        }
        let steered_to = flying && !self.entries.is_empty();
        self.entries.truncate(usize::from(steered_to));
        self.left_behind = steered_to;
    }

    /// The aircraft steers to something that is not in the chain; the chain begins behind it.
    pub fn begin_with_foreign(&mut self, item: &Item) {
        let Some(first) = self.entries.front() else { return };
        let foreign = Waypoint {
            token: Token(0),
            position: item.position,
            altitude_amsl_m: item.altitude_amsl_m,
            action: Action::Fly,
            end_of_plan: false,
            ..first.clone()
        };
        self.entries.push_front(foreign);
        self.left_behind = true;
    }

    /// Leave the waypoint being steered to for the one after it.
    pub fn leave_active(&mut self) {
        self.left_behind = self.entries.len() > 1;
    }

    /// The aircraft steers to `position` now.
    pub fn advance_to(&mut self, position: u64) {
        while self.first < position {
            if let Some(waypoint) = self.entries.pop_front() {
                self.passed = Some(ring::item(&waypoint));
            }
            self.first += 1;
            self.left_behind = false;
        }
    }

    /// Count positions from 0 again, without what was being left behind.
    pub fn restart(&mut self) {
        if self.left_behind {
            self.entries.pop_front();
            self.left_behind = false;
        }
        self.first = 0;
    }
}
