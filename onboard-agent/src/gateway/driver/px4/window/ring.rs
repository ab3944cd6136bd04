//! The ring of entries: how positions, entries and the list go together.

use crate::gateway::driver::mavlink::chain;
use crate::gateway::driver::mavlink::item::{Item, ItemKind, Pass, matches};
use crate::gateway::order::Fed;
use usal::contract::Waypoint;

/// Entries of the ring.
pub const RING: u64 = 40;
/// Entry of the jump back to entry 1.
const JUMP: usize = 1 + RING as usize;
/// Editions of a landing stand so much apart: a float of 10 km keeps it, and nobody feels it.
const EDITION_M: f64 = 0.01;
/// So many of them differ.
const LANDING_EDITIONS: u16 = 10;

/// The entry of a position: the same in every list that follows another without a renumbering.
pub fn entry(position: u64) -> u16 {
    match position {
        0 => 0,
        p => 1 + ((p - 1) % RING) as u16,
    }
}

/// The whole list while `first` is steered to and the end loiter is at `end`. `passed` came before `first`. Entries
/// that are out of reach behind the end loiter are the same. The jump carries the `edition` as its altitude.
pub fn list(
    (first, end): (u64, u64),
    edition: u16,
    passed: Option<Item>,
    wanted: impl Fn(u64) -> Option<Item>,
) -> Option<Vec<Item>> {
    let filler = wanted(end)?;
    let at = |p: u64| if p <= end { wanted(p) } else { Some(filler) };
    let from = first.max(1);
    let position_in = |number: u64| from + (number + RING - u64::from(entry(from))) % RING;
    let one = position_in(1);
    let before_one = match first {
        0 => at(0)?,
        _ if one > first => opening(at(one - 1)?),
        _ => passed.map_or(filler, opening),
    };
    let mut items = vec![before_one];
    for number in 1..=RING {
        items.push(at(position_in(number))?);
    }
    items.push(Item { kind: ItemKind::Jump { to: 1 }, altitude_amsl_m: f64::from(edition), ..filler });
    Some(items)
}

/// The whole list while `first` is steered to and `landing` is the last to be flown. It ends there: PX4 takes off again
/// for what stands behind a landing, and hangs for ever on a jump back from there. See [`lies_flat`]. The landing carries
/// the `edition`: it stands some centimetres higher.
pub fn list_that_lands(
    (first, landing): (u64, u64),
    edition: u16,
    passed: Option<Item>,
    wanted: impl Fn(u64) -> Option<Item>,
) -> Option<Vec<Item>> {
    // what is never flown again; and what the landing comes from, if it is all that is left
    let passed = match passed {
        Some(item) => item,
        None => wanted(first)?,
    };
    let before = (0..entry(first)).map(|_| Some(passing(passed)));
    let mut items: Vec<Item> = before.chain((first..=landing).map(wanted)).collect::<Option<_>>()?;
    if let Some(last) = items.last_mut() {
        last.altitude_amsl_m += EDITION_M * f64::from(edition % LANDING_EDITIONS);
    }
    Some(items)
}

/// What is flown from `first` to `landing` needs no jump.
pub fn lies_flat(first: u64, landing: u64) -> bool {
    u64::from(entry(landing)) == u64::from(entry(first)) + (landing - first)
}

/// The entry of a waypoint, as PX4 keeps it: how it is passed is not in its list, and does not come back from there.
pub fn item_of(waypoint: &Waypoint) -> Item {
    let item = Item::of(waypoint);
    if matches!(item.kind, ItemKind::Fly(_)) { passing(item) } else { item }
}

/// It only leads past its place.
pub fn passing(item: Item) -> Item {
    Item { kind: ItemKind::Fly(Pass::By), ..item }
}

/// Entry 0 is never flown again, but PX4 wants to see what a landing in entry 1 comes from, and that no list begins with one.
fn opening(item: Item) -> Item {
    if item.kind == ItemKind::Land { item.end_loiter() } else { item }
}

/// Our end loiter: it has the autopilot's own radius.
pub fn is_end_loiter(item: &Item) -> bool {
    matches!(item.kind, ItemKind::Loiter { radius_m } if radius_m == 0.0)
}

/// Nothing is flown behind it.
pub fn is_end(item: &Item) -> bool {
    is_end_loiter(item) || item.kind == ItemKind::Land
}

/// A list has the shape that [`list`] or [`list_that_lands`] gives it.
pub fn is_ours(list: &[Item]) -> bool {
    let Some((last, before)) = list.split_last() else { return false };
    match last.kind {
        ItemKind::Jump { to: 1 } => list.len() == JUMP + 1,
        ItemKind::Land => {
            let flown = |item: &Item| !matches!(item.kind, ItemKind::Jump { .. } | ItemKind::Land);
            (1..JUMP).contains(&before.len()) && before.iter().all(flown)
        }
        _ => false,
    }
}

/// Of the waypoints known before, those that are really on board from `first` on.
pub fn known_on_board(list: &[Item], first: u64, waypoints: Vec<Fed>) -> (usize, Vec<Fed>) {
    let at = |p: u64| list.get(usize::from(entry(p)));
    let is_at = |p: u64, waypoint: &Waypoint| at(p).is_some_and(|item| matches(item, &item_of(waypoint)));
    chain::known_on_board(first, RING - 1, is_at, waypoints)
}
