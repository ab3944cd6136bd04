//! What is being done to the autopilot's list: one transfer or one partial write at a time.

#[cfg(test)]
mod others_tests;

use super::aboard::Aboard;
use super::partial_write::PartialWrite;
use super::rto::Rto;
use super::transfer::Transfer;
use super::{Peer, mission_type};
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;

/// An entry of the list, as on the wire.
pub type Entry = MISSION_ITEM_INT_DATA;

/// The second, which was read back, is the first, as far as this autopilot keeps it.
pub type Same = fn(&Entry, &Entry) -> bool;

/// How a kind of autopilot deals with its list.
#[derive(Debug)]
pub struct Rules {
    /// Compares what was read back with what was written.
    pub same: Same,
    /// What the autopilot calls a list that it has: written on an accepting ack and on MISSION_CURRENT, it proves that
    /// the list is in use. An autopilot that has no such number says 0.
    pub id: Option<fn(&[Entry]) -> u32>,
    /// Entries may be asked for only after the list was, and in order; otherwise it breaks off.
    pub reads_in_order: bool,
}

/// How it ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Written and read back alike.
    Verified,
    /// The list.
    List(Vec<Entry>),
    /// Given up; what is on board is unknown.
    Failed(String),
}

#[derive(Debug, Clone)]
enum Job {
    Transfer(Transfer),
    Write(PartialWrite),
}

/// The list's one job, and what is known of the link and of the list.
#[derive(Debug, Clone, Default)]
pub struct Mission {
    job: Option<Job>,
    link: Rto,
    aboard: Aboard,
    /// What the autopilot called the list that was in use last.
    named: Option<u32>,
    /// And the one that this one replaced.
    replaced: Option<u32>,
    /// What the list that was verified last will be called, if it is named at all.
    expected: Option<u32>,
    /// The whole list was verified or read since it was last replaced; a write of some of its entries leaves its length.
    known: bool,
    /// It tells how long its list is.
    tells_length: bool,
    /// So many times in a row it said that another list is in use.
    foreign: u32,
}

/// So many times in a row it has to say that another list is in use: a message may be late.
const FOREIGN_AFTER: u32 = 5;

impl Mission {
    /// Replaces the whole list, and verifies it.
    pub fn upload(
        &mut self,
        now: Time,
        entries: Vec<Entry>,
        rules: &'static Rules,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) {
        self.aboard.replace(&entries);
        let link = std::mem::take(&mut self.link);
        self.job = Some(Job::Transfer(Transfer::upload(now, entries, rules, link, peer, out)));
    }

    /// Overwrites entries, which follow each other, and verifies them.
    pub fn overwrite(
        &mut self,
        now: Time,
        entries: Vec<Entry>,
        same: Same,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) {
        self.aboard.overwrite(&entries);
        let link = std::mem::take(&mut self.link);
        self.job = Some(Job::Write(PartialWrite::begin(now, entries, same, link, peer, out)));
    }

    /// Reads the whole list.
    pub fn read(&mut self, now: Time, rules: &'static Rules, peer: Peer, out: &mut Vec<MavMessage>) {
        let link = std::mem::take(&mut self.link);
        self.job = Some(Job::Transfer(Transfer::read_list(now, rules, link, peer, out)));
    }

    /// The autopilot says what the list is called that is in use.
    pub fn in_use(&mut self, list: u32) -> Option<Outcome> {
        match self.job.as_ref()? {
            Job::Transfer(transfer) if transfer.is_called(list) => {}
            _ => return None,
        }
        let before = self.named;
        let outcome = self.finish(Some(Outcome::Verified));
        self.named = Some(list);
        self.replaced = before.filter(|before| *before != list);
        outcome
    }

    /// It says which list is in use. True, once: another one than was verified or read last, which another station has
    /// brought aboard.
    pub fn is_foreign(&mut self, said: &MISSION_CURRENT_DATA) -> bool {
        self.tells_length |= (1..u16::MAX).contains(&said.total);
        if self.expected.is_some_and(|name| name == said.mission_id) {
            self.named = self.expected;
        }
        let is_other = self.is_of_other_length(said.total) || self.is_other(said.mission_id);
        let is_replaced_by_us = matches!(self.job, Some(Job::Transfer(_)));
        self.foreign = if is_other && self.known && !is_replaced_by_us { self.foreign + 1 } else { 0 };
        let found = self.foreign >= FOREIGN_AFTER;
        self.known &= !found;
        found
    }

    /// Some count the home entry, others don't.
    fn is_of_other_length(&self, total: u16) -> bool {
        let ours = self.aboard.entries().len();
        self.tells_length && ![ours, ours.saturating_sub(1)].contains(&usize::from(total))
    }

    /// 0: it does not name its list.
    fn is_other(&self, name: u32) -> bool {
        let ours = self.named.filter(|_| name != 0 && !self.is_replaced(name));
        ours.is_some_and(|ours| ours != name)
    }

