//! Pure: the executor's view of the aircraft, out of the gateway's variables.

use flight_exec::{AircraftState, Time};
use std::time::Duration;
use usal::contract::{Air, Attitude, Position, Power};

/// An older attitude may be that of before it was turned.
const FRESH: Duration = Duration::from_secs(3);

/// The latest of each.
#[derive(Debug, Clone, Default)]
pub struct Aircraft {
    position: Option<Position>,
    air: Option<Air>,
    power: Option<Power>,
    attitude: Option<(Time, Attitude)>,
}

impl Aircraft {
    /// A fresh position.
    pub fn position(&mut self, position: Position) {
        let finite = position.position.lat_deg.is_finite() && position.position.lon_deg.is_finite();
        if finite && position.altitude_amsl_m.is_finite() && position.ground_speed_mps.is_finite() {
            self.position = Some(position);
        }
    }

    /// Fresh air data.
    pub fn air(&mut self, air: Air) {
        if air.airspeed_mps.is_finite() && air.wind_east_mps.is_finite() && air.wind_north_mps.is_finite() {
            self.air = Some(air);
        }
    }

    /// A fresh state of the battery.
    pub fn power(&mut self, power: Power) {
        if power.battery.is_finite() {
            self.power = Some(power);
        }
    }

    /// A fresh attitude.
    pub fn attitude(&mut self, now: Time, attitude: Attitude) {
        if attitude.heading_deg.is_finite() {
            self.attitude = Some((now, attitude));
        }
    }

    /// How much warmer than the standard's the air is, by its density where the aircraft is; `None`: it is not known.
    pub fn isa_deviation_c(&self) -> Option<f64> {
        let (air, at) = (self.air?, self.position?);
        aircraft::air::isa_deviation_c(at.altitude_amsl_m, air.pressure_hpa, air.temperature_c)
    }

    /// Everything together, once a position is known. Without air data there is no wind; without
    /// battery data it is taken as full, as conditions on it must not fire on nothing. `engine_out`: see [`AircraftState::engine_out`].
    pub fn state(&self, now: Time, engine_out: bool) -> Option<AircraftState> {
        let p = self.position?;
        let fresh = self.attitude.filter(|(at, _)| now.saturating_sub(*at) < FRESH);
        let (wind_east_mps, wind_north_mps) =
            self.air.map_or((0.0, 0.0), |a| (a.wind_east_mps, a.wind_north_mps));
        Some(AircraftState {
            position: p.position,
            altitude_amsl_m: p.altitude_amsl_m,
            track_deg: if p.track_deg.is_finite() { p.track_deg } else { 0.0 },
            ground_speed_mps: p.ground_speed_mps,
            airspeed_mps: self.air.map_or(p.ground_speed_mps, |a| a.airspeed_mps),
            wind_east_mps,
            wind_north_mps,
            battery: self.power.map_or(1.0, |p| p.battery.clamp(0.0, 1.0)),
            fuel: self.power.and_then(|p| p.fuel).filter(|f| f.is_finite()).map(|f| f.clamp(0.0, 1.0)),
            on_ground: p.on_ground,
            engine_out: engine_out && !p.on_ground,
            heading_deg: fresh.filter(|_| p.on_ground).map(|(_, attitude)| attitude.heading_deg),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    /// A stream that had stopped before the aircraft was turned had it refused on.
    #[test]
    fn how_it_is_turned_is_known_for_some_seconds_only() {
        let mut aircraft = Aircraft::default();
        aircraft.position(Position {
            position: LatLon::new(36.0, -84.0),
            altitude_amsl_m: 300.0,
            altitude_home_m: 0.0,
            track_deg: 0.0,
            ground_speed_mps: 0.0,
            velocity_north_mps: 0.0,
            velocity_east_mps: 0.0,
            velocity_down_mps: 0.0,
            on_ground: true,
        });
        let turned = Attitude {
            roll_deg: 0.0,
            pitch_deg: 0.0,
            heading_deg: 232.0,
            roll_rate_dps: 0.0,
            pitch_rate_dps: 0.0,
            yaw_rate_dps: 0.0,
        };
        aircraft.attitude(Time::from_secs(10), turned);
        let heading_deg = |s| aircraft.state(Time::from_secs(s), false).and_then(|state| state.heading_deg);
        assert_eq!([heading_deg(11), heading_deg(20)], [Some(232.0), None]);
    }
}
