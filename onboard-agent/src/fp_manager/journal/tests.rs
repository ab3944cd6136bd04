//! Faults of the disk, one a test, without a disk and without a clock.

use super::faulty::{Death, Faulty, Operation, Random};
use super::*;
use crate::fp_manager::{Config, Manager, compile, restart};
use ::journal::frame;
use flight_exec::{Executor, RequestId, Token};
use proptest::prelude::*;
use service::Time;
use std::io::ErrorKind;
use std::sync::Arc;
use terrain::Flat;

const LIMITS: Limits = Limits { turns: 10, bytes: 4096, bytes_max: 8192, plans: 3 };

fn config() -> Config {
    Config { terrain: Arc::new(Flat(349.0)), ..Config::new("uav1", "") }
}

fn saved() -> Saved {
    let config = config();
    let executor = Executor::new(config.executor, config.terrain, config.profile);
    Manager::new(executor, Time::ZERO).saved().0
}

/// A turn that shows which one it is.
fn turn(number: u64) -> Vec<Entry> {
    vec![Entry { at: Time::from_secs(number), what: Record::NumberAfter(Token(number)) }]
}

fn job(number: u64, sync: bool) -> Job {
    Job::Turn { payload: encode(&turn(number)).unwrap(), sync }
}

fn state() -> Job {
    Job::State(Box::new(saved()), Vec::new())
}

fn writer(disk: &Faulty) -> Writer<Faulty> {
    Writer::new(Log::open(disk.clone(), LIMITS).0, None)
}

/// A writer with a state and turns 1 to `turns`, all on the disk.
fn writer_with(disk: &Faulty, turns: u64) -> Writer<Faulty> {
    let mut writer = writer(disk);
    let jobs = std::iter::once(state()).chain((1..=turns).map(|n| job(n, true)));
    writer.perform(Time::ZERO, jobs.collect());
    writer
}

/// The turns that a restart finds, and whether it knows that something is missing.
fn found(disk: &Faulty) -> (Vec<u64>, bool) {
    let (mut log, found) = Log::open(disk.clone(), LIMITS);
    let chapter = found.unwrap().iter().find_map(|found| log.chapter(found).ok()).expect("a segment");
    let numbers = chapter.turns.iter().map(|turn| turn[0].at.as_secs());
    (numbers.collect(), chapter.incomplete)
}

#[test]
fn what_was_synced_survives_a_loss_of_power_the_rest_may() {
    for seed in 0..50 {
        let disk = Faulty::default();
        let mut writer = writer_with(&disk, 3);
        writer.perform(Time::ZERO, (4..=6).map(|n| job(n, false)).collect());
        disk.reboot(Death::PowerLoss, &mut Random(seed));
        let (turns, incomplete) = found(&disk);
        assert!(turns.len() >= 3 && turns == (1..=turns.len() as u64).collect::<Vec<_>>(), "{turns:?}");
        assert!(!incomplete, "a torn tail is nothing that took effect");
    }
}

#[test]
fn what_leads_to_nothing_is_synced_within_a_second() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 1);
    writer.perform(Time::from_millis(2000), vec![job(2, false)]);
    let due = writer.due().expect("a sync");
    assert!(due <= Time::from_millis(3000), "{due:?}");
    writer.perform(due, Vec::new());
    assert_eq!(writer.due(), None);
    disk.reboot(Death::PowerLoss, &mut Random(1));
    assert_eq!(found(&disk).0, [1, 2]);
}

/// A fault comes and goes: it is reported, the flight goes on, and a new state brings the journal back.
fn fault_comes_and_goes(strike: impl Fn(&Faulty), advice: &str) {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 2);
    strike(&disk);
    writer.perform(Time::from_secs(1), vec![job(3, true)]);
    let trouble = writer.report(Time::from_secs(1)).trouble.expect("it is told");
    assert!(trouble.contains(advice), "{trouble}");
    assert!(!writer.report(Time::from_secs(1)).wants_state, "not again at once");
    assert!(writer.report(Time::from_secs(2)).wants_state, "again after a while");
    writer.perform(Time::from_secs(2), vec![state(), job(4, true)]);
    assert!(writer.report(Time::from_secs(2)).trouble.is_some(), "it lasts");
    assert_eq!(found(&disk).0[..2], [1, 2], "what was recorded before is still there");
    disk.repair();
    writer.perform(Time::from_secs(4), vec![state(), job(5, true)]);
    assert_eq!(writer.report(Time::from_secs(4)), Report::default());
    disk.reboot(Death::PowerLoss, &mut Random(7));
    assert_eq!(found(&disk), (vec![5], false));
}

