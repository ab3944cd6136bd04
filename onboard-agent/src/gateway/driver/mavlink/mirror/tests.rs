//! What a program that watches sees, and that it can change nothing.

use super::*;
use std::time::Duration;

const AUTOPILOT: Peer = Peer { system: 1, component: 1 };
const VIEWER: Peer = Peer { system: 255, component: 190 };

/// A mirror of an ArduPlane with a list of three, and what it says.
struct Rig {
    mirror: Mirror,
    list: Vec<Entry>,
    now: Time,
}

impl Rig {
    fn new() -> Self {
        let entry = |seq: u16| Entry {
            seq,
            x: 364_905_000,
            y: -842_710_000,
            z: 100.0,
            command: MavCmd::MAV_CMD_NAV_WAYPOINT,
            frame: MavFrame::MAV_FRAME_GLOBAL,
            ..Entry::DEFAULT
        };
        let mut rig = Self { mirror: Mirror::default(), list: (0..3).map(entry).collect(), now: Time::ZERO };
        let beat = HEARTBEAT_DATA {
            autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
            custom_mode: 10,
            ..HEARTBEAT_DATA::DEFAULT
        };
        rig.pass(&MavMessage::HEARTBEAT(beat));
        rig.heard();
        rig
    }

    /// The autopilot says something.
    fn pass(&mut self, message: &MavMessage) {
        let mut decoder = Decoder::default();
        decoder.push(&encode(AUTOPILOT, message));
        self.mirror.pass(&decoder.next_frame().unwrap());
    }

    /// What the program hears.
    fn heard(&mut self) -> Vec<MavMessage> {
        let mut outbox = Outbox::default();
        self.mirror.send(3, &mut outbox);
        assert_eq!(outbox.frames().count(), outbox.frames_over(3).count());
        let mut all = vec![];
        for bytes in outbox.frames_over(3) {
            let mut decoder = Decoder::default();
            decoder.push(bytes);
            let frame = decoder.next_frame().unwrap();
            assert_eq!(frame.sender, AUTOPILOT);
            all.push(frame.message().unwrap());
        }
        all
    }

    /// The program says something, and hears this.
    fn ask(&mut self, message: &MavMessage) -> Vec<MavMessage> {
        self.ask_bytes(&encode(VIEWER, message))
    }

    fn ask_bytes(&mut self, bytes: &[u8]) -> Vec<MavMessage> {
        self.now += Duration::from_secs(1);
        self.mirror.receive(FromLink::Datagram(bytes));
        while self.mirror.process(self.now, &self.list) {}
        self.heard()
    }

    fn command(&mut self, command: MavCmd, param1: f32) -> Vec<MavMessage> {
        self.ask(&MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            param1,
            command,
            target_system: 1,
            target_component: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }))
    }
}

fn encode(sender: Peer, message: &MavMessage) -> Vec<u8> {
    autopilot_link::frame::encode(sender, 0, message)
}

fn result(answers: &[MavMessage]) -> Option<MavResult> {
    answers.iter().find_map(|answer| match answer {
        MavMessage::COMMAND_ACK(ack) => {
            assert_eq!((ack.target_system, ack.target_component), (255, 190));
            Some(ack.result)
        }
        _ => None,
    })
}

fn list_result(answers: &[MavMessage]) -> Option<MavMissionResult> {
    answers.iter().find_map(|answer| match answer {
        MavMessage::MISSION_ACK(ack) => Some(ack.mavtype),
        _ => None,
    })
}

#[test]
fn what_the_autopilot_says_is_seen_but_for_its_conversations_with_others() {
    let mut rig = Rig::new();
    let attitude = MavMessage::ATTITUDE(ATTITUDE_DATA { roll: 0.5, ..ATTITUDE_DATA::DEFAULT });
    let current =
        MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA { seq: 2, ..MISSION_CURRENT_DATA::DEFAULT });
    let others = MavMessage::COMMAND_ACK(COMMAND_ACK_DATA::DEFAULT);
    let theirs = MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA::DEFAULT);
    for message in [&attitude, &others, &current, &theirs] {
        rig.pass(message);
    }
    assert_eq!(rig.heard(), [attitude, current]);
}

