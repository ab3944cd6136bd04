//! ArduPlane's parameters: those it is asked for.

use crate::core::params::{Param, Params, Setting as S};
use MavParamType::{
    MAV_PARAM_TYPE_INT8 as INT8, MAV_PARAM_TYPE_INT16 as INT16, MAV_PARAM_TYPE_INT32 as INT32,
};
use aircraft::{Habits, Profile, wp_radius_m};
use mavlink::dialects::ardupilotmega::MavParamType;

pub fn params(profile: &Profile) -> Params {
    let speeds = (profile.min_airspeed_mps as f32, profile.max_airspeed_mps as f32);
    let cruise = profile.cruise_airspeed_mps as f32;
    let turn_m = profile.turn_radius_m(profile.cruise_airspeed_mps).round() as f32;
    let habits = Habits::arduplane(profile);
    let any_radius = (-32767.0, 32767.0);
    let fixed = Param::fixed;
    let free = |name, value, range| Param::fixed(name, value).settable(range);
    Params::new(vec![
        fixed("SYSID_THISMAV", 1.0),
        free("AIRSPEED_CRUISE", cruise, speeds).is(S::Cruise),
        fixed("AIRSPEED_MIN", speeds.0).is(S::MinAirspeed).of(INT16),
        fixed("AIRSPEED_MAX", speeds.1).is(S::MaxAirspeed).of(INT16),
        fixed("ROLL_LIMIT_DEG", profile.max_bank_deg as f32),
        fixed("WP_RADIUS", wp_radius_m(profile) as f32).of(INT16),
        free("WP_LOITER_RAD", turn_m, any_radius).is(S::LoiterRadius).of(INT16),
        free("RTL_ALTITUDE", 100.0, (-1.0, 5000.0)).is(S::ReturnHeight),
        free("RTL_RADIUS", 0.0, any_radius).is(S::ReturnRadius).of(INT16),
        free("RTL_AUTOLAND", 0.0, (0.0, 4.0)).is(S::ReturnLands).of(INT8),
        free("TKOFF_ALT", 50.0, (0.0, 200.0)).is(S::TakeOffHeight).of(INT16),
        free("LAND_DISARMDELAY", 3.0, (0.0, 127.0)).is(S::DisarmDelay).of(INT8),
        free("ARMING_CHECK", 1.0, (0.0, 1.0)).is(S::ArmingChecks).of(INT32),
        free("BATT_LOW_PCT", 20.0, (0.0, 100.0)).is(S::LowBattery),
        free("BATT_CRT_PCT", 10.0, (0.0, 100.0)).is(S::CriticalBattery),
        fixed("MIS_RESTART", 0.0).of(INT8),
        fixed("MIS_OPTIONS", 0.0).of(INT16),
        // told, and without effect
        free("FS_GCS_ENABL", 0.0, (0.0, 3.0)).of(INT8),
        free("FS_SHORT_ACTN", 0.0, (0.0, 4.0)).of(INT8),
        free("FS_LONG_ACTN", 0.0, (0.0, 5.0)).of(INT8),
        free("ARSPD_USE", 1.0, (0.0, 2.0)).of(INT8),
        fixed("NAVL1_PERIOD", habits.period_s as f32),
        fixed("NAVL1_DAMPING", habits.damping as f32),
    ])
}
