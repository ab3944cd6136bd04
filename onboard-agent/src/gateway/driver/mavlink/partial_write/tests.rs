//! One write of some entries, message by message.

use super::*;
use MavMissionResult::*;

const PEER: Peer = Peer { system: 1, component: 1 };

fn entry(seq: u16, x: i32) -> Entry {
    Entry { seq, x, ..Entry::DEFAULT }
}

fn is_same(one: &Entry, other: &Entry) -> bool {
    one == other
}

/// Entries 5, 6 and 7.
fn begun(out: &mut Vec<MavMessage>) -> PartialWrite {
    let items = (5..8).map(|seq| entry(seq, 0)).collect();
    PartialWrite::begin(Time::ZERO, items, is_same, Rto::default(), PEER, out)
}

/// Numbers of the entries that are written, and of those that are asked for.
fn said(out: &mut Vec<MavMessage>) -> (Vec<u16>, Vec<u16>) {
    let (mut written, mut asked) = (vec![], vec![]);
    for message in out.drain(..) {
        match message {
            MavMessage::MISSION_ITEM_INT(item) => written.push(item.seq),
            MavMessage::MISSION_REQUEST_INT(request) => asked.push(request.seq),
            _ => {}
        }
    }
    (written, asked)
}

#[test]
fn what_was_not_read_back_is_written_again_with_what_lies_between() {
    let mut out = vec![];
    let mut write = begun(&mut out);
    assert_eq!(said(&mut out), (vec![5, 6, 7], vec![5, 6, 7]));
    assert_eq!((write.tick(Time::ZERO, PEER, &mut out), out.len()), (None, 0), "it is not late yet");
    write.item(Time::ZERO, &entry(6, 0));
    write.item(Time::ZERO, &entry(6, 0));
    write.tick(Time::from_secs(4), PEER, &mut out);
    assert_eq!(said(&mut out), (vec![5, 6, 7, 5, 6, 7], vec![5, 7, 5, 7]), "twice on such a link");
    write.item(Time::from_secs(4), &entry(5, 0));
    assert!(!write.is_complete());
    write.item(Time::from_secs(4), &entry(7, 0));
    assert!(write.is_complete());
}

#[test]
fn entries_that_nobody_asked_for_count_for_nothing() {
    let mut write = begun(&mut vec![]);
    for seq in [0, 4, 8, u16::MAX] {
        write.item(Time::ZERO, &entry(seq, 0));
    }
    assert_eq!(write.confirmed, [false; 3]);
}

#[test]
fn duplicates_are_answered_with_errors_that_mean_nothing_and_a_refusal_ends_it() {
    let write = begun(&mut vec![]);
    for meaningless in [
        MAV_MISSION_ACCEPTED,
        MAV_MISSION_ERROR,
        MAV_MISSION_INVALID_SEQUENCE,
        MAV_MISSION_DENIED,
        MAV_MISSION_OPERATION_CANCELLED,
    ] {
        assert_eq!(write.acked(meaningless), None);
    }
    assert!(write.acked(MAV_MISSION_NO_SPACE).is_some_and(|why| why.contains("refused the list")));
}

/// After how many rounds it is given up, and why.
fn given_up(answer: Option<Entry>) -> (u32, String) {
    let mut write = begun(&mut vec![]);
    let round = |round: u32| {
        answer.iter().for_each(|entry| write.item(Time::ZERO, entry));
        let why = write.tick(Time::from_secs(4 * u64::from(round)), PEER, &mut vec![])?;
        Some((round, why))
    };
    (1..1000).find_map(round).expect("not for ever")
}

#[test]
fn a_write_that_never_reads_back_is_given_up_with_the_reason() {
    let (rounds, why) = given_up(None);
    assert_eq!((rounds, why.as_str()), (PATIENCE + 1, "the autopilot does not answer"));
    let (rounds, why) = given_up(Some(entry(6, 99)));
    assert_eq!((rounds, why.as_str()), (PATIENCE + 1, "entry 6 reads back differently each time"));
}