    /// It speaks of the list before the one that is in use: this was sent before that was replaced.
    pub fn is_replaced(&self, list: u32) -> bool {
        self.replaced == Some(list)
    }

    /// The list, as it was when it was last verified or read.
    pub fn aboard(&self) -> &[Entry] {
        self.aboard.entries()
    }

    /// Something is being done.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// What is being done is given up.
    pub fn break_off(&mut self, why: &str) -> Option<Outcome> {
        self.is_busy().then(|| Outcome::Failed(why.to_owned())).and_then(|failed| self.finish(Some(failed)))
    }

    /// How long it is there and back.
    pub fn knows_trip(&mut self, trip: Option<Duration>) {
        let rto = match &mut self.job {
            Some(Job::Transfer(transfer)) => transfer.rto(),
            Some(Job::Write(write)) => write.rto(),
            None => &mut self.link,
        };
        rto.knows_trip(trip);
    }

    /// Time passed.
    pub fn tick(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) -> Option<Outcome> {
        let outcome = match self.job.as_mut()? {
            Job::Transfer(transfer) => transfer.tick(now, peer, out),
            Job::Write(write) => write.tick(now, peer, out).map(Outcome::Failed),
        };
        self.finish(outcome)
    }

    /// A message came in, and what it ended, if anything. `None`: it is not about what is being done.
    pub fn on_message(
        &mut self,
        now: Time,
        message: &MavMessage,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) -> Option<Option<Outcome>> {
        if let MavMessage::MISSION_ACK(a) = message
            && a.mission_type == mission_type()
            && a.mavtype == MavMissionResult::MAV_MISSION_ACCEPTED
            && let Some(verified) = self.in_use(a.opaque_id)
        {
            return Some(Some(verified));
        }
        let outcome = match self.job.as_mut()? {
            Job::Transfer(transfer) => on_transfer_message(transfer, now, message, peer, out)?,
            Job::Write(write) => on_write_message(write, now, message)?,
        };
        Some(self.finish(outcome))
    }

    fn finish(&mut self, outcome: Option<Outcome>) -> Option<Outcome> {
        let outcome = outcome?;
        self.aboard.ended(&outcome);
        if matches!(self.job, Some(Job::Transfer(_))) {
            self.known = !matches!(outcome, Outcome::Failed(_));
        }
        (self.replaced, self.named, self.expected, self.foreign) = (None, None, None, 0);
        self.link = match self.job.take()? {
            Job::Transfer(transfer) => {
                self.expected = transfer.name().filter(|_| outcome == Outcome::Verified);
                transfer.into_rto()
            }
            Job::Write(write) => write.into_rto(),
        };
        Some(outcome)
    }
}

#[expect(deprecated, reason = "ArduPilot asks by the deprecated message, and has to be answered")]
fn on_transfer_message(
    transfer: &mut Transfer,
    now: Time,
    message: &MavMessage,
    peer: Peer,
    out: &mut Vec<MavMessage>,
) -> Option<Option<Outcome>> {
    let plan = mission_type();
    match message {
        MavMessage::MISSION_REQUEST(r) if r.mission_type == plan => {
            transfer.requested(now, r.seq, out);
            Some(None)
        }
        MavMessage::MISSION_REQUEST_INT(r) if r.mission_type == plan => {
            transfer.requested(now, r.seq, out);
            Some(None)
        }
        MavMessage::MISSION_ACK(a) if a.mission_type == plan => {
            Some(transfer.acked(now, a.mavtype, peer, out))
        }
        MavMessage::MISSION_COUNT(c) if c.mission_type == plan => {
            Some(transfer.counted(now, c.count, peer, out))
        }
        MavMessage::MISSION_ITEM_INT(i) if i.mission_type == plan => Some(transfer.item(now, i, peer, out)),
        _ => None,
    }
}

fn on_write_message(write: &mut PartialWrite, now: Time, message: &MavMessage) -> Option<Option<Outcome>> {
    let plan = mission_type();
    match message {
        MavMessage::MISSION_ACK(a) if a.mission_type == plan => {
            Some(write.acked(a.mavtype).map(Outcome::Failed))
        }
        MavMessage::MISSION_ITEM_INT(i) if i.mission_type == plan => {
            write.item(now, i);
            Some(write.is_complete().then_some(Outcome::Verified))
        }
        _ => None,
    }
}

/// Asks how long the list is.
pub(super) fn request_list(peer: Peer) -> MavMessage {
    MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA {
        target_system: peer.system,
        target_component: peer.component,
        mission_type: mission_type(),
    })
}

