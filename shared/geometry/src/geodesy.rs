//! Positions on WGS84, and the geodesics between them (Karney 2013, by `geographiclib-rs`).

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

static WGS84: LazyLock<Geodesic> = LazyLock::new(Geodesic::wgs84);

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
    pub const fn new(lat_deg: f64, lon_deg: f64) -> Self {
        Self { lat_deg, lon_deg }
    }

    /// Finite, latitude within ±90 and longitude within ±180 degrees.
    pub fn is_valid(self) -> bool {
        self.lat_deg.abs() <= 90.0 && self.lon_deg.abs() <= 180.0
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
pub fn normalise_360(deg: f64) -> f64 {
    let r = deg.rem_euclid(360.0);
    if r >= 360.0 { 0.0 } else { r }
}

/// An angle brought into −180..=180 degrees; angles that are already there stay as they are.
pub fn normalise_180(deg: f64) -> f64 {
    if deg.abs() <= 180.0 {
        return deg;
    }
    let r = (deg + 180.0).rem_euclid(360.0) - 180.0;
    if r == -180.0 && deg > 0.0 { 180.0 } else { r }
}
