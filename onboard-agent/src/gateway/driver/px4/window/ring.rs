//! The ring of entries: how positions, entries and the list go together.

use crate::gateway::driver::mavlink::item::{Item, ItemKind, matches};
use crate::gateway::order::Fed;

/// Entries of the ring.
pub const RING: u64 = 40;
/// Entry of the jump back to entry 1.
const JUMP: usize = 1 + RING as usize;

/// The entry of a position: the same in every list.
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

/// Entry 0 is never flown again, but PX4 wants to see what a landing in entry 1 comes from, and that no list begins with one.
fn opening(item: Item) -> Item {
    if item.kind == ItemKind::Land { item.end_loiter() } else { item }
}

/// Our end loiter: it has the autopilot's own radius.
pub fn is_end_loiter(item: &Item) -> bool {
    matches!(item.kind, ItemKind::Loiter { radius_m } if radius_m == 0.0)
}

/// A list has the shape that [`list`] gives it.
pub fn is_ours(list: &[Item]) -> bool {
    list.len() == JUMP + 1 && matches!(list.last(), Some(Item { kind: ItemKind::Jump { to: 1 }, .. }))
}

/// Of the waypoints known before, those that are really on board from `first` on.
pub fn known_on_board(list: &[Item], first: u64, waypoints: Vec<Fed>) -> Vec<Fed> {
    let at = |p: u64| list.get(usize::from(entry(p)));
    waypoints
        .into_iter()
        .zip(first..first + RING - 1)
        .take_while(|(w, p)| at(*p).is_some_and(|i| matches(i, &Item::of(&w.waypoint))))
        .map(|(w, _)| w)
        .collect()
}
