//! Numbers that shape how a plan is flown; the defaults suit a small fixed-wing aircraft.

use serde::{Deserialize, Serialize};

/// Settings of an [`crate::Executor`]. Constant for a flight: a snapshot is restored with the same ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Config {
    /// Most waypoints issued ahead of the aircraft.
    pub horizon_waypoints: usize,
    /// Seconds of flight issued ahead of the waypoints that come next, if that takes fewer waypoints (at least 60).
    pub horizon_s: f64,
    /// Fewest waypoints ahead, however long their legs are: the gateway wants three in its buffer.
    pub least_waypoints: usize,
    /// Greatest distance between an arc and its waypoints' polygon, metres.
    pub arc_tolerance_m: f64,
    /// Seconds from an order here to its effect in the autopilot: part of the stopping distance.
    pub latency_s: f64,
    /// Turns of holdings and turn-rounds are laid out for the leg's airspeed plus this wind, m/s.
    pub design_wind_mps: f64,
    /// Least time between two regenerations after changed variables, seconds.
    pub debounce_s: f64,
    /// How often conditions that read the flight (battery, time, …) are read again, seconds.
    pub review_s: f64,
    /// A decision is asked for when it is due within this, seconds.
    pub ask_ahead_s: f64,
    /// An altitude counts as reached this close to it, metres: fifty feet, a few seconds of climb, less than a lap is worth.
    pub altitude_tolerance_m: f64,
    /// Slope of the final approach, degrees.
    pub glide_slope_deg: f64,
    /// Least length of the final approach, metres.
    pub final_approach_m: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            horizon_waypoints: 24,
            horizon_s: 120.0,
            least_waypoints: 5,
            arc_tolerance_m: 3.0,
            latency_s: 1.5,
            design_wind_mps: aircraft::DESIGN_WIND_MPS,
            debounce_s: 1.0,
            review_s: 1.0,
            ask_ahead_s: 120.0,
            altitude_tolerance_m: 15.0,
            glide_slope_deg: 4.5,
            final_approach_m: aircraft::glide_in::FINAL_M,
        }
    }
}
