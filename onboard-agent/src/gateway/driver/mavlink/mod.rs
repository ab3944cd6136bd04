//! What drivers of MAVLink autopilots share: mission transfer, commands, streams, telemetry, timeouts.

pub mod commands;
pub mod items;
pub mod partial_write;
pub mod rto;
pub mod streams;
pub mod telemetry;
pub mod transfer;

use mavlink::dialects::ardupilotmega::MavMissionType;

/// Whom we talk to.
pub use autopilot_link::frame::Sender as Peer;

/// The list of waypoints, beside those of fences and rally points.
pub fn mission_type() -> MavMissionType {
    MavMissionType::MAV_MISSION_TYPE_MISSION
}