#[test]
fn the_list_aboard_can_be_downloaded() {
    let mut rig = Rig::new();
    let ask = MISSION_REQUEST_LIST_DATA {
        target_system: 1,
        target_component: 1,
        ..MISSION_REQUEST_LIST_DATA::DEFAULT
    };
    let [MavMessage::MISSION_COUNT(count)] = &rig.ask(&MavMessage::MISSION_REQUEST_LIST(ask.clone()))[..]
    else {
        panic!("a count")
    };
    assert_eq!((count.count, count.target_system, count.target_component), (3, 255, 190));
    let request = MISSION_REQUEST_INT_DATA {
        target_system: 1,
        target_component: 1,
        seq: 2,
        ..MISSION_REQUEST_INT_DATA::DEFAULT
    };
    let [MavMessage::MISSION_ITEM_INT(item)] =
        &rig.ask(&MavMessage::MISSION_REQUEST_INT(request.clone()))[..]
    else {
        panic!("an item")
    };
    assert_eq!((item.seq, item.x, item.target_system), (2, 364_905_000, 255));
    let beyond = MISSION_REQUEST_INT_DATA { seq: 3, ..request };
    let answers = rig.ask(&MavMessage::MISSION_REQUEST_INT(beyond));
    assert_eq!(list_result(&answers), Some(MavMissionResult::MAV_MISSION_INVALID_SEQUENCE));
    let fence = MISSION_REQUEST_LIST_DATA { mission_type: MavMissionType::MAV_MISSION_TYPE_FENCE, ..ask };
    let [MavMessage::MISSION_COUNT(count)] = &rig.ask(&MavMessage::MISSION_REQUEST_LIST(fence))[..] else {
        panic!("a count")
    };
    assert_eq!(count.count, 0);
}

#[test]
#[expect(deprecated, reason = "programs ask so")]
fn a_program_that_asks_in_the_older_way_is_answered_so() {
    let mut rig = Rig::new();
    let request = MISSION_REQUEST_DATA { seq: 1, ..MISSION_REQUEST_DATA::DEFAULT };
    let [MavMessage::MISSION_ITEM(item)] = &rig.ask(&MavMessage::MISSION_REQUEST(request))[..] else {
        panic!("an item")
    };
    assert!((item.x - 36.4905).abs() < 1e-4 && item.frame == MavFrame::MAV_FRAME_GLOBAL, "{item:?}");
}

#[test]
fn every_order_is_denied_and_changes_nothing() {
    let mut rig = Rig::new();
    let orders = [
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        MavCmd::MAV_CMD_DO_SET_MODE,
        MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH,
        MavCmd::MAV_CMD_DO_FLIGHTTERMINATION,
        MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
    ];
    for order in orders {
        assert_eq!(result(&rig.command(order, 1.0)), Some(MavResult::MAV_RESULT_DENIED), "{order:?}");
    }
    let list_orders = [
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA { count: 5, ..MISSION_COUNT_DATA::DEFAULT }),
        MavMessage::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA::DEFAULT),
        MavMessage::MISSION_WRITE_PARTIAL_LIST(MISSION_WRITE_PARTIAL_LIST_DATA::DEFAULT),
        MavMessage::MISSION_ITEM_INT(Entry::DEFAULT),
    ];
    for order in list_orders {
        assert_eq!(list_result(&rig.ask(&order)), Some(MavMissionResult::MAV_MISSION_DENIED), "{order:?}");
    }
    let int = COMMAND_INT_DATA { command: MavCmd::MAV_CMD_DO_REPOSITION, ..COMMAND_INT_DATA::DEFAULT };
    assert_eq!(result(&rig.ask(&MavMessage::COMMAND_INT(int))), Some(MavResult::MAV_RESULT_DENIED));
}

