//! PX4's parameters, with the defaults of its fixed wing: those it is asked for. Whole numbers are sent as their bits.

use crate::core::params::{Param, Params, Setting as S};
use aircraft::Profile;

/// What it does when no ground station is heard: 0 nothing, 1 hold, 2 return, 3 land.
pub const LINK_LOSS_ACTION: &str = "NAV_DLL_ACT";
/// Silence of all ground stations that counts as loss, seconds.
pub const LINK_LOSS_AFTER_S: &str = "COM_DL_LOSS_T";
/// It holds for so long before that action, seconds.
pub const ACTION_AFTER_S: &str = "COM_FAIL_ACT_T";
/// What it does when its battery is critical: 0 and 1 nothing, 2 land, 3 return.
pub const LOW_BATTERY_ACTION: &str = "COM_LOW_BAT_ACT";
/// What a mission has to have: 0 nothing, 1 a take-off, 2 a landing, 3 both, 4 both or neither.
pub const REQUIRED_ITEMS: &str = "MIS_TKO_LAND_REQ";
/// Steepest approach of a mission, degrees.
pub const LANDING_ANGLE_DEG: &str = "FW_LND_ANG";

pub fn fixed_wing(profile: &Profile) -> Params {
    params(profile, 1.0)
}

pub fn vtol(profile: &Profile) -> Params {
    params(profile, 22.0)
}

fn params(profile: &Profile, mav_type: f32) -> Params {
    let speeds = (profile.min_airspeed_mps as f32, profile.max_airspeed_mps as f32);
    let cruise = profile.cruise_airspeed_mps as f32;
    let turn_m = profile.turn_radius_m(profile.cruise_airspeed_mps).round() as f32;
    let fixed = Param::fixed;
    let free = |name, value, range| Param::fixed(name, value).settable(range);
    let whole = |name, value, range| Param::fixed(name, value).settable(range).whole();
    Params::new(vec![
        fixed("MAV_SYS_ID", 1.0).whole(),
        fixed("MAV_TYPE", mav_type).whole(),
        free("FW_AIRSPD_TRIM", cruise, speeds).is(S::Cruise),
        fixed("FW_AIRSPD_MIN", speeds.0).is(S::MinAirspeed),
        fixed("FW_AIRSPD_MAX", speeds.1).is(S::MaxAirspeed),
        fixed("FW_R_LIM", profile.max_bank_deg as f32),
        free(LANDING_ANGLE_DEG, 5.0, (1.0, 15.0)),
        free("NAV_ACC_RAD", 10.0, (0.05, 200.0)),
        free("NAV_FW_ALT_RAD", 10.0, (0.05, 200.0)).is(S::AltitudeAcceptance),
        // told, and without effect
        free("FW_T_CLMB_R_SP", 3.0, (0.1, 50.0)),
        free("FW_T_SINK_R_SP", 2.0, (0.1, 50.0)),
        free("NAV_LOITER_RAD", turn_m, (-1000.0, 1000.0)).is(S::LoiterRadius),
        whole(LINK_LOSS_ACTION, 0.0, (0.0, 6.0)),
        whole("NAV_RCL_ACT", 2.0, (1.0, 6.0)),
        whole(LINK_LOSS_AFTER_S, 10.0, (5.0, 300.0)),
        free(ACTION_AFTER_S, 5.0, (0.0, 25.0)),
        whole("COM_RC_IN_MODE", 1.0, (0.0, 4.0)),
        whole(LOW_BATTERY_ACTION, 0.0, (0.0, 3.0)),
        free("COM_DISARM_LAND", 2.0, (-1.0, 20.0)).is(S::DisarmDelay),
        free("MIS_TAKEOFF_ALT", 25.0, (0.0, 200.0)).is(S::TakeOffHeight),
        whole(REQUIRED_ITEMS, 2.0, (0.0, 5.0)),
        free("RTL_RETURN_ALT", 100.0, (0.0, 5000.0)).is(S::ReturnHeight),
        free("RTL_LOITER_RAD", turn_m, (25.0, 1000.0)).is(S::ReturnRadius),
        whole("RTL_TYPE", 1.0, (0.0, 5.0)),
        fixed("RTL_LAND_DELAY", -1.0),
        free("BAT_LOW_THR", 0.15, (0.12, 0.5)).is_share_of(S::LowBattery),
        free("BAT_CRIT_THR", 0.07, (0.05, 0.5)).is_share_of(S::CriticalBattery),
    ])
}
