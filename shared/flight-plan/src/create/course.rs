//! How the path arrives where something new begins.

use crate::TurnDirection;
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// Where the path is before something new, and which way it goes there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// Where.
    pub from: LatLon,
    /// Degrees true; `None`: not known.
    pub course_deg: Option<f64>,
}

/// Less than that to the side is straight on: no arc leads there, degrees.
const STRAIGHT_DEG: f64 = 2.0;

/// Centre and direction of the arc to a place that begins along the path's course; `None`: the place is straight ahead or
/// behind.
pub fn arc_centre(approach: &Approach, to: LatLon) -> Option<(LatLon, TurnDirection)> {
    let frame = geometry::LocalFrame::new(approach.from);
    let chord = frame.to_local(to);
    let bearing_deg = approach.from.bearing_deg(to);
    let course_deg = approach.course_deg.unwrap_or(bearing_deg - 45.0);
    let aside_deg = normalise_180(bearing_deg - course_deg);
    if !(STRAIGHT_DEG..=180.0 - STRAIGHT_DEG).contains(&aside_deg.abs()) {
        return None;
    }
    let (turn, side_deg) =
        if aside_deg > 0.0 { (TurnDirection::Right, 90.0) } else { (TurnDirection::Left, -90.0) };
    let normal = geometry::Vec2::from_bearing_rad((course_deg + side_deg).to_radians());
    let radius_m = chord.dot(chord) / (2.0 * chord.dot(normal));
    Some((frame.to_geo(normal * radius_m), turn))
}
