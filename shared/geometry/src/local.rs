//! A flat frame around an origin: metres east and north.

use crate::LatLon;
use serde::{Deserialize, Serialize};

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
        self.e.hypot(self.n)
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

/// Farthest from its origin that a frame may be used, metres.
pub const RADIUS_M: f64 = 50_000.0;

/// A local frame: distances and bearings near the origin are those of the ellipsoid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalFrame {
    origin: LatLon,
    metres_per_deg_lat: f64,
    metres_per_deg_lon: f64,
}

impl LocalFrame {
    /// The frame around `origin`.
    pub fn new(origin: LatLon) -> Self {
        let (a, e2) = (6_378_137.0_f64, 0.006_694_379_990_141_316_f64);
        let lat = origin.lat_deg.to_radians();
        let w2 = 1.0 - e2 * lat.sin().powi(2);
        let meridional = a * (1.0 - e2) / w2.powf(1.5);
        let prime_vertical = a / w2.sqrt();
        Self {
            origin,
            metres_per_deg_lat: meridional.to_radians(),
            metres_per_deg_lon: (prime_vertical * lat.cos()).to_radians(),
        }
    }
    /// Where (0, 0) is.
    pub fn origin(&self) -> LatLon {
        self.origin
    }
    /// Metres east and north of the origin.
    pub fn to_local(&self, p: LatLon) -> Vec2 {
        let dlon = crate::geodesy::normalise_180(p.lon_deg - self.origin.lon_deg);
        Vec2::new(dlon * self.metres_per_deg_lon, (p.lat_deg - self.origin.lat_deg) * self.metres_per_deg_lat)
    }
    /// The position of a point of the frame.
    pub fn to_geo(&self, v: Vec2) -> LatLon {
        LatLon::new(
            self.origin.lat_deg + v.n / self.metres_per_deg_lat,
            crate::geodesy::normalise_180(self.origin.lon_deg + v.e / self.metres_per_deg_lon),
        )
    }
}
