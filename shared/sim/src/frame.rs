//! MAVLink frames from bytes and to bytes.
//!
//! The decoder keeps what the message parser would throw away (an enum value it doesn't know loses the
//! whole message), so that even an unknown command gets its answer. Garbage is counted and skipped.

use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message, calculate_crc};

/// System id of the simulated vehicle.
pub const SYSTEM_ID: u8 = 1;
/// Component id of its autopilot.
pub const COMPONENT_ID: u8 = 1;

const STX_V1: u8 = 0xFE;
const STX_V2: u8 = 0xFD;
const SIGNED: u8 = 0x01;
const SIGNATURE_BYTES: usize = 13;

/// Who sent a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sender {
    /// System id.
    pub system: u8,
    /// Component id.
    pub component: u8,
}

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
}

/// A byte stream cut into frames. Holds at most one unfinished frame.
#[derive(Debug, Default)]
pub struct Decoder {
    pending: Vec<u8>,
    /// Bytes that belonged to no good frame.
    pub ignored_bytes: u64,
}

enum Cut {
    NeedMore,
    Skip(usize),
    Frame(usize, Option<Frame>),
}

impl Decoder {
    /// Takes bytes and hands every whole frame to `each`.
    pub fn push(&mut self, bytes: &[u8], mut each: impl FnMut(Frame)) {
        self.pending.extend_from_slice(bytes);
        let mut at = 0;
        while let Some(rest) = self.pending.get(at..).filter(|rest| !rest.is_empty()) {
            match cut(rest) {
                Cut::NeedMore => break,
                Cut::Skip(bytes) => {
                    self.ignored_bytes += bytes as u64;
                    at += bytes;
                }
                Cut::Frame(bytes, frame) => {
                    at += bytes;
                    match frame {
                        Some(frame) => each(frame),
                        None => self.ignored_bytes += bytes as u64,
                    }
                }
            }
        }
        self.pending.drain(..at.min(self.pending.len()));
    }

    /// Decodes a datagram alone: what is left over at its end is garbage, not the start of the next one.
    pub fn datagram(&mut self, bytes: &[u8], each: impl FnMut(Frame)) {
        self.push(bytes, each);
        self.ignored_bytes += self.pending.len() as u64;
        self.pending.clear();
    }
}

/// Looks at the start of `rest`, which isn't empty.
fn cut(rest: &[u8]) -> Cut {
    let Some(start) = rest.iter().position(|b| matches!(*b, STX_V1 | STX_V2)) else {
        return Cut::Skip(rest.len());
    };
    if start > 0 {
        return Cut::Skip(start);
    }
    let (header, version) =
        if rest[0] == STX_V2 { (10, MavlinkVersion::V2) } else { (6, MavlinkVersion::V1) };
    if rest.len() < header {
        return Cut::NeedMore;
    }
    let flags = if header == 10 { rest[2] } else { 0 };
    if flags & !SIGNED != 0 {
        return Cut::Skip(1);
    }
    let payload_end = header + usize::from(rest[1]);
    let total = payload_end + 2 + if flags == SIGNED { SIGNATURE_BYTES } else { 0 };
    if rest.len() < total {
        return Cut::NeedMore;
    }
    let id = match version {
        MavlinkVersion::V2 => u32::from_le_bytes([rest[7], rest[8], rest[9], 0]),
        MavlinkVersion::V1 => u32::from(rest[5]),
    };
    let crc = u16::from_le_bytes([rest[payload_end], rest[payload_end + 1]]);
    if calculate_crc(&rest[1..payload_end], MavMessage::extra_crc(id)) != crc {
        return Cut::Skip(1);
    }
    let sender = Sender { system: rest[header - 5], component: rest[header - 4] };
    let sender = match version {
        MavlinkVersion::V2 => sender,
        MavlinkVersion::V1 => Sender { system: rest[3], component: rest[4] },
    };
    Cut::Frame(total, parse(version, id, sender, &rest[header..payload_end]))
}

fn parse(version: MavlinkVersion, id: u32, sender: Sender, payload: &[u8]) -> Option<Frame> {
    let body = match MavMessage::parse(version, id, payload) {
        Ok(message) => Body::Known(Box::new(message)),
        Err(_) => {
            // a message id the dialect doesn't have is of no use to anybody here
            MavMessage::default_message_from_id(id)?;
            Body::Strange { id, payload: payload.to_vec() }
        }
    };
    Some(Frame { sender, body })
}

/// The bytes of a message from the simulated autopilot.
pub fn encode(sequence: u8, message: &MavMessage) -> Vec<u8> {
    encode_from(Sender { system: SYSTEM_ID, component: COMPONENT_ID }, sequence, message)
}

