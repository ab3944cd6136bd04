//! The mission protocol, streamed: one transfer at a time.
//!
//! Items are sent unasked in a window; the autopilot's requests are its acknowledgements; what it
//! does not get it asks for again, and we go back to there. A final ack may be lost, late or left
//! over from an earlier transfer, so it proves nothing: every write is read back, and only what was
//! read back is claimed, or what the autopilot names as the list in use.

mod reading;
mod sending;
#[cfg(test)]
mod tests;

use super::Peer;
use super::mission::{Entry, Outcome, Rules, thanks};
use super::rto::Rto;
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;

/// Items in flight.
const WINDOW: usize = 24;
/// Items in flight on a link that can't keep up: more would only wait before it, for longer than we wait for an answer, and be sent
/// again and again.
const LEAST_WINDOW: usize = 6;
/// Timeouts without any progress before a transfer is given up.
const PATIENCE: u32 = 30;
/// Timeouts without any progress after which an autopilot may have stopped to answer.
const BROKEN_OFF: u32 = 8;
/// Times that a list that reads back differently is written again.
const REWRITES: u32 = 5;
/// Times that a list of which some was taken is sent anew from its first entry before that is given up: each begins with all the
/// patience there is, for on a bad link every entry is lost as often as before.
const RESTARTS: u32 = 10;
/// An autopilot that complains of whatever comes, and asks for nothing new, is given up after this: a radio that is slow and loses a
/// fifth has brought what it waits for by then, however many round trips that takes.
const COMPLAINS_FOR: Duration = Duration::from_secs(30);
/// The list is asked for again after this at most. An autopilot that gives entries in order begins anew with each question for the
/// list that it gets, also with one that comes late.
const LIST_WAITS: Duration = Duration::from_secs(4);
/// Farther than this, an autopilot gives up before what it waits for can be there. (Below the longest trip that is reckoned with, so
/// that it is seen.)
const TOO_FAR: Duration = Duration::from_secs(4);
/// More entries than this is no list.
const MAX_ITEMS: u16 = 2000;

#[derive(Debug, Clone, PartialEq)]
enum Phase {
    /// Items `..acked` were received; `..sent` were sent.
    Sending { acked: usize, sent: usize, asked: u32 },
    /// How long is the list?
    Counting,
    /// Entries are read; those that have come.
    Reading { got: Vec<Option<Entry>>, next: usize },
}

/// One transfer.
#[derive(Debug, Clone)]
pub struct Transfer {
    rules: &'static Rules,
    /// What is written; empty: the list is only read.
    items: Vec<Entry>,
    /// What the autopilot will call it.
    id: Option<u32>,
    phase: Phase,
    rto: Rto,
    silent: u32,
    /// Most that was ever acknowledged: only more than that is progress.
    best: usize,
    rewrites: u32,
    restarts: u32,
    /// The link has lost something.
    careful: bool,
    /// Items in flight now: half as many each time that nothing is answered in time, one more for each that is taken. What is only lost
    /// on the way is no sign of a narrow link.
    window: usize,
    went_back: Time,
    /// Times that it went back since.
    backs: u32,
    /// When it asked for something new.
    moved: Time,
    /// It got an entry that it did not wait for: one is missing, or came twice.
    complains: bool,
    /// Times that the list was asked for in vain.
    list_late: u32,
    /// It is not asked for again before this.
    list_due: Time,
    /// When something was sent whose answer can be timed.
    probe: Option<Time>,
}

impl Transfer {
    /// Begins to replace the list; `rto` carries over what is known of the link.
    pub fn upload(
        now: Time,
        items: Vec<Entry>,
        rules: &'static Rules,
        rto: Rto,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) -> Self {
        let mut transfer = Self::new(now, items, rules, rto);
        transfer.send_from_start(peer, out);
        transfer
    }

    /// Begins to read the list.
    pub fn read_list(
        now: Time,
        rules: &'static Rules,
        rto: Rto,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) -> Self {
        let mut transfer = Self::new(now, vec![], rules, rto);
        transfer.ask_list(now, peer, out);
        transfer
    }

