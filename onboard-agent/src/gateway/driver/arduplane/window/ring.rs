//! The ring of slots on board: how positions, slots and list entries go together.

use crate::gateway::driver::mavlink::chain;
use crate::gateway::driver::mavlink::climb_out::is_climb_out;
use crate::gateway::driver::mavlink::item::{Item, ItemKind, Pass, leads_the_same_way, matches};
use crate::gateway::order::Fed;
use aircraft::autopilot::{GREATEST_ACCEPTANCE_M, arc_acceptance_m, turn_acceptance_m};
use geometry::LatLon;
use usal::contract::{Action, Waypoint};

/// Slots of the ring.
pub const RING: u64 = 40;
/// Entry of the ring's last slot; the first is 2.
pub const LAST_SLOT: u16 = 1 + RING as u16;
/// Entry of the jump back to slot 2.
pub const JUMP_SLOT: u16 = LAST_SLOT + 1;
/// Height above home of the loiter at entry 1, metres.
const HOME_LOITER_M: f64 = 100.0;

/// The entry of a position.
pub fn slot(position: u64) -> u16 {
    2 + (position % RING) as u16
}

/// The last position that can be written in one go with `position`.
pub fn last_before_wrap(position: u64) -> u64 {
    position - position % RING + RING - 1
}

/// The whole list for a fresh ring: `items` from slot 2 on, the last of them (the end loiter) in every
/// slot that is left.
pub fn initial_list(home: Item, items: &[Item]) -> Vec<Item> {
    let over_home = Item { altitude_amsl_m: home.altitude_amsl_m + HOME_LOITER_M, ..home.end_loiter() };
    let filler = items.last().copied().unwrap_or(over_home);
    let mut list = vec![Item { kind: ItemKind::Home, ..home }, over_home];
    list.extend(items.iter().copied());
    list.resize(usize::from(JUMP_SLOT), filler);
    list.push(Item { kind: ItemKind::Jump { to: 2 }, ..home });
    list
}

/// A list has the shape that [`initial_list`] gives it.
pub fn is_ours(list: &[Item]) -> bool {
    list.len() == usize::from(JUMP_SLOT) + 1
        && matches!(list.last(), Some(Item { kind: ItemKind::Jump { to: 2 }, .. }))
}

/// Of the waypoints known before, those that are really on board from `first` on.
pub fn known_on_board(list: &[Item], first: u64, waypoints: Vec<Fed>) -> (usize, Vec<Fed>) {
    let at = |p: u64| list.get(usize::from(slot(p)));
    let is_at =
        |p: u64, waypoint: &Waypoint| at(p).is_some_and(|item| leads_the_same_way(item, &item_of(waypoint)));
    chain::known_on_board(first, RING, is_at, waypoints)
}

/// It flares early: ArduPlane 4.7 touched down 31 to 50 m before the place of its landing entry in nine landings of a small trainer at
/// 25 m/s (`assets/docs/flight-tests.md`). What it is short by grows with the speed: so many seconds of it, and some metres to spare.
const LANDS_SHORT_S: f64 = 2.4;

/// The entry of a waypoint to which it flies from another, and goes on to a third.
pub fn item_between(from: Option<&Waypoint>, waypoint: &Waypoint, onward: Option<&Waypoint>) -> Item {
    let item = item_of(waypoint);
    let early_m = match (item.kind, from.zip(onward)) {
        (ItemKind::Fly(Pass::By), _) if waypoint.on_arc => Some(arc_acceptance_m(waypoint.airspeed_mps)),
        // as far away as can be told: wherever the take-off ends, it is not turned round for
        (ItemKind::Fly(Pass::By), _) if from.is_some_and(|from| is_climb_out(from, waypoint)) => {
            Some(GREATEST_ACCEPTANCE_M)
        }
        // where a take-off or a circle is left is not known
        (ItemKind::Fly(Pass::By), Some((from, onward))) if from.action == Action::Fly => {
            let airspeed_mps = waypoint.airspeed_mps;
            turn_acceptance_m(from.position, waypoint.position, onward.position, airspeed_mps)
        }
        _ => None,
    };
    match early_m {
        Some(metres) => Item { kind: ItemKind::Fly(Pass::Within { metres }), ..item },
        None => item,
    }
}

/// The entry of a waypoint, by itself.
pub fn item_of(waypoint: &Waypoint) -> Item {
    let item = Item::of(waypoint);
    match waypoint.action {
        Action::Land { heading_deg } => {
            let short_m = LANDS_SHORT_S * waypoint.airspeed_mps;
            Item { position: item.position.destination(heading_deg, short_m), ..item }
        }
        _ => item,
    }
}

/// What is known to be on board.
#[derive(Debug, Clone)]
pub struct Slots {
    /// The take-off place.
    pub home: Item,
    /// `None`: unknown.
    slots: Vec<Option<Item>>,
}

impl Default for Slots {
    fn default() -> Self {
        let home = Item { position: LatLon::new(0.0, 0.0), altitude_amsl_m: 0.0, kind: ItemKind::Home };
        Self { home, slots: vec![None; RING as usize] }
    }
}

impl Slots {
    /// Nothing is known but the take-off place.
    pub fn with_home(home: Item) -> Self {
        Self { home, ..Self::default() }
    }

    /// From a list of our shape.
    pub fn from_list(list: &[Item]) -> Self {
        let mut slots: Vec<_> = list.iter().skip(2).take(RING as usize).map(|i| Some(*i)).collect();
        slots.resize(RING as usize, None);
        Self { home: list.first().copied().unwrap_or(Self::default().home), slots }
    }

    /// What is there.
    pub fn get(&self, position: u64) -> Option<Item> {
        self.slots.get((position % RING) as usize).copied().flatten()
    }

    /// It is there.
    pub fn holds(&self, position: u64, item: &Item) -> bool {
        self.get(position).is_some_and(|have| matches(&have, item))
    }

    /// A loiter with the autopilot's own radius: our end loiter.
    pub fn is_end_loiter(&self, position: u64) -> bool {
        matches!(self.get(position), Some(Item { kind: ItemKind::Loiter { radius_m }, .. }) if radius_m == 0.0)
    }

    /// Written and verified.
    pub fn put(&mut self, position: u64, items: Vec<Item>) {
        for (p, item) in (position..).zip(items) {
            if let Some(s) = self.slots.get_mut((p % RING) as usize) {
                *s = Some(item);
            }
        }
    }

    /// About to be written: unknown until verified.
    pub fn forget(&mut self, position: u64, count: usize) {
        for p in position..position + count as u64 {
            if let Some(s) = self.slots.get_mut((p % RING) as usize) {
                *s = None;
            }
        }
    }

    /// What [`initial_list`] wrote.
    pub fn fill(&mut self, items: Vec<Item>) {
        let filler = items.last().copied();
        self.slots = items.into_iter().map(Some).collect();
        self.slots.resize(RING as usize, filler);
    }
}
