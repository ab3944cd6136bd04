//! What the autopilot sends: one function a message.

use super::autopilot::Autopilot;
use super::item::degrees_e7;
use super::params::Setting;
use crate::frame::{COMPONENT_ID, SYSTEM_ID};
use aircraft::GRAVITY_MPS2;
use mavlink::dialects::ardupilotmega::*;

/// 2026-01-01, where simulated clocks start.
const EPOCH_US: u64 = 1_767_225_600_000_000;

/// Messages that say how fast the engine turns: EFI_STATUS, RPM, ESC_TELEMETRY_1_TO_4.
pub const RPM_MESSAGES: [u32; 3] = [225, 226, 11030];

/// The message with that id as it is now; `None`: not one of ours.
pub fn message(a: &Autopilot, now_ns: u64, id: u32) -> Option<MavMessage> {
    Some(match id {
        1 => sys_status(a),
        2 => system_time(now_ns),
        24 => gps_raw(a, now_ns),
        29 => pressure(a, now_ns),
        30 => attitude(a, now_ns),
        33 => global_position(a, now_ns),
        49 => global_origin(a, now_ns),
        62 => nav_controller(a),
        74 => vfr_hud(a),
        147 => battery_status(a),
        168 => wind(a),
        87 => return position_target(a, now_ns),
        141 => altitude(a, now_ns),
        291 => esc_status(a, now_ns),
        231 => wind_cov(a, now_ns),
        225 => efi_status(a),
        226 => rpm(a),
        242 => home_position(a, now_ns),
        245 => extended_sys_state(a),
        11030 => esc_telemetry(a),
        _ => return None,
    })
}

fn boot_ms(now_ns: u64) -> u32 {
    (now_ns / 1_000_000) as u32
}

fn boot_us(now_ns: u64) -> u64 {
    now_ns / 1000
}

/// A heartbeat of a fixed wing, for an autopilot to fill in.
pub fn fixed_wing() -> HEARTBEAT_DATA {
    HEARTBEAT_DATA { mavtype: MavType::MAV_TYPE_FIXED_WING, mavlink_version: 3, ..HEARTBEAT_DATA::DEFAULT }
}

/// The flags that mean the same to all.
pub fn armed_flag(a: &Autopilot) -> MavModeFlag {
    let custom = MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
    if a.is_armed() { custom | MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED } else { custom }
}

fn sys_status(a: &Autopilot) -> MavMessage {
    use MavSysStatusSensor as S;
    let present = S::MAV_SYS_STATUS_SENSOR_3D_GYRO
        | S::MAV_SYS_STATUS_SENSOR_3D_ACCEL
        | S::MAV_SYS_STATUS_SENSOR_3D_MAG
        | S::MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
        | S::MAV_SYS_STATUS_SENSOR_DIFFERENTIAL_PRESSURE
        | S::MAV_SYS_STATUS_SENSOR_GPS
        | S::MAV_SYS_STATUS_SENSOR_ANGULAR_RATE_CONTROL
        | S::MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION
        | S::MAV_SYS_STATUS_SENSOR_YAW_POSITION
        | S::MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL
        | S::MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
        | S::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
        | S::MAV_SYS_STATUS_AHRS
        | S::MAV_SYS_STATUS_SENSOR_BATTERY
        | S::MAV_SYS_STATUS_PREARM_CHECK;
    let mut health = present;
    health.set(S::MAV_SYS_STATUS_SENSOR_GPS, a.gps_ok);
    health.set(S::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS, a.aircraft.engine().healthy);
    health.set(S::MAV_SYS_STATUS_PREARM_CHECK, a.is_armed() || a.prearm_problem().is_none());
    let battery = a.aircraft.battery();
    MavMessage::SYS_STATUS(SYS_STATUS_DATA {
        onboard_control_sensors_present: present,
        onboard_control_sensors_enabled: present,
        onboard_control_sensors_health: health,
        load: 150,
        voltage_battery: (battery.voltage_v * 1000.0) as u16,
        current_battery: (battery.current_a * 100.0) as i16,
        battery_remaining: a.battery_pct().round() as i8,
        ..SYS_STATUS_DATA::DEFAULT
    })
}

fn system_time(now_ns: u64) -> MavMessage {
    MavMessage::SYSTEM_TIME(SYSTEM_TIME_DATA {
        time_unix_usec: EPOCH_US + boot_us(now_ns),
        time_boot_ms: boot_ms(now_ns),
    })
}