#[test]
fn disk_full() {
    fault_comes_and_goes(|disk| disk.limit(disk.size() + 5), "free some space");
}

#[test]
fn folder_not_writable() {
    let strike = |disk: &Faulty| {
        for operation in [Operation::Create, Operation::Append, Operation::Rename] {
            disk.fail(operation, ErrorKind::ReadOnlyFilesystem);
        }
    };
    fault_comes_and_goes(strike, "writable");
}

#[test]
fn sync_fails() {
    // after a failed sync nothing that was appended can be trusted, even if a later one succeeds
    fault_comes_and_goes(|disk| disk.fail(Operation::Sync, ErrorKind::Other), "check the disk");
}

#[test]
fn names_cannot_be_synced() {
    let strike = |disk: &Faulty| {
        disk.fail(Operation::Append, ErrorKind::Other);
        disk.fail(Operation::SyncNames, ErrorKind::Other);
    };
    fault_comes_and_goes(strike, "check the disk");
}

#[test]
fn killed_after_the_names_could_not_be_synced_it_is_known_that_something_is_missing() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 2);
    disk.fail(Operation::SyncNames, ErrorKind::Other);
    writer.perform(Time::from_secs(1), vec![state(), job(3, true)]);
    disk.reboot(Death::Kill, &mut Random(1));
    assert_eq!(found(&disk), (vec![], true), "{:?}", disk.names_now());
}

#[test]
fn no_room_for_a_new_segment_the_old_one_goes_on_up_to_its_greatest_length() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 11);
    assert!(writer.report(Time::ZERO + Time::from_secs(1)).wants_state);
    disk.fail(Operation::Create, ErrorKind::StorageFull);
    writer.perform(Time::from_secs(1), vec![state(), job(12, true)]);
    assert_eq!(writer.report(Time::from_secs(1)).trouble, None);
    assert_eq!(found(&disk).0.len(), 12);
    writer.perform(Time::from_secs(2), (13..500).map(|n| job(n, true)).collect());
    assert!(writer.report(Time::from_secs(2)).trouble.is_some());
    assert!(disk.size() < 2 * LIMITS.bytes_max as usize, "{} bytes", disk.size());
}

#[test]
fn segment_that_failed_in_flight_is_known_as_incomplete() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 2);
    disk.limit(disk.size());
    writer.perform(Time::from_secs(1), vec![job(3, true)]);
    assert_eq!(found(&disk), (vec![1, 2], true));
}

#[test]
fn turns_lost_before_a_disk_that_does_not_keep_up_are_never_skipped_over() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 2);
    writer.overrun(Time::from_secs(1));
    writer.perform(Time::from_secs(1), vec![job(9, true)]);
    assert!(writer.report(Time::from_secs(1)).trouble.is_some());
    assert_eq!(found(&disk), (vec![1, 2], true));
}

#[test]
fn damage_in_the_middle_stops_the_replay_there() {
    let disk = Faulty::default();
    writer_with(&disk, 5);
    let bytes_of_a_turn = encode(&turn(1)).unwrap().len() + frame::FRAME_BYTES;
    disk.damage("segment-00000001.journal", |bytes| {
        let third = bytes.len() - 3 * bytes_of_a_turn;
        bytes[third + frame::FRAME_BYTES] ^= 1;
    });
    assert_eq!(found(&disk), (vec![1, 2], true));
}

#[test]
fn state_damaged_the_segment_before_leads_up_to_it() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 4);
    writer.perform(Time::from_secs(1), vec![state(), job(5, true)]);
    disk.damage("segment-00000002.journal", |bytes| bytes[frame::HEADER_BYTES + 40] ^= 1);
    assert_eq!(found(&disk).0, [1, 2, 3, 4]);
    let (mut log, found) = Log::open(disk.clone(), LIMITS);
    let past = restart(&mut log, &found.unwrap(), &config(), Time::ZERO);
    assert_eq!(past.manager.executor().last_token(), Token(4));
    assert_eq!(past.troubles.len(), 1, "{:?}", past.troubles);
    assert!(disk.names_now().contains(&"segment-00000002.unusable".to_owned()));
}

