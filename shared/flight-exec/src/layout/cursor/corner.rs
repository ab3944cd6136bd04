//! Corners of patterns that are crossed: a turn ahead of time would leave out too much, or has no room.

use geometry::geodesy::normalise_180;
use geometry::{LatLon, Vec2};

/// A fly-by of a sharper turn than 127° begins more than two radii before its corner: such a corner is crossed. Its cosine.
const SHARP_COS: f64 = -0.601_815;
/// On the sphere.
const METRES_A_DEGREE: f64 = 111_195.0;
/// A shorter way has no direction: there is no corner at its end, metres.
const NO_WAY_M: f64 = 1e-3;

/// Where the path turns so sharply at the middle position that a turn of radius `radius_m` (metres) ahead of time would leave out far
/// too much, or where the ways before and after it have no room for the turn. In the plane: a degree more or less is nothing.
///
/// There is room if the turn's tangent is not longer than both ways together, as in the check of turns that the gateway and the review
/// do. Of a turn that begins a little before the one way, or ends behind the other, the path is left for a moment; crossed, each corner
/// of a small loop or of a short way between two tracks would be overshot.
pub fn is_to_be_crossed([from, at, next]: [LatLon; 3], radius_m: f64) -> bool {
    let shrunk = at.lat_deg.to_radians().cos();
    let way = |a: LatLon, b: LatLon| {
        Vec2::new(normalise_180(b.lon_deg - a.lon_deg) * shrunk, b.lat_deg - a.lat_deg) * METRES_A_DEGREE
    };
    let (before, after) = (way(from, at), way(at, next));
    let (before_m, after_m) = (before.length(), after.length());
    if before_m.min(after_m) < NO_WAY_M {
        return false;
    }
    let cos = before.dot(after) / (before_m * after_m);
    // the tangent of half the angle
    let need_m = radius_m * ((1.0 - cos).max(0.0) / (1.0 + cos)).sqrt();
    cos < SHARP_COS || need_m > before_m + after_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_crossed_that_are_sharp_or_have_no_room_on_both_ways_together() {
        let at = LatLon::new(36.5, -84.2);
        // a right angle needs its radius before and after it
        for (before_m, after_m, turned_deg, radius_m, crossed) in [
            (300.0, 300.0, 90.0, 150.0, false),
            (20.0, 300.0, 90.0, 150.0, false),
            (300.0, 20.0, 90.0, 150.0, false),
            (20.0, 120.0, 90.0, 150.0, true),
            (100.0, 100.0, 90.0, 190.0, false),
            (100.0, 100.0, 90.0, 210.0, true),
            (900.0, 900.0, 126.0, 150.0, false),
            (900.0, 900.0, 128.0, 150.0, true),
            (900.0, 900.0, 180.0, 1.0, true),
            (20.0, 20.0, 0.0, 150.0, false),
            (0.0, 300.0, 90.0, 1000.0, false),
            (300.0, 0.0, 90.0, 1000.0, false),
        ] {
            let way = [at.destination(180.0, before_m), at, at.destination(turned_deg, after_m)];
            let case = (before_m, after_m, turned_deg, radius_m);
            assert_eq!(is_to_be_crossed(way, radius_m), crossed, "{case:?}");
        }
    }
}
