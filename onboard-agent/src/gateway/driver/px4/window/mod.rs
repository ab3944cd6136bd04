//! Pure: unlimited waypoints on a list that PX4 takes whole.
//!
//! The list is a ring: entry 0 for what comes first, entries 1 to [`RING`], then a jump back to 1. A waypoint's
//! *position* counts up for ever, and says its entry ([`ring::entry`]). What is wanted is the chain: the waypoint being
//! steered to, those after it, and an end loiter.
//!
//! PX4 keeps the list in use until a new one is complete, and then goes on at the same entry, with what the new list
//! has there. As a position has the same entry in every list of ours, the aircraft may reach waypoints while a list
//! is on its way up: it goes on right with the new one. Only where it has to *leave* what it steers to, the new list
//! names the entry to go on at. A list with a landing ends there, without a jump (`ring::list_that_lands`); where the
//! landing is behind the jump, positions are counted anew, and the list says where to go on. What a lost answer leaves open is which of a few lists is in use ([`Window::lists`]):
//! what is the same in all of them is certain, the rest is not claimed.

mod landing;
mod line;
mod ring;
#[cfg(test)]
mod tests;

use crate::gateway::driver::mavlink::chain::Chain;
use crate::gateway::driver::mavlink::item::{Item, ItemKind, matches};
use crate::gateway::driver::mavlink::list::{Change, Feeding};
use crate::gateway::order::{Fed, Fix, Serial, Target};
use landing::Steepest;
use ring::{RING, entry};

/// Waypoints ahead of the aircraft that are put on board.
const AHEAD: u64 = 28;
/// A new list is sent when fewer waypoints than this are ahead.
const REFILL: u64 = 16;
/// Numbers that make lists differ.
const MOST_EDITIONS: u16 = 1000;
/// More lists than this that may be in use are as good as none that is known.
const MOST_LISTS: usize = 4;

/// A change in flight.
#[derive(Debug, Clone, PartialEq)]
enum Pending {
    Upload {
        items: Vec<Item>,
        /// Where it is to go on, if not where it is.
        jump: Option<u64>,
        /// The first position at which it is new.
        new_from: u64,
    },
    SetCurrent {
        position: u64,
    },
}

/// The windowed feed. See the module's text.
#[derive(Debug, Clone, Default)]
pub struct Window {
    chain: Chain,
    /// The lists of which one is in use; none: nothing is known.
    lists: Vec<Vec<Item>>,
    /// A list of ours is in use.
    installed: bool,
    /// It was seen to go along it.
    entered: bool,
    /// How far the chain is to be on board: position of the end loiter.
    end: u64,
    /// The farthest end loiter that may be on board.
    farthest: u64,
    pending: Option<Pending>,
    /// It was reported behind this, where the lists that may be in use differ: it has to come back.
    overrun: Option<u64>,
    /// It was told to go on here, and has not shown yet that it does.
    sent_to: Option<u64>,
    /// It shows that it does not: it is told again.
    disobeys: bool,
    /// Lists that are the same otherwise differ by this.
    edition: u16,
    /// Where the aircraft is.
    fix: Option<Fix>,
    /// How steep a landing may be.
    steepest: Steepest,
}

impl Feeding for Window {
    fn feed(&mut self, after: Serial, waypoints: Vec<Fed>) {
        let waypoints = self.steepest.with_close_ins(self.chain.last_up_to(after), waypoints);
        self.chain.feed(after, waypoints, self.entered);
        self.end = self.end.min(self.chain.end());
    }

    fn limit_landing(&mut self, steepest_deg: Option<f64>) {
        self.steepest = Steepest::told(steepest_deg);
    }

    fn leave(&mut self, serial: Serial) {
        if self.chain.active().is_some_and(|f| f.serial == serial) {
            self.chain.leave_active();
        }
    }

    fn clear(&mut self) {
        *self = self.anew();
    }