fn gps_raw(a: &Autopilot, now_ns: u64) -> MavMessage {
    let s = a.aircraft.state();
    let alt_mm = (s.altitude_amsl_m * 1000.0) as i32;
    let (fix_type, satellites_visible) =
        if a.gps_ok { (GpsFixType::GPS_FIX_TYPE_3D_FIX, 14) } else { (GpsFixType::GPS_FIX_TYPE_NO_FIX, 0) };
    MavMessage::GPS_RAW_INT(GPS_RAW_INT_DATA {
        time_usec: boot_us(now_ns),
        lat: degrees_e7(s.position.lat_deg),
        lon: degrees_e7(s.position.lon_deg),
        alt: alt_mm,
        eph: if a.gps_ok { 80 } else { u16::MAX },
        epv: if a.gps_ok { 120 } else { u16::MAX },
        vel: (s.ground_speed_mps() * 100.0) as u16,
        cog: (s.track_deg() * 100.0) as u16,
        fix_type,
        satellites_visible,
        alt_ellipsoid: alt_mm,
        h_acc: 800,
        v_acc: 1200,
        ..GPS_RAW_INT_DATA::DEFAULT
    })
}

/// International Standard Atmosphere below 11 km, on a day that may be warmer.
fn pressure(a: &Autopilot, now_ns: u64) -> MavMessage {
    let s = a.aircraft.state();
    let kelvin_share = aircraft::air::temperature_share(s.altitude_amsl_m);
    let shown_mps = a.shown_mps(s.airspeed_mps);
    MavMessage::SCALED_PRESSURE(SCALED_PRESSURE_DATA {
        time_boot_ms: boot_ms(now_ns),
        press_abs: (1013.25 * kelvin_share.powf(5.255_88)) as f32,
        press_diff: (0.5 * 1.225 * shown_mps * shown_mps / 100.0) as f32,
        temperature: ((15.0 - 0.0065 * s.altitude_amsl_m + a.isa_deviation_c()) * 100.0) as i16,
        ..SCALED_PRESSURE_DATA::DEFAULT
    })
}

fn attitude(a: &Autopilot, now_ns: u64) -> MavMessage {
    let s = a.aircraft.state();
    let pitch = (s.climb_mps / s.airspeed_mps.max(5.0)).clamp(-1.0, 1.0).asin();
    let turn_rate = if s.on_ground { 0.0 } else { GRAVITY_MPS2 * s.bank_rad.tan() / s.airspeed_mps.max(5.0) };
    MavMessage::ATTITUDE(ATTITUDE_DATA {
        time_boot_ms: boot_ms(now_ns),
        roll: s.bank_rad as f32,
        pitch: pitch as f32,
        yaw: s.heading_rad as f32,
        yawspeed: turn_rate as f32,
        ..ATTITUDE_DATA::DEFAULT
    })
}

fn global_position(a: &Autopilot, now_ns: u64) -> MavMessage {
    let s = a.aircraft.state();
    let cm_s = |mps: f64| (mps * 100.0) as i16;
    MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
        time_boot_ms: boot_ms(now_ns),
        lat: degrees_e7(s.position.lat_deg),
        lon: degrees_e7(s.position.lon_deg),
        alt: (s.altitude_amsl_m * 1000.0) as i32,
        relative_alt: ((s.altitude_amsl_m - a.home.altitude_amsl_m) * 1000.0) as i32,
        vx: cm_s(s.ground_velocity_mps.n),
        vy: cm_s(s.ground_velocity_mps.e),
        vz: cm_s(-s.climb_mps),
        hdg: (s.heading_deg() * 100.0) as u16 % 36000,
    })
}

fn nav_controller(a: &Autopilot) -> MavMessage {
    let s = a.aircraft.state();
    let Some(guided) = a.guided else {
        return MavMessage::NAV_CONTROLLER_OUTPUT(NAV_CONTROLLER_OUTPUT_DATA::DEFAULT);
    };
    let degrees = |deg: f64| geometry::geodesy::normalise_180(deg) as i16;
    MavMessage::NAV_CONTROLLER_OUTPUT(NAV_CONTROLLER_OUTPUT_DATA {
        nav_roll: guided.demand.bank_rad.to_degrees() as f32,
        nav_pitch: 0.0,
        alt_error: guided.altitude_error_m as f32,
        aspd_error: a.shown_mps(guided.demand.airspeed_mps - s.airspeed_mps) as f32,
        xtrack_error: guided.cross_track_m as f32,
        nav_bearing: degrees(s.track_deg()),
        target_bearing: degrees(guided.course_deg),
        wp_dist: guided.distance_m as u16,
    })
}

