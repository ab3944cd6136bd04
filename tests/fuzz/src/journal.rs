//! The journal: what a restart reads, whatever a crash or a broken disk has left.

use crate::plans::{of_hash, revived};
use ::journal::{End, Record, Unusable, encode, frame, read, scan};
use flight_exec::{Executor, Input};

/// What its owner notes is its own affair: anything.
type Notes = ciborium::Value;
type Chapter = ::journal::Chapter<Notes>;
type Entry = ::journal::Entry<Notes>;
type Saved = ::journal::Saved<Notes>;

/// Bytes that are a list of payloads for sound frames begin with this one; others are a segment as they are.
const FRAMED: u8 = b'F';

/// Any bytes as a segment, or as the payloads of one whose frames are sound: read, and its turns replayed. Cut off anywhere, a
/// segment gives a beginning of what it gave whole.
///
/// # Panics
/// Bytes that are made up, a torn tail that brings other turns, or a state that does not survive being written.
pub fn journal(bytes: &[u8]) {
    let segment = match bytes.split_first() {
        Some((&FRAMED, payloads)) => framed(payloads),
        _ => bytes.to_vec(),
    };
    sound(&segment);
    let Ok(chapter) = read::<Notes>(&segment) else { return };
    torn(&segment, &chapter);
    let saved: Saved = ciborium::from_reader(encode(&chapter.saved).unwrap().as_slice()).unwrap();
    assert_eq!(encode(&saved), encode(&chapter.saved), "a state written and read again");
    replay(chapter);
}

/// Each payload is behind its length, two bytes.
fn framed(mut payloads: &[u8]) -> Vec<u8> {
    let mut segment = frame::header(1).to_vec();
    for index in 0.. {
        let Some((length, rest)) = payloads.split_first_chunk() else { break };
        let length = usize::from(u16::from_le_bytes(*length)).min(rest.len());
        let (payload, rest) = rest.split_at(length);
        frame::append(1, index, payload, &mut segment).unwrap();
        payloads = rest;
    }
    segment
}

/// Frames and what is dropped are all there is.
fn sound(segment: &[u8]) {
    let Ok(scan) = scan(segment) else { return };
    let frames: usize = scan.payloads.iter().map(|p| frame::FRAME_BYTES + p.len()).sum();
    let dropped = match scan.end {
        End::Clean => 0,
        End::Torn { bytes } | End::Corrupt { bytes, .. } => bytes,
    };
    assert_eq!(frame::HEADER_BYTES + frames + dropped, segment.len());
}

/// Without its last byte, and without its second half.
fn torn(segment: &[u8], whole: &Chapter) {
    for length in [segment.len().saturating_sub(1), segment.len() / 2] {
        match read::<Notes>(&segment[..length]) {
            Ok(chapter) => {
                assert!(chapter.turns.len() <= whole.turns.len());
                // not by value: a number that is none is not even itself
                let beginning = &whole.turns[..chapter.turns.len()];
                assert_eq!(format!("{:?}", chapter.turns), format!("{beginning:?}"));
            }
            Err(Unusable::State(_) | Unusable::NoSegment(_)) => {}
        }
    }
}

/// As a restart does it: what a turn puts out was done before.
fn replay(chapter: Chapter) {
    let (last_step, proposed) =
        (chapter.saved.last_step, chapter.saved.proposed.as_deref().and_then(of_hash));
    let Ok(mut executor) = revived(chapter.saved.snapshot) else { return };
    executor.go_on(proposed, last_step);
    for entry in chapter.turns.into_iter().flatten() {
        again(&mut executor, entry);
    }
    executor.status();
    executor.deadline();
    executor.snapshot();
}

fn again(executor: &mut Executor, entry: Entry) {
    let input = match entry.what {
        Record::Input(input) => input,
        Record::NumberAfter(token) => return executor.number_after(token),
        Record::Propose { request, plan, based_on, .. } => {
            let Some(program) = of_hash(&plan) else { return };
            Input::Propose { request, program, based_on, objections: Vec::new() }
        }
        Record::Notes(_) | Record::Answered(_) => return,
    };
    executor.step(entry.at, input, &mut Vec::new());
}
