//! Distances between places that are mostly near: quicker than the geodesic where that makes no difference.

use crate::geodesy::normalise_180;
use crate::{LatLon, Vec2};

/// Farther than this distances are those of geodesics, metres.
const NEAR_M: f64 = 10_000.0;
/// WGS84.
const EQUATORIAL_RADIUS_M: f64 = 6_378_137.0;
const ECCENTRICITY_SQUARED: f64 = 0.006_694_379_990_141_316;

/// Distance (metres) and direction of travel at the far end (degrees true) from `a` to `b`.
///
/// Below 10 km by Gauss's formulas of the middle latitude (Jordan/Eggert/Kneissl, *Handbuch der Vermessungskunde* IV; on the
/// sphere those of Delambre, to the third order: error below 5 mm and 0.01°), beyond by the geodesic.
pub fn distance_and_course(a: LatLon, b: LatLon) -> (f64, f64) {
    let dlat = (b.lat_deg - a.lat_deg).to_radians();
    let dlon = normalise_180(b.lon_deg - a.lon_deg).to_radians();
    let middle_deg = 0.5 * (a.lat_deg + b.lat_deg);
    let (sin, cos) = middle_deg.to_radians().sin_cos();
    let w2 = 1.0 - ECCENTRICITY_SQUARED * sin * sin;
    let across_m = EQUATORIAL_RADIUS_M / w2.sqrt();
    let along_m = across_m * (1.0 - ECCENTRICITY_SQUARED) / w2;
    let (dlat2, dlon2) = (dlat * dlat, dlon * dlon);
    let north_m = along_m * dlat * (1.0 - dlon2 * (2.0 + sin * sin) / 24.0);
    let east_m = across_m * cos * dlon * (1.0 + (dlat2 - dlon2 * sin * sin) / 24.0);
    let way = Vec2::new(east_m, north_m);
    let length_m = way.length();
    if length_m < NEAR_M && middle_deg.abs() < 80.0 {
        // the mean of the directions at both ends, and half of what the meridians converge by
        let course_rad = way.bearing_rad() + 0.5 * dlon * sin;
        return (length_m, geodesy::normalise_360(course_rad.to_degrees()));
    }
    let geodesic = a.inverse(b);
    (geodesic.distance_m, geodesic.bearing_end_deg)
}

/// Distance between two near or far positions, metres (see [`distance_and_course`]).
pub fn distance_m(a: LatLon, b: LatLon) -> f64 {
    distance_and_course(a, b).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_by_the_middle_latitude_agrees_with_the_geodesic() {
        for lat_deg in [-85.0, -79.0, -36.5, 0.0, 47.0, 70.0, 89.0] {
            for (bearing_deg, metres) in [(3.0, 40.0), (90.0, 9_900.0), (233.0, 5_100.0), (359.0, 9_900.0)] {
                let from = LatLon::new(lat_deg, 179.99);
                let to = from.destination(bearing_deg, metres);
                let exact = from.inverse(to);
                let (distance_m, course_deg) = distance_and_course(from, to);
                let off_deg = normalise_180(course_deg - exact.bearing_end_deg);
                assert!(
                    (distance_m - exact.distance_m).abs() < 5e-3,
                    "{lat_deg} {bearing_deg} {metres}: {distance_m}"
                );
                assert!(off_deg.abs() < 0.01, "{lat_deg} {bearing_deg} {metres}: {off_deg}");
            }
        }
    }
}