#[test]
fn an_order_that_the_dialect_does_not_know_is_denied_too() {
    let mut rig = Rig::new();
    let mut payload = [0_u8; 33];
    payload[28..30].copy_from_slice(&60_001_u16.to_le_bytes());
    payload[30..32].copy_from_slice(&[1, 1]);
    rig.mirror.receive(FromLink::Datagram(&encode_payload(VIEWER, 0, COMMAND_LONG_DATA::ID, &payload)));
    assert!(rig.mirror.process(rig.now, &rig.list));
    let mut outbox = Outbox::default();
    rig.mirror.send(0, &mut outbox);
    let mut decoder = Decoder::default();
    decoder.push(outbox.frames().next().unwrap());
    let frame = decoder.next_frame().unwrap();
    let told = (frame.id, u16::from_le_bytes([frame.payload[0], frame.payload[1]]), frame.payload[2]);
    assert_eq!(told, (COMMAND_ACK_DATA::ID, 60_001, MavResult::MAV_RESULT_DENIED as u8));
}

#[test]
fn parameters_that_are_known_are_shown_and_a_change_is_answered_with_what_they_are() {
    let mut rig = Rig::new();
    let value = PARAM_VALUE_DATA {
        param_value: 90.0,
        param_id: "WP_RADIUS".into(),
        param_index: 700,
        ..PARAM_VALUE_DATA::DEFAULT
    };
    rig.pass(&MavMessage::PARAM_VALUE(value));
    let values = |answers: Vec<MavMessage>| -> Vec<(String, u16, u16, f32)> {
        let value = |answer| match answer {
            MavMessage::PARAM_VALUE(v) => {
                Some((v.param_id.to_str().unwrap().to_owned(), v.param_index, v.param_count, v.param_value))
            }
            _ => None,
        };
        answers.into_iter().filter_map(value).collect()
    };
    let all = values(rig.ask(&MavMessage::PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA::DEFAULT)));
    assert_eq!(all, [("SYSID_THISMAV".to_owned(), 0, 2, 1.0), ("WP_RADIUS".to_owned(), 1, 2, 90.0)]);
    let set = PARAM_SET_DATA { param_value: 5.0, param_id: "WP_RADIUS".into(), ..PARAM_SET_DATA::DEFAULT };
    let radius = ("WP_RADIUS".to_owned(), 1, 2, 90.0);
    assert_eq!(values(rig.ask(&MavMessage::PARAM_SET(set))), std::slice::from_ref(&radius));
    let read = PARAM_REQUEST_READ_DATA { param_index: 1, ..PARAM_REQUEST_READ_DATA::DEFAULT };
    assert_eq!(values(rig.ask(&MavMessage::PARAM_REQUEST_READ(read))), [radius]);
}

#[test]
fn a_message_that_was_heard_is_shown_again_and_one_that_was_not_is_denied() {
    let mut rig = Rig::new();
    let version = AUTOPILOT_VERSION_DATA { flight_sw_version: 7, ..AUTOPILOT_VERSION_DATA::DEFAULT };
    let id = AUTOPILOT_VERSION_DATA::ID as f32;
    assert_eq!(result(&rig.command(MavCmd::MAV_CMD_REQUEST_MESSAGE, id)), Some(MavResult::MAV_RESULT_DENIED));
    rig.pass(&MavMessage::AUTOPILOT_VERSION(version.clone()));
    rig.heard();
    let answers = rig.command(MavCmd::MAV_CMD_REQUEST_MESSAGE, id);
    assert_eq!(result(&answers), Some(MavResult::MAV_RESULT_ACCEPTED));
    assert!(answers.contains(&MavMessage::AUTOPILOT_VERSION(version)), "{answers:?}");
}

#[test]
fn what_is_for_another_vehicle_or_comes_before_the_autopilot_is_not_answered() {
    let mut rig = Rig::new();
    let elsewhere = MISSION_REQUEST_LIST_DATA { target_system: 7, ..MISSION_REQUEST_LIST_DATA::DEFAULT };
    assert_eq!(rig.ask(&MavMessage::MISSION_REQUEST_LIST(elsewhere)), []);
    rig.mirror = Mirror::default();
    assert_eq!(rig.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0), []);
}

#[test]
fn a_flood_of_orders_is_told_of_in_words_now_and_then() {
    let mut rig = Rig::new();
    let texts = (0..20)
        .flat_map(|_| rig.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0))
        .filter(|answer| matches!(answer, MavMessage::STATUSTEXT(_)));
    // one in five seconds
    assert_eq!(texts.count(), 4);
}
