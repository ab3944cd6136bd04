//! What is wanted on the autopilot's list, and what is being done to get it there.

#[cfg(test)]
mod tests;

use super::chain::Chain;
use super::item::{Item, ItemKind};
use crate::gateway::order::{Course, Fed, Fix, OrderId, Report, Serial, Target, Time};
use geometry::LatLon;
use std::time::Duration;

/// What failed is done again after this.
const RETRY: Duration = Duration::from_secs(1);
/// The list may be flown elsewhere for so long before the aircraft is brought back.
const ASTRAY_FOR: Duration = Duration::from_secs(2);

/// Something that is to be done to the list.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Replace the whole list, and verify it.
    Upload {
        /// The list.
        items: Vec<Item>,
        /// The entry to go on at; `None`: the autopilot stays where it is.
        current: Option<u16>,
    },
    /// Overwrite entries from `start` on, and verify them.
    Overwrite {
        /// First entry.
        start: u16,
        /// What comes there.
        items: Vec<Item>,
    },
    /// Steer to this entry.
    SetCurrent(u16),
}

/// How unlimited waypoints are kept on an autopilot's small list: its strategy, one kind of autopilot each.
pub trait Feeding: std::fmt::Debug + Send + Sync {
    /// Cancels what is behind `after`, and appends, as one transaction.
    fn feed(&mut self, after: Serial, waypoints: Vec<Fed>);
    /// Leave a waypoint that is being circled for the one after it, if there is one.
    fn leave(&mut self, serial: Serial);
    /// Forget everything: the flight is over.
    fn clear(&mut self);
    /// The list on board is no longer known (reboot, another station's upload).
    fn invalidate(&mut self);
    /// Take over a list that was read from an autopilot which is flying it. `waypoints`: what was
    /// known of it before a restart, the one steered to first; so many of them are on board. `None`: it is not
    /// one of ours.
    fn adopt(&mut self, list: &[Item], current: u16, waypoints: Vec<Fed>) -> Option<usize>;
    /// The autopilot says it steers to entry `seq`.
    fn reported(&mut self, seq: u16);
    /// The autopilot steers to something that is not in the chain.
    fn is_astray(&self, seq: u16) -> bool;
    /// Make the autopilot steer to the chain again.
    fn bring_back(&mut self);
    /// A landing may be so steep, degrees, where the autopilot tells that: of what is fed from now on.
    fn limit_landing(&mut self, _steepest_deg: Option<f64>) {}
    /// The aircraft is here now. For a strategy to which it matters when a list changes.
    fn moved(&mut self, fix: &Fix);
    /// The next change, if one is due and none is in flight. `may_install`: the aircraft is not
    /// flying the list, so that it may be replaced whole. `home`: the take-off place.
    fn next_change(&mut self, may_install: bool, home: Option<Item>) -> Option<Change>;
    /// The change in flight was carried out and confirmed.
    fn done(&mut self);
    /// The change in flight failed or its outcome is unknown: what it touched is unknown, and will
    /// be written again.
    fn failed(&mut self);
    /// Our list is on board.
    fn installed(&self) -> bool;
    /// Everything on board is in order and the aircraft may be let loose on it.
    fn ready(&self) -> bool;
    /// What the autopilot steers to, of what was fed.
    fn target(&self) -> Target;
    /// It circles behind the last waypoint, as far as the autopilot's own list says. For one that is adopted: what was known of it may
    /// be less than what it has.
    fn is_at_end(&self) -> bool {
        self.target() == Target::End
    }
}

/// What is being done to the list.
#[derive(Debug, Clone)]
enum Task {
    /// Something of the window's.
    Change,
    /// It is read, to adopt these waypoints.
    Adopt(OrderId, Vec<Fed>),
}

/// What is to be done next.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Bring this on board.
    Change(Change),
    /// Read the list.
    Read,
}

/// The list. See the module's text.
#[derive(Debug, Default)]
pub struct List {
    /// Once it is known which kind of autopilot it is, and what it takes.
    window: Option<Box<dyn Feeding>>,
    /// What was fed before.
    early: Chain,
    task: Option<Task>,
    retry_at: Option<Time>,
    /// A flight that was met in the air is to be examined.
    adopt: Option<(OrderId, Vec<Fed>)>,
    /// The list may be changed: we know this kind of autopilot.
    pub supported: bool,
    /// The pilot flies, or nobody does any more.
    pub hands_off: bool,
    /// The autopilot flies its list.
    pub flown: bool,
    current: Option<u16>,
    astray_since: Option<Time>,
    home: Option<Item>,
    /// The ground under the aircraft, for an autopilot that does not say where its home is.
    ground: Option<Item>,
    reported: Course,
}

