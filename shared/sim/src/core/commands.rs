//! `COMMAND_LONG` and `COMMAND_INT`.

use super::item::{Datum, datum_of};
use super::mode::Mode;
use super::{Peer, Simulator, telemetry};
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;

/// Magic number that forces arming and disarming.
const FORCE: f32 = 21196.0;

/// A command, however it came.
#[derive(Debug, Clone)]
pub(super) struct Command {
    code: MavCmd,
    params: [f32; 4],
    position: LatLon,
    z: f32,
    /// Of a COMMAND_INT; a COMMAND_LONG has none.
    frame: Option<MavFrame>,
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

fn done(ok: bool) -> MavResult {
    if ok { MavResult::MAV_RESULT_ACCEPTED } else { MavResult::MAV_RESULT_FAILED }
}

impl Simulator {
    /// Carries out a command and says how it went.
    pub(super) fn command(&mut self, peer: Peer, c: &Command) -> MavResult {
        match c.code {
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => self.arm_or_disarm(c),
            MavCmd::MAV_CMD_DO_SET_MODE => done(self.set_mode_number(c.params[1])),
            MavCmd::MAV_CMD_MISSION_START => done(self.autopilot.set_mode(Mode::Auto)),
            MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH => done(self.autopilot.set_mode(Mode::ReturnToLaunch)),
            MavCmd::MAV_CMD_NAV_LOITER_UNLIM => done(self.autopilot.set_mode(Mode::Loiter)),
            MavCmd::MAV_CMD_NAV_TAKEOFF => self.take_off(c),
            MavCmd::MAV_CMD_DO_REPOSITION => self.reposition(c),
            MavCmd::MAV_CMD_DO_CHANGE_SPEED => done(self.autopilot.change_speed(c.params[1].into())),
            MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT => self.set_current_command(c),
            MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL => self.set_interval(peer, c),
            MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL => self.send_interval(peer, c.params[0]),
            MavCmd::MAV_CMD_REQUEST_MESSAGE => self.send_requested(peer, c.params[0] as u32),
            MavCmd::MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES => self.send_requested(peer, 148),
            MavCmd::MAV_CMD_GET_HOME_POSITION => self.send_requested(peer, 242),
            _ => MavResult::MAV_RESULT_UNSUPPORTED,
        }
    }

    fn arm_or_disarm(&mut self, c: &Command) -> MavResult {
        let force = c.params[1] == FORCE;
        match c.params[0] {
            1.0 => done(self.autopilot.arm(force)),
            0.0 => done(self.autopilot.disarm(force)),
            _ => MavResult::MAV_RESULT_UNSUPPORTED,
        }
    }

    /// A mode by ArduPlane's number; false if there is none or it can't be entered.
    pub(super) fn set_mode_number(&mut self, number: f32) -> bool {
        match Mode::from_number(number as u32) {
            Some(mode) if number >= 0.0 => self.autopilot.set_mode(mode),
            _ => false,
        }
    }

    fn take_off(&mut self, c: &Command) -> MavResult {
        if !self.autopilot.is_armed() {
            return MavResult::MAV_RESULT_FAILED;
        }
        if c.z > 0.0 {
            self.autopilot.params.set("TKOFF_ALT", c.z.min(200.0));
        }
        done(self.autopilot.set_mode(Mode::TakeOff))
    }

    /// param2 bit 0: change to GUIDED; param3: radius; param4: any number but 0: counter-clockwise.
    fn reposition(&mut self, c: &Command) -> MavResult {
        const CHANGE_MODE: u32 = 1;
        let Some(frame) = c.frame else {
            return MavResult::MAV_RESULT_COMMAND_INT_ONLY;
        };
        let Ok(datum) = datum_of(frame) else {
            return MavResult::MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME;
        };
        let may_change = c.params[1] as u32 & CHANGE_MODE != 0;
        let guided = self.autopilot.mode() == Mode::Guided;
        if !c.position.is_valid() || !c.z.is_finite() || !(guided || may_change) {
            return MavResult::MAV_RESULT_DENIED;
        }
        let own = self.autopilot.params.value("WP_LOITER_RAD");
        let asked = f64::from(c.params[2]);
        let radius_m = if asked.is_finite() && asked > 0.0 { asked } else { own };
        let anticlockwise = c.params[3].is_finite() && c.params[3] != 0.0;
        if c.params[0] > 0.0 {
            self.autopilot.change_speed(c.params[0].into());
        }
        let signed_m = if anticlockwise { -radius_m } else { radius_m };
        self.autopilot.reposition(c.position, c.z.into(), datum, signed_m);
        MavResult::MAV_RESULT_ACCEPTED
    }

    fn set_current_command(&mut self, c: &Command) -> MavResult {
        let seq = c.params[0];
        if !(0.0..=65535.0).contains(&seq) {
            return MavResult::MAV_RESULT_DENIED;
        }
        if c.params[1] == 1.0 {
            self.autopilot.run.reset();
        }
        done(self.set_current(seq as u16))
    }

    fn set_interval(&mut self, peer: Peer, c: &Command) -> MavResult {
        let now_ns = self.now_ns;
        let interval_us = f64::from(c.params[1]);
        let known =
            self.streams_of(peer).is_some_and(|s| s.set_interval_us(c.params[0] as u32, interval_us, now_ns));
        done(known)
    }

    fn send_interval(&mut self, peer: Peer, id: f32) -> MavResult {
        let interval_us = self.streams_of(peer).map_or(0, |s| s.interval_us(id as u32));
        let message_id = id as u16;
        self.send(peer, &MavMessage::MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA { interval_us, message_id }));
        MavResult::MAV_RESULT_ACCEPTED
    }

    fn send_requested(&mut self, peer: Peer, id: u32) -> MavResult {
        let message = telemetry::message(&self.autopilot, self.now_ns, id);
        if let Some(message) = &message {
            self.send(peer, message);
        }
        done(message.is_some())
    }

    /// GUIDED takes a new altitude this way, and nothing else.
    pub(super) fn position_target(&mut self, c: &SET_POSITION_TARGET_GLOBAL_INT_DATA) {
        let Ok(datum) = datum_of(c.coordinate_frame) else { return };
        let base_m = match datum {
            Datum::Amsl => 0.0,
            Datum::Home => self.autopilot.home.altitude_amsl_m,
        };
        if c.alt.is_finite() {
            self.autopilot.change_altitude(base_m + f64::from(c.alt));
        }
    }
}
