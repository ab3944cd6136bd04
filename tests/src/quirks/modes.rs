//! What its heartbeat shows, and how modes and the engine are commanded on the ground.

use super::station::{Station, heartbeat, same};
use super::{ARDUPLANE, BOTH, PX4, Quirk};
use MavCmd::{
    MAV_CMD_COMPONENT_ARM_DISARM as ARM_DISARM, MAV_CMD_DO_SET_MODE as DO_SET_MODE,
    MAV_CMD_MISSION_START as MISSION_START, MAV_CMD_NAV_TAKEOFF as NAV_TAKEOFF,
};
use MavResult::{
    MAV_RESULT_ACCEPTED as ACCEPTED, MAV_RESULT_DENIED as DENIED, MAV_RESULT_FAILED as FAILED,
    MAV_RESULT_TEMPORARILY_REJECTED as REJECTED,
};
use mavlink::dialects::ardupilotmega::*;

/// ArduPlane's modes.
const MANUAL: f32 = 0.0;
const AUTO: f32 = 10.0;
const RTL: f32 = 11.0;
/// PX4's main mode of those that fly by themselves, and its sub modes.
const PX4_AUTO: f32 = 4.0;
const HOLD: f32 = 3.0;
const MISSION: f32 = 4.0;

/// A command without parameters but the first.
fn first(param: f32) -> [f32; 7] {
    [param, 0., 0., 0., 0., 0., 0.]
}

/// `DO_SET_MODE` by an autopilot's own numbers.
fn custom(main: f32, sub: f32) -> [f32; 7] {
    [1., main, sub, 0., 0., 0., 0.]
}

