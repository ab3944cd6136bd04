//! Answers of the mission protocol.

use super::item;
use crate::frame::Sender;
use mavlink::dialects::ardupilotmega::*;

/// A list of waypoints, not a fence nor rally points.
pub fn is_mission(mission_type: MavMissionType) -> bool {
    mission_type == MavMissionType::MAV_MISSION_TYPE_MISSION
}

/// `MISSION_ACK`.
pub fn mission_ack(to: Sender, result: MavMissionResult, mission_type: MavMissionType) -> MavMessage {
    MavMessage::MISSION_ACK(MISSION_ACK_DATA {
        target_system: to.system,
        target_component: to.component,
        mavtype: result,
        mission_type,
        ..MISSION_ACK_DATA::DEFAULT
    })
}

/// `MISSION_COUNT`.
pub fn mission_count(to: Sender, count: u16, mission_type: MavMissionType) -> MavMessage {
    MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
        count,
        target_system: to.system,
        target_component: to.component,
        mission_type,
        ..MISSION_COUNT_DATA::DEFAULT
    })
}

/// An item for the one who asked for it, in the form that was asked for.
pub fn mission_item(to: Sender, wire: MISSION_ITEM_INT_DATA, seq: u16, as_int: bool) -> MavMessage {
    let (target_system, target_component) = (to.system, to.component);
    let wire = MISSION_ITEM_INT_DATA { seq, target_system, target_component, ..wire };
    if as_int { MavMessage::MISSION_ITEM_INT(wire) } else { MavMessage::MISSION_ITEM(item::to_float(&wire)) }
}