/// Everything that was asked for has come.
pub(super) fn thanks(peer: Peer) -> MavMessage {
    MavMessage::MISSION_ACK(MISSION_ACK_DATA {
        target_system: peer.system,
        target_component: peer.component,
        mavtype: MavMissionResult::MAV_MISSION_ACCEPTED,
        mission_type: mission_type(),
        opaque_id: 0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) const PEER: Peer = Peer { system: 1, component: 1 };
    pub(super) const RULES: Rules = Rules { same: is_same, id: Some(length), reads_in_order: false };

    pub(super) fn is_same(one: &Entry, other: &Entry) -> bool {
        one == other
    }

    fn length(list: &[Entry]) -> u32 {
        list.len() as u32
    }

    #[test]
    fn what_is_said_of_the_list_before_the_one_in_use_is_known_as_that() {
        let mut mission = Mission::default();
        for (length, replaced) in [(3, None), (5, Some(3)), (4, Some(5))] {
            let entries = vec![Entry::DEFAULT; length];
            mission.upload(Time::ZERO, entries, &RULES, PEER, &mut vec![]);
            assert_eq!(mission.in_use(length as u32), Some(Outcome::Verified));
            assert_eq!((0..9).find(|list| mission.is_replaced(*list)), replaced);
        }
        // given up, and not named by the autopilot: nothing is known of names
        mission.upload(Time::ZERO, vec![Entry::DEFAULT; 5], &RULES, PEER, &mut vec![]);
        mission.break_off("no answer");
        assert!((0..9).all(|list| !mission.is_replaced(list)));
    }

    fn said(total: u16, mission_id: u32) -> MISSION_CURRENT_DATA {
        MISSION_CURRENT_DATA { total, mission_id, ..MISSION_CURRENT_DATA::DEFAULT }
    }

    /// How often it has to be said until it is found to be another list.
    fn found(mission: &mut Mission, total: u16, mission_id: u32) -> Option<usize> {
        (1..20).find(|_| mission.is_foreign(&said(total, mission_id)))
    }

    #[test]
    fn a_list_of_another_length_or_name_than_ours_is_another_stations() {
        let of_ours = || {
            let mut mission = Mission::default();
            assert_eq!(found(&mut mission, 7, 99), None, "nothing of ours is known");
            mission.upload(Time::ZERO, vec![Entry::DEFAULT; 5], &RULES, PEER, &mut vec![]);
            assert_eq!(found(&mut mission, 7, 99), None, "it is being written");
            assert_eq!(mission.in_use(5), Some(Outcome::Verified));
            mission
        };
        // its own length with and without home, our name and none
        for (total, name) in [(5, 5), (4, 5), (5, 0), (4, 0)] {
            assert_eq!(found(&mut of_ours(), total, name), None, "{total} {name}");
        }
        for (total, name) in [(9, 5), (5, 77), (0, 0), (u16::MAX, 0)] {
            assert_eq!(found(&mut of_ours(), total, name), Some(5), "{total} {name}");
        }
        let mut once_late = of_ours();
        assert!((0..4).all(|_| !once_late.is_foreign(&said(9, 0))));
        assert!(!once_late.is_foreign(&said(5, 5)));
        assert_eq!(found(&mut once_late, 9, 0), Some(5), "counted anew");
        assert_eq!(found(&mut once_late, 9, 0), None, "it is told once");
    }

    /// Its entries can't be written where there are none any more, and that is tried again and again.
    #[test]
    fn a_list_that_is_replaced_while_entries_are_written_is_found_too() {
        let mut mission = Mission::default();
        mission.upload(Time::ZERO, vec![Entry::DEFAULT; 5], &RULES, PEER, &mut vec![]);
        mission.finish(Some(Outcome::Verified));
        assert_eq!(found(&mut mission, 5, 0), None);
        mission.overwrite(Time::ZERO, vec![Entry::DEFAULT; 2], is_same, PEER, &mut vec![]);
        assert_eq!(found(&mut mission, 9, 0), Some(5), "while it is written");
        mission.break_off("no answer");
        assert_eq!(found(&mut mission, 9, 0), None, "it is told once");
        mission.upload(Time::ZERO, vec![Entry::DEFAULT; 5], &RULES, PEER, &mut vec![]);
        mission.finish(Some(Outcome::Verified));
        mission.overwrite(Time::ZERO, vec![Entry::DEFAULT; 2], is_same, PEER, &mut vec![]);
        mission.break_off("no answer");
        assert_eq!(found(&mut mission, 9, 0), Some(5), "after it was given up");
    }

    #[test]
    fn a_list_that_was_never_called_as_expected_is_not_judged_by_its_name() {
        let mut mission = Mission::default();
        mission.upload(Time::ZERO, vec![Entry::DEFAULT; 5], &RULES, PEER, &mut vec![]);
        mission.finish(Some(Outcome::Verified));
        assert_eq!(found(&mut mission, 5, 1234), None);
        assert!(!mission.is_foreign(&said(5, 5)));
        assert_eq!(found(&mut mission, 5, 1234), Some(5));
    }
}
