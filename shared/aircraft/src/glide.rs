//! The glide after an engine failure: at the cruise speed with the best glide ratio, in the wind, with more sink in the turns from
//! track to track.

use crate::power::glide_sink_mps;
use crate::{Profile, Winds};
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use geometry::near::distance_and_course;
use serde::{Deserialize, Serialize};

/// A point of a glide.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GlidePoint {
    /// Seconds since the engine failed.
    pub time_s: f64,
    /// Where.
    pub position: LatLon,
    /// Metres AMSL; may be below the ground.
    pub altitude_amsl_m: f64,
}

/// Where a glide begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlideStart {
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Where it flies to, degrees true.
    pub course_deg: f64,
}

/// The glide through some places, with a point at each, and at the last one in line with a runway; `None`: against the wind it does
/// not get there.
pub fn glide(
    profile: &Profile,
    winds: Winds,
    from: GlideStart,
    way: &[LatLon],
    runway_heading_deg: f64,
) -> Option<Vec<GlidePoint>> {
    let speed_mps = profile.cruise_airspeed_mps;
    let sink_mps = glide_sink_mps(profile, speed_mps, 1.0);
    let load_factor = 1.0 / profile.planning_bank_deg.to_radians().cos();
    let turning_mps = glide_sink_mps(profile, speed_mps, load_factor);
    let turn_s_per_rad = profile.turn_radius_m(speed_mps) / speed_mps;
    let GlideStart { position, altitude_amsl_m, mut course_deg } = from;
    let mut here = GlidePoint { time_s: 0.0, position, altitude_amsl_m };
    let mut points = vec![here];
    let turn = |at: &mut GlidePoint, from_deg: f64, to_deg: f64| {
        let turn_s = turn_rad(from_deg, to_deg) * turn_s_per_rad;
        at.time_s += turn_s;
        at.altitude_amsl_m -= turn_s * turning_mps;
    };
    for place in way {
        let (distance_m, arrives_deg) = distance_and_course(here.position, *place);
        if distance_m < 1.0 {
            continue;
        }
        let ground_mps = winds.at(here.altitude_amsl_m).ground_speed_mps(speed_mps, arrives_deg)?;
        here.time_s += distance_m / ground_mps;
        here.altitude_amsl_m -= distance_m / ground_mps * sink_mps;
        turn(&mut here, course_deg, arrives_deg);
        here.position = *place;
        course_deg = arrives_deg;
        points.push(here);
    }
    if let Some(last) = points.last_mut() {
        turn(last, course_deg, runway_heading_deg);
    }
    Some(points)
}

/// Angle between two courses, radians in 0..=π.
pub fn turn_rad(from_deg: f64, to_deg: f64) -> f64 {
    normalise_180(to_deg - from_deg).abs().to_radians()
}
