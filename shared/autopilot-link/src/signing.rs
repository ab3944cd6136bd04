//! Pure: MAVLink 2 signing (<https://mavlink.io/en/guide/message_signing.html>): frames that only who has the key can have made,
//! and that can't be sent again by somebody who has recorded them.
// the bytes come from a link
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use crate::frame::{CHECKSUM_BYTES, Frame, SIGNED, Sender, checksum, message_id};
use mavlink::MavlinkVersion;
use sha2::{Digest, Sha256};
use std::fmt;
use std::time::Duration;

const KEY_BYTES: usize = 32;
const STAMP_BYTES: usize = 6;
const VALUE_BYTES: usize = 6;
/// Stamps are in so many microseconds.
const UNIT_US: u128 = 10;
/// And begin in 2015, seconds since 1970.
const BEGIN_S: u64 = 1_420_070_400;
/// A sender that was not heard before may be so much behind, in units of a stamp: a minute.
const BEHIND: u64 = 6_000_000;
/// Senders whose stamps are remembered. More are no autopilot's.
const SENDERS: usize = 256;
/// The message of a radio, which has no key.
const RADIO_STATUS: u32 = 109;

/// A key that both ends have. It is never shown.
#[derive(Clone, PartialEq, Eq)]
pub struct Key([u8; KEY_BYTES]);

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key(…)")
    }
}

/// Why a text is no key; it does not repeat the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it is empty; write a passphrase into it, or a key of 64 hexadecimal digits")]
pub struct NoKey;

impl Key {
    /// Of a key file: 64 hexadecimal digits are the key itself, anything else is a passphrase, whose SHA-256 is the key as in
    /// Mission Planner, MAVProxy and QGroundControl. The end of the line does not belong to it.
    ///
    /// # Errors
    /// It is empty.
    pub fn read(text: &str) -> Result<Self, NoKey> {
        let text = text.trim_end_matches(['\r', '\n']);
        if text.trim().is_empty() {
            return Err(NoKey);
        }
        Ok(Self(hexadecimal(text.trim()).unwrap_or_else(|| Sha256::digest(text.as_bytes()).into())))
    }

    /// Of a frame up to its stamp.
    fn value(&self, frame: &[u8]) -> [u8; VALUE_BYTES] {
        let digest: [u8; 32] = Sha256::new().chain_update(self.0).chain_update(frame).finalize().into();
        digest.first_chunk().copied().unwrap_or_default()
    }

    /// The frame was signed with this key, whenever that was.
    pub fn has_signed(&self, frame: &Frame<'_>) -> bool {
        let (Some(_), Some((rest, value))) =
            (frame.signature(), frame.bytes.split_last_chunk::<VALUE_BYTES>())
        else {
            return false;
        };
        // no earlier answer for a better guess
        let differs = self.value(rest).iter().zip(value).fold(0, |differs, (a, b)| differs | (a ^ b));
        differs == 0
    }
}

fn hexadecimal(text: &str) -> Option<[u8; KEY_BYTES]> {
    if text.len() != 2 * KEY_BYTES || !text.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let mut key = [0; KEY_BYTES];
    for (at, byte) in key.iter_mut().enumerate() {
        *byte = u8::from_str_radix(text.get(2 * at..2 * at + 2)?, 16).ok()?;
    }
    Some(key)
}

/// One end of a signed conversation.
#[derive(Debug, Clone)]
pub struct Signing {
    key: Key,
    /// The time of day at the start, as a stamp, and when that was.
    start: u64,
    began: Option<Duration>,
    /// The newest stamp, of what was sent or received: stamps only grow.
    newest: u64,
    /// The newest of each sender, by the number that it gives its link.
    senders: Vec<((Sender, u8), u64)>,
}

impl Signing {
    /// With this key. `unix`: the time of day, since 1970.
    pub fn new(key: Key, unix: Duration) -> Self {
        let since = unix.saturating_sub(Duration::from_secs(BEGIN_S)).as_micros() / UNIT_US;
        let start = u64::try_from(since).unwrap_or(u64::MAX);
        Self { key, start, began: None, newest: 0, senders: Vec::new() }
    }

    /// The key.
    pub fn key(&self) -> &Key {
        &self.key
    }

    /// A stamp for now, a monotonic time; it is newer than all that were seen.
    fn stamp(&mut self, now: Duration) -> u64 {
        let began = *self.began.get_or_insert(now);
        let passed = u64::try_from(now.saturating_sub(began).as_micros() / UNIT_US).unwrap_or(u64::MAX);
        self.start.saturating_add(passed).max(self.newest.saturating_add(1))
    }

    /// Signs the MAVLink 2 frame that begins at a place of `bytes` and ends with them. `link`: our number of the link.
    pub fn sign(&mut self, now: Duration, link: u8, bytes: &mut Vec<u8>, begin: usize) {
        let stamp = self.stamp(now);
        let Some(frame) = bytes.get_mut(begin..) else { return };
        let Some(id) = message_id(MavlinkVersion::V2, frame) else { return };
        if let Some(flags) = frame.get_mut(2) {
            *flags |= SIGNED;
        }
        // it covers the flags
        bytes.truncate(bytes.len().saturating_sub(CHECKSUM_BYTES));
        let checksum = checksum(bytes.get(begin..).unwrap_or_default(), id);
        bytes.extend_from_slice(&checksum);
        bytes.push(link);
        bytes.extend(stamp.to_le_bytes().into_iter().take(STAMP_BYTES));
        let value = self.key.value(bytes.get(begin..).unwrap_or_default());
        bytes.extend_from_slice(&value);
        self.newest = stamp;
    }

