//! Several stations speak with the autopilot about its list: what it says to another one is not for us.

use super::*;

/// Another ground station, and another program on board.
const OTHERS: [(u8, u8); 2] = [(255, 190), (1, 190)];
/// To us, to all our system, and to whom it does not say.
const OURS: [(u8, u8); 3] = [(1, 191), (1, 0), (0, 0)];

fn refusal((target_system, target_component): (u8, u8)) -> MavMessage {
    let mavtype = MavMissionResult::MAV_MISSION_NO_SPACE;
    MavMessage::MISSION_ACK(MISSION_ACK_DATA {
        target_system,
        target_component,
        mavtype,
        ..MISSION_ACK_DATA::DEFAULT
    })
}

fn length((target_system, target_component): (u8, u8), count: u16) -> MavMessage {
    MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
        count,
        target_system,
        target_component,
        ..MISSION_COUNT_DATA::DEFAULT
    })
}

#[expect(deprecated, reason = "ArduPilot asks by the deprecated message")]
fn request((target_system, target_component): (u8, u8), seq: u16) -> MavMessage {
    MavMessage::MISSION_REQUEST(MISSION_REQUEST_DATA {
        seq,
        target_system,
        target_component,
        ..MISSION_REQUEST_DATA::DEFAULT
    })
}

impl Rig {
    fn hears(&mut self, message: &MavMessage) {
        self.session.on_message(self.now, 0, AUTOPILOT, message, &mut self.events);
    }

    /// What it ends with when nothing is in the way any more.
    fn end(&mut self) -> Ended {
        (0..3000)
            .find_map(|_| {
                self.step(&mut |_, _| true);
                self.ended()
            })
            .expect("an end")
    }
}

#[test]
fn another_stations_list_that_is_refused_is_not_ours() {
    for target in OTHERS {
        let mut rig = Rig::new();
        rig.begin(Task::Upload(items(30)));
        rig.hears(&refusal(target));
        assert_eq!(rig.ended(), None, "{target:?}");
        assert_eq!(rig.end(), Ended::Done, "{target:?}");
    }
    for target in OURS {
        let mut rig = Rig::new();
        rig.begin(Task::Upload(items(30)));
        rig.hears(&refusal(target));
        assert!(matches!(rig.ended(), Some(Ended::Failed(_))), "{target:?}");
    }
}

#[test]
fn the_length_that_another_station_is_told_is_not_that_of_the_list_we_read() {
    let mut rig = Rig::new();
    assert_eq!(rig.carry_out(Task::Upload(items(30)), |_, _| true).0, Ended::Done);
    rig.begin(Task::Read);
    OTHERS.into_iter().for_each(|target| rig.hears(&length(target, 2)));
    let Ended::List(list) = rig.end() else { panic!("not read") };
    assert_eq!(list.len(), 30);
}

#[test]
fn what_another_station_is_asked_for_we_have_not_sent() {
    let mut rig = Rig::new();
    rig.begin(Task::Upload(items(30)));
    let sent = |rig: &mut Rig| {
        rig.session.out.drain(..).filter(|m| matches!(m, MavMessage::MISSION_ITEM_INT(_))).count()
    };
    assert_eq!(sent(&mut rig), 24, "the window");
    OTHERS.into_iter().for_each(|target| rig.hears(&request(target, 10)));
    assert_eq!(sent(&mut rig), 0);
    rig.hears(&request(OURS[0], 10));
    assert_eq!(sent(&mut rig), 6, "the rest");
}