    fn invalidate(&mut self) {
        *self = Self { chain: std::mem::take(&mut self.chain), ..self.anew() };
    }

    fn adopt(&mut self, list: &[Item], current: u16, waypoints: Vec<Fed>) -> Option<usize> {
        if !ring::is_ours(list) || u64::from(current) > RING {
            return None;
        }
        let first = u64::from(current);
        let before = current.checked_sub(1).and_then(|before| list.get(usize::from(before)).copied());
        let (up_to, known) =
            ring::known_on_board(list, first, self.steepest.with_close_ins(before, waypoints));
        *self = Self {
            lists: vec![list.to_vec()],
            installed: true,
            entered: true,
            end: first + known.len() as u64,
            farthest: first + RING - 2,
            chain: Chain::resumed(first, known),
            ..self.anew()
        };
        Some(up_to)
    }

    fn reported(&mut self, seq: u16) {
        if !self.installed {
            return;
        }
        let position = self.position_of(seq);
        match (&self.pending, position, self.sent_to) {
            // either list may be meant: it is said again when the new one is known to be in use
            (Some(Pending::Upload { jump: Some(_), .. } | Pending::SetCurrent { .. }), ..) => {}
            (Some(Pending::Upload { new_from, .. }), Some(position), _) => {
                self.reach(position, Some(*new_from))
            }
            (None, Some(position), Some(wanted)) if self.has_gone_on(position, wanted) => {
                self.arrived_at(wanted);
                self.reach(position, self.deviation());
            }
            (None, _, Some(_)) => self.disobeys = true,
            (None, Some(position), None) => self.reach(position, self.deviation()),
            (_, None, _) => {}
        }
    }

    fn is_astray(&self, seq: u16) -> bool {
        let settled = self.pending.is_none() && self.sent_to.is_none() && self.overrun.is_none();
        self.entered && settled && self.position_of(seq).is_none()
    }

    fn bring_back(&mut self) {
        self.send_to(self.chain.first(), true);
    }

    fn next_change(&mut self, may_install: bool, _home: Option<Item>) -> Option<Change> {
        if self.pending.is_some() {
            return None;
        }
        if !self.installed {
            return if may_install && !self.chain.is_empty() { self.install() } else { None };
        }
        if let Some(position) = self.sent_to.filter(|_| self.entered) {
            return self.disobeys.then(|| self.set_current(position));
        }
        if self.sent_to.is_some() {
            // on the ground only a new list says where to begin, and the same one again is no news
            if !self.disobeys || !may_install {
                return None;
            }
            self.edition = self.next_edition();
            return self.install();
        }
        self.stretch();
        if self.landing().is_some_and(|landing| !ring::lies_flat(self.chain.first(), landing)) {
            self.renumber();
        }
        let jump = self.chain.jump().or(self.overrun);
        match self.deviation() {
            Some(new_from) if !may_install && jump.is_none() && self.may_wait(new_from) => None,
            Some(new_from) => self.upload(jump, new_from),
            // the same list again is no news for PX4, whatever it says of the entry to go on at
            None => jump.map(|position| self.set_current(position)),
        }
    }

    fn moved(&mut self, fix: &Fix) {
        self.fix = Some(*fix);
        if self.entered {
            self.chain.leave_climb_out_behind(fix);
            self.leave_behind_what_leads_in(fix);
        }
    }

    fn done(&mut self) {
        match self.pending.take() {
            Some(Pending::Upload { items, jump, .. }) => {
                self.installed = true;
                self.farthest = self.farthest_of(&items);
                self.lists = vec![items];
                jump.or(self.overrun).into_iter().for_each(|position| self.send_to(position, jump.is_none()));
            }
            Some(Pending::SetCurrent { position }) => self.arrived_at(position),
            None => {}
        }
    }