#[test]
fn old_segments_go_when_the_state_is_on_the_disk_and_not_before() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 1);
    for second in 1..5 {
        writer.perform(Time::from_secs(second), vec![state()]);
    }
    assert_eq!(disk.names_now(), ["segment-00000004.journal", "segment-00000005.journal"]);
    disk.fail(Operation::SyncNames, ErrorKind::Other);
    writer.perform(Time::from_secs(9), vec![state()]);
    assert_eq!(disk.names_now().len(), 3, "{:?}", disk.names_now());
}

#[test]
fn plan_missing_or_exchanged_is_told_and_flown_without() {
    let xml = include_str!("../../../../assets/plans/square.xml");
    for (change, reported) in [(&b"garbage"[..], "plan"), (&b"<flightPlan/>"[..], "plan")] {
        let (disk, config) = (Faulty::default(), config());
        let program = Arc::new(compile(xml.as_bytes(), &config).unwrap());
        let mut state = saved();
        state.proposed = Some(program.hash().clone());
        writer(&disk).perform(Time::ZERO, vec![Job::State(Box::new(state), vec![program.clone()])]);
        disk.damage(&format!("plan-{}.xml", program.hash()), |bytes| *bytes = change.to_vec());
        let (mut log, found) = Log::open(disk.clone(), LIMITS);
        let past = restart(&mut log, &found.unwrap(), &config, Time::ZERO);
        assert!(past.troubles[0].contains(reported), "{:?}", past.troubles);
        assert!(past.manager.executor().proposed().is_none());
    }
}

#[test]
fn turn_that_cannot_be_replayed_stops_the_replay_before_it() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 2);
    let missing =
        Record::Propose { request: RequestId(1), plan: "0123".into(), based_on: None, forbidden: false };
    let payload = encode(&vec![Entry { at: Time::from_secs(3), what: missing }]).unwrap();
    writer.perform(Time::ZERO, vec![Job::Turn { payload, sync: true }, job(4, true)]);
    let (mut log, found) = Log::open(disk.clone(), LIMITS);
    let past = restart(&mut log, &found.unwrap(), &config(), Time::ZERO);
    assert_eq!(past.manager.executor().last_token(), Token(2));
    assert!(
        past.troubles[0].contains("turn 3 of 4") && past.troubles[0].contains("0123"),
        "{:?}",
        past.troubles
    );
}

/// A disk that does nothing until it is let go.
struct Stuck(std::sync::Arc<std::sync::Mutex<()>>);

impl Storage for Stuck {
    fn names(&mut self) -> std::io::Result<Vec<String>> {
        Ok(Vec::new())
    }
    fn read(&mut self, _: &str, _: u64) -> std::io::Result<Vec<u8>> {
        Err(ErrorKind::NotFound.into())
    }
    fn create(&mut self, _: &str) -> std::io::Result<()> {
        Ok(())
    }
    fn append(&mut self, _: &str, _: &[u8]) -> std::io::Result<()> {
        drop(self.0.lock());
        Ok(())
    }
    fn sync(&mut self, _: &str) -> std::io::Result<()> {
        Ok(())
    }
    fn rename(&mut self, _: &str, _: &str) -> std::io::Result<()> {
        Ok(())
    }
    fn sync_names(&mut self) -> std::io::Result<()> {
        Ok(())
    }
    fn remove(&mut self, _: &str) -> std::io::Result<()> {
        Ok(())
    }
}

#[tokio::test]
async fn disk_is_stuck_the_flight_waits_once_and_not_long_and_says_so() {
    let lock = Arc::new(std::sync::Mutex::new(()));
    let mut writer =
        JournalHandle::start(Writer::new(Log::open(Stuck(lock.clone()), LIMITS).0, None)).unwrap();
    assert_eq!(writer.state_event(), None);
    let held = lock.lock();
    writer.give(state());
    writer.done().await;
    assert!(
        matches!(writer.state_event(), Some(flight_exec::Event::NotJournalled { reason }) if reason.contains("slow"))
    );
    for n in 0..50 {
        // each would take the whole patience, if it waited
        writer.give(job(n, true));
        writer.done().await;
        assert_eq!(writer.state_event(), None, "told once");
    }
    drop(held);
    let caught_up = async {
        while writer.state_event() != Some(flight_exec::Event::Journalled) {
            tokio::task::yield_now().await;
            writer.done().await;
        }
    };
    tokio::time::timeout(std::time::Duration::from_secs(30), caught_up).await.unwrap();
}