    /// Whether a frame may be believed: it is signed with the key, and newer than all from its sender before. A radio's report on
    /// itself is not signed.
    pub fn believes(&mut self, now: Duration, frame: &Frame<'_>) -> bool {
        if frame.id == RADIO_STATUS {
            return true;
        }
        let Some([link, s0, s1, s2, s3, s4, s5, ..]) = frame.signature() else { return false };
        let stamp = u64::from_le_bytes([*s0, *s1, *s2, *s3, *s4, *s5, 0, 0]);
        if !self.key.has_signed(frame) {
            return false;
        }
        let sender = (frame.sender, *link);
        let own = self.stamp(now);
        let room = self.senders.len() < SENDERS;
        let known = self.senders.iter_mut().find(|(known, _)| *known == sender);
        match known {
            Some((_, newest)) if stamp > *newest => *newest = stamp,
            None if room && stamp.saturating_add(BEHIND) >= own => {
                self.senders.push((sender, stamp));
            }
            _ => return false,
        }
        self.newest = self.newest.max(stamp);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Decoder, encode};
    use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavMessage};

    const AUTOPILOT: Sender = Sender { system: 1, component: 1 };
    const NOW: Duration = Duration::from_secs(1_763_884_800);

    fn signing(key: &str, unix: Duration) -> Signing {
        Signing::new(Key::read(key).unwrap(), unix)
    }

    fn plain() -> Vec<u8> {
        encode(AUTOPILOT, 0, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT))
    }

    fn signed(by: &mut Signing, after_s: u64) -> Vec<u8> {
        let mut bytes = vec![9, 9];
        bytes.extend(plain());
        by.sign(Duration::from_secs(after_s), 3, &mut bytes, 2);
        bytes.split_off(2)
    }

    fn believes(by: &mut Signing, bytes: &[u8]) -> bool {
        let mut decoder = Decoder::default();
        decoder.push(bytes);
        let frame = decoder.next_frame().expect("its checksum is right");
        by.believes(Duration::ZERO, &frame)
    }

    #[test]
    fn keys_are_hexadecimal_or_passphrases_and_never_shown() {
        let digits = "00".repeat(31) + "fF";
        assert_eq!(Key::read(&(digits.clone() + "\n")).unwrap().0[30..], [0, 255]);
        // as `hashlib.sha256(b"abc")`
        let abc = Key::read("abc\r\n").unwrap();
        assert_eq!(abc.0[..4], [0xba, 0x78, 0x16, 0xbf]);
        assert_ne!(Key::read("abc ").unwrap(), abc, "a blank may belong to it");
        assert_eq!(Key::read("x".repeat(64).as_str()).map(|key| key.0 != [0; 32]), Ok(true));
        assert_eq!(Key::read(" \n"), Err(NoKey));
        assert_eq!(format!("{abc:?} {:?}", signing("abc", NOW)).matches("186").count(), 0);
    }

    #[test]
    fn what_is_signed_is_believed_once_and_only_with_the_key() {
        let (mut far, mut own) = (signing("one", NOW), signing("one", NOW));
        let first = signed(&mut far, 0);
        let second = signed(&mut far, 0);
        assert!(believes(&mut own, &first) && believes(&mut own, &second));
        assert!(!believes(&mut own, &first) && !believes(&mut own, &second), "they are repeated");
        assert!(!believes(&mut signing("two", NOW), &first), "another key");
        assert!(!believes(&mut own, &plain()), "it is not signed");
        let mut spoilt = signed(&mut far, 1);
        *spoilt.last_mut().unwrap() ^= 1;
        assert!(!believes(&mut own, &spoilt));
    }

    #[test]
    fn a_sender_that_was_not_heard_before_is_not_more_than_a_minute_behind() {
        for (behind_s, believed) in [(0, true), (59, true), (61, false), (1_000_000, false)] {
            let mut far = signing("one", NOW - Duration::from_secs(behind_s));
            let frame = signed(&mut far, 0);
            assert_eq!(believes(&mut signing("one", NOW), &frame), believed, "{behind_s} s");
        }
        // one whose clock is ahead takes ours with it
        let (mut far, mut own) = (signing("one", NOW + Duration::from_secs(1000)), signing("one", NOW));
        assert!(believes(&mut own, &signed(&mut far, 0)));
        let answer = signed(&mut own, 0);
        assert!(believes(&mut far, &answer), "it would be too old");
    }

    #[test]
    fn stamps_grow_whatever_the_clock_does() {
        let (mut far, mut own) = (signing("one", NOW), signing("one", NOW));
        for after_s in [5, 5, 3, 0, 6] {
            assert!(believes(&mut own, &signed(&mut far, after_s)), "{after_s}");
        }
    }

    #[test]
    fn a_radio_has_no_key() {
        let bytes =
            crate::frame::encode_payload(Sender { system: 51, component: 68 }, 0, RADIO_STATUS, &[0; 9]);
        assert!(believes(&mut signing("one", NOW), &bytes));
    }

    #[test]
    fn more_senders_than_can_be_are_not_remembered() {
        let mut own = signing("one", NOW);
        let mut believed = 0;
        for system in 1..=40 {
            for component in 1..=10 {
                let mut far = signing("one", NOW);
                let sender = Sender { system, component };
                let mut bytes = encode(sender, 0, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT));
                far.sign(Duration::ZERO, 0, &mut bytes, 0);
                believed += usize::from(believes(&mut own, &bytes));
            }
        }
        assert_eq!((believed, own.senders.len()), (SENDERS, SENDERS));
    }
}