    fn failed(&mut self) {
        let Some(Pending::Upload { items, .. }) = self.pending.take() else { return };
        if !self.installed {
            return;
        }
        self.farthest = self.farthest.max(self.farthest_of(&items));
        // where nothing is known, one list more makes nothing certain
        if !self.lists.is_empty() && !self.lists.contains(&items) {
            self.lists.push(items);
        }
        if self.lists.len() > MOST_LISTS {
            self.lists.clear();
        }
    }

    fn installed(&self) -> bool {
        self.installed
    }

    fn ready(&self) -> bool {
        let told = self.sent_to.or(self.overrun).or(self.chain.jump());
        let settled = self.pending.is_none() && told.is_none();
        self.installed && self.entered && settled && self.deviation().is_none()
    }

    fn target(&self) -> Target {
        if !self.entered {
            return Target::None;
        }
        let Some(active) = self.chain.active() else { return Target::End };
        let item = ring::item_of(&active.waypoint);
        if self.steered_to().is_some_and(|steered| matches(&steered, &item)) {
            Target::Waypoint(active.serial)
        } else {
            Target::Unknown { next: self.chain.next() }
        }
    }

    fn is_at_end(&self) -> bool {
        self.target() == Target::End && self.steered_to().as_ref().is_some_and(ring::is_end_loiter)
    }
}

impl Window {
    /// A window with waypoints that were fed before the autopilot was known; `landing_deg`: how steep a landing may be, if it says that.
    pub fn new(early: Chain, landing_deg: Option<f64>) -> Self {
        let steepest = Steepest::told(landing_deg);
        let chain = Chain::resumed(0, steepest.with_close_ins(None, early.into_waypoints()));
        Self { chain, steepest, ..Self::default() }
    }

    /// With nothing in it, for the same autopilot. For that the list that it has would be no news.
    fn anew(&self) -> Self {
        Self { steepest: self.steepest, edition: self.next_edition(), ..Self::default() }
    }

    fn next_edition(&self) -> u16 {
        (self.edition + 1) % MOST_EDITIONS
    }

    /// What it steers to for certain.
    fn steered_to(&self) -> Option<Item> {
        let leaving = matches!(&self.pending, Some(Pending::Upload { jump: Some(_), .. }));
        if leaving || self.sent_to.is_some() || self.overrun.is_some() {
            return None;
        }
        self.aboard(self.chain.first())
    }

    /// What is on board at a position for certain, whichever list is in use.
    fn aboard(&self, position: u64) -> Option<Item> {
        let coming = match &self.pending {
            Some(Pending::Upload { items, .. }) => Some(items),
            _ => None,
        };
        let at = |list: &Vec<Item>| list.get(usize::from(entry(position))).copied();
        let item = self.lists.first().and_then(at)?;
        let mut others = self.lists.iter().skip(1).chain(coming).map(at);
        others.all(|other| other.is_some_and(|o| matches(&o, &item))).then_some(item)
    }

    /// A position of the chain (or its end loiter) by entry.
    fn position_of(&self, seq: u16) -> Option<u64> {
        let first = self.chain.first();
        let coming = match &self.pending {
            Some(Pending::Upload { items, .. }) => self.farthest_of(items),
            _ => 0,
        };
        (first..=self.farthest.max(coming).max(first)).find(|p| entry(*p) == seq)
    }

    /// The first end loiter or landing in a list, from where the aircraft is.
    fn farthest_of(&self, list: &[Item]) -> u64 {
        let first = self.chain.first();
        let ends = |p: &u64| list.get(usize::from(entry(*p))).is_some_and(ring::is_end);
        (first..first + RING - 1).find(ends).unwrap_or(first + AHEAD)
    }

    /// It is at a position; `differ`: the first one at which the lists that may be in use are not the same. It can't be
    /// farther along the right one.
    fn reach(&mut self, position: u64, differ: Option<u64>) {
        let most = differ.into_iter().chain(self.overrun).fold(position, u64::min).max(self.chain.first());
        if position > most {
            self.overrun = Some(most);
        }
        self.chain.advance_to(position.min(most));
    }

