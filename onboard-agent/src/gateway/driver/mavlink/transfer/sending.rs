//! Entries on their way to the autopilot.

use super::{LEAST_WINDOW, Phase, Transfer, WINDOW};
use crate::gateway::driver::mavlink::{Peer, mission_type};
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;

/// More often than this the time is not doubled after which entries are sent again.
const MOST_DOUBLINGS: u32 = 6;

impl Transfer {
    pub(super) fn send_from_start(&mut self, peer: Peer, out: &mut Vec<MavMessage>) {
        self.phase = Phase::Sending { acked: 0, sent: 0, asked: 0 };
        self.complains = false;
        out.extend(std::iter::repeat_n(self.opening(peer), self.copies()));
        self.send_window(out);
    }

    /// What it took before, it has to take again: that is progress, too.
    pub(super) fn send_anew(&mut self, peer: Peer, out: &mut Vec<MavMessage>) {
        self.restarts += 1;
        self.best = 0;
        self.send_from_start(peer, out);
    }

    fn opening(&self, peer: Peer) -> MavMessage {
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count: self.items.len() as u16,
            target_system: peer.system,
            target_component: peer.component,
            mission_type: mission_type(),
            opaque_id: 0,
        })
    }

    /// On a link that loses frames each entry goes twice: of those behind a lost one none is taken.
    pub(super) fn send_window(&mut self, out: &mut Vec<MavMessage>) {
        let (copies, window) = (self.copies(), self.window);
        let Phase::Sending { acked, sent, .. } = &mut self.phase else { return };
        let end = (*acked + window).min(self.items.len());
        for item in self.items.iter().take(end).skip(*sent) {
            out.extend(std::iter::repeat_n(MavMessage::MISSION_ITEM_INT(item.clone()), copies));
        }
        *sent = end.max(*sent);
    }

    /// The autopilot asks for an entry.
    pub fn requested(&mut self, now: Time, seq: u16, out: &mut Vec<MavMessage>) {
        let index = usize::from(seq);
        let Phase::Sending { acked, asked, .. } = &mut self.phase else { return };
        if index >= self.items.len() || index < *acked {
            return;
        }
        if index > *acked {
            let taken = index - *acked;
            (*acked, *asked) = (index, 1);
            self.window = (self.window + taken).min(WINDOW);
            self.moves(now);
            self.send_window(out);
            return;
        }
        *asked += 1;
        let again = *asked > 1;
        if !again {
            self.moves(now);
        } else {
            self.go_back(now, out);
        }
    }

    fn moves(&mut self, now: Time) {
        self.progressed(now);
        (self.moved, self.complains, self.backs) = (now, false, 0);
    }

    /// It complains of an entry that came twice, too; it waits for one that was lost when it has asked for nothing new since.
    pub(super) fn is_stuck(&self, now: Time) -> bool {
        self.complains && matches!(self.phase, Phase::Sending { .. }) && now >= self.stuck_at()
    }

    pub(super) fn stuck_at(&self) -> Time {
        self.moved.max(self.went_back) + self.until_next_back()
    }

    /// What was sent again is answered by then at the earliest. A narrow link takes the longer the more of it waits there, and of what
    /// goes twice no round trip can be measured: each time in vain it is given twice as long, until silence tells as much.
    fn until_next_back(&self) -> Duration {
        let trip = self.rto.trip();
        (trip * (1 << self.backs.min(MOST_DOUBLINGS))).min(self.rto.timeout().max(trip))
    }

    /// Sends again from the first entry that was not acknowledged; at most once a round trip, for
    /// each of a window's remaining items is answered with the same complaint.
    pub(super) fn go_back(&mut self, now: Time, out: &mut Vec<MavMessage>) {
        if now < self.went_back + self.until_next_back() {
            return;
        }
        (self.went_back, self.complains) = (now, false);
        self.backs += 1;
        self.careful = true;
        self.silent += 1;
        self.probe = None;
        if let Phase::Sending { acked, sent, .. } = &mut self.phase {
            *sent = *acked;
        }
        self.send_window(out);
        self.rto.start(now);
    }

    /// Nothing was answered in time.
    pub(super) fn narrow_window(&mut self) {
        self.window = (self.window / 2).max(LEAST_WINDOW);
    }
}
