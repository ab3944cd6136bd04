//! A flat frame around an origin: metres east and north.

mod series;

use crate::LatLon;
use crate::geodesy::normalise_180;
use serde::{Deserialize, Serialize};
use series::{Even, Odd};

/// Metres east and north of a frame's origin.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Vec2 {
    /// East, metres.
    pub e: f64,
    /// North, metres.
    pub n: f64,
}

impl Vec2 {
    /// From its components.
    pub const fn new(e: f64, n: f64) -> Self {
        Self { e, n }
    }
    /// Length, metres.
    pub fn length(self) -> f64 {
        // metres never overflow a square: the guard of `hypot` would only cost
        self.dot(self).sqrt()
    }
    /// Unit vector that points along a bearing (radians, clockwise from north).
    pub fn from_bearing_rad(bearing_rad: f64) -> Self {
        Self::new(bearing_rad.sin(), bearing_rad.cos())
    }
    /// Bearing of this vector, radians clockwise from north in −π..=π.
    pub fn bearing_rad(self) -> f64 {
        self.e.atan2(self.n)
    }
    /// Dot product.
    pub fn dot(self, o: Vec2) -> f64 {
        self.e * o.e + self.n * o.n
    }
    /// Cross product (positive: `o` is counter-clockwise, to the left, of `self`).
    pub fn cross(self, o: Vec2) -> f64 {
        self.e * o.n - self.n * o.e
    }
}

impl std::ops::Add for Vec2 {
    type Output = Vec2;
    fn add(self, o: Vec2) -> Vec2 {
        Vec2::new(self.e + o.e, self.n + o.n)
    }
}
impl std::ops::Sub for Vec2 {
    type Output = Vec2;
    fn sub(self, o: Vec2) -> Vec2 {
        Vec2::new(self.e - o.e, self.n - o.n)
    }
}
impl std::ops::Mul<f64> for Vec2 {
    type Output = Vec2;
    fn mul(self, k: f64) -> Vec2 {
        Vec2::new(self.e * k, self.n * k)
    }
}

/// Farthest from its origin that any frame may be used, metres; see [`LocalFrame::radius_m`].
pub const RADIUS_M: f64 = 100_000.0;
/// Greatest error inside [`LocalFrame::radius_m`], metres; tested against GeographicLib.
pub const ERROR_M: f64 = 0.1;
/// Inside this radius, up to [`EXACT_LATITUDE_DEG`], the error is below [`EXACT_ERROR_M`].
pub const EXACT_RADIUS_M: f64 = 10_000.0;
/// Greatest error inside [`EXACT_RADIUS_M`], metres; tested against GeographicLib.
pub const EXACT_ERROR_M: f64 = 1e-5;
/// North and south of this latitude frames lose accuracy, degrees.
pub const EXACT_LATITUDE_DEG: f64 = 85.0;

/// A local frame: azimuthal equidistant on the WGS84 ellipsoid.
///
/// Distance and bearing of a point from the origin are those of the geodesic. Between two other
/// points a distance d far from the origin they differ by a share of about (d / 6400 km)² / 6. No
/// geodesic is solved: both directions are power series of fifth order, good to
/// [`EXACT_ERROR_M`] near by and to [`ERROR_M`] inside [`LocalFrame::radius_m`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalFrame {
    origin: LatLon,
    /// Radius of curvature across the meridian, metres.
    prime_vertical_m: f64,
    /// Radius of the parallel by that.
    cos_lat: f64,
    to_north: Even,
    to_east: Odd,
    to_lat: Even,
    to_lon: Odd,
}

impl LocalFrame {
    /// The frame around `origin`.
    pub fn new(origin: LatLon) -> Self {
        let (a, e2) = (6_378_137.0_f64, 0.006_694_379_990_141_316_f64);
        let (sin_lat, cos_lat) = origin.lat_deg.to_radians().sin_cos();
        let t = sin_lat / cos_lat;
        let h = e2 / (1.0 - e2) * cos_lat * cos_lat;
        Self {
            origin,
            prime_vertical_m: a / (1.0 - e2 * sin_lat * sin_lat).sqrt(),
            cos_lat,
            to_north: series::north(t, h),
            to_east: series::east(t, h),
            to_lat: series::latitude(t, h),
            to_lon: series::longitude(t, h),
        }
    }

    /// The frame in the middle of positions, across the antimeridian too; `None` without any.
    pub fn around(positions: &[LatLon]) -> Option<Self> {
        let first = *positions.first()?;
        let (mut south, mut north, mut west, mut east) = (first.lat_deg, first.lat_deg, 0.0, 0.0);
        for p in positions {
            let lon = normalise_180(p.lon_deg - first.lon_deg);
            (south, north) = (p.lat_deg.min(south), p.lat_deg.max(north));
            (west, east) = (lon.min(west), lon.max(east));
        }
        let lon_deg = normalise_180(first.lon_deg + (west + east) / 2.0);
        Some(Self::new(LatLon::new((south + north) / 2.0, lon_deg)))
    }

    /// Where (0, 0) is.
    pub fn origin(&self) -> LatLon {
        self.origin
    }

    /// How far from the origin the error stays below [`ERROR_M`], metres: [`RADIUS_M`] up to
    /// some 80° of latitude, less towards the poles, where the series fail.
    pub fn radius_m(&self) -> f64 {
        let tan_lat = self.origin.lat_deg.to_radians().tan().abs();
        RADIUS_M.min(0.08 * self.prime_vertical_m / tan_lat)
    }

    /// Metres east and north of the origin.
    pub fn to_local(&self, p: LatLon) -> Vec2 {
        let x = (p.lat_deg - self.origin.lat_deg).to_radians();
        let y = normalise_180(p.lon_deg - self.origin.lon_deg).to_radians() * self.cos_lat;
        Vec2::new(self.to_east.at(x, y), self.to_north.at(x, y)) * self.prime_vertical_m
    }

    /// The position of a point of the frame.
    pub fn to_geo(&self, v: Vec2) -> LatLon {
        let v = v * self.prime_vertical_m.recip();
        let dlat = self.to_lat.at(v.n, v.e);
        let dlon = self.to_lon.at(v.n, v.e) / self.cos_lat;
        LatLon::new(
            self.origin.lat_deg + dlat.to_degrees(),
            normalise_180(self.origin.lon_deg + dlon.to_degrees()),
        )
    }
}

#[cfg(test)]
mod tests;