fn vfr_hud(a: &Autopilot) -> MavMessage {
    let s = a.aircraft.state();
    MavMessage::VFR_HUD(VFR_HUD_DATA {
        airspeed: a.shown_mps(s.airspeed_mps) as f32,
        groundspeed: s.ground_speed_mps() as f32,
        alt: s.altitude_amsl_m as f32,
        climb: s.climb_mps as f32,
        heading: s.heading_deg() as i16,
        throttle: (100.0 * a.throttle()) as u16,
    })
}

fn battery_status(a: &Autopilot) -> MavMessage {
    let battery = a.aircraft.battery();
    let mut voltages = [u16::MAX; 10];
    voltages[0] = (battery.voltage_v * 1000.0) as u16;
    let charge_state = match a.battery_pct() {
        pct if pct <= a.params.setting(Setting::CriticalBattery) => {
            MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_CRITICAL
        }
        pct if pct <= a.params.setting(Setting::LowBattery) => {
            MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_LOW
        }
        _ => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_OK,
    };
    MavMessage::BATTERY_STATUS(BATTERY_STATUS_DATA {
        current_consumed: (battery.used_ah() * 1000.0) as i32,
        energy_consumed: ((battery.capacity_j - battery.energy_left_j) / 100.0) as i32,
        temperature: i16::MAX,
        voltages,
        current_battery: (battery.current_a * 100.0) as i16,
        battery_function: MavBatteryFunction::MAV_BATTERY_FUNCTION_ALL,
        mavtype: MavBatteryType::MAV_BATTERY_TYPE_LIPO,
        battery_remaining: a.battery_pct().round() as i8,
        charge_state,
        ..BATTERY_STATUS_DATA::DEFAULT
    })
}

/// What it can do and which version it is.
pub fn autopilot_version(capabilities: MavProtocolCapability, flight_sw_version: u32) -> MavMessage {
    MavMessage::AUTOPILOT_VERSION(AUTOPILOT_VERSION_DATA {
        capabilities,
        uid: 0x004C_4547_574F_524B,
        flight_sw_version,
        ..AUTOPILOT_VERSION_DATA::DEFAULT
    })
}

fn wind(a: &Autopilot) -> MavMessage {
    MavMessage::WIND(WIND_DATA {
        direction: a.wind.direction_from_deg() as f32,
        speed: a.wind.speed_mps() as f32,
        speed_z: 0.0,
    })
}

/// Where it steers to, while it flies.
fn position_target(a: &Autopilot, now_ns: u64) -> Option<MavMessage> {
    let target = a.steered_to()?;
    Some(MavMessage::POSITION_TARGET_GLOBAL_INT(POSITION_TARGET_GLOBAL_INT_DATA {
        time_boot_ms: boot_ms(now_ns),
        lat_int: degrees_e7(target.position.lat_deg),
        lon_int: degrees_e7(target.position.lon_deg),
        alt: target.altitude_amsl_m as f32,
        type_mask: PositionTargetTypemask::empty(),
        coordinate_frame: MavFrame::MAV_FRAME_GLOBAL_INT,
        ..POSITION_TARGET_GLOBAL_INT_DATA::DEFAULT
    }))
}

fn altitude(a: &Autopilot, now_ns: u64) -> MavMessage {
    let amsl_m = a.aircraft.state().altitude_amsl_m;
    let over_home_m = (amsl_m - a.home.altitude_amsl_m) as f32;
    MavMessage::ALTITUDE(ALTITUDE_DATA {
        time_usec: boot_us(now_ns),
        altitude_monotonic: amsl_m as f32,
        altitude_amsl: amsl_m as f32,
        altitude_local: over_home_m,
        altitude_relative: over_home_m,
        altitude_terrain: f32::NAN,
        bottom_clearance: f32::NAN,
    })
}

fn wind_cov(a: &Autopilot, now_ns: u64) -> MavMessage {
    // where it goes to
    let to = (a.wind.direction_from_deg() + 180.0).to_radians();
    MavMessage::WIND_COV(WIND_COV_DATA {
        time_usec: boot_us(now_ns),
        wind_x: (a.wind.speed_mps() * to.cos()) as f32,
        wind_y: (a.wind.speed_mps() * to.sin()) as f32,
        wind_alt: a.aircraft.state().altitude_amsl_m as f32,
        ..WIND_COV_DATA::DEFAULT
    })
}

fn efi_status(a: &Autopilot) -> MavMessage {
    let engine = a.aircraft.engine();
    MavMessage::EFI_STATUS(EFI_STATUS_DATA {
        rpm: engine.rpm as f32,
        engine_load: (100.0 * engine.power_w / a.aircraft.profile().cruise_power_w) as f32,
        cylinder_head_temperature: engine.temperature_c as f32,
        health: u8::from(engine.healthy),
        ..EFI_STATUS_DATA::DEFAULT
    })
}

