//! Pure: positions on WGS84, and the geodesics between them (Karney 2013, by `geographiclib-rs`).
//!
//! A crate of its own, so that the service contract has positions without the rest of the geometry.

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

static WGS84: LazyLock<Geodesic> = LazyLock::new(Geodesic::wgs84);

/// Nearer to a pole nothing is flown, degrees of latitude. Autopilots reckon in metres per degree of longitude: 1° from the pole
/// that changes by a tenth within a waypoint or two, and from 89.43° ArduPlane holds it constant. A local frame is good within
/// 9 km there, and not at all at the pole.
pub const MAX_LATITUDE_DEG: f64 = 89.0;
/// What is wrong with a place beyond [`MAX_LATITUDE_DEG`].
pub const NEAR_POLE: &str = "nearer to a pole than 89° of latitude nothing is flown: meridians meet there, and autopilots navigate by \
latitude and longitude; stay within ±89°";

/// A position on the WGS84 ellipsoid, degrees; latitude in −90..=90, longitude in −180..=180.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct LatLon {
    /// Latitude, degrees north.
    pub lat_deg: f64,
    /// Longitude, degrees east.
    pub lon_deg: f64,
}

/// The geodesic between two positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inverse {
    /// Length, metres.
    pub distance_m: f64,
    /// Direction at the start, degrees true in 0..360.
    pub bearing_start_deg: f64,
    /// Direction of travel at the end, degrees true in 0..360.
    pub bearing_end_deg: f64,
}

/// Where a geodesic leads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direct {
    /// The position reached.
    pub position: LatLon,
    /// Direction of travel there, degrees true in 0..360.
    pub bearing_end_deg: f64,
}

impl LatLon {
    /// A position; use [`LatLon::is_valid`] on anything that comes from outside.
    #[inline]
    pub const fn new(lat_deg: f64, lon_deg: f64) -> Self {
        Self { lat_deg, lon_deg }
    }

    /// Finite, latitude within ±90 and longitude within ±180 degrees.
    #[inline]
    pub fn is_valid(self) -> bool {
        self.lat_deg.abs() <= 90.0 && self.lon_deg.abs() <= 180.0
    }

    /// Valid, and far enough from the poles to be flown to: see [`MAX_LATITUDE_DEG`].
    #[inline]
    pub fn is_navigable(self) -> bool {
        self.is_valid() && self.lat_deg.abs() <= MAX_LATITUDE_DEG
    }

    /// The geodesic to `other`.
    pub fn inverse(self, other: LatLon) -> Inverse {
        let (distance_m, azi1, azi2, _): (f64, f64, f64, f64) =
            WGS84.inverse(self.lat_deg, self.lon_deg, other.lat_deg, other.lon_deg);
        Inverse { distance_m, bearing_start_deg: normalise_360(azi1), bearing_end_deg: normalise_360(azi2) }
    }

    /// Geodesic distance to `other`, metres.
    pub fn distance_m(self, other: LatLon) -> f64 {
        self.inverse(other).distance_m
    }

    /// Initial geodesic bearing to `other`, degrees true in 0..360.
    pub fn bearing_deg(self, other: LatLon) -> f64 {
        self.inverse(other).bearing_start_deg
    }

    /// The position `distance_m` metres along the geodesic that leaves at `bearing_deg`.
    pub fn destination(self, bearing_deg: f64, distance_m: f64) -> LatLon {
        let (lat, lon): (f64, f64) = WGS84.direct(self.lat_deg, self.lon_deg, bearing_deg, distance_m);
        LatLon::new(lat, normalise_180(lon))
    }

    /// As [`LatLon::destination`], with the direction of travel at the end. A negative distance
    /// goes backwards along the geodesic; the direction of travel stays that of the forward one.
    pub fn direct(self, bearing_deg: f64, distance_m: f64) -> Direct {
        let (lat, lon, azimuth): (f64, f64, f64) =
            WGS84.direct(self.lat_deg, self.lon_deg, bearing_deg, distance_m);
        Direct { position: LatLon::new(lat, normalise_180(lon)), bearing_end_deg: normalise_360(azimuth) }
    }

    /// The point of the geodesic to `other` at a fraction of its length (0: here, 1: `other`).
    pub fn interpolate(self, other: LatLon, fraction: f64) -> LatLon {
        let line = self.inverse(other);
        self.destination(line.bearing_start_deg, line.distance_m * fraction)
    }
}

/// An angle brought into 0..360 degrees.
#[inline]
pub fn normalise_360(deg: f64) -> f64 {
    let r = deg.rem_euclid(360.0);
    if r >= 360.0 { 0.0 } else { r }
}

