//! PX4, fixed wing.

mod check;
mod commands;
mod departure;
mod failsafe;
mod items;
mod mission;
mod params;
mod transfer;

use super::{Behaviour, ListEnd, Party, Post, Rules};
use crate::core::autopilot::Autopilot;
use crate::core::commands::Command;
use crate::core::mode::Mode;
use crate::core::run::Phase;
use crate::core::streams::{Streamed, UNCHANGEABLE};
use crate::core::telemetry;
use aircraft::Habits;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;

/// The number of the command that `SET_MODE` stands for.
const DO_SET_MODE_ID: u16 = 176;
/// It starts up for so long, and does not arm.
const STARTS_UP_NS: u64 = 4_000_000_000;
/// An accepted mission is found to be flyable only so much later.
const SETTLES_NS: u64 = 300_000_000;
/// The last item reached is told so often again, a second apart.
const REACHED_AGAIN: u8 = 10;
const SECOND_NS: u64 = 1_000_000_000;
/// `MISSION_CURRENT` when it doesn't know.
const NO_SEQ: u16 = u16::MAX;

/// A VTOL differs in what it says it is.
pub(super) static VTOL_RULES: Rules = Rules { params: params::vtol, ..FIXED_WING };

pub(super) static RULES: Rules = FIXED_WING;

const FIXED_WING: Rules = Rules {
    first_item: 0,
    first_mode: Mode::Loiter,
    list_end: ListEnd::Hold,
    flies_on_after_landing: true,
    skips_take_off_in_air: true,
    holds_after_take_off: true,
    climbs_evenly: true,
    returns_to_land: true,
    refuses_speeds: false,
    tells_items: false,
    armed_texts: ["Armed", "Disarmed"],
    refusal_text: "Preflight check",
    engine_text: Some("Motor failure: Motor 1 undercurrent detected"),
    fence_text: "Maximum distance from home exceeded",
    lands_short_s: 0.0,
    params: params::fixed_wing,
    habits: |_| Habits::PX4,
    // whoever reads what comes waits for nothing else: 500 items in 0.1 to 0.2 s
    turn: Duration::ZERO,
    streams: &STREAMS,
    knows_old_requests: false,
    tells_unknown_params: true,
    home_moves: true,
    no_such_message: MavResult::MAV_RESULT_DENIED,
    no_such_interval: MavResult::MAV_RESULT_FAILED,
};

const STREAMS: [Streamed; 19] = [
    (0, 1000, UNCHANGEABLE),  // HEARTBEAT
    (1, 1000, 0),             // SYS_STATUS
    (2, 1000, 0),             // SYSTEM_TIME
    (24, 200, 0),             // GPS_RAW_INT
    (29, 1000, 0),            // SCALED_PRESSURE
    (30, 100, 0),             // ATTITUDE
    (33, 200, 0),             // GLOBAL_POSITION_INT
    (42, 1000, UNCHANGEABLE), // MISSION_CURRENT
    (49, 1000, 0),            // GPS_GLOBAL_ORIGIN
    (74, 250, 0),             // VFR_HUD
    (87, 0, 0),               // POSITION_TARGET_GLOBAL_INT
    (141, 1000, 0),           // ALTITUDE
    (147, 2000, 0),           // BATTERY_STATUS
    (148, 0, 0),              // AUTOPILOT_VERSION
    (231, 2000, 0),           // WIND_COV
    (242, 2000, 0),           // HOME_POSITION
    (245, 1000, 0),           // EXTENDED_SYS_STATE
    (291, 1000, 0),           // ESC_STATUS
    (111, 0, 0),              // TIMESYNC, only so that its interval can be asked for
];

/// Modes by its main and sub modes; what it holds in has one, whichever way it was entered.
const MODES: [(Mode, u8, u8); 8] = [
    (Mode::Manual, 1, 0),
    (Mode::FlyByWireA, 3, 0),
    (Mode::TakeOff, 4, 2),
    (Mode::Loiter, 4, 3),
    (Mode::Auto, 4, 4),
    (Mode::ReturnToLaunch, 4, 5),
    (Mode::Land, 4, 6),
    (Mode::Termination, 10, 0),
];