#[test]
fn document_of_a_proposal_is_kept_between_the_turns_of_the_flight() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 0);
    let xml: Vec<u8> = (0..2_000_000_u32).map(|n| n as u8).collect();
    writer.perform(Time::ZERO, vec![Job::Document { hash: "0123".into(), xml: xml.clone() }]);
    let mut turns = 0;
    while writer.is_writing() {
        turns += 1;
        writer.perform(Time::ZERO, vec![job(turns, true)]);
        assert_eq!(found(&disk).0.len() as u64, turns, "the turn does not wait");
        let before = disk.size();
        writer.write_piece();
        assert!(disk.size() - before <= 1 << 18, "a piece is small");
    }
    assert!(turns >= 8, "{turns}");
    disk.reboot(Death::PowerLoss, &mut Random(3));
    assert_eq!(Log::open(disk.clone(), LIMITS).0.plan("0123"), Some(xml));
}

#[test]
fn document_that_cannot_be_kept_beforehand_does_not_stop_the_recording() {
    let disk = Faulty::default();
    let mut writer = writer_with(&disk, 1);
    disk.fail(Operation::Create, ErrorKind::StorageFull);
    writer.perform(Time::ZERO, vec![Job::Document { hash: "0123".into(), xml: vec![1; 9] }]);
    writer.write_piece();
    assert!(!writer.is_writing());
    writer.perform(Time::ZERO, vec![job(2, true)]);
    assert_eq!((writer.report(Time::ZERO).trouble, found(&disk).0), (None, vec![1, 2]));
}

#[test]
fn plans_that_were_only_proposed_do_not_pile_up() {
    let xml = include_str!("../../../../assets/plans/square.xml");
    let (disk, config) = (Faulty::default(), config());
    let mut writer = writer_with(&disk, 0);
    for n in 0..20 {
        let other = xml.replace("Square circuit", &format!("Circuit {n}"));
        let program = Arc::new(compile(other.as_bytes(), &config).unwrap());
        writer.perform(Time::from_secs(n), vec![Job::Plan(program)]);
        if writer.report(Time::from_secs(n)).wants_state {
            writer.perform(Time::from_secs(n), vec![state()]);
        }
    }
    let plans = disk.names_now().iter().filter(|name| name.starts_with("plan")).count();
    assert!(plans <= 2 * (LIMITS.plans + 1), "{plans} plans");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    #[test]
    fn garbage_in_place_of_a_state_or_a_turn_is_no_panic(garbage in proptest::collection::vec(any::<u8>(), 0..100)) {
        let mut bytes = frame::header(1).to_vec();
        frame::append(1, 0, &garbage, &mut bytes).unwrap();
        prop_assert!(::journal::read::<ManagerState>(&bytes).is_err());
        let mut bytes = frame::header(1).to_vec();
        frame::append(1, 0, &encode(&saved()).unwrap(), &mut bytes).unwrap();
        frame::append(1, 1, &garbage, &mut bytes).unwrap();
        let chapter = ::journal::read::<ManagerState>(&bytes).unwrap();
        prop_assert!(chapter.turns.len() + usize::from(chapter.incomplete) == 1);
    }
}

#[test]
fn real_folder_keeps_what_was_written() {
    let directory = tempfile::tempdir().unwrap();
    let folder = || Folder::new(directory.path().join("made/when/needed"));
    let mut writer = Writer::new(Log::open(folder(), LIMITS).0, None);
    writer.perform(Time::ZERO, vec![state(), job(1, true), job(2, false), state(), job(3, false)]);
    assert_eq!(writer.report(Time::ZERO).trouble, None);
    let (mut log, found) = Log::open(folder(), LIMITS);
    let found = found.unwrap();
    let turns: Vec<usize> = found.iter().map(|f| log.chapter(f).unwrap().turns.len()).collect();
    assert_eq!(turns, [1, 2], "newest first");
}
