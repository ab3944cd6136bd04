//! The state of the path while it is laid out: where it is, which way it goes, how high and how fast.

use flight_plan::AltitudeReference;
use geometry::{LatLon, LocalFrame};
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
pub struct Passing {
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
    pub last: Passing,
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

/// Distance (metres) and direction of travel at the far end (degrees true) from `a` to `b`.
///
/// Below 5 km by a local frame around the middle (error below 1 mm and 0.001°), beyond by the geodesic.
pub fn distance_and_course(a: LatLon, b: LatLon) -> (f64, f64) {
    let dlon = geometry::geodesy::normalise_180(b.lon_deg - a.lon_deg);
    let middle = LatLon::new(0.5 * (a.lat_deg + b.lat_deg), a.lon_deg + 0.5 * dlon);
    let frame = LocalFrame::new(middle);
    let way = frame.to_local(b) - frame.to_local(a);
    let length = way.length();
    if length < 5000.0 && middle.lat_deg.abs() < 85.0 {
        return (length, geometry::geodesy::normalise_360(way.bearing_rad().to_degrees()));
    }
    let geodesic = a.inverse(b);
    (geodesic.distance_m, geodesic.bearing_end_deg)
}

/// Distance between two near or far positions, metres (see [`distance_and_course`]).
pub fn distance_m(a: LatLon, b: LatLon) -> f64 {
    distance_and_course(a, b).0
}
