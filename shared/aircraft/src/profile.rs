//! What an aircraft can do.

use serde::{Deserialize, Serialize};

/// Performance of a fixed-wing aircraft. SI units; airspeeds are true airspeeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// What a plan's `aircraft` attribute names.
    pub name: String,
    /// Slowest safe airspeed, m/s.
    pub min_airspeed_mps: f64,
    /// Usual airspeed, m/s.
    pub cruise_airspeed_mps: f64,
    /// Fastest airspeed, m/s.
    pub max_airspeed_mps: f64,
    /// Bank used for planning turns, degrees.
    pub planning_bank_deg: f64,
    /// Steepest bank the autopilot commands, degrees.
    pub max_bank_deg: f64,
    /// Time constant of the bank response, s.
    pub bank_time_constant_s: f64,
    /// Best climb, m/s.
    pub max_climb_mps: f64,
    /// Steepest descent, m/s (positive).
    pub max_descent_mps: f64,
    /// Highest altitude, metres AMSL.
    pub ceiling_amsl_m: f64,
    /// Usable energy, joules.
    pub energy_j: f64,
    /// Power in level cruise, watts.
    pub cruise_power_w: f64,
    /// Extra power per m/s of climb, watts.
    pub climb_power_w_per_mps: f64,
    /// Best glide ratio with the engine out.
    pub glide_ratio: f64,
    /// Shortest runway it can use, metres.
    pub min_runway_m: f64,
}

impl Default for Profile {
    /// The trainer: a 25 m/s electric aeroplane of about 7 kg, two hours and a half of energy.
    fn default() -> Self {
        Self {
            name: "trainer".into(),
            min_airspeed_mps: 16.0,
            cruise_airspeed_mps: 25.0,
            max_airspeed_mps: 35.0,
            planning_bank_deg: 25.0,
            max_bank_deg: 45.0,
            bank_time_constant_s: 0.4,
            max_climb_mps: 4.0,
            max_descent_mps: 4.0,
            ceiling_amsl_m: 3000.0,
            energy_j: 3.0e6,
            cruise_power_w: 300.0,
            climb_power_w_per_mps: 70.0,
            glide_ratio: 12.0,
            min_runway_m: 150.0,
        }
    }
}
