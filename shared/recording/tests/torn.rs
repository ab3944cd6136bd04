//! What is left of a recording when the power goes, and what hostile files do: nothing.
#![cfg(test)]

mod common;

use common::{Rig, UNIX, ms, numbered, position};
use proptest::prelude::*;
use recording::{Config, Contents, Damage, END_BYTES, Ending, Input, is_end, repair, scan};
use std::time::Duration;

const COUNT: &str = "legwork/uav1/counter/variable/count";

/// A few seconds of a flight with 50 messages a second, when its bytes were written, and how many ms it lasts.
fn flight() -> Rig {
    let mut rig = Rig::new(Config::new("uav1"));
    for i in 0..200 {
        rig.frame(ms(20 * i), numbered("uav1", i, ms(20 * i)));
        if i % 10 == 0 {
            rig.frame(ms(20 * i), position(ms(20 * i)));
        }
    }
    rig.until(ms(4050));
    rig
}

/// Times of the counter's messages, since the flight's beginning.
fn times(bytes: &[u8]) -> (Contents, Vec<Duration>) {
    let mut times = Vec::new();
    let contents = scan(bytes, &mut |m| {
        if m.channel.topic == COUNT {
            times.push(Duration::from_nanos(m.log_ns) - UNIX);
        }
    });
    (contents.unwrap(), times)
}

/// What the process, or the power, leaves when it ends in the moment in which byte `cut` is being written.
fn killed(rig: &Rig, cut: usize) {
    let bytes = &rig.files[0].1[..cut];
    assert!(!is_end(&bytes[cut.saturating_sub(END_BYTES as usize)..]));
    let (written_at, _) = *rig.appended.iter().find(|(_, length)| *length >= cut).unwrap();
    let (contents, times) = times(bytes);
    let expected: Vec<Duration> = (0..200).map(|i| ms(20 * i)).collect();
    assert_eq!(times, expected[..times.len()], "a beginning of the flight, without gaps");
    let lost_from = expected.get(times.len()).copied().unwrap_or(written_at);
    assert!(
        written_at.saturating_sub(lost_from) <= ms(100),
        "cut at byte {cut}: {lost_from:?} of {written_at:?}"
    );
    match contents.ending {
        Ending::Foreign => assert!(cut < 8),
        Ending::Torn { good_bytes } => {
            assert!(good_bytes as usize <= cut);
            let told = contents.findings.iter().any(|f| f.offset == good_bytes);
            assert!(told, "{:?}", contents.findings);
        }
        Ending::Finished => panic!("it was not finished"),
    }
}

#[test]
fn two_hundred_deaths_lose_a_tenth_of_a_second_at_most() {
    let rig = flight();
    let length = rig.files[0].1.len();
    let mut random = 1u64;
    for _ in 0..200 {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        killed(&rig, (random >> 33) as usize % length + 1);
    }
    // and in the seams between two writes
    for (_, length) in &rig.appended {
        killed(&rig, *length);
    }
}

#[test]
fn torn_file_is_mended_into_one_that_every_tool_opens() {
    let rig = flight();
    let whole = &rig.files[0].1;
    for cut in [whole.len(), whole.len() - 1, whole.len() / 2, 400] {
        let torn = &whole[..cut];
        let mut mended = Vec::new();
        let contents = repair(torn, &mut mended).unwrap();
        let (before, after) = (times(torn), times(&mended));
        assert_eq!(before.1, after.1, "{cut}");
        assert!(is_end(&mended[mended.len() - END_BYTES as usize..]));
        assert_eq!((after.0.ending, after.0.findings.len()), (Ending::Finished, 0), "{:?}", after.0.findings);
        assert_eq!(after.0.messages, contents.messages);
        let lost = &after.0.metadata.iter().find(|(name, _)| name == "legwork.recovered").unwrap().1;
        let Ending::Torn { good_bytes } = contents.ending else { panic!("not torn") };
        assert_eq!(lost["bytes_lost"], (cut as u64 - good_bytes).to_string());
        assert!(mcap::Summary::read(&mended).unwrap().is_some(), "it has an index");
    }
}

#[test]
fn damaged_chunk_is_left_out_and_the_others_are_read() {
    let mut bytes = flight().files[0].1.clone();
    let whole = times(&bytes).1.len();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x10;
    let (contents, times) = times(&bytes);
    assert!(times.len() < whole && times.len() > whole - 20, "{} of {whole}", times.len());
    assert!(times.last() > Some(&ms(3900)), "what comes behind it was read");
    assert!(
        contents
            .findings
            .iter()
            .any(|f| matches!(f.damage, Damage::Checksum { .. } | Damage::Malformed { .. })),
        "{:?}",
        contents.findings
    );
}

