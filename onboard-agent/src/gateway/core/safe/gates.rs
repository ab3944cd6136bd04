//! Places on a way to a runway with what is told there, circles of them, and whether such a way leads above the ground.
//!
//! The autopilot flies straight from altitude to altitude.

use super::{Situation, along};
use aircraft::glide::Circle;
use geometry::LatLon;

/// Waypoints of a circle.
pub(super) const CORNERS: u32 = 8;

/// A place on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gate {
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// A corner of a circle.
    pub on_arc: bool,
}

/// A place, and circles from there and back to it in line with a course, evenly from one altitude to another, metres AMSL.
pub(super) fn circles(
    at: LatLon,
    (course_deg, right): (f64, bool),
    count: u32,
    (from_m, to_m): (f64, f64),
    s: &Situation,
) -> Vec<Gate> {
    let side = if right { 1.0 } else { -1.0 };
    let radius_m = Circle::of(s.profile, s.wind()).radius_m;
    let centre = at.destination(course_deg + 90.0 * side, radius_m);
    let corners = count * CORNERS;
    let corner = |i: u32| {
        let turned_deg = 360.0 * f64::from(i % CORNERS) / f64::from(CORNERS);
        let position = match i % CORNERS {
            0 => at,
            _ => centre.destination(course_deg + side * (turned_deg - 90.0), radius_m),
        };
        let share = if corners == 0 { 1.0 } else { f64::from(i) / f64::from(corners) };
        let altitude_amsl_m = from_m + share * (to_m - from_m);
        Gate { position, altitude_amsl_m, on_arc: corners > 0 }
    };
    (0..=corners).map(corner).collect()
}

/// It stays above all ground that is known until the last gate, by the altitudes that it is told: by so much as is asked for at one of
/// them, metres.
pub(super) fn is_over_ground(gates: &[Gate], s: &Situation, clearance_m: impl Fn(f64) -> f64) -> bool {
    let Some(terrain) = s.terrain else { return true };
    let mut from = (s.position, s.altitude_amsl_m);
    gates.iter().all(|gate| {
        let ((start, start_m), end_m) = (from, gate.altitude_amsl_m);
        from = (gate.position, end_m);
        along(start, gate.position).all(|(share, place)| {
            let height_m = start_m + share * (end_m - start_m);
            terrain.elevation_m(place).is_none_or(|ground_m| height_m > ground_m + clearance_m(height_m))
        })
    })
}
