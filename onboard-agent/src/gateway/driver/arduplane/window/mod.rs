//! Pure: unlimited waypoints on an autopilot's small list.
//!
//! The autopilot holds a ring: entry 0 home, entry 1 a loiter over home (where an autopilot that
//! restarts its list begins), entries 2 to [`LAST_SLOT`] the ring, then a jump back to 2. A waypoint's
//! *position* counts up for ever; its slot is `2 + position mod RING`.
//!
//! What is wanted is a **chain**: the waypoint being steered to, those after it, and behind the last
//! one an **end loiter**, a loiter that never ends. The window compares the chain with what it knows to be
//! on board and makes one write at a time, always the one that keeps the aircraft safe whatever
//! happens next:
//!
//! 1. what differs first is not an end loiter: put an end loiter there (entries are written in order, so this is
//!    atomic). What lies beyond can't be reached any more, and may follow in the same write;
//! 2. it is an end loiter: bring what lies *behind* it in order, up to the new end loiter;
//! 3. that is in order: replace the end loiter by the waypoint (one entry, so atomic).
//!
//! How early it is turned before a waypoint depends on the one after it. When that becomes known, or another, and nothing else is to be
//! done, the entry is written again.
//!
//! So the aircraft never steers to a cancelled waypoint that it was not already steering to, and a
//! link that dies at any instant leaves a chain that ends in a loiter. A write of unknown outcome
//! just makes its slots unknown, and the same three rules heal them.

mod ring;
#[cfg(test)]
mod tests;

use crate::gateway::driver::mavlink::chain::Chain;
use crate::gateway::driver::mavlink::item::{Item, ItemKind, leads_the_same_way};
use crate::gateway::driver::mavlink::list::{Change, Feeding};
use crate::gateway::order::{Fed, Fix, Serial, Target};
use ring::{LAST_SLOT, RING, Slots, initial_list, slot};

/// Waypoints ahead of the aircraft that are kept on board; the rest of the ring is already passed.
const AHEAD: u64 = 28;
/// The ring is topped up when fewer waypoints than this are ahead.
const REFILL: u64 = 16;

/// Most entries of one write: an emergency does not wait for a long one.
const AT_ONCE: u64 = 8;

/// A change in flight.
#[derive(Debug, Clone, PartialEq)]
enum Pending {
    Upload { items: Vec<Item> },
    Write { position: u64, items: Vec<Item> },
    SetCurrent { position: u64 },
}

/// The windowed feed. See the module's text.
#[derive(Debug, Clone, Default)]
pub struct Window {
    chain: Chain,
    board: Slots,
    /// Our ring is on board and its entry was made current.
    installed: bool,
    /// The current entry was confirmed since the ring was uploaded.
    entered: bool,
    /// How far the chain is to be on board: position of the end loiter.
    end: u64,
    pending: Option<Pending>,
    /// What the autopilot had in the entry when it began to steer to it; `None`: not certain.
    loaded: Option<Item>,
    /// This position was reached while it was being written: nobody knows what was loaded.
    reached_in_doubt: Option<u64>,
}

impl Feeding for Window {
    fn feed(&mut self, after: Serial, waypoints: Vec<Fed>) {
        let flying = self.entered;
        self.chain.feed(after, waypoints, flying);
        self.end = self.end.min(self.chain.end());
        self.leave_foreign();
    }

    fn ready(&self) -> bool {
        let settled = self.pending.is_none() && !self.must_reload() && self.chain.jump().is_none();
        self.installed && self.entered && settled && self.deviation().is_none()
    }

    fn installed(&self) -> bool {
        self.installed
    }

    fn target(&self) -> Target {
        if !self.entered {
            return Target::None;
        }
        let Some(active) = self.chain.active() else { return Target::End };
        let next = self.chain.next();
        let item = ring::item_of(&active.waypoint);
        match (self.loaded.is_some_and(|l| leads_the_same_way(&l, &item)), active.serial) {
            (false, _) => Target::Unknown { next },
            (true, Serial(0)) => {
                let Item { position, altitude_amsl_m, .. } = item;
                Target::Elsewhere { next, position, altitude_amsl_m }
            }
            (true, serial) => Target::Waypoint(serial),
        }
    }

    fn reported(&mut self, seq: u16) {
        let first = self.chain.first();
        let position = self.position_of(seq).filter(|p| self.entered && *p > first);
        let Some(position) = position else { return };
        if self.is_being_written(position) && self.board.get(position).is_none() {
            self.reached_in_doubt = Some(position);
            return;
        }
        self.chain.advance_to(position);
        self.loaded = self.board.get(position);
        self.leave_foreign();
    }

    fn is_astray(&self, seq: u16) -> bool {
        self.entered && self.pending.is_none() && self.position_of(seq).is_none()
    }

