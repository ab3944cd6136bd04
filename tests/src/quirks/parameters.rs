//! Parameters.

use super::station::{Station, same};
use super::{ARDUPLANE, PX4, Quirk};
use MavParamType::{
    MAV_PARAM_TYPE_INT8 as INT8, MAV_PARAM_TYPE_INT16 as INT16, MAV_PARAM_TYPE_INT32 as INT32,
    MAV_PARAM_TYPE_REAL32 as REAL32,
};
use anyhow::ensure;
use mavlink::dialects::ardupilotmega::*;

/// What comes of a question for a parameter.
#[derive(Debug, PartialEq)]
pub(super) enum Told {
    Value(f32, MavParamType),
    Error(MavParamError),
}

pub(super) const QUIRKS: &[Quirk] = &[
    Quirk {
        name: "whole_parameters_are_sent_as_floats",
        of: ARDUPLANE,
        does: "RTL_AUTOLAND set to 2 is told as the float 2, of type INT8",
        check: |s| {
            let before = read(s, "RTL_AUTOLAND")?;
            let told = set(s, "RTL_AUTOLAND", 2.0, INT8)?;
            if let Told::Value(value, kind) = before {
                set(s, "RTL_AUTOLAND", value, kind)?;
            }
            same("told", told, Told::Value(2.0, INT8))
        },
        flies: false,
    },
    Quirk {
        name: "whole_parameters_are_sent_as_their_bits",
        of: PX4,
        does: "MIS_TKO_LAND_REQ set to 2 is told as the bits of the whole number 2, of type INT32",
        check: |s| {
            let before = read(s, "MIS_TKO_LAND_REQ")?;
            let told = set(s, "MIS_TKO_LAND_REQ", f32::from_bits(2), INT32)?;
            if let Told::Value(value, kind) = before {
                set(s, "MIS_TKO_LAND_REQ", value, kind)?;
            }
            same("told", told, Told::Value(f32::from_bits(2), INT32))
        },
        flies: false,
    },
    Quirk {
        name: "parameters_are_of_many_types",
        of: ARDUPLANE,
        does: "AIRSPEED_CRUISE, RTL_ALTITUDE and NAVL1_PERIOD are REAL32, AIRSPEED_MIN, TKOFF_ALT, WP_LOITER_RAD and WP_RADIUS INT16, \
               FS_LONG_ACTN and MIS_RESTART INT8, ARMING_CHECK INT32",
        check: |s| {
            types(s, REAL32, &["AIRSPEED_CRUISE", "RTL_ALTITUDE", "NAVL1_PERIOD"])?;
            types(s, INT16, &["AIRSPEED_MIN", "TKOFF_ALT", "WP_LOITER_RAD", "WP_RADIUS"])?;
            types(s, INT8, &["FS_LONG_ACTN", "MIS_RESTART"])?;
            types(s, INT32, &["ARMING_CHECK"])
        },
        flies: false,
    },
    Quirk {
        name: "parameters_are_of_two_types",
        of: PX4,
        does: "FW_AIRSPD_TRIM, NAV_LOITER_RAD and RTL_RETURN_ALT are REAL32, MAV_TYPE, NAV_DLL_ACT, COM_RC_IN_MODE and RTL_TYPE INT32",
        check: |s| {
            types(s, REAL32, &["FW_AIRSPD_TRIM", "NAV_LOITER_RAD", "RTL_RETURN_ALT"])?;
            types(s, INT32, &["MAV_TYPE", "NAV_DLL_ACT", "COM_RC_IN_MODE", "RTL_TYPE"])
        },
        flies: false,
    },
    Quirk {
        name: "unknown_parameter_does_not_exist",
        of: PX4,
        does: "asked for a parameter that it has not: PARAM_ERROR, DOES_NOT_EXIST",
        check: |s| {
            let missing = Told::Error(MavParamError::MAV_PARAM_ERROR_DOES_NOT_EXIST);
            same("told", read(s, "NO_SUCH")?, missing)
        },
        flies: false,
    },
    Quirk {
        name: "unknown_parameter_gets_no_answer",
        of: ARDUPLANE,
        does: "asked for a parameter that it has not: nothing",
        check: |s| {
            s.forget();
            ask(s, "NO_SUCH");
            ask(s, "NAVL1_PERIOD");
            same("told first", matches!(told(s)?, Told::Value(_, REAL32)), true)
        },
        flies: false,
    },
];

fn ask(s: &mut Station, name: &str) {
    s.say(&MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
        param_index: -1,
        param_id: name.into(),
        target_system: s.target.system,
        target_component: s.target.component,
    }));
}

fn read(s: &mut Station, name: &str) -> anyhow::Result<Told> {
    s.forget();
    ask(s, name);
    told(s)
}

/// All of these are of that type.
fn types(s: &mut Station, kind: MavParamType, names: &[&str]) -> anyhow::Result<()> {
    for name in names {
        let told = read(s, name)?;
        ensure!(matches!(told, Told::Value(_, of) if of == kind), "{name}: {told:?}, not {kind:?}");
    }
    Ok(())
}

/// Sets one, and what is told of it then.
pub(super) fn set(
    s: &mut Station,
    name: &str,
    param_value: f32,
    param_type: MavParamType,
) -> anyhow::Result<Told> {
    s.forget();
    s.say(&MavMessage::PARAM_SET(PARAM_SET_DATA {
        param_value,
        target_system: s.target.system,
        target_component: s.target.component,
        param_id: name.into(),
        param_type,
    }));
    told(s)
}

/// The first that is told.
fn told(s: &mut Station) -> anyhow::Result<Told> {
    s.hear("an answer about a parameter", |message| match message {
        MavMessage::PARAM_VALUE(told) if told.param_id.to_str() != Ok("_HASH_CHECK") => {
            Some(Told::Value(told.param_value, told.param_type))
        }
        MavMessage::PARAM_ERROR(told) => Some(Told::Error(told.error)),
        _ => None,
    })
}