    fn new(now: Time, items: Vec<Entry>, rules: &'static Rules, mut rto: Rto) -> Self {
        rto.start(now);
        Self {
            rules,
            id: rules.id.map(|id| id(&items)).filter(|id| *id != 0),
            items,
            phase: Phase::Counting,
            careful: rto.copies() > 1,
            rto,
            window: WINDOW,
            silent: 0,
            best: 0,
            rewrites: 0,
            restarts: 0,
            went_back: now,
            backs: 0,
            moved: now,
            complains: false,
            list_late: 0,
            list_due: now,
            probe: Some(now),
        }
    }

    /// It is known by this name once it is in use.
    pub fn is_called(&self, id: u32) -> bool {
        self.id == Some(id)
    }

    /// What the autopilot will call the list that is written.
    pub fn name(&self) -> Option<u32> {
        self.id
    }

    fn writes(&self) -> bool {
        !self.items.is_empty()
    }

    /// What was learnt of the link.
    pub fn into_rto(self) -> Rto {
        self.rto
    }

    /// What is known of the link.
    pub fn rto(&mut self) -> &mut Rto {
        &mut self.rto
    }

    fn progressed(&mut self, now: Time) {
        if let Some(sent) = self.probe.take() {
            self.rto.sample(now.saturating_sub(sent));
        }
        let reached = match &self.phase {
            Phase::Sending { acked, .. } => *acked,
            _ => usize::MAX,
        };
        if reached == usize::MAX || reached > self.best {
            self.silent = 0;
            self.best = reached.min(self.items.len());
        }
        self.rto.progress(now);
    }

    /// The autopilot says how the transfer went, or that something is wrong.
    pub fn acked(
        &mut self,
        now: Time,
        result: MavMissionResult,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) -> Option<Outcome> {
        use MavMissionResult::*;
        match (&self.phase, result) {
            // one that comes before the last item was asked for may be left over from another transfer
            (Phase::Sending { sent, acked, .. }, MAV_MISSION_ACCEPTED)
                if *sent == self.items.len() && *acked + 1 >= self.items.len() =>
            {
                self.verify(now, peer, out);
                None
            }
            // not receiving: the end came through and its ack was lost, or the opening was lost
            (Phase::Sending { sent, acked, .. }, MAV_MISSION_ERROR)
                if *sent == self.items.len() && *acked > 0 =>
            {
                self.verify(now, peer, out);
                None
            }
            (Phase::Sending { acked, asked, .. }, MAV_MISSION_INVALID_SEQUENCE)
                if *acked > 0 || *asked > 0 =>
            {
                self.complains = true;
                None
            }
            (
                Phase::Sending { .. },
                MAV_MISSION_ACCEPTED | MAV_MISSION_ERROR | MAV_MISSION_INVALID_SEQUENCE,
            ) => None,
            // another station's transfer, or one that the autopilot gave up: wait and begin again
            (_, MAV_MISSION_DENIED | MAV_MISSION_OPERATION_CANCELLED) => None,
            (Phase::Sending { .. }, refused) => {
                Some(Outcome::Failed(format!("the autopilot refused the list: {refused:?}")))
            }
            (Phase::Reading { .. }, MAV_MISSION_ERROR) if self.rules.reads_in_order => {
                self.careful = true;
                self.read_back(now, peer, out);
                None
            }
            (Phase::Reading { .. } | Phase::Counting, _) => None,
        }
    }

    fn verify(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) {
        self.progressed(now);
        self.read_back(now, peer, out);
    }

    fn read_back(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) {
        if self.rules.reads_in_order {
            self.phase = Phase::Counting;
            self.ask_list(now, peer, out);
        } else {
            self.read(now, self.items.len(), peer, out);
        }
    }

    /// The length of the list.
    pub fn counted(
        &mut self,
        now: Time,
        count: u16,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) -> Option<Outcome> {
        if self.phase != Phase::Counting {
            return None;
        }
        if count > MAX_ITEMS {
            return Some(Outcome::Failed(format!("the autopilot claims a list of {count} entries")));
        }
        self.progressed(now);
        self.read(now, usize::from(count), peer, out);
        self.complete(now, peer, out)
    }

