//! Energy: what flying costs, the battery that pays, and the engine's instruments.

use crate::{GRAVITY_MPS2, Profile};

/// Electronics that run even when the engine doesn't, watts.
const AVIONICS_POWER_W: f64 = 8.0;
/// Least engine power when it runs, as a share of the cruise power.
const IDLE_SHARE: f64 = 0.05;
/// Share of the cruise drag that grows with the square of the airspeed; the rest is induced.
const PARASITIC_SHARE: f64 = 0.7;
/// A six-cell lithium battery: empty and full open-circuit voltage, and internal resistance.
const EMPTY_V: f64 = 19.8;
const FULL_V: f64 = 25.2;
const RESISTANCE_OHM: f64 = 0.03;
const AMBIENT_C: f64 = 15.0;

/// Power a steady flight state asks of the battery, watts.
///
/// Parasitic drag grows with V², induced drag with (n/V)² (Anderson, *Introduction to Flight*,
/// ch. 6), each times V; climbing adds its potential energy at the profile's rate and descending gives
/// it back, down to idle. `load_factor` n = 1/cos φ.
pub fn demanded_power_w(profile: &Profile, airspeed_mps: f64, climb_mps: f64, load_factor: f64) -> f64 {
    let v = (airspeed_mps / profile.cruise_airspeed_mps).max(0.1);
    let induced = (1.0 - PARASITIC_SHARE) * load_factor * load_factor / v;
    let level_w = profile.cruise_power_w * (PARASITIC_SHARE * v * v * v + induced);
    let propulsion_w = level_w + profile.climb_power_w_per_mps * climb_mps;
    propulsion_w.max(IDLE_SHARE * profile.cruise_power_w)
}

/// Steepest sink with the engine out at a load factor, m/s (positive): V / glide ratio, worse in turns.
pub fn glide_sink_mps(profile: &Profile, airspeed_mps: f64, load_factor: f64) -> f64 {
    airspeed_mps / profile.glide_ratio * load_factor
}

/// The battery.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Battery {
    /// Usable energy left, joules.
    pub energy_left_j: f64,
    /// Usable energy when full, joules.
    pub capacity_j: f64,
    /// At the terminals, volts.
    pub voltage_v: f64,
    /// Drawn now, amperes.
    pub current_a: f64,
}

impl Battery {
    /// A full one.
    pub fn full(profile: &Profile) -> Self {
        Self {
            energy_left_j: profile.energy_j,
            capacity_j: profile.energy_j,
            voltage_v: FULL_V,
            current_a: 0.0,
        }
    }

    /// Share of the usable energy left, 0..1.
    pub fn share(&self) -> f64 {
        (self.energy_left_j / self.capacity_j).clamp(0.0, 1.0)
    }

    /// Charge used since full, ampere-hours at the mean voltage.
    pub fn used_ah(&self) -> f64 {
        (self.capacity_j - self.energy_left_j) / (0.5 * (EMPTY_V + FULL_V)) / 3600.0
    }

    /// Takes `power_w` for `dt_s` seconds.
    pub(crate) fn draw(&mut self, dt_s: f64, power_w: f64) {
        self.energy_left_j = (self.energy_left_j - power_w * dt_s).max(0.0);
        let open_v = EMPTY_V + (FULL_V - EMPTY_V) * self.share();
        self.current_a = power_w / open_v;
        self.voltage_v = open_v - self.current_a * RESISTANCE_OHM;
    }
}

/// The engine's instruments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engine {
    /// Able to give power (not failed, and energy left).
    pub healthy: bool,
    /// Power it gives now, watts.
    pub power_w: f64,
    /// Revolutions per minute.
    pub rpm: f64,
    /// Winding (or cylinder-head) temperature, degrees Celsius.
    pub temperature_c: f64,
}

impl Engine {
    /// Cold and still.
    pub fn cold() -> Self {
        Self { healthy: true, power_w: 0.0, rpm: 0.0, temperature_c: AMBIENT_C }
    }

    /// Follows `power_w` for `dt_s`: revolutions with the cube root of the power (propeller law,
    /// 0.5 s lag), temperature with the power (60 s lag).
    pub(crate) fn follow(&mut self, dt_s: f64, profile: &Profile, power_w: f64) {
        self.power_w = power_w;
        let load = power_w / profile.cruise_power_w;
        let blend = |tau_s: f64| (dt_s / tau_s).min(1.0);
        self.rpm += (6000.0 * load.cbrt() - self.rpm) * blend(0.5);
        self.temperature_c += (AMBIENT_C + 45.0 * load - self.temperature_c) * blend(60.0);
    }
}

/// Power for the electronics alone, watts.
pub(crate) fn avionics_power_w() -> f64 {
    AVIONICS_POWER_W
}

/// Load factor of a coordinated turn at a bank, n = 1/cos φ.
pub(crate) fn load_factor(bank_rad: f64) -> f64 {
    1.0 / bank_rad.cos().max(0.1)
}

/// Turn rate of a coordinated turn, rad/s: ψ̇ = g · tan φ / V.
pub(crate) fn turn_rate_rad_s(bank_rad: f64, airspeed_mps: f64) -> f64 {
    GRAVITY_MPS2 * bank_rad.tan() / airspeed_mps.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn level_cruise_costs_the_cruise_power_and_climbing_what_the_profile_says() {
        let p = Profile::default();
        assert!((demanded_power_w(&p, 25.0, 0.0, 1.0) - 300.0).abs() < 1e-9);
        assert!((demanded_power_w(&p, 25.0, 2.0, 1.0) - 440.0).abs() < 1e-9);
        assert!(demanded_power_w(&p, 25.0, -4.0, 1.0) < 60.0);
        assert!(demanded_power_w(&p, 25.0, 0.0, 1.4) > 300.0);
        assert!(demanded_power_w(&p, 33.0, 0.0, 1.0) > 500.0);
    }

    #[test]
    fn an_empty_battery_stays_empty_and_sags_under_load() {
        let p = Profile::default();
        let mut battery = Battery::full(&p);
        battery.draw(1.0, 300.0);
        assert!(battery.voltage_v < FULL_V && battery.current_a > 11.0);
        battery.draw(1.0e9, 300.0);
        assert_eq!(battery.energy_left_j, 0.0);
        assert_eq!(battery.share(), 0.0);
        assert!(battery.voltage_v < EMPTY_V);
    }

    #[test]
    fn the_engine_warms_up_slowly_and_spins_up_quickly() {
        let p = Profile::default();
        let mut engine = Engine::cold();
        for _ in 0..50 {
            engine.follow(0.1, &p, 300.0);
        }
        assert!((engine.rpm - 6000.0).abs() < 10.0, "{}", engine.rpm);
        assert!(engine.temperature_c > 16.0 && engine.temperature_c < 25.0);
    }
}
