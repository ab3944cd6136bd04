//! Entries that are asked for.

use super::{LIST_WAITS, Phase, Transfer, WINDOW};
use crate::gateway::driver::mavlink::mission::request_list;
use crate::gateway::driver::mavlink::{Peer, mission_type};
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::*;

impl Transfer {
    /// How long is the list?
    pub(super) fn ask_list(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) {
        out.push(request_list(peer));
        if self.rules.reads_in_order {
            let waits = self.rto.timeout() * (1 << self.list_late.min(5));
            self.list_due = now + waits.min(LIST_WAITS.max(self.rto.timeout()));
        }
    }

    pub(super) fn read(&mut self, now: Time, count: usize, peer: Peer, out: &mut Vec<MavMessage>) {
        self.phase = Phase::Reading { got: vec![None; count], next: 0 };
        self.probe = Some(now);
        self.ask(peer, out);
    }

    /// Asks for what is missing, a window at a time.
    pub(super) fn ask(&mut self, peer: Peer, out: &mut Vec<MavMessage>) {
        // asked twice for one it breaks off, if the second question comes after it gave the next
        let copies = if self.rules.reads_in_order { 1 } else { self.copies() };
        let Phase::Reading { got, next } = &mut self.phase else { return };
        let have = got.iter().flatten().count();
        // asked for in order, it gives them all in a row, but breaks off if one is missing
        let window = if self.rules.reads_in_order && self.careful { 1 } else { WINDOW };
        let end = (have + window).min(got.len());
        for (i, _) in got.iter().enumerate().take(end).skip(*next).filter(|(_, g)| g.is_none()) {
            let question = MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
                seq: i as u16,
                target_system: peer.system,
                target_component: peer.component,
                mission_type: mission_type(),
            });
            out.extend(std::iter::repeat_n(question, copies));
        }
        *next = end.max(*next);
    }

    /// On a link that loses frames what does no harm is said twice.
    pub(super) fn copies(&self) -> usize {
        if self.careful { 2 } else { 1 }
    }
}
