//! The state of the path while it is laid out: where it is, which way it goes, how high and how fast.

use flight_plan::AltitudeReference;
use geometry::LatLon;
pub use geometry::near::{distance_and_course, distance_m};
use serde::{Deserialize, Serialize};

/// A wanted altitude with its datum, numbers only.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Metres.
    pub metres: f64,
    /// Above what.
    pub reference: AltitudeReference,
}

/// A point that the path passes: what belongs to the waypoint and not to the leg.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PathEnd {
    /// Where.
    pub position: LatLon,
    /// How high.
    pub level: Level,
    /// Airspeed towards it, m/s.
    pub airspeed_mps: f64,
    /// Crossed before turning.
    pub fly_over: bool,
}

/// The end of the path laid out so far.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PathState {
    /// The last point.
    pub last: PathEnd,
    /// Direction of travel there, degrees true.
    pub course_deg: f64,
    /// Altitude the aircraft can have there, given its climb, metres AMSL.
    pub predicted_amsl_m: f64,
    /// Altitude of the last waypoint as it is commanded, ahead of the predicted one in a climb, metres AMSL.
    pub commanded_amsl_m: f64,
    /// Path length since the start of the flight, metres.
    pub distance_m: f64,
    /// Flying time for it without wind, seconds.
    pub time_s: f64,
}