impl List {
    /// Cancel and append, as one transaction.
    pub fn feed(&mut self, after: Serial, waypoints: Vec<Fed>) {
        match &mut self.window {
            Some(window) => window.feed(after, waypoints),
            None => self.early.feed(after, waypoints, false),
        }
    }

    /// It is known how this autopilot's list is kept, and how steep a landing it takes, degrees: from then on it is, by what was told last.
    pub fn keep(&mut self, window: fn(Chain, Option<f64>) -> Box<dyn Feeding>, landing_deg: Option<f64>) {
        let early = &mut self.early;
        self.window
            .get_or_insert_with(|| window(std::mem::take(early), landing_deg))
            .limit_landing(landing_deg);
    }

    /// Leave a loiter for the waypoint after it.
    pub fn leave(&mut self, serial: Serial) {
        if let Some(window) = &mut self.window {
            window.leave(serial);
        }
    }

    /// The flight is over.
    pub fn forget(&mut self) {
        self.early = Chain::default();
        if let Some(window) = &mut self.window {
            window.clear();
        }
        self.adopt = None;
    }

    /// Find out whether waypoints of ours are flown.
    pub fn adopt(&mut self, id: OrderId, known: Vec<Fed>) {
        self.adopt = Some((id, known));
    }

    /// What is aboard is not ours any more: the autopilot started anew, or another station put its list there.
    pub fn lost(&mut self) {
        if let Some(window) = &mut self.window {
            window.invalidate();
        }
    }

    /// The take-off place, metres AMSL.
    pub fn set_home(&mut self, position: LatLon, altitude_amsl_m: f64) {
        self.home = Some(Item { position, altitude_amsl_m, kind: ItemKind::Home });
    }

    /// The aircraft is here now. The ground under it is where its height above home says.
    pub fn moved(&mut self, fix: &Fix) {
        let altitude_amsl_m = fix.altitude_amsl_m - fix.altitude_home_m;
        self.ground = Some(Item { position: fix.position, altitude_amsl_m, kind: ItemKind::Home });
        if let Some(window) = &mut self.window {
            window.moved(fix);
        }
    }

    /// The autopilot says it steers to this entry.
    pub fn steers_to(&mut self, now: Time, seq: u16) {
        self.current = Some(seq);
        let Some(window) = &mut self.window else { return };
        window.reported(seq);
        if !window.is_astray(seq) || !self.flown {
            self.astray_since = None;
            return;
        }
        let since = *self.astray_since.get_or_insert(now);
        if now.saturating_sub(since) > ASTRAY_FOR {
            self.astray_since = None;
            window.bring_back();
        }
    }

    /// What is to be done next, if anything, and nothing is being done.
    pub fn next(&mut self, now: Time) -> Option<Step> {
        if self.task.is_some() || self.window.is_none() || self.retry_at.is_some_and(|at| now < at) {
            return None;
        }
        self.retry_at = None;
        if let Some((id, known)) = self.adopt.take_if(|_| self.current.is_some()) {
            self.task = Some(Task::Adopt(id, known));
            return Some(Step::Read);
        }
        if !self.supported || self.hands_off {
            return None;
        }
        let change = self.window.as_mut()?.next_change(!self.flown, self.home.or(self.ground))?;
        self.task = Some(Task::Change);
        Some(Step::Change(change))
    }

    /// It was done, and the autopilot confirmed it.
    pub fn done(&mut self) {
        if let (Some(Task::Change), Some(window)) = (self.task.take(), &mut self.window) {
            window.done();
        }
    }

    /// It failed, or its outcome is unknown: it is done again.
    pub fn failed(&mut self, now: Time, why: String) -> Option<Report> {
        self.retry_at = Some(now + RETRY);
        match self.task.take()? {
            Task::Change => {
                tracing::warn!(why, "the autopilot's list was not changed");
                self.window.as_mut()?.failed();
                None
            }
            Task::Adopt(id, _) => Some(Report::Failed(id, why)),
        }
    }

    /// The list was read.
    pub fn read(&mut self, list: &[Item]) -> Option<Report> {
        let Some(Task::Adopt(id, known)) = self.task.take() else { return None };
        let aboard = self.window.as_mut()?.adopt(list, self.current.unwrap_or(0), known);
        Some(Report::Adopted(id, aboard))
    }

    /// Ours is aboard, and every waypoint of it was flown.
    pub fn is_at_end(&self) -> bool {
        self.window.as_ref().is_some_and(|w| w.installed() && w.is_at_end())
    }

    /// How far the autopilot is with the waypoints, if that has changed.
    pub fn new_course(&mut self) -> Option<Course> {
        let w = self.window.as_ref()?;
        let course = Course { aboard: w.installed(), ready: w.ready(), target: w.target() };
        (std::mem::replace(&mut self.reported, course) != course).then_some(course)
    }
}
