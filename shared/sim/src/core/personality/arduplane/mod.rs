//! ArduPlane.

mod commands;
mod mission;
mod params;
pub mod transfer;

use super::{Behaviour, ListEnd, Party, Post, Rules};
use crate::core::autopilot::Autopilot;
use crate::core::commands::Command;
use crate::core::item::{Datum, datum_of};
use crate::core::mode::Mode;
use crate::core::run::Phase;
use crate::core::streams::Streamed;
use crate::core::telemetry;
use aircraft::Habits;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;

/// The number that it acknowledges `SET_MODE` by.
const SET_MODE_ID: u16 = 11;

pub(super) static RULES: Rules = Rules {
    first_item: 1,
    first_mode: Mode::Manual,
    list_end: ListEnd::Return,
    flies_on_after_landing: false,
    skips_take_off_in_air: false,
    holds_after_take_off: false,
    climbs_evenly: false,
    returns_to_land: false,
    refuses_speeds: true,
    tells_items: true,
    armed_texts: ["Throttle armed", "Throttle disarmed"],
    refusal_text: "PreArm",
    engine_text: None,
    fence_text: "Circle fence breached",
    // 31 to 50 m in nine landings at 25 m/s
    lands_short_s: 1.6,
    params: params::params,
    habits: Habits::arduplane,
    // 50 Hz: one item of a list in 20 ms for those who wait to be asked
    turn: Duration::from_millis(20),
    streams: &STREAMS,
    knows_old_requests: true,
    tells_unknown_params: false,
    home_moves: false,
    no_such_message: MavResult::MAV_RESULT_FAILED,
    no_such_interval: MavResult::MAV_RESULT_DENIED,
};

const STREAMS: [Streamed; 21] = [
    (0, 1000, 0),      // HEARTBEAT
    (1, 500, 2),       // SYS_STATUS
    (2, 1000, 12),     // SYSTEM_TIME
    (24, 500, 2),      // GPS_RAW_INT
    (29, 500, 1),      // SCALED_PRESSURE
    (30, 250, 10),     // ATTITUDE
    (33, 250, 6),      // GLOBAL_POSITION_INT
    (42, 500, 2),      // MISSION_CURRENT
    (49, 0, 0),        // GPS_GLOBAL_ORIGIN
    (62, 500, 2),      // NAV_CONTROLLER_OUTPUT
    (74, 250, 11),     // VFR_HUD
    (87, 500, 2),      // POSITION_TARGET_GLOBAL_INT
    (147, 1000, 12),   // BATTERY_STATUS
    (148, 0, 0),       // AUTOPILOT_VERSION
    (168, 1000, 12),   // WIND
    (225, 1000, 12),   // EFI_STATUS
    (226, 1000, 12),   // RPM
    (242, 0, 0),       // HOME_POSITION
    (245, 1000, 2),    // EXTENDED_SYS_STATE
    (11030, 1000, 12), // ESC_TELEMETRY_1_TO_4
    (111, 0, 0),       // TIMESYNC, only so that its interval can be asked for
];

/// Modes by its numbers; it has no landing mode.
const MODES: [(Mode, u32); 8] = [
    (Mode::Manual, 0),
    (Mode::Circle, 1),
    (Mode::FlyByWireA, 5),
    (Mode::Auto, 10),
    (Mode::ReturnToLaunch, 11),
    (Mode::Loiter, 12),
    (Mode::TakeOff, 13),
    (Mode::Guided, 15),
];

fn mode_of(number: f32) -> Option<Mode> {
    MODES.iter().find(|(_, n)| number >= 0.0 && *n == number as u32).map(|(mode, _)| *mode)
}

pub fn number_of(mode: Mode) -> u32 {
    MODES.iter().find(|(m, _)| *m == mode).map_or(0, |(_, number)| *number)
}

/// ArduPlane and its mission protocol.
#[derive(Debug, Default)]
pub(super) struct ArduPlane {
    transfer: transfer::Transfer,
    told_current: u16,
}

impl Behaviour for ArduPlane {
    fn message(&self, a: &Autopilot, _now_ns: u64, id: u32) -> Option<MavMessage> {
        match id {
            0 => Some(heartbeat(a)),
            42 => Some(mission_current(a)),
            148 => Some(autopilot_version()),
            _ => None,
        }
    }

    fn command(&mut self, a: &mut Autopilot, c: &Command, _now_ns: u64, out: &mut Vec<Post>) -> MavResult {
        commands::command(a, c, out)
    }

