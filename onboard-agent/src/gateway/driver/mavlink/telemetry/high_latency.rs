//! `HIGH_LATENCY2`: everything in one short message, over a link that carries little more (a satellite's). It is coarse, and counts
//! only while the usual messages do not come.

use super::{ALTITUDES_M, Readings, place};
use crate::gateway::driver::mavlink::session::SessionEvent;
use crate::gateway::order::{Fix, Report, Time};
use mavlink::dialects::ardupilotmega::HIGH_LATENCY2_DATA;
use std::f64::consts::PI;
use std::time::Duration;
use usal::contract::{Air, Power};

/// A position of the usual messages is better for so long.
const FINER_FOR: Duration = Duration::from_secs(5);

impl Readings {
    /// Takes it in, but for the mode. What it does not say (voltage, the take-off place) stays as it was said before; a share of the
    /// battery or a height over home is only told with that.
    pub(super) fn summary(
        &mut self,
        now: Time,
        m: &HIGH_LATENCY2_DATA,
        out: &mut Vec<SessionEvent>,
    ) -> Option<()> {
        let mut say = |report| out.push(SessionEvent::Telemetry(report));
        say(Report::Alive);
        if self.finer_at.is_some_and(|at| now.saturating_sub(at) < FINER_FOR) {
            return Some(());
        }
        let position = place(m.latitude, m.longitude)?;
        let altitude_amsl_m = f64::from(m.altitude);
        (ALTITUDES_M.contains(&altitude_amsl_m) && self.is_plausible(now, position)).then_some(())?;
        self.last_fix = Some((now, position));
        self.airspeed_mps = f64::from(m.airspeed) / 5.0;
        self.throttle = f64::from(m.throttle.min(100)) / 100.0;
        self.summed_up_wind(m);
        if let Some(home_amsl_m) = self.home_amsl_m {
            // it says where the nose points, not where it goes
            let (heading, ground_mps) =
                ((f64::from(m.heading) * 2.0).to_radians(), f64::from(m.groundspeed) / 5.0);
            say(Report::Fix(Fix {
                position,
                altitude_amsl_m,
                altitude_home_m: altitude_amsl_m - home_amsl_m,
                north_mps: ground_mps * heading.cos(),
                east_mps: ground_mps * heading.sin(),
                down_mps: -f64::from(m.climb_rate) / 10.0,
            }));
        }
        say(Report::Air(Air {
            airspeed_mps: self.airspeed_mps,
            wind_east_mps: self.wind.0,
            wind_north_mps: self.wind.1,
            pressure_hpa: self.pressure_hpa,
            temperature_c: self.temperature_c,
        }));
        say(Report::Throttle(self.throttle));
        // −1: it does not know
        let battery = (0..=100).contains(&m.battery).then(|| f64::from(m.battery) / 100.0);
        if let (Some(battery), Some(before)) = (battery, &self.power) {
            say(Report::Power(Power { battery, ..*before }));
        }
        Some(())
    }

