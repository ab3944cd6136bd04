//! Overwriting a few entries: opening, entries and the requests to read them back, all at once.
//!
//! On a link that loses frames every exchange in a row costs a timeout, so there is just one: a
//! **round** is a complete try of its own. Only what was read back as wanted counts, and acks prove
//! nothing (they may be lost, late, or left over). What was not read back in time is written again, as
//! a round of its own; on a link that was seen to lose frames everything is sent twice.
//!
//! Entries are written in order: an entry is on board only when those before it are.

#[cfg(test)]
mod tests;

use super::mission::{Entry, Same};
use super::rto::Rto;
use super::{Peer, mission_type};
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::*;

/// Rounds without any progress before a write is given up.
const PATIENCE: u32 = 30;

/// One write.
#[derive(Debug, Clone)]
pub struct PartialWrite {
    /// Entries that follow each other.
    items: Vec<Entry>,
    same: Same,
    /// Read back as wanted.
    confirmed: Vec<bool>,
    /// An entry that read back differently, since the last progress.
    differs: Option<u16>,
    rounds: u32,
    rto: Rto,
    /// When the first round was sent; a later one's answers can't be distinguished from an earlier one's.
    probe: Option<Time>,
}

impl PartialWrite {
    /// Begins a write; `rto` carries over what is known of the link.
    pub fn begin(
        now: Time,
        items: Vec<Entry>,
        same: Same,
        rto: Rto,
        peer: Peer,
        out: &mut Vec<MavMessage>,
    ) -> Self {
        let confirmed = vec![false; items.len()];
        let mut partial_write =
            Self { items, same, confirmed, differs: None, rounds: 0, rto, probe: Some(now) };
        partial_write.rto.start(now);
        partial_write.round(peer, out);
        partial_write
    }

    /// What was learnt of the link.
    pub fn into_rto(self) -> Rto {
        self.rto
    }

    /// What is known of the link.
    pub fn rto(&mut self) -> &mut Rto {
        &mut self.rto
    }

    /// Everything was read back as wanted.
    pub fn is_complete(&self) -> bool {
        self.confirmed.iter().all(|c| *c)
    }

    /// Writes and reads back what is not confirmed.
    fn round(&mut self, peer: Peer, out: &mut Vec<MavMessage>) {
        let Some(first) = self.confirmed.iter().position(|c| !c) else { return };
        let last = self.confirmed.iter().rposition(|c| !c).unwrap_or(first);
        let copies = self.rto.copies();
        for _ in 0..copies {
            out.push(self.opening(first, last, peer));
        }
        for _ in 0..copies {
            let entries = self.items.iter().take(last + 1).skip(first);
            out.extend(entries.cloned().map(MavMessage::MISSION_ITEM_INT));
        }
        for _ in 0..copies {
            let missing = (first..=last).filter(|i| self.confirmed.get(*i) == Some(&false));
            out.extend(missing.map(|i| self.question(i, peer)));
        }
    }

    fn opening(&self, first: usize, last: usize, peer: Peer) -> MavMessage {
        MavMessage::MISSION_WRITE_PARTIAL_LIST(MISSION_WRITE_PARTIAL_LIST_DATA {
            start_index: (self.start() + first as u16) as i16,
            end_index: (self.start() + last as u16) as i16,
            target_system: peer.system,
            target_component: peer.component,
            mission_type: mission_type(),
        })
    }

    /// Number of the first entry.
    fn start(&self) -> u16 {
        self.items.first().map_or(0, |i| i.seq)
    }

    fn question(&self, index: usize, peer: Peer) -> MavMessage {
        MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
            seq: self.start() + index as u16,
            target_system: peer.system,
            target_component: peer.component,
            mission_type: mission_type(),
        })
    }

    /// An entry was read back.
    pub fn item(&mut self, now: Time, data: &MISSION_ITEM_INT_DATA) {
        let Some(index) = data.seq.checked_sub(self.start()).map(usize::from) else { return };
        let (Some(wanted), Some(confirmed)) = (self.items.get(index), self.confirmed.get_mut(index)) else {
            return;
        };
        if !(self.same)(wanted, data) {
            self.differs = Some(data.seq);
            return;
        }
        if !std::mem::replace(confirmed, true) {
            self.progressed(now);
        }
    }

    fn progressed(&mut self, now: Time) {
        if let Some(sent) = self.probe.take() {
            self.rto.sample(now.saturating_sub(sent));
        }
        self.rto.no_doubling();
        self.rounds = 0;
        self.differs = None;
    }

    /// The autopilot says that something is wrong. `Some`: it will never take this.
    ///
    /// Duplicates and what comes after a lost frame are answered with errors that mean nothing here.
    pub fn acked(&self, result: MavMissionResult) -> Option<String> {
        use MavMissionResult::*;
        match result {
            MAV_MISSION_ACCEPTED
            | MAV_MISSION_ERROR
            | MAV_MISSION_INVALID_SEQUENCE
            | MAV_MISSION_DENIED
            | MAV_MISSION_OPERATION_CANCELLED => None,
            refused => Some(format!("the autopilot refused the list: {refused:?}")),
        }
    }

    /// Time passed: another round, if one is due. `Some`: given up, and what is on board is unknown.
    pub fn tick(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) -> Option<String> {
        if !self.rto.expired(now) {
            return None;
        }
        self.rounds += 1;
        self.probe = None;
        if self.rounds > PATIENCE {
            return Some(match self.differs {
                Some(entry) => format!("entry {entry} reads back differently each time"),
                None => "the autopilot does not answer".into(),
            });
        }
        self.round(peer, out);
        None
    }
}