    /// An entry came.
    pub fn item(
        &mut self,
        now: Time,
        data: &MISSION_ITEM_INT_DATA,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) -> Option<Outcome> {
        let index = usize::from(data.seq);
        let Phase::Reading { got, .. } = &mut self.phase else { return None };
        let slot = got.get_mut(index)?;
        if slot.is_some() {
            return None;
        }
        *slot = Some(data.clone());
        self.progressed(now);
        self.ask(peer, out);
        self.complete(now, peer, out)
    }

    fn complete(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) -> Option<Outcome> {
        let Phase::Reading { got, .. } = &self.phase else { return None };
        let list: Vec<Entry> = got.iter().cloned().collect::<Option<_>>()?;
        out.push(thanks(peer));
        if !self.writes() {
            return Some(Outcome::List(list));
        }
        let Some(entry) = self.difference(&list) else { return Some(Outcome::Verified) };
        self.rewrites += 1;
        if self.rewrites > REWRITES {
            return Some(Outcome::Failed(format!("entry {entry} reads back differently each time")));
        }
        self.best = 0;
        self.send_from_start(peer, out);
        self.probe = None;
        self.rto.start(now);
        None
    }

    fn is_kept_from_reading(&self) -> bool {
        let nothing = match &self.phase {
            Phase::Reading { got, .. } => got.iter().all(Option::is_none),
            phase => *phase == Phase::Counting,
        };
        self.writes() && nothing && self.silent >= 3
    }

    /// The first entry that is not what was written.
    fn difference(&self, list: &[Entry]) -> Option<usize> {
        let same = |(a, b)| (self.rules.same)(a, b);
        let differs = self.items.iter().zip(list).position(|pair| !same(pair));
        let end = self.items.len().min(list.len());
        differs.or((self.items.len() != list.len()).then_some(end))
    }

    /// Time passed.
    pub fn tick(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) -> Option<Outcome> {
        if self.is_stuck(now) {
            if now.saturating_sub(self.moved) > COMPLAINS_FOR {
                return Some(Outcome::Failed(self.why_given_up()));
            }
            self.go_back(now, out);
            return None;
        }
        let waits_for_list = self.phase == Phase::Counting && now < self.list_due;
        if waits_for_list || !self.rto.expired(now) {
            return None;
        }
        self.silent += 1;
        self.probe = None;
        self.careful = true;
        if self.silent > PATIENCE || self.restarts > RESTARTS {
            return Some(Outcome::Failed(self.why_given_up()));
        }
        // it may still be waiting for entries: then it does not let us read
        if self.is_kept_from_reading() {
            self.send_anew(peer, out);
            return None;
        }
        match &mut self.phase {
            Phase::Counting => {
                self.list_late += 1;
                self.ask_list(now, peer, out);
            }
            Phase::Sending { acked, asked, .. } if *acked == 0 && *asked == 0 => {
                self.send_from_start(peer, out)
            }
            // the end may have come through although nothing says so: ask
            Phase::Sending { acked, .. } if *acked + 1 == self.items.len() && self.silent >= 2 => {
                self.read_back(now, peer, out);
                self.probe = None;
            }
            Phase::Sending { .. } if self.silent.is_multiple_of(4) => self.send_anew(peer, out),
            Phase::Sending { acked, sent, .. } => {
                *sent = *acked;
                self.narrow_window();
                self.send_window(out);
            }
            // the list has to be asked for again
            Phase::Reading { .. } if self.rules.reads_in_order && self.silent.is_multiple_of(BROKEN_OFF) => {
                self.read_back(now, peer, out);
            }
            Phase::Reading { next, .. } => {
                *next = 0;
                self.ask(peer, out);
            }
        }
        None
    }

    fn why_given_up(&self) -> String {
        let trip = self.rto.trip();
        if trip < TOO_FAR {
            let took_some = self.complains || self.restarts > RESTARTS;
            let why = if took_some {
                "the link loses too much of the list"
            } else {
                "the autopilot does not answer"
            };
            return why.into();
        }
        format!(
            "the link takes {:.0} s there and back, and an autopilot gives up before that: use a faster one for the list",
            trip.as_secs_f64()
        )
    }
}