pub(super) const QUIRKS: &[Quirk] = &[
    Quirk {
        name: "heartbeat_is_of_a_fixed_wing_with_modes_of_its_own",
        of: BOTH,
        does: "type FIXED_WING, the flag CUSTOM_MODE_ENABLED, not armed",
        check: |s| {
            let beat = s.hear("a heartbeat", heartbeat)?;
            same("type", beat.mavtype, MavType::MAV_TYPE_FIXED_WING)?;
            let has = |flag| beat.base_mode.contains(flag);
            same("own modes", has(MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED), true)?;
            same("armed", has(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED), false)
        },
        flies: false,
    },
    Quirk {
        name: "modes_are_numbers",
        of: ARDUPLANE,
        does: "`DO_SET_MODE` 0 and 11 are MANUAL and RTL, and show as 0 and 11",
        check: |s| {
            for mode in [RTL, MANUAL] {
                s.expect(DO_SET_MODE, custom(mode, 0.), ACCEPTED)?;
                s.shows(mode as u32)?;
            }
            Ok(())
        },
        flies: false,
    },
    Quirk {
        name: "modes_are_main_and_sub_modes",
        of: PX4,
        does: "`DO_SET_MODE` 4, 4 and 4, 3 are mission and hold, and show as 0x04040000 and 0x03040000",
        check: |s| {
            for (sub, shown) in [(MISSION, 0x0404_0000), (HOLD, 0x0304_0000)] {
                s.expect(DO_SET_MODE, custom(PX4_AUTO, sub), ACCEPTED)?;
                s.shows(shown)?;
            }
            Ok(())
        },
        flies: false,
    },
    Quirk {
        name: "base_mode_tells_who_flies",
        of: ARDUPLANE,
        does: "RTL has the flag GUIDED_ENABLED, MANUAL has not; MANUAL_INPUT_ENABLED and STABILIZE_ENABLED have both",
        check: |s| {
            let manual = flags_in(s, custom(MANUAL, 0.), 0)?;
            same("MANUAL", who(manual), [true, false, true, false])?;
            let rtl = flags_in(s, custom(RTL, 0.), 11)?;
            flags_in(s, custom(MANUAL, 0.), 0)?;
            same("RTL", who(rtl), [true, true, true, false])
        },
        flies: false,
    },
    Quirk {
        name: "base_mode_of_holding_is_auto_guided_and_stabilised",
        of: PX4,
        does: "hold has the flags GUIDED_ENABLED, STABILIZE_ENABLED and AUTO_ENABLED",
        check: |s| {
            let hold = flags_in(s, custom(PX4_AUTO, HOLD), 0x0304_0000)?;
            same("hold", who(hold), [false, true, true, true])
        },
        flies: false,
    },
    Quirk {
        name: "unknown_mode_has_failed",
        of: ARDUPLANE,
        does: "`DO_SET_MODE` with a number of no mode: FAILED",
        check: |s| s.expect(DO_SET_MODE, custom(77., 0.), FAILED),
        flies: false,
    },
    Quirk {
        name: "unknown_mode_is_rejected",
        of: PX4,
        does: "`DO_SET_MODE` with a number of no mode: TEMPORARILY_REJECTED",
        check: |s| s.expect(DO_SET_MODE, custom(77., 0.), REJECTED),
        flies: false,
    },
    Quirk {
        name: "mission_mode_without_a_list_is_left_at_once",
        of: ARDUPLANE,
        does: "AUTO without a list is accepted, and goes on to RTL",
        check: |s| {
            s.expect(DO_SET_MODE, custom(AUTO, 0.), ACCEPTED)?;
            let shown = s.shows(RTL as u32);
            s.expect(DO_SET_MODE, custom(MANUAL, 0.), ACCEPTED)?;
            shown
        },
        flies: false,
    },
    Quirk {
        name: "mission_mode_without_a_list_refuses_to_arm",
        of: PX4,
        does: "mission mode can be chosen without a list, but arming is TEMPORARILY_REJECTED, in words",
        check: |s| {
            s.expect(DO_SET_MODE, custom(PX4_AUTO, MISSION), ACCEPTED)?;
            s.shows(0x0404_0000)?;
            s.expect(ARM_DISARM, first(1.), REJECTED)?;
            s.says("Arming denied")?;
            s.expect(DO_SET_MODE, custom(PX4_AUTO, HOLD), ACCEPTED)
        },
        flies: false,
    },
    Quirk {
        name: "arming_in_return_is_refused",
        of: ARDUPLANE,
        does: "arming in RTL: FAILED, and it says that the mode is not armable",
        check: |s| {
            s.expect(DO_SET_MODE, custom(RTL, 0.), ACCEPTED)?;
            let refused =
                s.expect(ARM_DISARM, first(1.), FAILED).and_then(|()| s.says("not armable").map(drop));
            s.expect(DO_SET_MODE, custom(MANUAL, 0.), ACCEPTED)?;
            refused
        },
        flies: false,
    },
    Quirk {
        name: "arming_by_another_number_is_unsupported",
        of: ARDUPLANE,
        does: "`COMPONENT_ARM_DISARM` 2: UNSUPPORTED",
        check: |s| s.expect(ARM_DISARM, first(2.), MavResult::MAV_RESULT_UNSUPPORTED),
        flies: false,
    },
    Quirk {
        name: "take_off_of_one_that_is_not_armed_has_failed",
        of: ARDUPLANE,
        does: "`NAV_TAKEOFF` before it is armed: FAILED",
        check: |s| s.expect(NAV_TAKEOFF, [0., 0., 0., 0., 0., 0., 50.], FAILED),
        flies: false,
    },
    Quirk {
        name: "mission_without_a_list_can_not_be_started",
        of: PX4,
        does: "`MISSION_START` without a list: DENIED",
        check: |s| s.expect(MISSION_START, first(0.), DENIED),
        flies: false,
    },
];

fn flags_in(s: &mut Station, mode: [f32; 7], shown: u32) -> anyhow::Result<MavModeFlag> {
    s.expect(DO_SET_MODE, mode, ACCEPTED)?;
    s.hear("that mode", |message| {
        heartbeat(message).filter(|beat| beat.custom_mode == shown).map(|beat| beat.base_mode)
    })
}

/// By hand, guided, stabilised, auto.
fn who(flags: MavModeFlag) -> [bool; 4] {
    [
        MavModeFlag::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED,
        MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED,
        MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED,
        MavModeFlag::MAV_MODE_FLAG_AUTO_ENABLED,
    ]
    .map(|flag| flags.contains(flag))
}
