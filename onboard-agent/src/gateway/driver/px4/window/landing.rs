//! The landing that ends a list, and one that is left.

use super::{Window, ring};
use crate::gateway::driver::mavlink::item::{Item, ItemKind};
use geometry::near::distance_m;
use usal::contract::{Action, Waypoint};

/// It refuses a list whose landing comes from more steeply than this above the place of the touch-down (its default), or from below it,
/// degrees and metres.
const STEEPEST_DEG: f64 = 5.0;
const LEAST_M: f64 = 1.0;
/// It takes this whatever it is set to, degrees.
const EASY_DEG: f64 = 3.0;

impl Window {
    /// A landing that is left for something else does not end the list, and is not flown any more. What led to it stands in its place:
    /// if the same landing comes next, PX4 wants to see that it is come to from above.
    pub(super) fn instead_of_landing(&self, position: u64, landing: Item) -> Item {
        let before = self.chain.before(position).filter(|item| item.kind != ItemKind::Land);
        ring::passing(before.unwrap_or(landing))
    }

    /// The entry of a waypoint at a position. What leads to a landing is no higher there than PX4 takes.
    pub(super) fn item_of(&self, position: u64, waypoint: &Waypoint) -> Item {
        let item = ring::item_of(waypoint);
        let landing = self.chain.at(position + 1).filter(|next| matches!(next.action, Action::Land { .. }));
        match (item.kind, landing) {
            (ItemKind::Fly(_), Some(landing)) => no_steeper(item, landing, STEEPEST_DEG),
            _ => item,
        }
    }

    /// What a landing that is flown to at once comes from: where the aircraft is. PX4 judges by it whether that is too steep or begins too
    /// low, and then flies no list at all.
    pub(super) fn comes_from(&self, landing: u64) -> Option<Item> {
        let at = self.chain.at(landing).filter(|_| landing == self.chain.first())?;
        let item = Item {
            position: self.fix?.position,
            altitude_amsl_m: f64::INFINITY,
            ..ring::passing(ring::item_of(at))
        };
        Some(no_steeper(item, at, EASY_DEG))
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

fn no_steeper(item: Item, landing: &Waypoint, degrees: f64) -> Item {
    let most_m = distance_m(item.position, landing.position) * degrees.to_radians().tan();
    let altitude_amsl_m = item.altitude_amsl_m.min(landing.altitude_amsl_m + most_m.max(LEAST_M));
    Item { altitude_amsl_m, ..item }
}
