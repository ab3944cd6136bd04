//! A segment of the journal as bytes. Whatever the bytes are, reading them neither panics
//! nor allocates more than a reference per frame.
// the bytes may be damaged
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

/// First bytes of every segment.
const MAGIC: [u8; 8] = *b"LEGWORKJ";
/// Version of the format; others are not read.
const VERSION: u32 = 2;
/// Bytes of a segment's header: magic, version, checksum, number.
pub const HEADER_BYTES: usize = 24;
/// Bytes before a frame's payload: length, its complement, index, checksum.
pub const FRAME_BYTES: usize = 16;
/// Longest payload, bytes.
pub const PAYLOAD_MAX: usize = 64 << 20;
/// Behind a damaged frame, so many places that look like a sound one are looked into.
const PLACES_MAX: usize = 64;

/// A payload longer than [`PAYLOAD_MAX`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a record of {0} bytes is longer than any the journal takes ({PAYLOAD_MAX})")]
pub struct TooLong(usize);

/// Why bytes are no segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoSegment {
    /// It doesn't begin as one.
    #[error("it does not begin as a segment of the journal")]
    Header,
    /// Another format.
    #[error("its format is version {0}, this program reads version {VERSION}")]
    Version(u32),
}

/// How the frames of a segment end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// With the last byte.
    Clean,
    /// What comes last was not written whole: so many bytes are dropped.
    Torn {
        /// Dropped.
        bytes: usize,
    },
    /// A frame is damaged and sound ones stand behind it: nothing from there on can be used.
    Corrupt {
        /// Offset of the damaged frame.
        at: usize,
        /// Dropped, from there to the end.
        bytes: usize,
    },
}

/// What a segment holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scan<'a> {
    /// Its number.
    pub number: u64,
    /// Payloads of its sound frames, in order, up to the first that is not.
    pub payloads: Vec<&'a [u8]>,
    /// What comes behind them.
    pub end: End,
}

/// A segment's header.
pub fn header(number: u64) -> [u8; HEADER_BYTES] {
    let mut bytes = [0; HEADER_BYTES];
    let check = checksum(&[&MAGIC, &VERSION.to_le_bytes(), &number.to_le_bytes()]);
    let parts = MAGIC.into_iter().chain(VERSION.to_le_bytes()).chain(check.to_le_bytes());
    for (byte, value) in bytes.iter_mut().zip(parts.chain(number.to_le_bytes())) {
        *byte = value;
    }
    bytes
}

/// Appends a frame, the `index`-th of segment `number`, to `out`.
///
/// # Errors
/// The payload is too long; nothing is appended.
pub fn append(number: u64, index: u32, payload: &[u8], out: &mut Vec<u8>) -> Result<(), TooLong> {
    let length = u32::try_from(payload.len()).ok().filter(|_| payload.len() <= PAYLOAD_MAX);
    let length = length.ok_or(TooLong(payload.len()))?;
    for value in [length, !length, index, frame_checksum(number, index, payload)] {
        out.extend(value.to_le_bytes());
    }
    out.extend_from_slice(payload);
    Ok(())
}

/// Reads a segment as far as it can be trusted.
///
/// # Errors
/// The header is not one of ours.
pub fn scan(bytes: &[u8]) -> Result<Scan<'_>, NoSegment> {
    let number = read_header(bytes)?;
    let (mut payloads, mut at) = (Vec::new(), HEADER_BYTES);
    let end = loop {
        let rest = bytes.get(at..).unwrap_or_default();
        match sound(rest, number) {
            Some((index, payload)) if usize::try_from(index) == Ok(payloads.len()) => {
                payloads.push(payload);
                at += FRAME_BYTES + payload.len();
            }
            _ if rest.is_empty() => break End::Clean,
            _ if has_sound_frame(rest, number) => break End::Corrupt { at, bytes: rest.len() },
            _ => break End::Torn { bytes: rest.len() },
        }
    };
    Ok(Scan { number, payloads, end })
}

fn read_header(bytes: &[u8]) -> Result<u64, NoSegment> {
    let (magic, rest) = bytes.split_first_chunk::<8>().ok_or(NoSegment::Header)?;
    let (version, rest) = take_u32(rest).ok_or(NoSegment::Header)?;
    let (check, rest) = take_u32(rest).ok_or(NoSegment::Header)?;
    let number = rest.first_chunk::<8>().ok_or(NoSegment::Header)?;
    if *magic != MAGIC || check != checksum(&[magic, &version.to_le_bytes(), number]) {
        return Err(NoSegment::Header);
    }
    if version != VERSION {
        return Err(NoSegment::Version(version));
    }
    Ok(u64::from_le_bytes(*number))
}

/// The frame that `rest` begins with, whole and undamaged: its index and its payload.
fn sound(rest: &[u8], number: u64) -> Option<(u32, &[u8])> {
    let (length, rest) = take_u32(rest)?;
    let (complement, rest) = take_u32(rest)?;
    let (index, rest) = take_u32(rest)?;
    let (check, rest) = take_u32(rest)?;
    let payload = rest.get(..usize::try_from(length).ok().filter(|_| length == !complement)?)?;
    (payload.len() <= PAYLOAD_MAX && check == frame_checksum(number, index, payload))
        .then_some((index, payload))
}

