//! What drivers of MAVLink autopilots share: the conversation (`session`), what is done to a list (`mission`, by
//! `transfer` and `partial_write`), commands, streams, telemetry and timeouts. It knows no autopilot's habits.

pub mod commands;
pub mod mission;
mod partial_write;
mod rto;
pub mod session;
mod streams;
mod telemetry;
mod transfer;

use mavlink::dialects::ardupilotmega::MavMissionType;

/// Whom we talk to.
pub use autopilot_link::frame::Sender as Peer;

/// The list of waypoints, beside those of fences and rally points.
fn mission_type() -> MavMissionType {
    MavMissionType::MAV_MISSION_TYPE_MISSION
}