    fn leave(&mut self, serial: Serial) {
        if self.chain.active().is_some_and(|f| f.serial == serial) {
            self.chain.leave_active();
        }
    }

    fn bring_back(&mut self) {
        self.loaded = None;
    }

    fn moved(&mut self, fix: &Fix) {
        if self.entered {
            self.chain.leave_climb_out_behind(fix);
        }
    }

    fn next_change(&mut self, may_install: bool, home: Option<Item>) -> Option<Change> {
        if self.pending.is_some() {
            return None;
        }
        if !self.installed {
            return if may_install && !self.chain.is_empty() { self.install(home?) } else { None };
        }
        // what the aircraft waits for comes before topping up
        if self.is_short_chain_complete()
            && let Some(change) = self.set_current()
        {
            return Some(change);
        }
        self.stretch();
        match self.deviation() {
            Some(position) => Some(self.write_towards(position)),
            None => self.set_current().or_else(|| self.correct_turn()),
        }
    }

    fn done(&mut self) {
        match self.pending.take() {
            Some(Pending::Upload { items }) => {
                self.installed = true;
                self.board.fill(items);
            }
            Some(Pending::Write { position, items }) => {
                self.board.put(position, items);
                self.resolve_doubt();
            }
            Some(Pending::SetCurrent { position }) => self.arrived_at(position),
            None => {}
        }
    }

    fn failed(&mut self) {
        self.pending = None;
        self.resolve_doubt();
    }

    fn invalidate(&mut self) {
        self.installed = false;
        self.entered = false;
        self.pending = None;
        self.board = Slots::with_home(self.board.home);
    }

    fn clear(&mut self) {
        *self = Self::default();
    }

    fn adopt(&mut self, list: &[Item], current: u16, waypoints: Vec<Fed>) -> Option<usize> {
        if !ring::is_ours(list) || !(2..=LAST_SLOT).contains(&current) {
            return None;
        }
        self.clear();
        self.board = Slots::from_list(list);
        self.installed = true;
        self.entered = true;
        self.loaded = list.get(usize::from(current)).copied();
        let first = u64::from(current - 2);
        let (up_to, known) = ring::known_on_board(list, first, waypoints);
        self.end = first + known.len() as u64;
        self.chain = Chain::resumed(first, known);
        Some(up_to)
    }
}

impl Window {
    /// A window with waypoints that were fed before the autopilot was known.
    pub fn new(chain: Chain) -> Self {
        Self { chain, ..Self::default() }
    }

    /// The write is over, during which an entry of it was reached.
    fn resolve_doubt(&mut self) {
        let Some(position) = self.reached_in_doubt.take() else { return };
        self.chain.advance_to(position);
        self.loaded = None;
        self.leave_foreign();
    }

    /// When the aircraft steers to something that is not in the chain (it was faster than the cut,
    /// or was met on its way there), that is left like any cancelled waypoint.
    fn leave_foreign(&mut self) {
        let circling = matches!(self.loaded, Some(Item { kind: ItemKind::Loiter { .. }, .. }));
        if self.entered && self.must_reload() && !circling {
            let first = self.chain.first();
            let item = self.loaded.unwrap_or_else(|| self.end_loiter(first));
            self.chain.begin_with_foreign(&item);
        }
    }

    /// The autopilot steers to something else than what is in the entry now: overwriting an entry
    /// changes nothing until it is made current again.
    fn must_reload(&self) -> bool {
        let first = self.chain.first();
        let wanted = self.lead(first);
        !self.chain.is_left_behind(first) && !self.loaded.is_some_and(|l| leads_the_same_way(&l, &wanted))
    }

    fn is_being_written(&self, position: u64) -> bool {
        match &self.pending {
            Some(Pending::Write { position: start, items }) => {
                (*start..*start + items.len() as u64).contains(&position)
            }
            _ => false,
        }
    }

    /// A position of the chain (or its end loiter) by slot.
    fn position_of(&self, seq: u16) -> Option<u64> {
        let first = self.chain.first();
        (first..=self.end_loiter_on_board()).find(|p| slot(*p) == seq)
    }

    /// The first end loiter on board from the active position on.
    fn end_loiter_on_board(&self) -> u64 {
        let first = self.chain.first();
        (first..first + RING - 1).find(|p| self.board.is_end_loiter(*p)).unwrap_or(first + AHEAD)
    }

    /// Where a position is to lead.
    fn lead(&self, position: u64) -> Item {
        match self.chain.at(position) {
            Some(waypoint) if position < self.end => ring::item_of(waypoint),
            _ => self.end_loiter(position),
        }
    }

