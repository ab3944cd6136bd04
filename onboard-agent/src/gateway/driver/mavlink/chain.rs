//! The waypoints that are still to be flown, by position.

use super::climb_out::{fed_of, with_climb_outs};
use super::item::Item;
use crate::gateway::order::{Fed, Serial};
use std::collections::VecDeque;
use usal::contract::{Action, Token, Waypoint};

/// The chain: entry `i` is at position `first + i`.
#[derive(Debug, Clone, Default)]
pub struct Chain {
    entries: VecDeque<Fed>,
    first: u64,
    /// The first entry was cancelled while the aircraft steered to it: it is left as soon as the
    /// autopilot can be made to jump to the entry after it.
    left_behind: bool,
    /// The entry before `first`, for the end loiter's place.
    passed: Option<Item>,
}

impl Chain {
    /// A chain whose first waypoint is being steered to.
    pub fn resumed(first: u64, waypoints: Vec<Fed>) -> Self {
        Self { entries: waypoints.into(), first, left_behind: false, passed: None }
    }

    /// All of it that is left to fly.
    pub fn into_waypoints(self) -> Vec<Fed> {
        self.entries.into()
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

    /// The waypoint being steered to.
    pub fn active(&self) -> Option<&Fed> {
        self.entries.front()
    }

    /// The first waypoint that was not flown yet; 0: there is none.
    pub fn next(&self) -> Serial {
        self.entries.iter().map(|f| f.serial).find(|s| s.0 > 0).unwrap_or_default()
    }

    /// The waypoint at a position.
    pub fn at(&self, position: u64) -> Option<&Waypoint> {
        let index = position.checked_sub(self.first)?;
        self.entries.get(usize::try_from(index).ok()?).map(|f| &f.waypoint)
    }

    /// What comes before a position.
    pub fn before(&self, position: u64) -> Option<Item> {
        match position.checked_sub(1).and_then(|p| self.at(p)) {
            Some(waypoint) => Some(Item::of(waypoint)),
            None => self.passed,
        }
    }

    /// The waypoint from which the line to a position is flown; `None`: from wherever the aircraft is.
    pub fn line_from(&self, position: u64) -> Option<&Waypoint> {
        let before = position.checked_sub(1).filter(|p| !self.is_left_behind(*p))?;
        self.at(before)
    }

    /// The position holds the cancelled waypoint that the aircraft still steers to.
    pub fn is_left_behind(&self, position: u64) -> bool {
        self.left_behind && position == self.first
    }

    /// Where the aircraft is to jump to.
    pub fn jump(&self) -> Option<u64> {
        (self.left_behind && self.entries.len() > 1).then_some(self.first + 1)
    }

    /// Cancels what is behind `after`, and appends. `flying`: the autopilot steers to the first entry, which
    /// then can't just vanish.
    pub fn feed(&mut self, after: Serial, waypoints: Vec<Fed>, flying: bool) {
        self.cancel(after, flying);
        self.entries.extend(with_climb_outs(waypoints));
    }

    fn cancel(&mut self, after: Serial, flying: bool) {
        let keep = self.entries.iter().take_while(|f| f.serial <= after).count();
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
        let waypoint = Waypoint {
            token: Token(0),
            position: item.position,
            altitude_amsl_m: item.altitude_amsl_m,
            action: Action::Fly,
            end_of_plan: false,
            ..first.waypoint.clone()
        };
        self.entries.push_front(Fed { serial: Serial(0), waypoint });
        self.left_behind = true;
    }

    /// Leave what is steered to for the waypoint after it; a take-off with its climb-out.
    pub fn leave_active(&mut self) {
        let Some(left) = self.entries.front().map(|fed| fed.serial) else { return };
        while self.entries.get(1).is_some_and(|fed| fed.serial == left) {
            self.entries.remove(1);
        }
        self.skip_active();
    }

    /// Leave what is steered to for whatever comes next, of the same waypoint or not.
    pub fn skip_active(&mut self) {
        self.left_behind = self.entries.len() > 1;
    }

    /// The entry at a position and the one behind it are of the same waypoint.
    pub fn is_one(&self, position: u64) -> bool {
        let serial = |position: u64| {
            let index = usize::try_from(position.checked_sub(self.first)?).ok()?;
            self.entries.get(index).map(|fed| fed.serial)
        };
        serial(position).is_some_and(|one| serial(position + 1) == Some(one))
    }

    /// The last entry that a feed behind `after` leaves.
    pub fn last_up_to(&self, after: Serial) -> Option<Item> {
        let kept = self.entries.iter().take_while(|fed| fed.serial <= after).last();
        kept.map(|fed| Item::of(&fed.waypoint))
    }

    /// The aircraft steers to `position` now.
    pub fn advance_to(&mut self, position: u64) {
        while self.first < position {
            if let Some(fed) = self.entries.pop_front() {
                self.passed = Some(Item::of(&fed.waypoint));
            }
            self.first += 1;
            self.left_behind = false;
        }
    }

    /// Count positions from another number.
    pub fn renumber(&mut self, first: u64) {
        self.first = first;
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

/// Of the waypoints known before, those that are really on board from position `first` on, at most so many; and how many were known
/// up to the last of these. Those that were flown while nobody looked are left out: it goes on with the one from which most are there.
pub fn known_on_board(
    first: u64,
    most: u64,
    is_at: impl Fn(u64, &Waypoint) -> bool,
    waypoints: Vec<Fed>,
) -> (usize, Vec<Fed>) {
    let mut waypoints = with_climb_outs(waypoints);
    let is_there = |(fed, position): (&Fed, u64)| is_at(position, &fed.waypoint);
    let run = |from: usize| {
        let rest = waypoints.get(from..).unwrap_or_default();
        rest.iter().zip(first..first + most).take_while(|pair| is_there(*pair)).count()
    };
    let longest = |best: (usize, usize), from: usize| {
        let count = run(from);
        if count > best.1 { (from, count) } else { best }
    };
    let (from, count) = (0..waypoints.len()).fold((0, 0), longest);
    waypoints.truncate(from + count);
    (fed_of(&waypoints), waypoints.split_off(from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    fn fed(n: u64) -> Fed {
        let waypoint = Waypoint {
            token: Token(n),
            position: LatLon::new(36.0 + n as f64 * 1e-3, -84.0),
            altitude_amsl_m: 500.0,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: "leg".into(),
            end_of_plan: false,
        };
        Fed { serial: Serial(n), waypoint }
    }

    #[test]
    fn what_was_flown_while_nobody_looked_is_left_out() {
        // 7 is steered to, 12 is the last on board
        let is_at =
            |position: u64, waypoint: &Waypoint| position <= 15 && waypoint.token == Token(position - 3);
        for (known, expected) in [((5, 20), (7, 12)), ((7, 20), (7, 12)), ((7, 9), (7, 9)), ((8, 20), (0, 0))]
        {
            let waypoints: Vec<Fed> = (known.0..=known.1).map(fed).collect();
            let (up_to, found) = known_on_board(10, 40, is_at, waypoints);
            let numbers: Vec<u64> = found.iter().map(|fed| fed.serial.0).collect();
            let wanted: Vec<u64> = if expected.0 == 0 { vec![] } else { (expected.0..=expected.1).collect() };
            assert_eq!(numbers, wanted, "{known:?}");
            assert_eq!(up_to as u64, if expected.0 == 0 { 0 } else { expected.1 + 1 - known.0 });
        }
    }
}