    fn set_mode(&mut self, a: &mut Autopilot, c: &SET_MODE_DATA, _now_ns: u64) -> (u16, MavResult) {
        (SET_MODE_ID, commands::done(commands::set_mode(a, mode_of(c.custom_mode as f32))))
    }

    fn mission(
        &mut self,
        a: &mut Autopilot,
        party: Party,
        message: &MavMessage,
        now_ns: u64,
        out: &mut Vec<Post>,
    ) -> bool {
        self.mission_message(a, party, message, now_ns, out)
    }

    fn strange_item(&mut self, a: &mut Autopilot, party: Party, out: &mut Vec<Post>) {
        self.transfer.cancel(party);
        let refused = transfer::Reply::Ack(MavMissionResult::MAV_MISSION_UNSUPPORTED);
        mission::send(a, party, refused, out);
    }

    /// All are sent as floats, and it is said what they are.
    fn encode_param(&self, value: f32, kind: MavParamType) -> (f32, MavParamType) {
        (value, kind)
    }

    fn decode_param(&self, value: f32, _sent_as: MavParamType, _kind: MavParamType) -> Option<f32> {
        Some(value)
    }

    /// GUIDED takes a new altitude this way, and nothing else.
    fn position_target(&mut self, a: &mut Autopilot, c: &SET_POSITION_TARGET_GLOBAL_INT_DATA) {
        let Ok(datum) = datum_of(c.coordinate_frame) else { return };
        let base_m = match datum {
            Datum::Amsl => 0.0,
            Datum::Home => a.home.altitude_amsl_m,
        };
        if c.alt.is_finite() {
            a.change_altitude(base_m + f64::from(c.alt));
        }
    }

    fn after_step(&mut self, a: &mut Autopilot, now_ns: u64, out: &mut Vec<Post>) {
        if let Some((party, reply)) = self.transfer.tick(now_ns) {
            mission::send(a, party, reply, out);
        }
        out.extend(a.take_reached().into_iter().map(|seq| (None, telemetry::item_reached(seq))));
        if a.run.current != self.told_current {
            self.told_current = a.run.current;
            out.push((None, mission_current(a)));
        }
    }
}

fn heartbeat(a: &Autopilot) -> MavMessage {
    let flies_itself = !matches!(a.mode(), Mode::Manual | Mode::FlyByWireA);
    // the sticks always have a say, and it always calls itself stabilised
    let mut base_mode =
        MavModeFlag::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED | MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED;
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED, flies_itself);
    let failing = !a.gps_ok || !a.aircraft.engine().healthy;
    let system_status = match (failing, a.aircraft.state().on_ground) {
        (true, _) => MavState::MAV_STATE_CRITICAL,
        (false, true) => MavState::MAV_STATE_STANDBY,
        (false, false) => MavState::MAV_STATE_ACTIVE,
    };
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: number_of(a.mode()),
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        base_mode: base_mode | telemetry::armed_flag(a),
        system_status,
        ..telemetry::fixed_wing()
    })
}

fn mission_current(a: &Autopilot) -> MavMessage {
    let count = a.mission.items().len();
    let mission_state = match a.run.phase {
        _ if count < 2 => MissionState::MISSION_STATE_NO_MISSION,
        Phase::Running => MissionState::MISSION_STATE_ACTIVE,
        Phase::Complete => MissionState::MISSION_STATE_COMPLETE,
        Phase::Stopped if a.run.current == 0 => MissionState::MISSION_STATE_NOT_STARTED,
        Phase::Stopped => MissionState::MISSION_STATE_PAUSED,
    };
    MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA {
        seq: a.run.current,
        total: count.saturating_sub(1) as u16,
        mission_state,
        mission_mode: if a.mode() == Mode::Auto { 1 } else { 2 },
        ..MISSION_CURRENT_DATA::DEFAULT
    })
}

fn autopilot_version() -> MavMessage {
    use MavProtocolCapability as C;
    let capabilities = C::MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT
        | C::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
        | C::MAV_PROTOCOL_CAPABILITY_MISSION_INT
        | C::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
        | C::MAV_PROTOCOL_CAPABILITY_MAVLINK2;
    // 4.7.0-dev, as what it imitates says
    telemetry::autopilot_version(capabilities, 0x0407_0000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mode_numbers_are_its_own_and_unknown_ones_are_none() {
        for (number, mode) in [(0.0, Mode::Manual), (10.0, Mode::Auto), (15.0, Mode::Guided)] {
            assert_eq!(mode_of(number), Some(mode));
            assert_eq!(number_of(mode) as f32, number);
        }
        for unknown in [17.0, -1.0, f32::NAN] {
            assert_eq!(mode_of(unknown), None);
        }
    }
}
