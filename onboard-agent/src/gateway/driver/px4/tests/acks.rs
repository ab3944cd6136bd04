//! Answers to commands, of which several stations give some.

use super::*;

fn ack(target_system: u8, target_component: u8, result: MavResult) -> MavMessage {
    let command = MavCmd::MAV_CMD_DO_CHANGE_SPEED;
    MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
        command,
        result,
        target_system,
        target_component,
        ..COMMAND_ACK_DATA::DEFAULT
    })
}

#[test]
fn an_answer_to_another_station_is_not_ours() {
    for (ours, accepted) in [((1, 191), true), ((0, 0), true), ((1, 191), false)] {
        let mut rig = Rig::flying();
        rig.pass = Box::new(|to, m| !(to == To::Driver && matches!(m, MavMessage::COMMAND_ACK(_))));
        let id = rig.order(Order::Speed(25.0));
        let [refused, done] = [MavResult::MAV_RESULT_DENIED, MavResult::MAV_RESULT_ACCEPTED];
        rig.hear(&ack(255, 190, if accepted { refused } else { done }));
        rig.hear(&ack(1, 190, if accepted { refused } else { done }));
        assert_eq!(rig.outcome(id), None, "{ours:?}");
        rig.hear(&ack(ours.0, ours.1, if accepted { done } else { refused }));
        assert_eq!(rig.outcome(id).map(|outcome| outcome.is_ok()), Some(accepted), "{ours:?}");
    }
}
