//! Telemetry messages to contract values. No field is trusted.

mod high_latency;

use super::session::SessionEvent;
use crate::gateway::order::{Fix, Report, Time};
use geometry::LatLon;
use geometry::geodesy::normalise_360;
use mavlink::dialects::ardupilotmega::*;
use std::f32::consts::TAU;
use std::ops::RangeInclusive;
use usal::contract::{Air, Attitude, Engine, Gps, Power};

/// A position that is farther from the last one than this could have been flown, m/s.
const FASTEST_MPS: f64 = 300.0;
/// Grace for such a jump, metres.
const JUMP_M: f64 = 500.0;
/// After so many jumps in a row to about the same place, it is believed.
const BELIEVED_AFTER: u32 = 10;
/// Angles come within one turn of zero, radians; and what turns faster than this is no aircraft, rad/s.
const ANGLES_RAD: RangeInclusive<f32> = -TAU..=TAU;
const TURNS_RADPS: RangeInclusive<f32> = -50.0..=50.0;
/// What an aircraft and the air around it may be; what lies outside is no measurement.
const ALTITUDES_M: RangeInclusive<f64> = -500.0..=20_000.0;
const SPEEDS_MPS: RangeInclusive<f64> = -FASTEST_MPS..=FASTEST_MPS;
const PRESSURES_HPA: RangeInclusive<f64> = 10.0..=1200.0;
const TEMPERATURES_C: RangeInclusive<f64> = -100.0..=100.0;
const ENGINE_TEMPERATURES_C: RangeInclusive<f64> = -100.0..=2000.0;
const FASTEST_RPM: f32 = 200_000.0;
/// So near to 0, 0 no position is known, degrees × 10⁷: 1 km of sea.
const NOWHERE: u32 = 100_000;
/// Its value where nothing is measured: voltage in mV and dilution of precision.
const NOT_MEASURED: u16 = u16::MAX;
/// A dilution of precision that nothing can be made of.
const NO_HDOP: f64 = 99.99;
/// A time of day before this (2020-01-01, in microseconds since 1970) is none: the autopilot has not received it from a satellite.
const NO_TIME_BEFORE_US: u64 = 1_577_836_800_000_000;

/// A place to which it seems to have jumped.
#[derive(Debug, Clone, Copy)]
struct Jump {
    /// Where it was said to be last, and when.
    said: (Time, LatLon),
    /// So often in a row it was said to be about there.
    times: u32,
}

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
    jump: Option<Jump>,
    /// When a position of the usual message came.
    finer_at: Option<Time>,
    /// The take-off place's altitude AMSL, as its two heights say it.
    home_amsl_m: Option<f64>,
    /// The energy, as it was said last.
    power: Option<Power>,
    /// A summary says where the wind blows to, not where it comes from.
    pub wind_blows_to: bool,
    /// The time of day when it was received last, seconds since 1970.
    day: Option<(Time, i64)>,
}

impl Readings {
    /// Takes in a message. What makes no sense is counted in `ignored`.
    pub fn take(&mut self, now: Time, message: &MavMessage, out: &mut Vec<SessionEvent>, ignored: &mut u64) {
        let sense = match message {
            // it does not know yet where it is
            MavMessage::GLOBAL_POSITION_INT(m) if is_nowhere(m.lat, m.lon) && self.last_fix.is_none() => {
                Some(())
            }
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
            // it does not know how much is left
            MavMessage::SYS_STATUS(m) if m.battery_remaining == -1 => Some(()),
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
            MavMessage::POSITION_TARGET_GLOBAL_INT(m) if is_nowhere(m.lat_int, m.lon_int) => Some(()),
            MavMessage::POSITION_TARGET_GLOBAL_INT(m) => place(m.lat_int, m.lon_int)
                .map(|place| out.push(SessionEvent::Telemetry(Report::SteersTo(place)))),
            MavMessage::EXTENDED_SYS_STATE(m) => {
                landed(m.landed_state).map(|r| out.push(SessionEvent::Telemetry(r)))
            }
            _ => Some(()),
        };
        *ignored += u64::from(sense.is_none());
    }

