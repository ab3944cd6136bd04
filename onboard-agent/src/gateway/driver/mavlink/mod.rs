//! The driver of MAVLink autopilots and what their dialects share: the conversation (`session`) over the `links`, the waypoints (`chain`)
//! and the list that they go to (`list`, `item`), what is done to it (`mission`, by `transfer` and `partial_write`),
//! commands, parameters, streams, telemetry, words and timeouts. It knows no autopilot's habits: those are a `dialect`.

mod aboard;
pub mod chain;
pub mod climb_out;
mod clocks;
pub mod commands;
pub mod courier;
pub mod dialect;
pub mod driver;
pub mod examine;
pub mod item;
mod links;
pub mod list;
mod mirror;
pub mod mission;
pub mod parameters;
mod partial_write;
mod rto;
pub mod session;
mod statistics;
mod streams;
mod telemetry;
mod transfer;
mod unknown;
mod words;

use mavlink::dialects::ardupilotmega::MavMissionType;

/// Whom we talk to.
pub use autopilot_link::frame::Sender as Peer;

/// The list of waypoints, beside those of fences and rally points.
fn mission_type() -> MavMissionType {
    MavMissionType::MAV_MISSION_TYPE_MISSION
}

/// A message with these targets is for `own`: it is named, or everybody is (0), or no target is.
fn is_for(own: Peer, system: Option<u8>, component: Option<u8>) -> bool {
    let to = |own: u8, target: Option<u8>| target.is_none_or(|target| target == 0 || target == own);
    to(own.system, system) && to(own.component, component)
}