/// The bytes of a message from anybody.
pub fn encode_from(sender: Sender, sequence: u8, message: &MavMessage) -> Vec<u8> {
    let header = MavHeader { system_id: sender.system.into(), component_id: sender.component, sequence };
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message(header, message);
    raw.raw_bytes().to_vec()
}

/// The bytes of a MAVLink 2 frame around a payload made by hand.
pub fn encode_payload(sequence: u8, id: u32, payload: &[u8]) -> Vec<u8> {
    let length = payload.len().min(255);
    let [id0, id1, id2, _] = id.to_le_bytes();
    let mut bytes = vec![STX_V2, length as u8, 0, 0, sequence, SYSTEM_ID, COMPONENT_ID, id0, id1, id2];
    bytes.extend_from_slice(&payload[..length]);
    let crc = calculate_crc(&bytes[1..], MavMessage::extra_crc(id));
    bytes.extend_from_slice(&crc.to_le_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, TIMESYNC_DATA};
    use proptest::prelude::*;

    fn timesync(ts1: i64) -> MavMessage {
        MavMessage::TIMESYNC(TIMESYNC_DATA { tc1: 0, ts1, ..TIMESYNC_DATA::DEFAULT })
    }

    fn decode(bytes: &[u8]) -> (Vec<Frame>, u64) {
        let (mut decoder, mut frames) = (Decoder::default(), Vec::new());
        decoder.push(bytes, |f| frames.push(f));
        (frames, decoder.ignored_bytes)
    }

    #[test]
    fn what_is_encoded_is_decoded() {
        for message in [timesync(5), MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT)] {
            let (frames, ignored) = decode(&encode(7, &message));
            assert_eq!((frames.len(), ignored), (1, 0));
            assert_eq!(frames[0].body, Body::Known(Box::new(message)));
            assert_eq!(frames[0].sender, Sender { system: 1, component: 1 });
        }
    }

    #[test]
    fn garbage_is_counted_and_the_next_frame_is_found() {
        let mut bytes = vec![0x00, 0x11, 0xFD, 0x03];
        bytes.extend(encode(0, &timesync(1)));
        bytes.extend([9; 40]);
        bytes.extend(encode(1, &timesync(2)));
        bytes.extend([0; 300]);
        let (frames, ignored) = decode(&bytes);
        assert_eq!(frames.len(), 2);
        assert_eq!(ignored, 4 + 40 + 300);
    }

    #[test]
    fn a_damaged_checksum_loses_only_that_frame() {
        let mut bytes = encode(0, &timesync(1));
        *bytes.last_mut().unwrap() ^= 0x55;
        bytes.extend(encode(1, &timesync(2)));
        assert_eq!(decode(&bytes).0, [Frame::new(Sender { system: 1, component: 1 }, timesync(2))]);
    }

    #[test]
    fn an_unknown_enum_value_is_kept_as_a_strange_frame() {
        let mut payload = [0_u8; 33];
        payload[28..30].copy_from_slice(&60_001_u16.to_le_bytes());
        payload[32] = 1;
        let (frames, _) = decode(&encode_payload(0, 76, &payload));
        assert!(matches!(&frames[0].body, Body::Strange { id: 76, .. }), "{frames:?}");
    }

    #[test]
    fn version_one_frames_are_understood() {
        let header = MavHeader { system_id: 200, component_id: 3, sequence: 1 };
        let message = MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT);
        let mut raw = mavlink::MAVLinkV1MessageRaw::new();
        raw.serialize_message(header, &message);
        let expected = Frame::new(Sender { system: 200, component: 3 }, message);
        assert_eq!(decode(raw.raw_bytes()), (vec![expected], 0));
    }

    #[test]
    fn a_cut_datagram_does_not_swallow_the_next_one() {
        let (mut decoder, mut count) = (Decoder::default(), 0);
        let whole = encode(0, &timesync(1));
        decoder.datagram(&whole[..9], |_| count += 1);
        decoder.datagram(&whole, |_| count += 1);
        assert_eq!((count, decoder.ignored_bytes), (1, 9));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn any_bytes_in_any_pieces_give_the_frames_among_them(
            noise in prop::collection::vec(any::<u8>(), 0..600),
            piece in 1..50_usize,
        ) {
            let mut bytes = noise;
            // longer than any frame a false start could claim
            bytes.extend([0; 300]);
            bytes.extend(encode(3, &timesync(77)));
            let (mut decoder, mut last) = (Decoder::default(), None);
            for part in bytes.chunks(piece) {
                decoder.push(part, |f| last = Some(f));
            }
            prop_assert_eq!(last, Some(Frame::new(Sender { system: 1, component: 1 }, timesync(77))));
            prop_assert!(decoder.pending.is_empty());
        }
    }
}