fn rpm(a: &Autopilot) -> MavMessage {
    MavMessage::RPM(RPM_DATA { rpm1: a.aircraft.engine().rpm as f32, rpm2: -1.0 })
}

fn esc_telemetry(a: &Autopilot) -> MavMessage {
    let (engine, battery) = (a.aircraft.engine(), a.aircraft.battery());
    let first = |value: f64| [value.clamp(0.0, 65535.0) as u16, 0, 0, 0];
    MavMessage::ESC_TELEMETRY_1_TO_4(ESC_TELEMETRY_1_TO_4_DATA {
        voltage: first(battery.voltage_v * 100.0),
        current: first(battery.current_a * 100.0),
        totalcurrent: first(battery.used_ah() * 1000.0),
        rpm: first(engine.rpm),
        count: first(1.0),
        temperature: [engine.temperature_c.clamp(0.0, 255.0) as u8, 0, 0, 0],
    })
}

fn esc_status(a: &Autopilot, now_ns: u64) -> MavMessage {
    let (engine, battery) = (a.aircraft.engine(), a.aircraft.battery());
    MavMessage::ESC_STATUS(ESC_STATUS_DATA {
        time_usec: boot_us(now_ns),
        rpm: [engine.rpm as i32, 0, 0, 0],
        voltage: [battery.voltage_v as f32, 0.0, 0.0, 0.0],
        current: [battery.current_a as f32, 0.0, 0.0, 0.0],
        index: 0,
    })
}

fn home_position(a: &Autopilot, now_ns: u64) -> MavMessage {
    MavMessage::HOME_POSITION(HOME_POSITION_DATA {
        latitude: degrees_e7(a.home.position.lat_deg),
        longitude: degrees_e7(a.home.position.lon_deg),
        altitude: (a.home.altitude_amsl_m * 1000.0) as i32,
        q: [1.0, 0.0, 0.0, 0.0],
        time_usec: boot_us(now_ns),
        ..HOME_POSITION_DATA::DEFAULT
    })
}

fn global_origin(a: &Autopilot, now_ns: u64) -> MavMessage {
    MavMessage::GPS_GLOBAL_ORIGIN(GPS_GLOBAL_ORIGIN_DATA {
        latitude: degrees_e7(a.home.position.lat_deg),
        longitude: degrees_e7(a.home.position.lon_deg),
        altitude: (a.home.altitude_amsl_m * 1000.0) as i32,
        time_usec: boot_us(now_ns),
    })
}

fn extended_sys_state(a: &Autopilot) -> MavMessage {
    let s = a.aircraft.state();
    let low = s.altitude_amsl_m - a.home.altitude_amsl_m < 10.0;
    let landed_state = match (s.on_ground, low && s.climb_mps > 0.5, low && s.climb_mps < -0.3) {
        (true, ..) => MavLandedState::MAV_LANDED_STATE_ON_GROUND,
        (false, true, _) => MavLandedState::MAV_LANDED_STATE_TAKEOFF,
        (false, _, true) => MavLandedState::MAV_LANDED_STATE_LANDING,
        _ => MavLandedState::MAV_LANDED_STATE_IN_AIR,
    };
    MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
        vtol_state: MavVtolState::MAV_VTOL_STATE_UNDEFINED,
        landed_state,
    })
}

/// `TIMESYNC` question of the lockstep: "it is now `now_ns`".
pub fn timesync(tc1: i64, ts1: i64) -> MavMessage {
    MavMessage::TIMESYNC(TIMESYNC_DATA { tc1, ts1, target_system: 0, target_component: 0 })
}

/// A text, cut to what fits.
pub fn statustext(severity: MavSeverity, text: &str) -> MavMessage {
    let mut cut = 50.min(text.len());
    while !text.is_char_boundary(cut) {
        cut -= 1;
    }
    let text = text.get(..cut).unwrap_or_default().into();
    MavMessage::STATUSTEXT(STATUSTEXT_DATA { severity, text, ..STATUSTEXT_DATA::DEFAULT })
}

/// `MISSION_ITEM_REACHED`.
pub fn item_reached(seq: u16) -> MavMessage {
    MavMessage::MISSION_ITEM_REACHED(MISSION_ITEM_REACHED_DATA { seq })
}

/// `true` if a message for that target is for us (0 means everybody).
pub fn is_for_us(system: Option<u8>, component: Option<u8>) -> bool {
    system.is_none_or(|id| id == 0 || id == SYSTEM_ID)
        && component.is_none_or(|id| id == 0 || id == COMPONENT_ID)
}