    /// It goes on where it was told to; in flight, it may be farther by now, but not along what was fed meanwhile.
    fn has_gone_on(&self, position: u64, wanted: u64) -> bool {
        position == wanted || (position > wanted && self.entered && !self.disobeys)
    }

    fn arrived_at(&mut self, position: u64) {
        self.entered = true;
        self.sent_to = None;
        self.overrun = None;
        self.disobeys = false;
        self.chain.advance_to(position);
    }

    fn send_to(&mut self, position: u64, again: bool) {
        self.sent_to = Some(position);
        self.disobeys = again;
    }

    /// What is wanted at a position. `None`: nothing is known to circle about.
    fn wanted(&self, position: u64) -> Option<Item> {
        match self.chain.at(position) {
            Some(waypoint) if position < self.end => {
                let item = ring::item_of(waypoint);
                let is_left = item.kind == ItemKind::Land && !self.ends_at(position);
                let leads_nowhere = self.chain.is_left_behind(position);
                match (is_left, leads_nowhere) {
                    (true, _) => Some(self.instead_of_landing(position, item)),
                    (false, true) => Some(self.comes_from(position + 1).unwrap_or(item)),
                    (false, false) => Some(item),
                }
            }
            _ => {
                let before = self.chain.before(position).or_else(|| self.aboard(position))?;
                Some(before.end_loiter())
            }
        }
    }

    /// How far on board the chain should reach: extended in large steps, so that there are few lists.
    fn stretch(&mut self) {
        let (first, full) = (self.chain.first(), self.chain.end());
        let many = self.end >= first + REFILL && self.lasts_behind_the_next_line();
        let enough = many || self.end >= full;
        if !enough || self.end < first {
            self.end = full.min(first + AHEAD);
        }
        self.end = self.landing().map_or(self.end.min(full), |landing| landing + 1);
    }

    /// Counts positions anew, so that what is left lies flat. What is on board has other numbers, and says nothing:
    /// until the new list is in use, nothing that is reported counts.
    fn renumber(&mut self) {
        self.end = 1 + self.end - self.chain.first();
        self.chain.renumber(1);
        self.farthest = self.end;
        self.lists.clear();
        self.overrun = Some(1);
    }

    /// First position that is not on board as wanted, for certain.
    fn deviation(&self) -> Option<u64> {
        let first = self.chain.first();
        let in_order = |p: u64| match (self.aboard(p), self.wanted(p)) {
            (Some(have), Some(want)) => matches(&have, &want),
            (_, want) => want.is_none(),
        };
        let last = self.landing().unwrap_or(self.end);
        (first..=last).find(|p| !self.chain.is_left_behind(*p) && !in_order(*p))
    }

    fn install(&mut self) -> Option<Change> {
        self.chain.restart();
        if self.ends_at(0) {
            // no list begins with its landing: what that comes from stands before it
            self.chain.renumber(1);
        }
        self.lists.clear();
        self.sent_to = None;
        self.end = 0;
        self.entered = false;
        self.stretch();
        self.upload(Some(self.chain.first()), self.chain.first())
    }

    fn upload(&mut self, jump: Option<u64>, new_from: u64) -> Option<Change> {
        let first = self.chain.first();
        let (passed, wanted) = (self.chain.before(first), |p| self.wanted(p));
        let items = match self.landing() {
            Some(landing) => {
                let from = self.comes_from(landing).or(passed);
                ring::list_that_lands((first, landing), self.edition, from, wanted)?
            }
            None => ring::list((first, self.end), self.edition, passed, wanted)?,
        };
        // of a list that nobody knows, nothing can be overrun
        let new_from = if self.lists.is_empty() { u64::MAX } else { new_from };
        self.pending = Some(Pending::Upload { items: items.clone(), jump, new_from });
        Some(Change::Upload { items, current: jump.map(entry) })
    }

    fn set_current(&mut self, position: u64) -> Change {
        self.pending = Some(Pending::SetCurrent { position });
        Change::SetCurrent(entry(position))
    }
}