    fn fix(&mut self, now: Time, m: &GLOBAL_POSITION_INT_DATA) -> Option<Fix> {
        let position = place(m.lat, m.lon)?;
        let fix = Fix {
            position,
            altitude_amsl_m: f64::from(m.alt) / 1e3,
            altitude_home_m: f64::from(m.relative_alt) / 1e3,
            north_mps: f64::from(m.vx) / 1e2,
            east_mps: f64::from(m.vy) / 1e2,
            down_mps: f64::from(m.vz) / 1e2,
        };
        let altitudes = [fix.altitude_amsl_m, fix.altitude_home_m];
        let speeds = [fix.north_mps, fix.east_mps, fix.down_mps];
        let in_range = altitudes.iter().all(|m| ALTITUDES_M.contains(m))
            && speeds.iter().all(|v| SPEEDS_MPS.contains(v));
        (in_range && self.is_plausible(now, position)).then_some(())?;
        self.last_fix = Some((now, position));
        self.finer_at = Some(now);
        self.home_amsl_m = Some(fix.altitude_amsl_m - fix.altitude_home_m);
        Some(fix)
    }

    fn is_plausible(&mut self, now: Time, position: LatLon) -> bool {
        let Some(last) = self.last_fix else { return true };
        if is_in_reach(last, now, position) {
            self.jump = None;
            return true;
        }
        // another place each time is noise, however long it lasts
        let before = self.jump.filter(|jump| is_in_reach(jump.said, now, position));
        let times = before.map_or(0, |jump| jump.times) + 1;
        self.jump = Some(Jump { said: (now, position), times });
        times > BELIEVED_AFTER
    }

    fn unix_s(&self, now: Time) -> Option<i64> {
        let (then, unix_s) = self.day?;
        Some(unix_s.saturating_add_unsigned(now.saturating_sub(then).as_secs()))
    }

    fn hud(&mut self, m: &VFR_HUD_DATA) -> Option<Air> {
        let airspeed = f64::from(m.airspeed);
        (0.0..=FASTEST_MPS).contains(&airspeed).then_some(())?;
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
        let (pressure_hpa, temperature_c) = (f64::from(m.press_abs), f64::from(m.temperature) / 100.0);
        let in_range = PRESSURES_HPA.contains(&pressure_hpa) && TEMPERATURES_C.contains(&temperature_c);
        in_range.then_some(())?;
        (self.pressure_hpa, self.temperature_c) = (pressure_hpa, temperature_c);
        Some(())
    }

    fn engine(&mut self, rpm: f32) -> Option<Engine> {
        (0.0..=FASTEST_RPM).contains(&rpm).then_some(Engine {
            rpm: f64::from(rpm),
            temperature_c: self.engine_temperature_c,
            throttle: self.throttle,
        })
    }