/// An angle brought into −180..=180 degrees; angles that are already there stay as they are.
#[inline]
pub fn normalise_180(deg: f64) -> f64 {
    if deg.abs() <= 180.0 {
        return deg;
    }
    let r = (deg + 180.0).rem_euclid(360.0) - 180.0;
    if r == -180.0 && deg > 0.0 { 180.0 } else { r }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::excessive_precision, reason = "the published figures are kept as they are printed")]
    use super::*;
    use proptest::prelude::*;

    /// From GeographicLib's published test set (Karney, geodesic test cases):
    /// lat1, lon1, azi1, lat2, lon2, azi2, s12.
    const PUBLISHED: [[f64; 7]; 7] = [
        [-21.97856, 142.59065, -32.44456876433189, 41.84138, 98.56635, -41.84359951440466, 8394328.894657671],
        [
            -66.99028,
            112.2363,
            173.73491240878403,
            -12.70631,
            285.90344,
            2.512956620913668,
            11150344.2312080241,
        ],
        [
            -17.42761,
            173.34268,
            -159.033557661192928,
            -15.84784,
            5.93557,
            -20.787484651536988,
            16076603.1631180673,
        ],
        [-68.82867, -74.28391, 93.774347763114881, -50.63005, -8.36685, 34.65564085411343, 3956936.926063544],
        [
            -19.79938,
            -174.47484,
            71.167275780171533,
            -11.99349,
            -154.35109,
            65.589099775199228,
            2319004.8601169389,
        ],
        [
            -87.85331,
            85.66836,
            -65.120313040242748,
            66.48646,
            16.09921,
            -4.888658719272296,
            17286615.3147144645,
        ],
        [
            1.74708,
            128.32011,
            -101.584843631173858,
            -11.16617,
            11.87109,
            -86.325793296437476,
            12942901.1241347408,
        ],
    ];

    #[test]
    fn published_geodesics() {
        for [lat1, lon1, azi1, lat2, lon2, azi2, s12] in PUBLISHED {
            let (a, b) = (LatLon::new(lat1, lon1), LatLon::new(lat2, normalise_180(lon2)));
            let way = a.inverse(b);
            assert!((way.distance_m - s12).abs() < 1e-6, "{way:?}");
            assert!((way.bearing_start_deg - normalise_360(azi1)).abs() < 1e-10, "{way:?}");
            assert!((way.bearing_end_deg - normalise_360(azi2)).abs() < 1e-10, "{way:?}");
            let there = a.direct(azi1, s12);
            assert!(there.position.distance_m(b) < 1e-6, "{there:?}");
            assert!((there.bearing_end_deg - normalise_360(azi2)).abs() < 1e-10);
        }
    }

    #[test]
    fn across_the_antimeridian_and_over_a_pole() {
        let way = LatLon::new(0.0, 179.5).inverse(LatLon::new(0.0, -179.5));
        assert!((way.distance_m - 111_319.490_793).abs() < 1e-3);
        assert_eq!(way.bearing_start_deg, 90.0);
        let over = LatLon::new(89.9, 0.0).direct(0.0, 22_338.78);
        assert!((over.position.lat_deg - 89.9).abs() < 1e-4);
        assert!((over.position.lon_deg.abs() - 180.0).abs() < 1e-9);
        assert!((over.bearing_end_deg - 180.0).abs() < 1e-9);
        let west = LatLon::new(10.0, -179.99).destination(270.0, 5_000.0);
        assert!(west.is_valid() && west.lon_deg > 179.9);
    }

    #[test]
    fn garbage_is_no_position_and_does_not_panic() {
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
            assert!(!LatLon::new(bad, 0.0).is_valid());
            assert!(!LatLon::new(0.0, bad).is_valid());
            let _ = LatLon::new(bad, bad).inverse(LatLon::new(0.0, bad));
            let _ = LatLon::new(0.0, bad).direct(bad, bad);
            let _ = (normalise_180(bad), normalise_360(bad));
        }
        assert!(!LatLon::new(90.000_001, 0.0).is_valid());
        for (lat, navigable) in
            [(89.0, true), (-89.0, true), (89.000_1, false), (-90.0, false), (f64::NAN, false)]
        {
            assert_eq!(LatLon::new(lat, 10.0).is_navigable(), navigable, "{lat}");
        }
    }

    #[test]
    fn angles_are_brought_into_range() {
        for (deg, in_360, in_180) in [
            (0.0, 0.0, 0.0),
            (-90.0, 270.0, -90.0),
            (360.0, 0.0, 0.0),
            (540.0, 180.0, 180.0),
            (-540.0, 180.0, -180.0),
            (719.0, 359.0, -1.0),
            (-1e-20, 0.0, -1e-20),
        ] {
            assert_eq!((normalise_360(deg), normalise_180(deg)), (in_360, in_180), "{deg}");
        }
    }

    proptest! {
        #[test]
        fn inverse_undoes_direct(
            lat in -90.0..90.0, lon in -180.0..180.0, bearing in 0.0..360.0, metres in 1.0..500_000.0,
        ) {
            let from = LatLon::new(lat, lon);
            let to = from.direct(bearing, metres);
            let back = from.inverse(to.position);
            prop_assert!((back.distance_m - metres).abs() < 1e-6);
            let turn = normalise_180(back.bearing_start_deg - bearing);
            prop_assert!(turn.to_radians().abs() * metres < 1e-5, "{turn}");
            prop_assert!(from.destination(back.bearing_start_deg, metres).distance_m(to.position) < 1e-5);
        }

        #[test]
        fn interpolation_divides_the_geodesic(
            lat1 in -89.0..89.0, lat2 in -89.0..89.0, lon in -180.0..180.0, share in 0.0..1.0,
        ) {
            let (a, b) = (LatLon::new(lat1, 170.0), LatLon::new(lat2, lon));
            let whole = a.distance_m(b);
            prop_assume!(whole < 15e6);
            let p = a.interpolate(b, share);
            prop_assert!((a.distance_m(p) - whole * share).abs() < 1e-4);
            prop_assert!((p.distance_m(b) - whole * (1.0 - share)).abs() < 1e-4);
        }
    }
}
