//! Telemetry messages to contract values. No field is trusted.

mod high_latency;

use super::session::SessionEvent;
use crate::gateway::order::{Fix, Report, Time};
use geometry::LatLon;
use geometry::geodesy::normalise_360;
use mavlink::dialects::ardupilotmega::*;
use usal::contract::{Air, Attitude, Engine, Gps, Power};

/// A position that is farther from the last one than this could have been flown, m/s.
const FASTEST_MPS: f64 = 300.0;
/// Grace for such a jump, metres.
const JUMP_M: f64 = 500.0;
/// After so many jumps in a row to about the same place, it is believed.
const BELIEVED_AFTER: u32 = 10;
/// A time of day before this (2020-01-01, in microseconds since 1970) is none: the autopilot has not received it from a satellite.
const NO_TIME_BEFORE_US: u64 = 1_577_836_800_000_000;

/// What is put together from several messages.
#[derive(Debug, Clone, Default)]
pub struct Readings {
    airspeed_mps: f64,
    wind: (f64, f64),
    pressure_hpa: f64,
    temperature_c: f64,
    throttle: f64,
    engine_temperature_c: f64,
    fuel: Option<f64>,
    last_fix: Option<(Time, LatLon)>,
    jumps: u32,
    /// When a position of the usual message came.
    finer_at: Option<Time>,
    /// The take-off place's altitude AMSL, as its two heights say it.
    home_amsl_m: Option<f64>,
    /// The energy, as it was said last.
    power: Option<Power>,
    /// The time of day when it was received last, seconds since 1970.
    day: Option<(Time, i64)>,
}

impl Readings {
    /// Takes in a message. What makes no sense is counted in `ignored`.
    pub fn take(&mut self, now: Time, message: &MavMessage, out: &mut Vec<SessionEvent>, ignored: &mut u64) {
        let sense = match message {
            MavMessage::GLOBAL_POSITION_INT(m) => {
                self.fix(now, m).map(|f| out.push(SessionEvent::Telemetry(Report::Fix(f))))
            }
            MavMessage::ATTITUDE(m) => {
                attitude(m).map(|a| out.push(SessionEvent::Telemetry(Report::Attitude(a))))
            }
            MavMessage::VFR_HUD(m) => self.hud(m).map(|air| {
                let said = [Report::Air(air), Report::Throttle(self.throttle)];
                out.extend(said.map(SessionEvent::Telemetry));
            }),
            MavMessage::WIND(m) => self.wind(m),
            MavMessage::WIND_COV(m) => self.wind_vector(m),
            MavMessage::SCALED_PRESSURE(m) => self.pressure(m),
            MavMessage::GPS_RAW_INT(m) => {
                out.push(SessionEvent::Telemetry(Report::Gps(gps(m, self.unix_s(now)))));
                Some(())
            }
            MavMessage::SYSTEM_TIME(m) => {
                let known = Some(m.time_unix_usec).filter(|us| *us >= NO_TIME_BEFORE_US);
                let unix_s = known.and_then(|us| i64::try_from(us / 1_000_000).ok());
                self.day = unix_s.map(|unix_s| (now, unix_s));
                Some(())
            }
            MavMessage::SYS_STATUS(m) => {
                self.power(m).map(|p| out.push(SessionEvent::Telemetry(Report::Power(p))))
            }
            // not asked for: it would come beside all that it sums up
            MavMessage::HIGH_LATENCY2(summary) => self.summary(now, summary, out),
            MavMessage::FUEL_STATUS(m) => self.tank(m),
            MavMessage::RPM(m) => {
                self.engine(m.rpm1).map(|e| out.push(SessionEvent::Telemetry(Report::Engine(e))))
            }
            MavMessage::EFI_STATUS(m) => self.efi(m),
            MavMessage::HOME_POSITION(m) => home(m).map(|h| out.push(SessionEvent::Telemetry(h))),
            MavMessage::EXTENDED_SYS_STATE(m) => {
                landed(m.landed_state).map(|r| out.push(SessionEvent::Telemetry(r)))
            }
            _ => Some(()),
        };
        *ignored += u64::from(sense.is_none());
    }

    fn fix(&mut self, now: Time, m: &GLOBAL_POSITION_INT_DATA) -> Option<Fix> {
        let position = place(m.lat, m.lon)?;
        self.is_plausible(now, position).then_some(())?;
        self.last_fix = Some((now, position));
        self.finer_at = Some(now);
        self.home_amsl_m = Some((f64::from(m.alt) - f64::from(m.relative_alt)) / 1e3);
        Some(Fix {
            position,
            altitude_amsl_m: f64::from(m.alt) / 1e3,
            altitude_home_m: f64::from(m.relative_alt) / 1e3,
            north_mps: f64::from(m.vx) / 1e2,
            east_mps: f64::from(m.vy) / 1e2,
            down_mps: f64::from(m.vz) / 1e2,
        })
    }

    fn is_plausible(&mut self, now: Time, position: LatLon) -> bool {
        let Some((then, last)) = self.last_fix else { return true };
        let reach_m = JUMP_M + FASTEST_MPS * now.saturating_sub(then).as_secs_f64();
        let flat_m = geometry::LocalFrame::new(last).to_local(position).length();
        let jumped = flat_m > reach_m;
        self.jumps = if jumped { self.jumps + 1 } else { 0 };
        !jumped || self.jumps > BELIEVED_AFTER
    }

