//! `COMMAND_LONG` and `COMMAND_INT`: those about messages; the others are the personality's.

use super::{Peer, Simulator};
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;

/// Magic number that forces arming and disarming.
const FORCE: f32 = 21196.0;

/// A command, however it came.
#[derive(Debug, Clone)]
pub struct Command {
    /// Which.
    pub code: MavCmd,
    /// The first four parameters.
    pub params: [f32; 4],
    /// The fifth and sixth.
    pub position: LatLon,
    /// The seventh.
    pub z: f32,
    /// Of a COMMAND_INT; a COMMAND_LONG has none.
    pub frame: Option<MavFrame>,
}

impl From<&COMMAND_LONG_DATA> for Command {
    fn from(c: &COMMAND_LONG_DATA) -> Self {
        Self {
            code: c.command,
            params: [c.param1, c.param2, c.param3, c.param4],
            position: LatLon::new(c.param5.into(), c.param6.into()),
            z: c.param7,
            frame: None,
        }
    }
}

impl From<&COMMAND_INT_DATA> for Command {
    fn from(c: &COMMAND_INT_DATA) -> Self {
        Self {
            code: c.command,
            params: [c.param1, c.param2, c.param3, c.param4],
            position: LatLon::new(f64::from(c.x) * 1e-7, f64::from(c.y) * 1e-7),
            z: c.z,
            frame: Some(c.frame),
        }
    }
}

impl Command {
    /// It is to be done whatever is against it.
    pub fn is_forced(&self) -> bool {
        self.params[1] == FORCE
    }

    /// A place is to be flown to even if that takes another mode.
    pub fn may_change_mode(&self) -> bool {
        self.params[1] as u32 & 1 != 0
    }
}

impl Simulator {
    /// Carries out a command and says how it went.
    pub(super) fn command(&mut self, peer: Peer, c: &Command) -> MavResult {
        match c.code {
            MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL => self.set_interval(peer, c),
            MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL => self.send_interval(peer, c.params[0]),
            MavCmd::MAV_CMD_REQUEST_MESSAGE => self.send_requested(peer, c.params[0] as u32),
            MavCmd::MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES if self.rules.knows_old_requests => {
                self.send_requested(peer, 148)
            }
            MavCmd::MAV_CMD_GET_HOME_POSITION if self.rules.knows_old_requests => {
                self.send_requested(peer, 242)
            }
            _ => {
                let mut out = Vec::new();
                let result = self.behaviour.command(&mut self.autopilot, c, self.now_ns, &mut out);
                self.post(out);
                result
            }
        }
    }

    fn set_interval(&mut self, peer: Peer, c: &Command) -> MavResult {
        let now_ns = self.now_ns;
        let interval_us = f64::from(c.params[1]);
        let known =
            self.streams_of(peer).is_some_and(|s| s.set_interval_us(c.params[0] as u32, interval_us, now_ns));
        if known { MavResult::MAV_RESULT_ACCEPTED } else { self.rules.no_such_interval }
    }

    fn send_interval(&mut self, peer: Peer, id: f32) -> MavResult {
        let interval_us = self.streams_of(peer).map_or(0, |s| s.interval_us(id as u32));
        let message_id = id as u16;
        self.send(peer, &MavMessage::MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA { interval_us, message_id }));
        MavResult::MAV_RESULT_ACCEPTED
    }

    fn send_requested(&mut self, peer: Peer, id: u32) -> MavResult {
        let Some(message) = self.message(id) else {
            return self.rules.no_such_message;
        };
        self.send(peer, &message);
        MavResult::MAV_RESULT_ACCEPTED
    }
}
