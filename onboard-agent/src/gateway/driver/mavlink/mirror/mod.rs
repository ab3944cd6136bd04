//! The mirror: another ground station's program watches the vehicle, and can change nothing.
//!
//! It sees what the autopilot says, frame by frame, and in its name the list that is aboard. What it asks for is answered from what
//! is known here; what it orders is refused in the protocol's own words (`answers`). Nothing of it goes on to the autopilot: there
//! is no way from here to there.

mod answers;
mod parameters;
#[cfg(test)]
mod tests;

use super::Peer;
use super::mission::Entry;
use crate::gateway::driver::FromLink;
use crate::gateway::order::Time;
use autopilot_link::Outbox;
use autopilot_link::frame::{Decoder, Frame, encode_into, encode_payload};
use mavlink::MessageData;
use mavlink::dialects::ardupilotmega::*;
use parameters::Parameters;
use std::collections::BTreeMap;

/// Kinds of messages whose last one is kept, to be shown when it is asked for.
const KINDS: usize = 256;
/// Messages with a part in somebody's conversation with the autopilot: another one can't follow it.
#[expect(deprecated, reason = "programs still speak so")]
const CONVERSATIONS: [u32; 18] = [
    PING_DATA::ID,
    PARAM_VALUE_DATA::ID,
    MISSION_ITEM_DATA::ID,
    MISSION_REQUEST_DATA::ID,
    MISSION_REQUEST_LIST_DATA::ID,
    MISSION_COUNT_DATA::ID,
    MISSION_ACK_DATA::ID,
    MISSION_REQUEST_INT_DATA::ID,
    MISSION_ITEM_INT_DATA::ID,
    COMMAND_ACK_DATA::ID,
    COMMAND_LONG_DATA::ID,
    COMMAND_INT_DATA::ID,
    FILE_TRANSFER_PROTOCOL_DATA::ID,
    TIMESYNC_DATA::ID,
    LOG_ENTRY_DATA::ID,
    LOG_DATA_DATA::ID,
    SETUP_SIGNING_DATA::ID,
    PARAM_ERROR_DATA::ID,
];

/// The mirror. See the module's text.
#[derive(Debug, Default)]
pub struct Mirror {
    decoder: Decoder,
    /// In whose name we speak, once it was heard.
    autopilot: Option<Peer>,
    parameters: Parameters,
    /// The last message of each kind.
    latest: BTreeMap<u32, Vec<u8>>,
    sequence: u8,
    out: Outbox,
    /// When it was last told that nothing can be changed here.
    told: Option<Time>,
}

impl Mirror {
    /// The autopilot said something.
    pub fn pass(&mut self, frame: &Frame<'_>) {
        self.autopilot = Some(frame.sender);
        if frame.id == PARAM_VALUE_DATA::ID || frame.id == HEARTBEAT_DATA::ID {
            self.parameters.hear(frame);
        }
        if CONVERSATIONS.contains(&frame.id) {
            return;
        }
        self.say_payload(frame.sender, frame.id, frame.payload);
        if let Some(kept) = self.latest.get_mut(&frame.id) {
            kept.clear();
            kept.extend_from_slice(frame.payload);
        } else if self.latest.len() < KINDS {
            self.latest.insert(frame.id, frame.payload.to_vec());
        }
    }

    /// Takes in what the link to the other program brought.
    pub fn receive(&mut self, from: FromLink<'_>) {
        match from {
            FromLink::Connected => self.decoder.restart(),
            FromLink::Stream(bytes) => self.decoder.push(bytes),
            FromLink::Datagram(bytes) => self.decoder.push_datagram(bytes),
        }
    }

    /// Answers the next message of what was received. `list`: what is aboard. False: there is none left.
    pub fn process(&mut self, now: Time, list: &[Entry]) -> bool {
        let mut decoder = std::mem::take(&mut self.decoder);
        let frame = decoder.next_frame();
        let more = frame.is_some();
        if let (Some(frame), Some(autopilot)) = (frame, self.autopilot) {
            self.answer(now, autopilot, &frame, list);
        }
        self.decoder = decoder;
        more
    }

    /// Hands over the frames for the other program. `link`: the number of the link to it.
    pub fn send(&mut self, link: usize, outbox: &mut Outbox) {
        for frame in self.out.frames() {
            outbox.push_over(link, |bytes| bytes.extend_from_slice(frame));
        }
        self.out.clear();
    }

    fn say(&mut self, autopilot: Peer, message: &MavMessage) {
        self.out.push(|bytes| encode_into(autopilot, self.sequence, message, bytes));
        self.sequence = self.sequence.wrapping_add(1);
    }

    fn say_payload(&mut self, autopilot: Peer, id: u32, payload: &[u8]) {
        let frame = encode_payload(autopilot, self.sequence, id, payload);
        self.out.push(|bytes| bytes.extend_from_slice(&frame));
        self.sequence = self.sequence.wrapping_add(1);
    }

    /// The last message of a kind again. False: there was none.
    fn say_again(&mut self, autopilot: Peer, id: u32) -> bool {
        let Some(payload) = self.latest.get(&id).cloned() else { return false };
        self.say_payload(autopilot, id, &payload);
        true
    }
}
