//! Which messages the autopilot is to send, and how often. Asked for again when they don't come.

use super::Peer;
use crate::gateway::order::Time;
use mavlink::MessageData;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;

/// What has not come for so long is asked for (again).
const MISSING: Duration = Duration::from_secs(3);

/// `(message, interval in milliseconds)`; interval 0: asked for once, until it comes.
const WANTED: [(u32, u32); 13] = [
    (GLOBAL_POSITION_INT_DATA::ID, 100),
    (ATTITUDE_DATA::ID, 100),
    (MISSION_CURRENT_DATA::ID, 100),
    (VFR_HUD_DATA::ID, 200),
    (GPS_RAW_INT_DATA::ID, 400),
    (SYS_STATUS_DATA::ID, 500),
    (WIND_DATA::ID, 500),
    (RPM_DATA::ID, 500),
    (EFI_STATUS_DATA::ID, 1000),
    (SCALED_PRESSURE_DATA::ID, 1000),
    (SYSTEM_TIME_DATA::ID, 1000),
    (EXTENDED_SYS_STATE_DATA::ID, 500),
    (HOME_POSITION_DATA::ID, 0),
];

/// When each was last seen or asked for.
#[derive(Debug, Clone, Default)]
pub struct Streams {
    touched: [Option<Time>; WANTED.len()],
    got_home: bool,
}

impl Streams {
    /// A message came.
    pub fn seen(&mut self, now: Time, id: u32) {
        if let Some(i) = WANTED.iter().position(|(wanted, _)| *wanted == id)
            && let Some(touched) = self.touched.get_mut(i)
        {
            *touched = Some(now);
            self.got_home |= id == HOME_POSITION_DATA::ID;
        }
    }

    /// Asks for what is missing.
    pub fn tick(&mut self, now: Time, peer: Peer, out: &mut Vec<MavMessage>) {
        for ((id, interval_ms), touched) in WANTED.iter().zip(&mut self.touched) {
            let missing = touched.is_none_or(|at| now.saturating_sub(at) >= MISSING);
            let wanted = *interval_ms > 0 || !self.got_home;
            if missing && wanted {
                *touched = Some(now);
                out.push(ask(*id, *interval_ms, peer));
            }
        }
    }
}

fn ask(id: u32, interval_ms: u32, peer: Peer) -> MavMessage {
    let (command, param2) = match interval_ms {
        0 => (MavCmd::MAV_CMD_REQUEST_MESSAGE, 0.0),
        ms => (MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, ms as f32 * 1000.0),
    };
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1: id as f32,
        param2,
        param3: 0.0,
        param4: 0.0,
        param5: 0.0,
        param6: 0.0,
        param7: 0.0,
        command,
        target_system: peer.system,
        target_component: peer.component,
        confirmation: 0,
    })
}
