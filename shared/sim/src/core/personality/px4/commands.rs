//! PX4's answers to commands.

use super::failsafe::Failsafe;
use super::{Px4, STARTS_UP_NS, items, mode_of, needs_sticks};
use crate::core::autopilot::{Autopilot, Severity};
use crate::core::commands::Command;
use crate::core::mode::Mode;
use crate::core::params::Setting;
use mavlink::dialects::ardupilotmega::*;

use MavResult::{
    MAV_RESULT_ACCEPTED as ACCEPTED, MAV_RESULT_DENIED as DENIED,
    MAV_RESULT_TEMPORARILY_REJECTED as REJECTED, MAV_RESULT_UNSUPPORTED as UNSUPPORTED,
};

impl Px4 {
    /// Carries out a command and says how it went.
    pub(super) fn carry_out(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64) -> MavResult {
        if items::stray_in_command(c.code, &c.params).is_some() {
            return DENIED;
        }
        match c.code {
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => self.arm_or_disarm(a, c, now_ns),
            MavCmd::MAV_CMD_DO_SET_MODE => self.set_mode_command(a, c, now_ns),
            MavCmd::MAV_CMD_MISSION_START => self.start_mission(a, c, now_ns),
            MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH => self.enter(a, Some(Mode::ReturnToLaunch), now_ns),
            MavCmd::MAV_CMD_NAV_LAND => self.enter(a, Some(Mode::Land), now_ns),
            MavCmd::MAV_CMD_DO_FLIGHTTERMINATION => terminate(a, c),
            MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF if !self.is_vtol => UNSUPPORTED,
            MavCmd::MAV_CMD_NAV_TAKEOFF | MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF => self.take_off(a, c, now_ns),
            MavCmd::MAV_CMD_DO_REPOSITION => self.reposition(a, c, now_ns),
            MavCmd::MAV_CMD_DO_ORBIT => self.orbit(a, c, now_ns),
            MavCmd::MAV_CMD_DO_CHANGE_SPEED => {
                self.departure.change_speed(a, c.params[1].into(), now_ns);
                ACCEPTED
            }
            MavCmd::MAV_CMD_DO_LAND_START => self.land_by_mission(a, now_ns),
            _ => UNSUPPORTED,
        }
    }

    /// Enters a mode. On the ground with the engine safe it can always be chosen; else it has to be one that can be flown.
    pub(super) fn enter(&mut self, a: &mut Autopilot, mode: Option<Mode>, now_ns: u64) -> MavResult {
        let Some(mode) = mode else { return REJECTED };
        let possible = match mode {
            Mode::Auto => self.has_mission(a, now_ns),
            mode => !needs_sticks(mode),
        };
        if a.is_armed() && a.mode() == Mode::Termination {
            return REJECTED;
        }
        if a.is_armed() && !possible {
            a.say(Severity::Critical, "That mode is not possible now");
            return REJECTED;
        }
        self.failsafe.overruled();
        if a.mode() != mode {
            a.set_mode(mode);
            // a speed lasts until the next change, but the mission's own comes back with it
            a.change_speed(if mode == Mode::Auto { a.mission_speed_mps().unwrap_or_default() } else { 0.0 });
        }
        ACCEPTED
    }

