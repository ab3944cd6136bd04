//! The plane a leg is flown in: metres east and north of the leg's start, such that geodesics are
//! straight to well below the accuracy of flight.

use geometry::geodesy::normalise_180;
use geometry::{LatLon, Vec2};

const EQUATORIAL_RADIUS_M: f64 = 6_378_137.0;
const ECCENTRICITY_SQUARED: f64 = 0.006_694_379_990_141_316;

/// A transverse-Mercator-like plane around an origin, series to the second order (Snyder 1987,
/// *Map Projections*, eqs. 8-9 and 8-10 cut short). Within 20 km the geodesic between two points stays
/// within 0.1 m of the straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    origin: LatLon,
    meridional_radius_m: f64,
    /// Relative growth of the meridional radius per radian of latitude.
    meridional_growth: f64,
}

impl Plane {
    pub(super) fn around(origin: LatLon) -> Self {
        let (sin, cos) = origin.lat_deg.to_radians().sin_cos();
        let w2 = 1.0 - ECCENTRICITY_SQUARED * sin * sin;
        Self {
            origin,
            meridional_radius_m: EQUATORIAL_RADIUS_M * (1.0 - ECCENTRICITY_SQUARED) / (w2 * w2.sqrt()),
            meridional_growth: 3.0 * ECCENTRICITY_SQUARED * sin * cos / w2,
        }
    }

    /// Metres east and north of the origin, and the angle of true north there, radians anticlockwise
    /// from the plane's north.
    pub(super) fn project(&self, p: LatLon) -> (Vec2, f64) {
        let (sin, cos) = p.lat_deg.to_radians().sin_cos();
        let dlat = (p.lat_deg - self.origin.lat_deg).to_radians();
        let dlon = normalise_180(p.lon_deg - self.origin.lon_deg).to_radians();
        let transverse_m = EQUATORIAL_RADIUS_M / (1.0 - ECCENTRICITY_SQUARED * sin * sin).sqrt() * cos;
        let along_meridian_m = self.meridional_radius_m * dlat * (1.0 + 0.5 * self.meridional_growth * dlat);
        let east = transverse_m * dlon;
        (Vec2::new(east, along_meridian_m + 0.5 * east * sin * dlon), dlon * sin)
    }

    /// A vector given in true east and north at a point with that convergence, in the plane's axes.
    pub(super) fn rotate(true_vector: Vec2, convergence_rad: f64) -> Vec2 {
        let (sin, cos) = convergence_rad.sin_cos();
        Vec2::new(true_vector.e * cos - true_vector.n * sin, true_vector.e * sin + true_vector.n * cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn geodesics_are_straight_lines_of_their_length() {
        for (lat, bearing) in [(36.5, 90.0), (36.5, 45.0), (-60.0, 250.0), (0.0, 10.0), (70.0, 80.0)] {
            let from = LatLon::new(lat, 179.95);
            let plane = Plane::around(from);
            let (end, _) = plane.project(from.destination(bearing, 20_000.0));
            assert!((end.length() - 20_000.0).abs() < 0.5, "{lat} {bearing}: {}", end.length());
            let along = end * (1.0 / end.length());
            for metres in [2_000.0, 10_000.0, 15_000.0] {
                let (p, _) = plane.project(from.destination(bearing, metres));
                assert!(along.cross(p).abs() < 0.1, "{lat} {bearing} {metres}: {}", along.cross(p));
            }
        }
    }

    #[test]
    fn convergence_turns_the_true_course_into_the_lines_direction() {
        let from = LatLon::new(50.0, 10.0);
        let plane = Plane::around(from);
        let geodesic = from.inverse(from.destination(70.0, 20_000.0));
        let (end, convergence) = plane.project(from.destination(70.0, 20_000.0));
        let course = Vec2::from_bearing_rad(geodesic.bearing_end_deg.to_radians());
        let in_plane = Plane::rotate(course, convergence);
        assert!((in_plane.bearing_rad() - end.bearing_rad()).abs() < 1e-5);
    }
}
