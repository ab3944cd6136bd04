//! What is said while something is done to the list, and is not about it.

use super::tests::{PEER, RULES, is_same};
use super::*;
use MavMissionType::{MAV_MISSION_TYPE_FENCE as FENCE, MAV_MISSION_TYPE_MISSION as PLAN};

/// Everything that is said of a list, of this kind.
#[expect(deprecated, reason = "ArduPilot asks by the deprecated message")]
fn of(mission_type: MavMissionType) -> [MavMessage; 5] {
    [
        MavMessage::MISSION_REQUEST(MISSION_REQUEST_DATA { mission_type, ..MISSION_REQUEST_DATA::DEFAULT }),
        MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
            mission_type,
            ..MISSION_REQUEST_INT_DATA::DEFAULT
        }),
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA { mission_type, ..MISSION_COUNT_DATA::DEFAULT }),
        MavMessage::MISSION_ACK(MISSION_ACK_DATA { mission_type, opaque_id: 3, ..MISSION_ACK_DATA::DEFAULT }),
        MavMessage::MISSION_ITEM_INT(Entry { mission_type, ..Entry::DEFAULT }),
    ]
}

/// With a list of three aboard.
fn mission() -> Mission {
    let mut mission = Mission::default();
    mission.upload(Time::ZERO, vec![Entry::DEFAULT; 3], &RULES, PEER, &mut vec![]);
    assert_eq!(mission.in_use(3), Some(Outcome::Verified));
    mission
}

fn hear(mission: &mut Mission, message: &MavMessage) -> Option<Option<Outcome>> {
    mission.on_message(Time::ZERO, message, PEER, &mut vec![])
}

type Begin = fn(&mut Mission);

const READ: Begin = |mission| mission.read(Time::ZERO, &RULES, PEER, &mut vec![]);
const UPLOAD: Begin =
    |mission| mission.upload(Time::ZERO, vec![Entry::DEFAULT; 3], &RULES, PEER, &mut vec![]);
const WRITE: Begin =
    |mission| mission.overwrite(Time::ZERO, vec![Entry::DEFAULT; 2], is_same, PEER, &mut vec![]);

#[test]
fn messages_about_fences_are_not_about_the_list() {
    for begin in [READ, UPLOAD, WRITE] {
        for message in of(FENCE) {
            let mut mission = mission();
            begin(&mut mission);
            assert_eq!(hear(&mut mission, &message), None, "{message:?}");
            assert!(mission.is_busy());
        }
    }
}

#[test]
fn messages_about_the_list_are_only_heard_while_something_is_done_to_it() {
    for message in of(PLAN) {
        assert_eq!(hear(&mut mission(), &message), None, "{message:?}");
        for begin in [READ, UPLOAD] {
            let mut mission = mission();
            begin(&mut mission);
            assert!(hear(&mut mission, &message).is_some(), "{message:?}");
        }
    }
    let mut mission = mission();
    WRITE(&mut mission);
    let heard: Vec<_> = of(PLAN).iter().map(|message| hear(&mut mission, message).is_some()).collect();
    assert_eq!(heard, [false, false, false, true, true], "of a part nothing is counted or asked for");
    let beat = MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT);
    assert_eq!(hear(&mut mission, &beat), None);
    UPLOAD(&mut mission);
    assert_eq!(hear(&mut mission, &beat), None);
}

/// It takes what it has already for the new one at once.
#[test]
fn an_answer_that_names_the_list_ends_an_upload_and_nothing_else() {
    let [.., named, _] = of(PLAN);
    let mut uploaded = mission();
    UPLOAD(&mut uploaded);
    assert_eq!(hear(&mut uploaded, &named), Some(Some(Outcome::Verified)));
    for begin in [READ, WRITE] {
        let mut mission = mission();
        begin(&mut mission);
        assert_eq!((mission.in_use(3), hear(&mut mission, &named)), (None, Some(None)));
        assert!(mission.is_busy());
    }
    assert_eq!(mission().in_use(3), None, "nothing is written");
}

#[test]
fn a_refused_write_fails_and_one_that_reads_back_is_verified() {
    let mut refused = mission();
    WRITE(&mut refused);
    let mavtype = MavMissionResult::MAV_MISSION_NO_SPACE;
    let ack = MavMessage::MISSION_ACK(MISSION_ACK_DATA { mavtype, ..MISSION_ACK_DATA::DEFAULT });
    assert!(matches!(hear(&mut refused, &ack), Some(Some(Outcome::Failed(_)))));
    assert!(!refused.is_busy() && refused.break_off("late").is_none());
    let mut written = mission();
    written.overwrite(Time::ZERO, vec![Entry::DEFAULT], is_same, PEER, &mut vec![]);
    let item = MavMessage::MISSION_ITEM_INT(Entry::DEFAULT);
    assert_eq!(hear(&mut written, &item), Some(Some(Outcome::Verified)));
    assert_eq!(written.tick(Time::from_secs(9), PEER, &mut vec![]), None);
}

#[test]
fn a_write_that_nobody_answers_ends() {
    let mut mission = mission();
    WRITE(&mut mission);
    let ended = (1..1000).find_map(|n| mission.tick(Time::from_secs(4 * n), PEER, &mut vec![]));
    assert!(matches!(ended, Some(Outcome::Failed(_))), "{ended:?}");
}

#[test]
fn while_it_is_replaced_by_us_another_list_in_use_is_no_other_stations() {
    let mut mission = mission();
    UPLOAD(&mut mission);
    let said = MISSION_CURRENT_DATA { total: 9, ..MISSION_CURRENT_DATA::DEFAULT };
    assert!((0..20).all(|_| !mission.is_foreign(&said)));
}