    fn unix_s(&self, now: Time) -> Option<i64> {
        let (then, unix_s) = self.day?;
        Some(unix_s.saturating_add_unsigned(now.saturating_sub(then).as_secs()))
    }

    fn hud(&mut self, m: &VFR_HUD_DATA) -> Option<Air> {
        let airspeed = f64::from(m.airspeed);
        (airspeed.is_finite() && airspeed >= 0.0).then_some(())?;
        self.airspeed_mps = airspeed;
        self.throttle = f64::from(m.throttle.min(100)) / 100.0;
        Some(Air {
            airspeed_mps: self.airspeed_mps,
            wind_east_mps: self.wind.0,
            wind_north_mps: self.wind.1,
            pressure_hpa: self.pressure_hpa,
            temperature_c: self.temperature_c,
        })
    }

    /// The message says where the wind comes from.
    fn wind(&mut self, m: &WIND_DATA) -> Option<()> {
        let (from, speed) = (f64::from(m.direction).to_radians(), f64::from(m.speed));
        (from.is_finite() && (0.0..100.0).contains(&speed)).then_some(())?;
        self.wind = (-speed * from.sin(), -speed * from.cos());
        Some(())
    }

    /// This message says where it blows to.
    fn wind_vector(&mut self, m: &WIND_COV_DATA) -> Option<()> {
        let (north, east) = (f64::from(m.wind_x), f64::from(m.wind_y));
        (0.0..100.0).contains(&north.hypot(east)).then_some(())?;
        self.wind = (east, north);
        Some(())
    }

    fn pressure(&mut self, m: &SCALED_PRESSURE_DATA) -> Option<()> {
        m.press_abs.is_finite().then_some(())?;
        self.pressure_hpa = f64::from(m.press_abs);
        self.temperature_c = f64::from(m.temperature) / 100.0;
        Some(())
    }

    fn engine(&mut self, rpm: f32) -> Option<Engine> {
        (rpm.is_finite() && rpm >= 0.0).then_some(Engine {
            rpm: f64::from(rpm),
            temperature_c: self.engine_temperature_c,
            throttle: self.throttle,
        })
    }

    fn power(&mut self, m: &SYS_STATUS_DATA) -> Option<Power> {
        let power = (0..=100).contains(&m.battery_remaining).then(|| Power {
            voltage_v: f64::from(m.voltage_battery) / 1e3,
            current_a: f64::from(m.current_battery) / 1e2,
            battery: f64::from(m.battery_remaining) / 100.0,
            fuel: self.fuel,
        });
        self.power = power.or(self.power);
        power
    }

    /// It is published with the battery.
    fn tank(&mut self, m: &FUEL_STATUS_DATA) -> Option<()> {
        (0..=100).contains(&m.percent_remaining).then_some(())?;
        self.fuel = Some(f64::from(m.percent_remaining) / 100.0);
        Some(())
    }

    fn efi(&mut self, m: &EFI_STATUS_DATA) -> Option<()> {
        m.cylinder_head_temperature.is_finite().then_some(())?;
        self.engine_temperature_c = f64::from(m.cylinder_head_temperature);
        Some(())
    }
}

/// A valid position; 0, 0 stands for "unknown".
fn place(lat: i32, lon: i32) -> Option<LatLon> {
    let position = LatLon::new(f64::from(lat) / 1e7, f64::from(lon) / 1e7);
    (position.is_valid() && (lat, lon) != (0, 0)).then_some(position)
}

fn attitude(m: &ATTITUDE_DATA) -> Option<Attitude> {
    let deg = |rad: f32| f64::from(rad).to_degrees();
    let all = [m.roll, m.pitch, m.yaw, m.rollspeed, m.pitchspeed, m.yawspeed];
    all.iter().all(|v| v.is_finite()).then(|| Attitude {
        roll_deg: deg(m.roll),
        pitch_deg: deg(m.pitch),
        heading_deg: normalise_360(deg(m.yaw)),
        roll_rate_dps: deg(m.rollspeed),
        pitch_rate_dps: deg(m.pitchspeed),
        yaw_rate_dps: deg(m.yawspeed),
    })
}

fn gps(m: &GPS_RAW_INT_DATA, unix_s: Option<i64>) -> Gps {
    Gps {
        fix_3d: m.fix_type as u32 >= GpsFixType::GPS_FIX_TYPE_3D_FIX as u32,
        satellites: m.satellites_visible,
        hdop: f64::from(m.eph) / 100.0,
        unix_s,
    }
}

fn home(m: &HOME_POSITION_DATA) -> Option<Report> {
    let position = place(m.latitude, m.longitude)?;
    Some(Report::Home { position, altitude_amsl_m: f64::from(m.altitude) / 1e3 })
}

fn landed(state: MavLandedState) -> Option<Report> {
    match state {
        MavLandedState::MAV_LANDED_STATE_UNDEFINED => None,
        MavLandedState::MAV_LANDED_STATE_ON_GROUND => Some(Report::OnGround(true)),
        _ => Some(Report::OnGround(false)),
    }
}