    /// What stands against arming in the present mode.
    pub(super) fn arming_problem(&self, a: &Autopilot, now_ns: u64) -> Option<&'static str> {
        let no_mission = a.mode() == Mode::Auto && !self.has_mission(a, now_ns);
        match a.mode() {
            _ if now_ns < STARTS_UP_NS => Some("it starts up"),
            _ if a.prearm_problem().is_some() => a.prearm_problem(),
            Mode::ReturnToLaunch | Mode::Land => Some("not in this mode"),
            mode if needs_sticks(mode) => Some("nobody is at the sticks"),
            _ if no_mission => Some(self.problem.unwrap_or("no mission is ready")),
            _ if Failsafe::is_needed(a) && self.failsafe.is_lost(a, now_ns) => Some("no ground station"),
            _ => None,
        }
    }

    /// It can't be forced to arm, only to disarm.
    fn arm_or_disarm(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64) -> MavResult {
        let done = match c.params[0] {
            1.0 => self.arm(a, now_ns),
            0.0 => disarm(a, c.is_forced()),
            _ => return UNSUPPORTED,
        };
        if done { ACCEPTED } else { REJECTED }
    }

    fn arm(&self, a: &mut Autopilot, now_ns: u64) -> bool {
        if self.arming_problem(a, now_ns).is_some() && !a.is_armed() {
            // which check it was, the real one tells by its own events only
            a.say(Severity::Critical, "Arming denied: Resolve system health failures first");
            return false;
        }
        a.arm(false)
    }

    fn set_mode_command(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64) -> MavResult {
        let [base, main, sub, _] = c.params.map(|p| p as u8);
        let is_custom = base & MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED.bits() != 0;
        self.enter(a, mode_of(main, sub).filter(|_| is_custom), now_ns)
    }

    /// Mission mode, and armed. param1: the first item, if not negative.
    fn start_mission(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64) -> MavResult {
        let first = c.params[0];
        let is_known = (-1.0..a.mission.items().len() as f32).contains(&first);
        if !self.has_mission(a, now_ns) || !is_known {
            a.say(Severity::Critical, "No mission to start");
            return DENIED;
        }
        if first >= 0.0 {
            a.set_current(first as u16);
        }
        match self.enter(a, Some(Mode::Auto), now_ns) {
            ACCEPTED if !self.arm(a, now_ns) => REJECTED,
            result => result,
        }
    }

    /// z: the altitude AMSL it ends at.
    fn take_off(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64) -> MavResult {
        let height_m = f64::from(c.z) - a.home.altitude_amsl_m;
        if c.z.is_finite() && height_m > 0.0 {
            a.params.set_setting(Setting::TakeOffHeight, height_m.min(200.0) as f32);
        }
        self.enter(a, Some(Mode::TakeOff), now_ns)
    }

    /// param1: speed; param2 bit 0: change to holding. It holds on the usual circle: radius and direction are not taken from
    /// the command.
    fn reposition(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64) -> MavResult {
        if !c.may_change_mode() && a.mode() != Mode::Loiter {
            return DENIED;
        }
        let result = self.circle(a, c, 0.0, now_ns);
        if result == ACCEPTED && c.params[0] > 0.0 {
            a.change_speed(c.params[0].into());
        }
        result
    }

    /// The mission from where its landing begins.
    fn land_by_mission(&mut self, a: &mut Autopilot, now_ns: u64) -> MavResult {
        match a.landing_start() {
            Some(seq) if self.has_mission(a, now_ns) => {
                a.set_current(seq);
                self.enter(a, Some(Mode::Auto), now_ns)
            }
            _ => REJECTED,
        }
    }

    /// param1: radius, negative counter-clockwise.
    fn orbit(&mut self, a: &mut Autopilot, c: &Command, now_ns: u64) -> MavResult {
        let radius_m = if c.params[0].is_finite() { c.params[0].into() } else { 0.0 };
        self.circle(a, c, radius_m, now_ns)
    }

    /// Holds at a place; what of it is not a number is as it is.
    fn circle(&mut self, a: &mut Autopilot, c: &Command, radius_m: f64, now_ns: u64) -> MavResult {
        let is_anywhere = !c.position.is_valid() && !c.z.is_finite();
        if is_anywhere && a.mode() == Mode::Loiter && a.circles() {
            // it holds already (`Navigator::is_established_on_loiter`); on its way to a place it circles where it is
            return ACCEPTED;
        }
        let result = self.enter(a, Some(Mode::Loiter), now_ns);
        if result == ACCEPTED && a.is_armed() {
            let s = *a.aircraft.state();
            let position = if c.position.is_valid() { c.position } else { s.position };
            // whatever the frame says
            let altitude_m = if c.z.is_finite() { c.z.into() } else { s.altitude_amsl_m };
            a.circle(Mode::Loiter, position, altitude_m, radius_m);
        }
        result
    }
}

/// param1: more than a half ends the flight. It shows that, and is still armed; one whose parameters keep engine and surfaces from it
/// accepts it all the same.
fn terminate(a: &mut Autopilot, c: &Command) -> MavResult {
    if !a.is_armed() || c.params[0] <= 0.5 {
        return REJECTED;
    }
    if !a.flies_on {
        a.say(Severity::Critical, "Flight termination active");
        a.set_mode(Mode::Termination);
    }
    ACCEPTED
}

/// Makes an item the current one; on the ground that is taken and has no effect. False: no such item.
pub(super) fn jump(a: &mut Autopilot, seq: u16) -> bool {
    if a.aircraft.state().on_ground {
        return usize::from(seq) < a.mission.items().len();
    }
    a.set_current(seq)
}

fn disarm(a: &mut Autopilot, force: bool) -> bool {
    let done = a.disarm(force);
    if !done {
        a.say(Severity::Critical, "Disarming refused: it flies");
    }
    done
}