#[test]
fn compressed_and_foreign_files_are_told() {
    let (contents, _) = times(b"PK\x03\x04 something else");
    assert_eq!(contents.findings[0].to_string(), "byte 0: this is no MCAP file: it does not begin as one");
    assert_eq!(contents.ending, Ending::Foreign);
    let mut bytes = times_of_compressed();
    let (contents, _) = times(&bytes);
    assert_eq!(contents.findings.len(), 1, "one for all chunks: {:?}", contents.findings);
    assert!(contents.findings[0].to_string().contains("\"zstd\""), "{}", contents.findings[0]);
    bytes.truncate(3);
    assert_eq!(times(&bytes).0.ending, Ending::Foreign);
    assert_eq!(times(b"").0.ending, Ending::Foreign);
}

/// Chunks that say they are compressed.
fn times_of_compressed() -> Vec<u8> {
    let mut bytes = recording_magic();
    for _ in 0..3 {
        let mut chunk = vec![0u8; 8 + 8 + 8 + 4];
        chunk.extend(4u32.to_le_bytes());
        chunk.extend(b"zstd");
        chunk.extend(3u64.to_le_bytes());
        chunk.extend([1, 2, 3]);
        record(&mut bytes, 0x06, &chunk);
    }
    record(&mut bytes, 0x0f, &[0; 4]);
    record(&mut bytes, 0x02, &[0; 20]);
    bytes.extend(recording_magic());
    bytes
}

fn recording_magic() -> Vec<u8> {
    b"\x89MCAP0\r\n".to_vec()
}

fn record(bytes: &mut Vec<u8>, opcode: u8, content: &[u8]) {
    bytes.push(opcode);
    bytes.extend((content.len() as u64).to_le_bytes());
    bytes.extend(content);
}

#[test]
fn lengths_that_lie_cost_no_memory() {
    for opcode in [0x01, 0x03, 0x04, 0x05, 0x06, 0x09, 0x0c, 0x80] {
        for length in [u64::MAX, u64::from(u32::MAX), 1 << 40, 300 << 20] {
            let mut bytes = recording_magic();
            bytes.push(opcode);
            bytes.extend(length.to_le_bytes());
            bytes.extend([0xff; 100]);
            let (contents, _) = times(&bytes);
            assert_eq!(contents.findings.len(), 1);
            assert_eq!(
                (contents.findings[0].offset, &contents.findings[0].damage),
                (8, &Damage::Torn { bytes: 109 })
            );
            // and inside of a record
            let mut inner = recording_magic();
            record(&mut inner, opcode, &[0xff; 100]);
            times(&inner);
        }
    }
}

/// A small finished file.
fn small() -> Vec<u8> {
    let mut rig = Rig::new(Config::new("uav1"));
    for i in 0..5 {
        rig.frame(ms(20 * i), numbered("uav1", i, ms(20 * i)));
        rig.frame(ms(20 * i), position(ms(20 * i)));
    }
    rig.step(ms(100), Input::Close);
    rig.files.remove(0).1
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(128) })]

    #[test]
    fn whatever_the_bytes_are_they_are_read_and_mended(
        flips in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in any::<prop::sample::Index>(),
        garbage in proptest::collection::vec(any::<u8>(), 0..40),
    ) {
        let mut bytes = small();
        for (index, value) in flips {
            let index = index.index(bytes.len());
            bytes[index] = value;
        }
        bytes.truncate(cut.index(bytes.len()) + 1);
        bytes.extend(garbage);
        let (contents, _) = times(&bytes);
        prop_assert!(contents.bytes <= bytes.len() as u64);
        prop_assert!(contents.findings.iter().all(|f| f.offset <= bytes.len() as u64));
        let mut mended = Vec::new();
        repair(bytes.as_slice(), &mut mended).unwrap();
        let (after, _) = times(&mended);
        prop_assert_eq!(after.ending, Ending::Finished);
        prop_assert_eq!(after.messages, contents.messages);
    }

    #[test]
    fn garbage_behind_the_magic_is_read(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let (contents, _) = times(&[recording_magic(), bytes].concat());
        prop_assert!(!contents.findings.is_empty());
    }
}
