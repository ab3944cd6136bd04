//! Frames from bytes, whatever they are, and to bytes.

use super::*;
use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, TIMESYNC_DATA};
use proptest::prelude::*;

const AUTOPILOT: Sender = Sender { system: 1, component: 1 };

fn timesync(ts1: i64) -> MavMessage {
    MavMessage::TIMESYNC(TIMESYNC_DATA { tc1: 0, ts1, ..TIMESYNC_DATA::DEFAULT })
}

fn bytes_of(ts1: i64) -> Vec<u8> {
    encode(AUTOPILOT, 0, &timesync(ts1))
}

/// Takes every whole frame: who sent it, and its message.
fn take(decoder: &mut Decoder) -> Vec<(Sender, Option<MavMessage>)> {
    let mut found = vec![];
    while let Some(frame) = decoder.next_frame() {
        found.push((frame.sender, frame.message()));
    }
    found
}

fn decode(bytes: &[u8]) -> (Vec<(Sender, Option<MavMessage>)>, u64) {
    let mut decoder = Decoder::default();
    decoder.push(bytes);
    (take(&mut decoder), decoder.ignored_bytes)
}

#[test]
fn what_is_encoded_is_decoded() {
    for message in [timesync(5), MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT)] {
        let bytes = encode(AUTOPILOT, 7, &message);
        assert_eq!(decode(&bytes), (vec![(AUTOPILOT, Some(message))], 0));
    }
}

#[test]
fn garbage_is_counted_and_the_next_frame_is_found_whatever_the_pieces() {
    let mut bytes = vec![0x00, 0x11, 0xFD, 0x03];
    for i in 1..=5 {
        bytes.extend(bytes_of(i));
        bytes.extend([0xFE, 9, 0xFD]);
    }
    bytes.extend(bytes_of(6));
    bytes.extend([0; 300]);
    let expected: Vec<_> = (1..=6).map(|i| (AUTOPILOT, Some(timesync(i)))).collect();
    for piece in [1, 7, 64, 4096] {
        let (mut decoder, mut found) = (Decoder::default(), vec![]);
        for part in bytes.chunks(piece) {
            decoder.push(part);
            found.extend(take(&mut decoder));
        }
        assert_eq!(found, expected, "pieces of {piece}");
        assert_eq!(decoder.ignored_bytes, 4 + 5 * 3 + 300, "pieces of {piece}");
    }
}

#[test]
fn a_damaged_checksum_loses_only_that_frame_and_is_counted() {
    let mut bytes = bytes_of(1);
    *bytes.last_mut().unwrap() ^= 0x55;
    bytes.extend(bytes_of(2));
    let mut decoder = Decoder::default();
    decoder.push(&bytes);
    assert_eq!(take(&mut decoder), [(AUTOPILOT, Some(timesync(2)))]);
    assert_eq!(decoder.bad_frames, 1);
}

/// A frame of a message that only a newer dialect knows, so that nobody here can tell whether its checksum is right.
fn of_a_strange_kind(sequence: u8) -> Vec<u8> {
    let mut bytes = encode_payload(AUTOPILOT, sequence, 441, &[7, 0xFD, 3, 0, 1]);
    *bytes.last_mut().unwrap() ^= 0x55;
    bytes
}

#[test]
fn a_message_of_a_strange_kind_is_a_frame_without_a_message_and_not_damage() {
    let stream = [bytes_of(1), of_a_strange_kind(2), bytes_of(3), of_a_strange_kind(4)].concat();
    let expected = [Some(timesync(1)), None, Some(timesync(3)), None].map(|message| (AUTOPILOT, message));
    let mut decoder = Decoder::default();
    decoder.push_datagram(&stream);
    assert_eq!(take(&mut decoder), expected);
    let mut in_pieces = Decoder::default();
    let mut found = vec![];
    for byte in stream.iter().chain(&bytes_of(5)) {
        in_pieces.push(&[*byte]);
        found.extend(take(&mut in_pieces));
    }
    assert_eq!(found, [&expected[..], &[(AUTOPILOT, Some(timesync(5)))]].concat());
    assert_eq!((decoder.bad_frames, in_pieces.bad_frames), (0, 0));
    assert_eq!((decoder.ignored_bytes, in_pieces.ignored_bytes), (0, 0));
}