    /// Voltage or current that is not measured is 0.
    fn power(&mut self, m: &SYS_STATUS_DATA) -> Option<Power> {
        let millivolts = if m.voltage_battery == NOT_MEASURED { 0 } else { m.voltage_battery };
        let centiamperes = if m.current_battery == -1 { 0 } else { m.current_battery };
        let power = (0..=100).contains(&m.battery_remaining).then(|| Power {
            voltage_v: f64::from(millivolts) / 1e3,
            current_a: f64::from(centiamperes) / 1e2,
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
        let temperature_c = f64::from(m.cylinder_head_temperature);
        ENGINE_TEMPERATURES_C.contains(&temperature_c).then_some(())?;
        self.engine_temperature_c = temperature_c;
        Some(())
    }
}

/// It can have flown there from where it was then.
fn is_in_reach((then, last): (Time, LatLon), now: Time, position: LatLon) -> bool {
    let reach_m = JUMP_M + FASTEST_MPS * now.saturating_sub(then).as_secs_f64();
    geometry::LocalFrame::new(last).to_local(position).length() <= reach_m
}

/// A valid position that is known.
fn place(lat: i32, lon: i32) -> Option<LatLon> {
    let position = LatLon::new(f64::from(lat) / 1e7, f64::from(lon) / 1e7);
    (position.is_valid() && !is_nowhere(lat, lon)).then_some(position)
}

/// 0, 0 stands for "unknown"; and without a fix ArduPlane reckons on from there.
fn is_nowhere(lat: i32, lon: i32) -> bool {
    lat.unsigned_abs() < NOWHERE && lon.unsigned_abs() < NOWHERE
}

fn attitude(m: &ATTITUDE_DATA) -> Option<Attitude> {
    let deg = |rad: f32| f64::from(rad).to_degrees();
    let angles = [m.roll, m.pitch, m.yaw];
    let turns = [m.rollspeed, m.pitchspeed, m.yawspeed];
    let in_range =
        angles.iter().all(|v| ANGLES_RAD.contains(v)) && turns.iter().all(|v| TURNS_RADPS.contains(v));
    in_range.then(|| Attitude {
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
        satellites: (m.satellites_visible != u8::MAX).then_some(m.satellites_visible),
        hdop: if m.eph == NOT_MEASURED { NO_HDOP } else { f64::from(m.eph) / 100.0 },
        unix_s,
    }
}

fn home(m: &HOME_POSITION_DATA) -> Option<Report> {
    let position = place(m.latitude, m.longitude)?;
    let altitude_amsl_m = f64::from(m.altitude) / 1e3;
    ALTITUDES_M.contains(&altitude_amsl_m).then_some(Report::Home { position, altitude_amsl_m })
}

fn landed(state: MavLandedState) -> Option<Report> {
    match state {
        MavLandedState::MAV_LANDED_STATE_UNDEFINED => None,
        MavLandedState::MAV_LANDED_STATE_ON_GROUND => Some(Report::OnGround(true)),
        _ => Some(Report::OnGround(false)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is made of a message; how many were without sense.
    fn taken(message: MavMessage) -> (Vec<SessionEvent>, u64) {
        let (mut out, mut ignored) = (vec![], 0);
        Readings::default().take(Time::ZERO, &message, &mut out, &mut ignored);
        (out, ignored)
    }

    fn fix() -> GLOBAL_POSITION_INT_DATA {
        GLOBAL_POSITION_INT_DATA {
            lat: 363_000_000,
            lon: -841_000_000,
            alt: 500_000,
            ..GLOBAL_POSITION_INT_DATA::DEFAULT
        }
    }

    #[test]
    fn a_value_that_nothing_can_have_loses_its_message_and_is_counted() {
        let hud = |airspeed| MavMessage::VFR_HUD(VFR_HUD_DATA { airspeed, ..VFR_HUD_DATA::DEFAULT });
        let air = |press_abs, temperature| {
            MavMessage::SCALED_PRESSURE(SCALED_PRESSURE_DATA {
                press_abs,
                temperature,
                ..SCALED_PRESSURE_DATA::DEFAULT
            })
        };
        let position = MavMessage::GLOBAL_POSITION_INT;
        let good = [position(fix()), hud(25.0), air(960.0, 1500)];
        for message in good {
            assert_eq!(taken(message.clone()).1, 0, "{message:?}");
        }
        let bad = [
            position(GLOBAL_POSITION_INT_DATA { lat: 910_000_000, ..fix() }),
            position(GLOBAL_POSITION_INT_DATA { alt: i32::MAX, ..fix() }),
            position(GLOBAL_POSITION_INT_DATA { relative_alt: i32::MIN, ..fix() }),
            position(GLOBAL_POSITION_INT_DATA { vz: i16::MAX, ..fix() }),
            hud(f32::NAN),
            hud(-1.0),
            hud(1e9),
            air(-5.0, 1500),
            air(f32::INFINITY, 1500),
            air(960.0, i16::MAX),
            MavMessage::ATTITUDE(ATTITUDE_DATA { roll: 1e30, ..ATTITUDE_DATA::DEFAULT }),
            MavMessage::ATTITUDE(ATTITUDE_DATA { yawspeed: 1e3, ..ATTITUDE_DATA::DEFAULT }),
            MavMessage::RPM(RPM_DATA { rpm1: 1e9, rpm2: 0.0 }),
            MavMessage::EFI_STATUS(EFI_STATUS_DATA {
                cylinder_head_temperature: 1e9,
                ..EFI_STATUS_DATA::DEFAULT
            }),
            MavMessage::HOME_POSITION(HOME_POSITION_DATA {
                latitude: 1,
                altitude: i32::MAX,
                ..HOME_POSITION_DATA::DEFAULT
            }),
        ];
        for message in bad {
            let (out, ignored) = taken(message.clone());
            assert_eq!((out, ignored), (vec![], 1), "{message:?}");
        }
    }

    #[test]
    fn a_position_that_is_not_known_yet_is_none_and_one_that_gets_lost_is_without_sense() {
        let at = |lat, lon| MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA { lat, lon, ..fix() });
        let nowhere = at(0, 0);
        let (mut readings, mut out, mut ignored) = (Readings::default(), vec![], 0);
        // as an ArduPlane begins
        for (lat, lon) in [(0, 0), (856, 1506), (1219, 2244)] {
            readings.take(Time::ZERO, &at(lat, lon), &mut out, &mut ignored);
        }
        assert_eq!((out.len(), ignored), (0, 0));
        readings.take(Time::ZERO, &MavMessage::GLOBAL_POSITION_INT(fix()), &mut out, &mut ignored);
        readings.take(Time::ZERO, &nowhere, &mut out, &mut ignored);
        assert_eq!((out.len(), ignored), (1, 1));
    }

    /// Whether each of these positions is believed, degrees of latitude ten times a second behind a first one at 36.3°.
    fn believed(lats_deg: &[f64]) -> Vec<bool> {
        let at = |lat_deg: f64| {
            let lat = (lat_deg * 1e7) as i32;
            MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA { lat, ..fix() })
        };
        let mut readings = Readings::default();
        let mut is_taken = |(number, lat_deg): (u32, f64)| {
            let (mut out, mut ignored) = (vec![], 0);
            readings.take(Time::from_millis(100) * number, &at(lat_deg), &mut out, &mut ignored);
            assert_eq!(out.len() as u64 + ignored, 1);
            !out.is_empty()
        };
        assert!(is_taken((0, 36.3)));
        (1..).zip(lats_deg.iter().copied()).map(is_taken).collect()
    }

    #[test]
    fn a_jump_is_believed_once_it_lasts_and_scattered_places_never() {
        let steady = believed(&[37.3; 12]);
        assert_eq!(steady, [[false; 10].as_slice(), &[true; 2]].concat(), "it was carried there");
        let scattered: Vec<f64> = (0..50).map(|number| 40.0 + f64::from(number % 7)).collect();
        assert_eq!(believed(&scattered), [false; 50]);
        // it is where it was in between
        let between: Vec<f64> = (0..50).map(|number| if number % 5 == 4 { 36.3 } else { 37.3 }).collect();
        let expected: Vec<bool> = between.iter().map(|lat_deg| *lat_deg < 37.0).collect();
        assert_eq!(believed(&between), expected);
    }

    #[test]
    fn what_is_not_measured_is_no_measurement() {
        let status = SYS_STATUS_DATA {
            voltage_battery: u16::MAX,
            current_battery: -1,
            battery_remaining: 50,
            ..SYS_STATUS_DATA::DEFAULT
        };
        let (out, _) = taken(MavMessage::SYS_STATUS(status));
        let [SessionEvent::Telemetry(Report::Power(power))] = out.as_slice() else { panic!("{out:?}") };
        assert_eq!((power.voltage_v, power.current_a, power.battery), (0.0, 0.0, 0.5));
        let unknown =
            GPS_RAW_INT_DATA { eph: u16::MAX, satellites_visible: 255, ..GPS_RAW_INT_DATA::DEFAULT };
        let (out, _) = taken(MavMessage::GPS_RAW_INT(unknown));
        let [SessionEvent::Telemetry(Report::Gps(gps))] = out.as_slice() else { panic!("{out:?}") };
        assert_eq!((gps.hdop, gps.satellites), (99.99, None));
    }
}
