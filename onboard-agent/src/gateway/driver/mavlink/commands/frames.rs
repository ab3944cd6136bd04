//! Commands as they are sent.

use super::{Command, Peer};
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;

/// `MAV_CMD_COMPONENT_ARM_DISARM`: disarm even in flight.
const FORCE: f32 = 21_196.0;

/// The number of a command, which is all that its answer names.
pub(super) fn number(command: Command) -> MavCmd {
    match command {
        // the message is answered by nobody
        Command::Current(_) | Command::Select(_) => MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT,
        Command::Mode(_) => MavCmd::MAV_CMD_DO_SET_MODE,
        Command::Arm | Command::Disarm | Command::ForceDisarm => MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        Command::Speed(_) => MavCmd::MAV_CMD_DO_CHANGE_SPEED,
        Command::GoTo { .. } => MavCmd::MAV_CMD_DO_REPOSITION,
        Command::Terminate => MavCmd::MAV_CMD_DO_FLIGHTTERMINATION,
    }
}

/// The message that gives it; `confirmation`: how often it was sent before.
pub(super) fn encode(command: Command, confirmation: u8, peer: Peer) -> MavMessage {
    let (param1, param2, param3) = match command {
        Command::Current(seq) => (f32::from(seq), 0.0, 0.0),
        // 1: the number is the autopilot's own
        Command::Mode(mode) => (1.0, f32::from(mode.main), f32::from(mode.sub)),
        Command::Arm | Command::Terminate => (1.0, 0.0, 0.0),
        Command::Disarm => (0.0, 0.0, 0.0),
        Command::ForceDisarm => (0.0, FORCE, 0.0),
        // 0: airspeed; throttle −1: as it is
        Command::Speed(mps) => (0.0, mps as f32, -1.0),
        Command::GoTo { place, .. } => return reposition(place, peer),
        Command::Select(seq) => return select(seq, peer),
    };
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1,
        param2,
        param3,
        param4: 0.0,
        param5: 0.0,
        param6: 0.0,
        param7: 0.0,
        command: number(command),
        target_system: peer.system,
        target_component: peer.component,
        confirmation,
    })
}

#[expect(deprecated, reason = "PX4 1.18 knows no command for it")]
fn select(seq: u16, peer: Peer) -> MavMessage {
    let (target_system, target_component) = (peer.system, peer.component);
    MavMessage::MISSION_SET_CURRENT(MISSION_SET_CURRENT_DATA { seq, target_system, target_component })
}

/// What is not given is "not used": NaN, or the greatest whole number.
fn reposition(place: Option<(LatLon, f64)>, peer: Peer) -> MavMessage {
    let degrees = |deg: f64| (deg * 1e7).round() as i32;
    let (x, y, z, param4) = match place {
        Some((at, altitude_amsl_m)) => {
            (degrees(at.lat_deg), degrees(at.lon_deg), altitude_amsl_m as f32, 0.0)
        }
        None => (i32::MAX, i32::MAX, f32::NAN, f32::NAN),
    };
    MavMessage::COMMAND_INT(COMMAND_INT_DATA {
        param1: -1.0,
        param2: 1.0,
        param3: 0.0,
        param4,
        x,
        y,
        z,
        command: MavCmd::MAV_CMD_DO_REPOSITION,
        target_system: peer.system,
        target_component: peer.component,
        frame: MavFrame::MAV_FRAME_GLOBAL,
        current: 0,
        autocontinue: 0,
    })
}