    /// What is wanted at a position.
    fn wanted(&self, position: u64) -> Item {
        match self.chain.at(position) {
            Some(waypoint) if position < self.end => {
                let from = self.chain.line_from(position);
                ring::item_between(from, waypoint, self.chain.at(position + 1))
            }
            _ => self.end_loiter(position),
        }
    }

    fn end_loiter(&self, position: u64) -> Item {
        match self.chain.before(position) {
            Some(item) => item.end_loiter(),
            None => self.board.get(position).unwrap_or(self.board.home).end_loiter(),
        }
    }

    /// How far on board the chain should reach: extended in large steps, so that there are few
    /// transactions.
    fn stretch(&mut self) {
        let (first, full) = (self.chain.first(), self.chain.end());
        let enough = self.end >= first + REFILL || self.end >= full;
        if !enough || self.end < first {
            self.end = full.min(first + AHEAD);
        }
        self.end = self.end.min(full);
    }

    /// First position that does not lead to where it should.
    fn deviation(&self) -> Option<u64> {
        let first = self.chain.first();
        let leads_there =
            |p: u64| self.board.get(p).is_some_and(|have| leads_the_same_way(&have, &self.lead(p)));
        // what is being left behind is not written again
        (first..=self.end).find(|p| !self.chain.is_left_behind(*p) && !leads_there(*p))
    }

    /// First position whose turn is not on board as wanted: what follows it is known since, or has changed. The one steered to
    /// stays as it was loaded.
    fn stale_turn(&self) -> Option<u64> {
        (self.chain.first() + 1..self.end).find(|p| !self.board.holds(*p, &self.wanted(*p)))
    }

    fn is_short_chain_complete(&self) -> bool {
        let target = self.chain.jump().unwrap_or(self.chain.first());
        self.end > target && self.deviation().is_none()
    }

    fn install(&mut self, home: Item) -> Option<Change> {
        self.chain.restart();
        self.board = Slots::with_home(home);
        self.end = 0;
        self.stretch();
        let items: Vec<Item> = (0..=self.end).map(|p| self.wanted(p)).collect();
        self.entered = false;
        let list = initial_list(home, &items);
        self.pending = Some(Pending::Upload { items });
        Some(Change::Upload { items: list, current: None })
    }

    fn write_towards(&mut self, position: u64) -> Change {
        // When the aircraft waits for it, three waypoints now are better than many later.
        let urgent = self.chain.jump().is_some() || position == self.chain.first();
        let end = if urgent { self.end.min(position + 3) } else { self.end };
        self.end = end;
        if !self.board.is_end_loiter(position) {
            return self.cut(position, end);
        }
        let behind = (position + 1..=end).find(|p| !self.board.holds(*p, &self.wanted(*p)));
        match behind {
            Some(start) => {
                let stop = end.min(start + AT_ONCE - 1).min(ring::last_before_wrap(start));
                let items = (start..=stop).map(|p| self.wanted(p)).collect();
                self.write(start, items)
            }
            None => self.write(position, vec![self.wanted(position)]),
        }
    }

    /// An end loiter, and behind it (which is written after it, and out of reach once it is there) what comes
    /// after the waypoint that will replace it.
    fn cut(&mut self, position: u64, end: u64) -> Change {
        let stop = end.min(position + AT_ONCE - 1).min(ring::last_before_wrap(position));
        let end_loiter = self.end_loiter(position);
        let behind = (position + 1..=stop).map(|p| self.wanted(p));
        let items = std::iter::once(end_loiter).chain(behind).collect();
        self.write(position, items)
    }

    /// A turn is corrected by one entry, which leads to the same place whether it is written or not: nothing has to be cut off, and
    /// nothing becomes unknown.
    fn correct_turn(&mut self) -> Option<Change> {
        let position = self.stale_turn()?;
        let items = vec![self.wanted(position)];
        self.pending = Some(Pending::Write { position, items: items.clone() });
        Some(Change::Overwrite { start: slot(position), items })
    }

    fn write(&mut self, position: u64, items: Vec<Item>) -> Change {
        self.board.forget(position, items.len());
        self.pending = Some(Pending::Write { position, items: items.clone() });
        Change::Overwrite { start: slot(position), items }
    }

    fn set_current(&mut self) -> Option<Change> {
        let position = match self.chain.jump() {
            Some(jump) => jump,
            None if !self.entered || self.must_reload() => self.chain.first(),
            None => return None,
        };
        self.pending = Some(Pending::SetCurrent { position });
        Some(Change::SetCurrent(slot(position)))
    }

    fn arrived_at(&mut self, position: u64) {
        self.entered = true;
        if position >= self.chain.first() {
            self.loaded = self.board.get(position);
            self.chain.advance_to(position);
        }
    }
}
