//! ArduPlane's answers to commands.

use super::{mission_current, mode_of};
use crate::core::autopilot::{Autopilot, Severity};
use crate::core::commands::Command;
use crate::core::item::datum_of;
use crate::core::mode::Mode;
use crate::core::params::Setting;
use crate::core::personality::Post;
use mavlink::dialects::ardupilotmega::*;

/// The airspeed that stands for its own cruise airspeed, m/s.
const OWN_SPEED_MPS: f64 = -2.0;

pub fn done(ok: bool) -> MavResult {
    if ok { MavResult::MAV_RESULT_ACCEPTED } else { MavResult::MAV_RESULT_FAILED }
}

/// Carries out a command and says how it went.
pub fn command(a: &mut Autopilot, c: &Command, out: &mut Vec<Post>) -> MavResult {
    match c.code {
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => arm_or_disarm(a, c),
        MavCmd::MAV_CMD_DO_SET_MODE => done(set_mode(a, mode_of(c.params[1]))),
        MavCmd::MAV_CMD_MISSION_START => done(set_mode(a, Some(Mode::Auto))),
        MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH => done(set_mode(a, Some(Mode::ReturnToLaunch))),
        MavCmd::MAV_CMD_NAV_LOITER_UNLIM => done(set_mode(a, Some(Mode::Loiter))),
        MavCmd::MAV_CMD_NAV_TAKEOFF => take_off(a, c),
        MavCmd::MAV_CMD_DO_REPOSITION => reposition(a, c),
        MavCmd::MAV_CMD_DO_CHANGE_SPEED => done(change_speed(a, c)),
        MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT => set_current_command(a, c, out),
        _ => MavResult::MAV_RESULT_UNSUPPORTED,
    }
}

/// Enters a mode, which forgets the airspeed that was told before; false if there is none or it can't be entered now.
pub fn set_mode(a: &mut Autopilot, mode: Option<Mode>) -> bool {
    let before = a.mode();
    let is_entered = mode.is_some_and(|mode| a.set_mode(mode));
    if a.mode() != before {
        a.change_speed(OWN_SPEED_MPS);
    }
    is_entered
}

/// Makes an item the current one, and says so at once.
pub fn set_current(a: &mut Autopilot, seq: u16, out: &mut Vec<Post>) -> bool {
    let known = a.set_current(seq);
    if known {
        out.push((None, mission_current(a)));
    }
    known
}

fn arm_or_disarm(a: &mut Autopilot, c: &Command) -> MavResult {
    match c.params[0] {
        1.0 => done(arm(a, c.is_forced())),
        0.0 => done(a.disarm(c.is_forced())),
        _ => MavResult::MAV_RESULT_UNSUPPORTED,
    }
}

/// In other modes no speed is taken.
fn change_speed(a: &mut Autopilot, c: &Command) -> bool {
    matches!(a.mode(), Mode::Auto | Mode::Guided) && a.change_speed(c.params[1].into())
}

/// Returning it is not armed.
fn arm(a: &mut Autopilot, force: bool) -> bool {
    let is_armable = force || a.mode() != Mode::ReturnToLaunch;
    if !is_armable {
        a.say(Severity::Critical, "Arm: RTL mode not armable");
    }
    is_armable && a.arm(force)
}

fn take_off(a: &mut Autopilot, c: &Command) -> MavResult {
    if !a.is_armed() {
        return MavResult::MAV_RESULT_FAILED;
    }
    if c.z > 0.0 {
        a.params.set_setting(Setting::TakeOffHeight, c.z.min(200.0));
    }
    done(a.set_mode(Mode::TakeOff))
}

/// param2 bit 0: change to GUIDED; param3: radius; param4: any number but 0: counter-clockwise.
fn reposition(a: &mut Autopilot, c: &Command) -> MavResult {
    let Some(frame) = c.frame else {
        return MavResult::MAV_RESULT_UNSUPPORTED;
    };
    let Ok(datum) = datum_of(frame) else {
        return MavResult::MAV_RESULT_DENIED;
    };
    if !c.position.is_valid() || !c.z.is_finite() {
        return MavResult::MAV_RESULT_DENIED;
    }
    if a.mode() != Mode::Guided && !c.may_change_mode() {
        return MavResult::MAV_RESULT_FAILED;
    }
    let asked = f64::from(c.params[2]);
    let radius_m =
        if asked.is_finite() && asked > 0.0 { asked } else { a.params.setting(Setting::LoiterRadius) };
    let anticlockwise = c.params[3].is_finite() && c.params[3] != 0.0;
    if c.params[0] > 0.0 {
        a.change_speed(c.params[0].into());
    }
    let signed_m = if anticlockwise { -radius_m } else { radius_m };
    a.circle(Mode::Guided, c.position, a.amsl_m(c.z.into(), datum), signed_m);
    MavResult::MAV_RESULT_ACCEPTED
}

fn set_current_command(a: &mut Autopilot, c: &Command, out: &mut Vec<Post>) -> MavResult {
    let seq = c.params[0];
    if !(0.0..a.mission.items().len() as f32).contains(&seq) {
        return MavResult::MAV_RESULT_DENIED;
    }
    if c.params[1] == 1.0 {
        a.run.reset();
    }
    done(set_current(a, seq as u16, out))
}
