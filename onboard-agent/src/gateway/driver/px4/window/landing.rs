//! The landing that ends a list, and one that is left.

use super::{Window, ring};
use crate::gateway::driver::mavlink::item::{Item, ItemKind};
use usal::contract::Action;

impl Window {
    /// A landing that is left for something else does not end the list, and is not flown any more. What led to it stands in its place:
    /// if the same landing comes next, PX4 wants to see that it is come to from above.
    pub(super) fn instead_of_landing(&self, position: u64, landing: Item) -> Item {
        let before = self.chain.before(position).filter(|item| item.kind != ItemKind::Land);
        ring::passing(before.unwrap_or(landing))
    }

    /// It is to land at a position, and nothing comes behind that.
    pub(super) fn ends_at(&self, position: u64) -> bool {
        let is_left = position == self.chain.first() && self.chain.jump().is_some();
        !is_left && self.chain.at(position).is_some_and(|w| matches!(w.action, Action::Land { .. }))
    }

    /// The landing that is to be on board.
    pub(super) fn landing(&self) -> Option<u64> {
        (self.chain.first()..self.end).find(|p| self.ends_at(*p))
    }
}