fn mode_of(main: u8, sub: u8) -> Option<Mode> {
    match (main, sub) {
        (1, _) => Some(Mode::Manual),
        // altitude, position, acro, stabilised: all need somebody at the sticks
        (2 | 3 | 5 | 7, _) => Some(Mode::FlyByWireA),
        (4, 0) => Some(Mode::Auto),
        _ => MODES.iter().find(|(_, m, s)| (*m, *s) == (main, sub)).map(|(mode, ..)| *mode),
    }
}

fn number_of(mode: Mode) -> u32 {
    let mode = if mode == Mode::Guided { Mode::Loiter } else { mode };
    let (main, sub) = MODES.iter().find(|(m, ..)| *m == mode).map_or((1, 0), |(_, main, sub)| (*main, *sub));
    u32::from(main) << 16 | u32::from(sub) << 24
}

/// By hand; nobody is at the sticks here.
fn needs_sticks(mode: Mode) -> bool {
    matches!(mode, Mode::Manual | Mode::FlyByWireA | Mode::Circle)
}

/// PX4, its mission protocol and what it watches.
#[derive(Debug, Default)]
pub(super) struct Px4 {
    transfer: transfer::Transfer,
    failsafe: failsafe::Failsafe,
    departure: departure::Departure,
    /// When the mission was taken; what is wrong with it is known a moment later.
    taken_ns: u64,
    problem: Option<&'static str>,
    /// A list was taken that has no item marked as the current one: which it is, is not known for a moment.
    is_current_unknown: bool,
    /// Stands for the list, and is the same for the same list.
    list_id: u32,
    is_vtol: bool,
    told: Told,
}

/// What the ground was told of the mission.
#[derive(Debug, Default)]
struct Told {
    current: u16,
    complete: bool,
    reached: Option<u16>,
    reached_again: u8,
    reached_ns: u64,
}

impl Px4 {
    /// A VTOL.
    pub fn vtol() -> Self {
        Self { is_vtol: true, ..Self::default() }
    }

    /// The mission can be flown, as far as it knows by now.
    fn has_mission(&self, a: &Autopilot, now_ns: u64) -> bool {
        !a.mission.items().is_empty() && self.problem.is_none() && self.is_settled(now_ns)
    }

    /// It has found out whether the mission can be flown.
    fn is_settled(&self, now_ns: u64) -> bool {
        now_ns.saturating_sub(self.taken_ns) >= SETTLES_NS
    }

    fn mission_current(&self, a: &Autopilot, now_ns: u64) -> MavMessage {
        let count = a.mission.items().len() as u16;
        let unfit = self.problem.is_some() && self.is_settled(now_ns);
        let mission_state = match a.run.phase {
            _ if count == 0 || unfit => MissionState::MISSION_STATE_NO_MISSION,
            Phase::Running => MissionState::MISSION_STATE_ACTIVE,
            Phase::Complete => MissionState::MISSION_STATE_COMPLETE,
            Phase::Stopped if a.run.current == 0 => MissionState::MISSION_STATE_NOT_STARTED,
            Phase::Stopped => MissionState::MISSION_STATE_PAUSED,
        };
        let active = matches!(a.mode(), Mode::Auto | Mode::TakeOff | Mode::Land);
        MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA {
            seq: if self.is_current_unknown { NO_SEQ } else { a.run.current },
            total: if count == 0 { NO_SEQ } else { count },
            mission_state,
            mission_mode: if active { 1 } else { 2 },
            mission_id: self.list_id,
            ..MISSION_CURRENT_DATA::DEFAULT
        })
    }

    fn heartbeat(&self, a: &Autopilot, now_ns: u64) -> MavMessage {
        let flags = if needs_sticks(a.mode()) {
            MavModeFlag::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
        } else {
            MavModeFlag::MAV_MODE_FLAG_AUTO_ENABLED
                | MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED
                | MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED
        };
        let failing = self.failsafe.is_active() || !a.gps_ok;
        let system_status = match (a.is_armed(), failing) {
            (true, true) => MavState::MAV_STATE_CRITICAL,
            (true, false) => MavState::MAV_STATE_ACTIVE,
            (false, _) if self.arming_problem(a, now_ns).is_none() => MavState::MAV_STATE_STANDBY,
            (false, _) => MavState::MAV_STATE_UNINIT,
        };
        MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: number_of(a.mode()),
            autopilot: MavAutopilot::MAV_AUTOPILOT_PX4,
            base_mode: flags | telemetry::armed_flag(a),
            system_status,
            mavtype: if self.is_vtol {
                MavType::MAV_TYPE_VTOL_FIXEDROTOR
            } else {
                MavType::MAV_TYPE_FIXED_WING
            },
            ..telemetry::fixed_wing()
        })
    }

    /// Which item is current, and which were reached: at once, and the last one again and again.
    fn tell_mission(&mut self, a: &mut Autopilot, now_ns: u64, out: &mut Vec<Post>) {
        let complete = a.run.phase == Phase::Complete;
        if self.is_current_unknown {
            out.push((None, self.mission_current(a, now_ns)));
            (self.is_current_unknown, self.told.current) = (false, NO_SEQ);
        } else if (a.run.current, complete) != (self.told.current, self.told.complete) {
            (self.told.current, self.told.complete) = (a.run.current, complete);
            out.push((None, self.mission_current(a, now_ns)));
        }
        for seq in a.take_reached() {
            out.push((None, telemetry::item_reached(seq)));
            (self.told.reached, self.told.reached_again, self.told.reached_ns) = (Some(seq), 0, now_ns);
        }
        let due = now_ns.saturating_sub(self.told.reached_ns) >= SECOND_NS;
        if let Some(seq) = self.told.reached.filter(|_| due && self.told.reached_again < REACHED_AGAIN) {
            out.push((None, telemetry::item_reached(seq)));
            (self.told.reached_again, self.told.reached_ns) = (self.told.reached_again + 1, now_ns);
        }
    }
}

