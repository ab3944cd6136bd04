//! MAVLink frames in bytes. Garbage is skipped and counted, never a reason to stop.

use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MAV_STX, MAV_STX_V2, MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message};

/// Longest frame: header 10, payload 255, checksum 2, signature 13.
const LONGEST: usize = 280;
const SIGNED: u8 = 1;

/// One message out of the bytes.
pub type Decoded = (MavHeader, MavMessage);

/// Finds frames in bytes that come in pieces.
#[derive(Debug, Clone, Default)]
pub struct Decoder {
    rest: Vec<u8>,
    /// Bytes that belonged to no frame, and frames that could not be understood.
    pub garbage: u64,
}

enum Found {
    /// `(header, message)`, if it was understood, and the frame's length.
    Frame(Option<Box<Decoded>>, usize),
    Incomplete,
    Nothing,
}

impl Decoder {
    /// Takes in bytes and gives the messages that are complete. Keeps at most one partial frame.
    pub fn feed(&mut self, bytes: &[u8], out: &mut Vec<Decoded>) {
        self.rest.extend_from_slice(bytes);
        let used = self.scan(out);
        self.rest.drain(..used);
    }

    /// As `feed`, for a datagram: what is left over at its end is garbage.
    pub fn feed_datagram(&mut self, bytes: &[u8], out: &mut Vec<Decoded>) {
        self.feed(bytes, out);
        self.garbage += self.rest.len() as u64;
        self.rest.clear();
    }

    fn scan(&mut self, out: &mut Vec<Decoded>) -> usize {
        let mut at = 0;
        while let Some(tail) = self.rest.get(at..).filter(|t| !t.is_empty()) {
            match find(tail) {
                Found::Frame(Some(decoded), length) => {
                    out.push(*decoded);
                    at += length;
                }
                Found::Frame(None, length) => {
                    self.garbage += 1;
                    at += length;
                }
                Found::Incomplete => break,
                Found::Nothing => {
                    self.garbage += 1;
                    at += 1;
                }
            }
        }
        at
    }
}

/// What stands at the beginning of the bytes.
fn find(bytes: &[u8]) -> Found {
    let get = |i: usize| bytes.get(i).copied();
    let v2 = match get(0) {
        Some(MAV_STX_V2) => true,
        Some(MAV_STX) => false,
        _ => return Found::Nothing,
    };
    let (Some(length), Some(flags)) = (get(1), get(2)) else { return Found::Incomplete };
    // other incompatible flags than the signature: not for us
    if v2 && flags & !SIGNED != 0 {
        return Found::Nothing;
    }
    let head = if v2 { 10 } else { 6 };
    let sum = head + usize::from(length);
    let total = sum + 2 + if v2 && flags & SIGNED != 0 { 13 } else { 0 };
    debug_assert!(total <= LONGEST);
    let Some(frame) = bytes.get(..total) else { return Found::Incomplete };
    parse(frame, v2, head, sum).map_or(Found::Nothing, |decoded| Found::Frame(decoded.map(Box::new), total))
}

/// `None`: the checksum is wrong. `Some(None)`: a frame, but not one that is understood.
fn parse(frame: &[u8], v2: bool, head: usize, sum: usize) -> Option<Option<Decoded>> {
    let get = |i: usize| frame.get(i).copied();
    let (id, sequence, system, component, version) = if v2 {
        let id = u32::from_le_bytes([get(7)?, get(8)?, get(9)?, 0]);
        (id, get(4)?, get(5)?, get(6)?, MavlinkVersion::V2)
    } else {
        (u32::from(get(5)?), get(2)?, get(3)?, get(4)?, MavlinkVersion::V1)
    };
    let expected = u16::from_le_bytes([get(sum)?, get(sum + 1)?]);
    let actual = mavlink::calculate_crc(frame.get(1..sum)?, MavMessage::extra_crc(id));
    if actual != expected {
        return None;
    }
    let header = MavHeader { system_id: u32::from(system), component_id: component, sequence };
    // an unknown value in an enumeration loses this message only
    Some(MavMessage::parse(version, id, frame.get(head..sum)?).ok().map(|m| (header, m)))
}

/// A message as MAVLink 2 bytes.
pub fn encode(header: MavHeader, message: &MavMessage) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message(header, message);
    raw.raw_bytes().to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::ardupilotmega::{MISSION_CURRENT_DATA, MissionState};
    use proptest::prelude::*;

    fn frame(seq: u16) -> Vec<u8> {
        let header = MavHeader { system_id: 1, component_id: 1, sequence: 0 };
        let message = MISSION_CURRENT_DATA {
            seq,
            total: 40,
            mission_state: MissionState::MISSION_STATE_ACTIVE,
            mission_mode: 0,
            mission_id: 0,
            fence_id: 0,
            rally_points_id: 0,
        };
        encode(header, &MavMessage::MISSION_CURRENT(message))
    }

    fn seqs(decoded: &[Decoded]) -> Vec<u16> {
        let seq = |d: &Decoded| match &d.1 {
            MavMessage::MISSION_CURRENT(m) => Some(m.seq),
            _ => None,
        };
        decoded.iter().filter_map(seq).collect()
    }

    #[test]
    fn frames_are_found_between_garbage_and_across_pieces() {
        let mut bytes = vec![1, 2, 0xFD, 3];
        for i in 1..=5 {
            bytes.extend(frame(i));
            bytes.extend([0xFE, 9, 0xFD]);
        }
        bytes.extend(frame(6));
        bytes.extend([0; 300]);
        for piece in [1, 7, 64, 4096] {
            let (mut decoder, mut out) = (Decoder::default(), vec![]);
            bytes.chunks(piece).for_each(|c| decoder.feed(c, &mut out));
            assert_eq!(seqs(&out), [1, 2, 3, 4, 5, 6], "pieces of {piece}");
            assert!(decoder.garbage > 0 && decoder.rest.len() < LONGEST);
        }
    }

    #[test]
    fn a_stray_datagram_does_not_stall_the_next() {
        let (mut decoder, mut out) = (Decoder::default(), vec![]);
        decoder.feed_datagram(&[0xFD, 200, 0, 0], &mut out);
        decoder.feed_datagram(&frame(3), &mut out);
        assert_eq!(seqs(&out), [3]);
        assert_eq!(decoder.garbage, 4);
    }

    #[test]
    fn an_unknown_value_of_an_enumeration_loses_only_its_message() {
        let mut bad = frame(1);
        // mission_state is the fifth byte of the payload
        bad[10 + 4] = 200;
        let sum = bad.len() - 2;
        let crc = mavlink::calculate_crc(&bad[1..sum], MavMessage::extra_crc(42)).to_le_bytes();
        bad[sum..].copy_from_slice(&crc);
        bad.extend(frame(2));
        let (mut decoder, mut out) = (Decoder::default(), vec![]);
        decoder.feed(&bad, &mut out);
        assert_eq!(seqs(&out), [2]);
        assert_eq!(decoder.garbage, 1);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]
        #[test]
        fn garbage_is_survived_in_bounded_memory(chunks in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..600), 0..20)) {
            let (mut decoder, mut out) = (Decoder::default(), vec![]);
            for chunk in &chunks {
                decoder.feed(chunk, &mut out);
                prop_assert!(decoder.rest.len() < LONGEST);
            }
            decoder.rest.clear();
            out.clear();
            decoder.feed(&frame(7), &mut out);
            prop_assert_eq!(seqs(&out), vec![7]);
        }
    }
}