    /// Autopilots differ in which direction that of a wind is. Where nothing is measured, none blows.
    fn summed_up_wind(&mut self, m: &HIGH_LATENCY2_DATA) {
        let (mps, said) = (f64::from(m.windspeed) / 5.0, (f64::from(m.wind_heading) * 2.0).to_radians());
        let to = if self.wind_blows_to { said } else { said + PI };
        if m.windspeed > 0 {
            self.wind = (mps * to.sin(), mps * to.cos());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::ardupilotmega::{GLOBAL_POSITION_INT_DATA, MavMessage, SYS_STATUS_DATA};

    fn take(readings: &mut Readings, second: u64, message: &MavMessage) -> (Vec<Report>, u64) {
        let (mut out, mut ignored) = (vec![], 0);
        readings.take(Time::from_secs(second), message, &mut out, &mut ignored);
        let report = |event| match event {
            SessionEvent::Telemetry(report) => report,
            other => panic!("{other:?}"),
        };
        (out.into_iter().map(report).collect(), ignored)
    }

    fn summary() -> HIGH_LATENCY2_DATA {
        HIGH_LATENCY2_DATA {
            latitude: 363_190_000,
            longitude: -841_730_000,
            altitude: 470,
            heading: 45,
            groundspeed: 125,
            airspeed: 130,
            climb_rate: -12,
            throttle: 40,
            battery: 61,
            ..HIGH_LATENCY2_DATA::DEFAULT
        }
    }

    #[test]
    fn a_summary_counts_while_nothing_finer_comes() {
        let mut readings = Readings::default();
        let fine = GLOBAL_POSITION_INT_DATA {
            lat: 363_200_000,
            lon: -841_730_000,
            alt: 480_000,
            relative_alt: 130_000,
            ..GLOBAL_POSITION_INT_DATA::DEFAULT
        };
        let status =
            SYS_STATUS_DATA { voltage_battery: 24_000, battery_remaining: 70, ..SYS_STATUS_DATA::DEFAULT };
        take(&mut readings, 0, &MavMessage::GLOBAL_POSITION_INT(fine));
        take(&mut readings, 0, &MavMessage::SYS_STATUS(status));
        let summed_up = MavMessage::HIGH_LATENCY2(summary());
        assert_eq!(take(&mut readings, 1, &summed_up), (vec![Report::Alive], 0));
        let (said, ignored) = take(&mut readings, 60, &summed_up);
        let [
            Report::Alive,
            Report::Fix(fix),
            Report::Air(air),
            Report::Throttle(throttle),
            Report::Power(power),
        ] = &said[..]
        else {
            panic!("{said:?}")
        };
        assert_eq!((fix.altitude_amsl_m, fix.altitude_home_m, ignored), (470.0, 120.0, 0));
        assert!(fix.north_mps.abs() < 1e-9 && (fix.east_mps - 25.0).abs() < 1e-9, "to the east: {fix:?}");
        assert!((fix.down_mps - 1.2).abs() < 1e-9);
        assert_eq!((air.airspeed_mps, *throttle, power.battery, power.voltage_v), (26.0, 0.4, 0.61, 24.0));
    }

    #[test]
    fn the_wind_is_told_from_where_the_autopilot_means_it() {
        let windy =
            MavMessage::HIGH_LATENCY2(HIGH_LATENCY2_DATA { windspeed: 25, wind_heading: 45, ..summary() });
        for wind_blows_to in [true, false] {
            let mut readings = Readings { wind_blows_to, ..Readings::default() };
            let (said, _) = take(&mut readings, 0, &windy);
            let Report::Air(air) = &said[1] else { panic!("{said:?}") };
            let east_mps = if wind_blows_to { 5.0 } else { -5.0 };
            assert!(
                (air.wind_east_mps - east_mps).abs() < 1e-9 && air.wind_north_mps.abs() < 1e-9,
                "{air:?}"
            );
            let (said, _) = take(&mut readings, 1, &MavMessage::HIGH_LATENCY2(summary()));
            let Report::Air(air) = &said[1] else { panic!("{said:?}") };
            assert!((air.wind_east_mps - east_mps).abs() < 1e-9, "it says none, and may not know any");
        }
    }

    #[test]
    fn what_it_can_not_say_alone_and_what_makes_no_sense_is_not_said() {
        let mut readings = Readings::default();
        let (said, _) = take(&mut readings, 0, &MavMessage::HIGH_LATENCY2(summary()));
        assert!(matches!(&said[..], [Report::Alive, Report::Air(_), Report::Throttle(_)]), "{said:?}");
        for (latitude, longitude) in [(0, 0), (910_000_000, 0), (i32::MIN, i32::MAX)] {
            let nowhere = HIGH_LATENCY2_DATA { latitude, longitude, ..summary() };
            let (said, ignored) = take(&mut readings, 1, &MavMessage::HIGH_LATENCY2(nowhere));
            assert_eq!((said, ignored), (vec![Report::Alive], 1));
        }
        let deep = HIGH_LATENCY2_DATA { altitude: i16::MIN, ..summary() };
        assert_eq!(take(&mut readings, 2, &MavMessage::HIGH_LATENCY2(deep)), (vec![Report::Alive], 1));
    }
}
