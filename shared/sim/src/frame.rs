//! What a MAVLink frame says to the simulator.
//!
//! What the message parser would throw away (an enum value that it doesn't know loses the whole message) is
//! kept, so that even an unknown command gets its answer.

use autopilot_link::frame::Frame as RawFrame;
pub use autopilot_link::frame::{Decoder, Sender, encode as encode_from};
use mavlink::Message;
use mavlink::dialects::ardupilotmega::MavMessage;

/// System id of the simulated vehicle.
pub const SYSTEM_ID: u8 = 1;
/// Component id of its autopilot.
pub const COMPONENT_ID: u8 = 1;
const OWN: Sender = Sender { system: SYSTEM_ID, component: COMPONENT_ID };

/// Bytes of a frame around its payload.
const AROUND: usize = 12;

/// What a frame carries.
#[derive(Debug, Clone, PartialEq)]
pub enum Body {
    /// A message of the dialect.
    Known(Box<MavMessage>),
    /// A message of the dialect with a value the dialect doesn't know; the payload is as received.
    Strange {
        /// Message id.
        id: u32,
        /// Payload, trailing zeros possibly cut.
        payload: Vec<u8>,
    },
}

/// A frame whose checksum is right.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Who sent it.
    pub sender: Sender,
    /// What it says.
    pub body: Body,
}

impl Frame {
    /// A message as if `sender` had sent it.
    pub fn new(sender: Sender, message: MavMessage) -> Self {
        Self { sender, body: Body::Known(Box::new(message)) }
    }

    /// How many bytes it has on the line.
    pub fn bytes(&self) -> usize {
        match &self.body {
            Body::Known(message) => encode_from(self.sender, 0, message).len(),
            Body::Strange { payload, .. } => AROUND + payload.len(),
        }
    }

    /// `None`: a message id that the dialect doesn't have is of no use to anybody here.
    fn read(raw: &RawFrame) -> Option<Self> {
        let body = match raw.message() {
            Some(message) => Body::Known(Box::new(message)),
            None => {
                MavMessage::default_message_from_id(raw.id)?;
                Body::Strange { id: raw.id, payload: raw.payload.to_vec() }
            }
        };
        Some(Self { sender: raw.sender, body })
    }
}

/// The frames that are complete.
pub fn take_frames(decoder: &mut Decoder) -> Vec<Frame> {
    let mut frames = vec![];
    while let Some(raw) = decoder.next_frame() {
        frames.extend(Frame::read(&raw));
    }
    frames
}

/// A datagram has a good frame in it.
pub fn is_mavlink(datagram: &[u8]) -> bool {
    let mut decoder = Decoder::default();
    decoder.push_datagram(datagram);
    decoder.next_frame().is_some()
}

/// The bytes of a message from the simulated autopilot.
pub fn encode(sequence: u8, message: &MavMessage) -> Vec<u8> {
    encode_from(OWN, sequence, message)
}

/// The bytes of a MAVLink 2 frame of the simulated autopilot around a payload made by hand.
pub fn encode_payload(sequence: u8, id: u32, payload: &[u8]) -> Vec<u8> {
    autopilot_link::frame::encode_payload(OWN, sequence, id, payload)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_enum_value_is_kept_as_a_strange_frame() {
        let mut payload = [0_u8; 33];
        payload[28..30].copy_from_slice(&60_001_u16.to_le_bytes());
        payload[32] = 1;
        let mut decoder = Decoder::default();
        decoder.push(&encode_payload(0, 76, &payload));
        let frames = take_frames(&mut decoder);
        assert!(matches!(&frames[0].body, Body::Strange { id: 76, .. }), "{frames:?}");
        assert_eq!(frames[0].bytes(), encode_payload(0, 76, &payload).len());
    }
}