/// Somewhere in `rest` there is a sound frame of this segment.
fn has_sound_frame(rest: &[u8], number: u64) -> bool {
    let looks_like_one = |bytes: &&[u8]| {
        let prefix = take_u32(bytes).and_then(|(length, rest)| Some((length, take_u32(rest)?.0)));
        prefix.is_some_and(|(length, complement)| length == !complement)
    };
    let places = (0..rest.len()).filter_map(|at| rest.get(at..));
    places.filter(looks_like_one).take(PLACES_MAX).any(|bytes| sound(bytes, number).is_some())
}

fn take_u32(bytes: &[u8]) -> Option<(u32, &[u8])> {
    bytes.split_first_chunk::<4>().map(|(value, rest)| (u32::from_le_bytes(*value), rest))
}

/// Over number and index too: a frame of another segment, or in another place, is none.
fn frame_checksum(number: u64, index: u32, payload: &[u8]) -> u32 {
    checksum(&[&number.to_le_bytes(), &index.to_le_bytes(), payload])
}

fn checksum(parts: &[&[u8]]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    parts.iter().for_each(|part| hasher.update(part));
    hasher.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    fn segment(payloads: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = header(7).to_vec();
        for (index, payload) in payloads.iter().enumerate() {
            append(7, u32::try_from(index).unwrap(), payload, &mut bytes).unwrap();
        }
        bytes
    }

    fn payloads() -> impl Strategy<Value = Vec<Vec<u8>>> {
        vec(vec(any::<u8>(), 0..40), 0..6)
    }

    /// So many frames end at or before a length.
    fn whole(payloads: &[Vec<u8>], length: usize) -> usize {
        let ends = payloads.iter().scan(HEADER_BYTES, |at, p| {
            *at += FRAME_BYTES + p.len();
            Some(*at)
        });
        ends.take_while(|end| *end <= length).count()
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

        #[test]
        fn truncation_at_every_byte_gives_a_prefix(payloads in payloads()) {
            let bytes = segment(&payloads);
            for length in 0..=bytes.len() {
                let Ok(scan) = scan(&bytes[..length]) else {
                    prop_assert!(length < HEADER_BYTES);
                    continue;
                };
                let whole = whole(&payloads, length);
                prop_assert_eq!(&scan.payloads, &payloads[..whole]);
                let kept = segment(&payloads[..whole]).len();
                let torn = End::Torn { bytes: length - kept };
                prop_assert_eq!(scan.end, if length == kept { End::Clean } else { torn });
            }
        }

        #[test]
        fn every_flipped_bit_is_detected(payloads in payloads(), bit in any::<proptest::sample::Index>()) {
            let mut bytes = segment(&payloads);
            let bit = bit.index(bytes.len() * 8);
            bytes[bit / 8] ^= 1 << (bit % 8);
            if let Ok(scan) = scan(&bytes) {
                prop_assert!(bit / 8 >= HEADER_BYTES);
                prop_assert_eq!(&scan.payloads, &payloads[..whole(&payloads, bit / 8)]);
                prop_assert_ne!(scan.end, End::Clean);
            }
        }

        #[test]
        fn last_frame_half_written_and_zeros_behind_it_are_torn(
            payloads in payloads(), half in 0usize..FRAME_BYTES, zeros in 1usize..40,
        ) {
            let mut last = Vec::new();
            append(7, u32::try_from(payloads.len()).unwrap(), b"last", &mut last).unwrap();
            let bytes = [&segment(&payloads), &last[..half], &vec![0; zeros]].concat();
            let scan = scan(&bytes).unwrap();
            prop_assert_eq!(scan.payloads, payloads);
            prop_assert_eq!(scan.end, End::Torn { bytes: half + zeros });
        }

        #[test]
        fn garbage_is_no_panic(garbage in vec(any::<u8>(), 0..200), headed in any::<bool>()) {
            let bytes = if headed { [&header(1)[..], &garbage].concat() } else { garbage };
            let _ = scan(&bytes);
        }
    }

    #[test]
    fn damage_before_other_frames_is_corruption_at_the_end_it_is_a_torn_tail() {
        let payloads = [vec![1; 10], vec![2; 10], vec![3; 10]];
        let frame = FRAME_BYTES + 10;
        for (damaged, end) in [
            (0, End::Corrupt { at: HEADER_BYTES, bytes: 3 * frame }),
            (1, End::Corrupt { at: HEADER_BYTES + frame, bytes: 2 * frame }),
            (2, End::Torn { bytes: frame }),
        ] {
            let mut bytes = segment(&payloads);
            bytes[HEADER_BYTES + damaged * frame + FRAME_BYTES] ^= 0x10;
            assert_eq!(scan(&bytes).unwrap().end, end);
        }
    }

    #[test]
    fn frame_out_of_its_place_is_none() {
        let mut bytes = header(7).to_vec();
        append(7, 1, b"second", &mut bytes).unwrap();
        assert_eq!(scan(&bytes).unwrap().payloads, Vec::<&[u8]>::new());
        let mut bytes = header(7).to_vec();
        append(6, 0, b"of the segment before", &mut bytes).unwrap();
        assert_eq!(scan(&bytes).unwrap().payloads, Vec::<&[u8]>::new());
    }

    #[test]
    fn versions_before_and_to_come_are_named() {
        for version in [VERSION - 1, VERSION + 1] {
            let mut bytes = header(7);
            bytes[8..12].copy_from_slice(&version.to_le_bytes());
            let check = checksum(&[&bytes[..8], &bytes[8..12], &bytes[16..]]);
            bytes[12..16].copy_from_slice(&check.to_le_bytes());
            assert_eq!(scan(&bytes), Err(NoSegment::Version(version)));
        }
    }
}