impl Behaviour for Px4 {
    fn message(&self, a: &Autopilot, now_ns: u64, id: u32) -> Option<MavMessage> {
        match id {
            0 => Some(self.heartbeat(a, now_ns)),
            42 => Some(self.mission_current(a, now_ns)),
            148 => Some(autopilot_version()),
            _ => None,
        }
    }

    fn command(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64, _out: &mut Vec<Post>) -> MavResult {
        self.carry_out(a, c, now_ns)
    }

    fn set_mode(&mut self, a: &mut Autopilot, c: &SET_MODE_DATA, now_ns: u64) -> (u16, MavResult) {
        let [_, _, main, sub] = c.custom_mode.to_le_bytes();
        (DO_SET_MODE_ID, self.enter(a, mode_of(main, sub), now_ns))
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
        let reply = self.transfer.strange_item(party);
        self.send(a, party, reply, 0, out);
    }

    /// A whole number is sent as its bits.
    fn encode_param(&self, value: f32, kind: MavParamType) -> (f32, MavParamType) {
        match kind {
            MavParamType::MAV_PARAM_TYPE_INT32 => (f32::from_bits(value as i32 as u32), kind),
            _ => (value, kind),
        }
    }

    fn decode_param(&self, value: f32, sent_as: MavParamType, kind: MavParamType) -> Option<f32> {
        match kind {
            _ if sent_as != kind => None,
            MavParamType::MAV_PARAM_TYPE_INT32 => Some(value.to_bits() as i32 as f32),
            _ => Some(value),
        }
    }

    fn heard(&mut self, heartbeat: &HEARTBEAT_DATA, now_ns: u64) {
        if heartbeat.mavtype == MavType::MAV_TYPE_GCS {
            self.failsafe.heard(now_ns);
        }
    }

    fn after_step(&mut self, a: &mut Autopilot, now_ns: u64, out: &mut Vec<Post>) {
        if let Some((party, reply)) = self.transfer.tick(now_ns) {
            self.send(a, party, reply, now_ns, out);
        }
        self.failsafe.watch(a, now_ns);
        self.departure.watch(a, now_ns);
        self.tell_mission(a, now_ns, out);
    }
}

fn autopilot_version() -> MavMessage {
    // among them whole numbers in missions and commands, and parameters sent as bits
    let capabilities = MavProtocolCapability::from_bits_truncate(0xE8FF);
    // 1.18.0 in development, as what it imitates says
    telemetry::autopilot_version(capabilities, 0x0112_0000)
}