#[test]
fn what_no_frame_follows_is_no_message_of_a_strange_kind() {
    let mut decoder = Decoder::default();
    decoder.push_datagram(&[&of_a_strange_kind(1)[..], &[0, 0], &bytes_of(2)].concat());
    assert_eq!(take(&mut decoder), [(AUTOPILOT, Some(timesync(2)))]);
    assert!(decoder.bad_frames > 0);
}

#[test]
fn a_frame_knows_its_number_its_checksum_and_its_bytes() {
    let bytes = encode(AUTOPILOT, 200, &timesync(1));
    let mut decoder = Decoder::default();
    decoder.push(&[&[0, 1], &bytes[..], &[9]].concat());
    let frame = decoder.next_frame().unwrap();
    let checksum = u16::from_le_bytes([bytes[bytes.len() - 2], bytes[bytes.len() - 1]]);
    assert_eq!((frame.sequence, frame.checksum, frame.bytes), (200, checksum, &bytes[..]));
}

#[test]
fn an_unknown_value_of_an_enumeration_loses_the_message_and_not_the_frame() {
    let mut payload = [0_u8; 33];
    payload[28..30].copy_from_slice(&60_001_u16.to_le_bytes());
    payload[32] = 1;
    let mut bytes = encode_payload(AUTOPILOT, 0, 76, &payload);
    bytes.extend(bytes_of(2));
    let mut decoder = Decoder::default();
    decoder.push(&bytes);
    let frame = decoder.next_frame().unwrap();
    assert_eq!((frame.id, frame.payload, frame.message()), (76, &payload[..], None));
    assert_eq!(take(&mut decoder), [(AUTOPILOT, Some(timesync(2)))]);
}

#[test]
fn version_one_frames_are_understood() {
    let header = MavHeader { system_id: 200, component_id: 3, sequence: 1 };
    let message = MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT);
    let mut raw = mavlink::MAVLinkV1MessageRaw::new();
    raw.serialize_message(header, &message);
    let expected = (Sender { system: 200, component: 3 }, Some(message));
    assert_eq!(decode(raw.raw_bytes()), (vec![expected], 0));
}

#[test]
fn a_cut_datagram_does_not_swallow_the_next_one_and_a_new_stream_not_its_first_frame() {
    let (mut decoder, whole) = (Decoder::default(), bytes_of(1));
    decoder.push_datagram(&whole[..9]);
    assert_eq!(take(&mut decoder), []);
    decoder.push_datagram(&whole);
    assert_eq!((take(&mut decoder).len(), decoder.ignored_bytes), (1, 9));
    decoder.push(&whole[..9]);
    assert_eq!(take(&mut decoder), []);
    decoder.restart();
    decoder.push(&whole);
    assert_eq!((take(&mut decoder).len(), decoder.ignored_bytes), (1, 9));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]
    #[test]
    fn any_bytes_in_any_pieces_give_the_frames_among_them_in_bounded_memory(
        noise in prop::collection::vec(any::<u8>(), 0..600),
        piece in 1..50_usize,
    ) {
        let mut bytes = noise;
        // longer than any frame that a false start could claim
        bytes.extend([0; 300]);
        bytes.extend(bytes_of(77));
        let (mut decoder, mut last) = (Decoder::default(), None);
        for part in bytes.chunks(piece) {
            decoder.push(part);
            last = take(&mut decoder).pop().or(last);
            prop_assert!(decoder.pending.len() - decoder.done <= LONGEST);
        }
        prop_assert_eq!(last, Some((AUTOPILOT, Some(timesync(77)))));
        prop_assert_eq!(decoder.pending.len(), decoder.done);
    }
}
