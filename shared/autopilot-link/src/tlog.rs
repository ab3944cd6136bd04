//! Pure: telemetry logs (`.tlog`) as Mission Planner, MAVProxy and pymavlink write them: before each frame its time, microseconds
//! since 1970, as eight bytes, big-endian.
//!
//! MAVProxy puts the number of the link into the last two bits of the time, and 3 for what was sent; so do we.
// the bytes come from a file
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use crate::frame::{Beginning, LONGEST, begins};

const TIME_BYTES: usize = 8;
/// In the last two bits of the time: it was sent.
const SENT: u64 = 3;

/// Appends a frame that came over a link, by its number; of links beyond the third nothing tells them apart.
pub fn received(time_us: u64, link: usize, frame: &[u8], out: &mut Vec<u8>) {
    record(time_us, (link as u64).min(SENT - 1), frame, out);
}

/// Appends a frame that was sent.
pub fn sent(time_us: u64, frame: &[u8], out: &mut Vec<u8>) {
    record(time_us, SENT, frame, out);
}

fn record(time_us: u64, mark: u64, frame: &[u8], out: &mut Vec<u8>) {
    out.extend_from_slice(&(time_us & !SENT | mark).to_be_bytes());
    out.extend_from_slice(frame);
}

/// Cuts a log that comes in pieces into frames with their times. Keeps at most one unfinished record, once all whole ones
/// were taken.
#[derive(Debug, Clone, Default)]
pub struct Reader {
    pending: Vec<u8>,
    /// Bytes of `pending` that are done with.
    done: usize,
    /// Bytes that belonged to no record.
    pub ignored_bytes: u64,
}

/// A frame of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Record<'a> {
    /// When it was received or sent, microseconds since 1970.
    pub time_us: u64,
    /// The frame.
    pub frame: &'a [u8],
}

impl Reader {
    /// Takes in a piece; take the records by [`Self::next_record`] before the next one.
    pub fn push(&mut self, bytes: &[u8]) {
        self.pending.drain(..self.done.min(self.pending.len()));
        self.done = 0;
        self.pending.extend_from_slice(bytes);
    }

    /// The next whole record; `None`: more bytes are needed.
    pub fn next_record(&mut self) -> Option<Record<'_>> {
        loop {
            let rest = self.pending.get(self.done..)?;
            let (time, frame) = rest.split_first_chunk::<TIME_BYTES>()?;
            match begins(frame) {
                Beginning::Frame(length) => {
                    let (time_us, start) = (u64::from_be_bytes(*time), self.done + TIME_BYTES);
                    self.done = start + length;
                    return Some(Record { time_us, frame: self.pending.get(start..self.done)? });
                }
                Beginning::NeedMore if frame.len() < LONGEST => return None,
                Beginning::NeedMore | Beginning::Nothing => {
                    self.done += 1;
                    self.ignored_bytes += 1;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Sender, encode};
    use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavMessage};
    use proptest::prelude::*;

    fn frame(sequence: u8) -> Vec<u8> {
        encode(Sender { system: 1, component: 1 }, sequence, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT))
    }

    fn read(log: &[u8], piece: usize) -> (Vec<(u64, Vec<u8>)>, Reader) {
        let (mut reader, mut found) = (Reader::default(), vec![]);
        for part in log.chunks(piece) {
            reader.push(part);
            while let Some(record) = reader.next_record() {
                found.push((record.time_us, record.frame.to_vec()));
            }
        }
        (found, reader)
    }

    #[test]
    fn what_is_written_is_read_with_its_time_and_the_link_in_its_last_bits() {
        let mut log = vec![];
        received(1_763_884_800_000_003, 0, &frame(1), &mut log);
        received(1_763_884_800_000_004, 7, &frame(2), &mut log);
        sent(1_763_884_800_000_008, &frame(3), &mut log);
        let expected = vec![
            (1_763_884_800_000_000, frame(1)),
            (1_763_884_800_000_006, frame(2)),
            (1_763_884_800_000_011, frame(3)),
        ];
        for piece in [1, 7, 4096] {
            assert_eq!(read(&log, piece).0, expected, "pieces of {piece}");
        }
    }

    #[test]
    fn damage_in_the_middle_loses_only_what_was_there() {
        let mut log = vec![];
        (0..20).for_each(|n| received(u64::from(n) << 4, 0, &frame(n), &mut log));
        log.splice(100..130, [0xFD; 41]);
        let (found, reader) = read(&log, 64);
        assert!(found.len() >= 16 && found.last() == Some(&(19 << 4, frame(19))), "{}", found.len());
        assert!(reader.ignored_bytes > 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]
        #[test]
        fn any_bytes_are_read_in_bounded_memory(
            noise in prop::collection::vec(any::<u8>(), 0..2000),
            piece in 1..300_usize,
        ) {
            let mut reader = Reader::default();
            for part in noise.chunks(piece) {
                reader.push(part);
                while reader.next_record().is_some() {}
                prop_assert!(reader.pending.len() - reader.done <= TIME_BYTES + LONGEST);
            }
        }
    }
}
