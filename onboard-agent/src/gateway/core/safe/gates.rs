//! Places on a way to a runway with what is told there, circles of them, and whether such a way leads above the ground.
//!
//! The autopilot flies straight from altitude to altitude.

use super::Situation;
use super::ground::along_high;
use aircraft::glide::Circle;
use geometry::LatLon;
use geometry::near::distance_m;

/// Waypoints of a circle.
pub(super) const CORNERS: u32 = 8;
/// Radii of a turn within which an aircraft has turned to where it is going.
const TURNED_RADII: f64 = 4.0;
/// It climbs away from what is low beneath it by this share of its speed over the ground: half of what the least able aircraft is told to.
const AWAY: f64 = 0.05;

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

/// Circles that are flown for a change of height.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circles {
    pub count: u32,
    /// Metres.
    pub radius_m: f64,
    /// Clockwise.
    pub right: bool,
}

impl Circles {
    /// As many as it takes for a height at a rate, in metres and m/s; where that would be too many, so many wider ones.
    pub fn at_rate((height_m, mps): (f64, f64), most: u32, right: bool, s: &Situation) -> Self {
        let circle = Circle::of(s.profile, s.wind());
        let count = (height_m / (mps * circle.time_s)).ceil().max(1.0);
        let wider = (count / f64::from(most)).max(1.0);
        Self { count: (count / wider).ceil() as u32, radius_m: circle.radius_m * wider, right }
    }

    /// From a place on a course and back to it, evenly from one altitude to another, metres AMSL.
    pub fn gates(&self, at: LatLon, course_deg: f64, (from_m, to_m): (f64, f64)) -> Vec<Gate> {
        let side = if self.right { 1.0 } else { -1.0 };
        let centre = at.destination(course_deg + 90.0 * side, self.radius_m);
        let corners = self.count * CORNERS;
        let corner = |i: u32| {
            let turned_deg = 360.0 * f64::from(i % CORNERS) / f64::from(CORNERS);
            let position = match i % CORNERS {
                0 => at,
                _ => centre.destination(course_deg + side * (turned_deg - 90.0), self.radius_m),
            };
            let share = if corners == 0 { 1.0 } else { f64::from(i) / f64::from(corners) };
            let altitude_amsl_m = from_m + share * (to_m - from_m);
            Gate { position, altitude_amsl_m, on_arc: corners > 0 }
        };
        (0..=corners).map(corner).collect()
    }
}

/// How far it flies until it has turned to where it is going, metres.
pub(super) fn turned_m(s: &Situation) -> f64 {
    TURNED_RADII * s.profile.turn_radius_m(s.profile.cruise_airspeed_mps)
}

/// How much clearance can be asked for at a place, metres: an aircraft that flies low, or where the elevation model is too high, has
/// first to turn and to climb away from there.
fn possible_m(s: &Situation, has_m: f64, asked_m: f64, place: LatLon) -> f64 {
    if asked_m <= has_m {
        return asked_m;
    }
    asked_m.min(has_m + AWAY * (distance_m(s.position, place) - turned_m(s)).max(0.0))
}

/// It stays above all ground that is known until the last gate, by the altitudes that it is told: by so much as is asked for at one of
/// them, metres (no less at a higher one), and possible there.
pub(super) fn is_over_ground(gates: &[Gate], s: &Situation, asked_m: impl Fn(f64) -> f64) -> bool {
    let Some(terrain) = s.terrain else { return true };
    // it is there, whatever the elevation model says
    let has_m = terrain.elevation_m(s.position).map_or(f64::INFINITY, |m| s.altitude_amsl_m - m - 1.0);
    let mut from = (s.position, s.altitude_amsl_m);
    gates.iter().all(|gate| {
        let ((start, start_m), end_m) = (from, gate.altitude_amsl_m);
        from = (gate.position, end_m);
        let height_m = |share: f64| start_m + share * (end_m - start_m);
        let most_asked_m = asked_m(start_m.max(end_m));
        let is_low = |most_m: f64, shares: [f64; 2]| {
            let [begins_m, ends_m] = shares.map(height_m);
            begins_m.min(ends_m) > most_m + most_asked_m
        };
        along_high(terrain, start, gate.position, is_low).all(|(share, place)| {
            let height_m = height_m(share);
            let clear_m = || possible_m(s, has_m, asked_m(height_m), place);
            terrain.elevation_m(place).is_none_or(|ground_m| height_m > ground_m + clear_m())
        })
    })
}
