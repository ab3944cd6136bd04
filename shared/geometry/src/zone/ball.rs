//! Balls in space around pieces of the earth's surface: whether two can meet takes one distance.

use crate::{LatLon, PathElement};

/// Equatorial radius of WGS84, metres.
const A_M: f64 = 6_378_137.0;
/// Its first eccentricity squared.
const E2: f64 = 0.006_694_379_990_141_316;
/// Nothing on the ellipsoid curves more sharply than this, metres: the meridian at the equator.
const MIN_CURVATURE_M: f64 = A_M * (1.0 - E2);
/// Makes up for rounding, metres.
const ROUNDING_M: f64 = 0.01;

/// A ball; straight distances in it are never longer than those on the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    middle_m: [f64; 3],
    radius_m: f64,
}

impl Ball {
    /// Everything up to a distance on the ground from a position, metres.
    pub fn new(middle: LatLon, radius_m: f64) -> Self {
        Self { middle_m: earth_centred(middle), radius_m: radius_m + ROUNDING_M }
    }

    /// A path element.
    pub fn around(element: &PathElement) -> Self {
        match *element {
            PathElement::Line { from, to } => Self::around_line(earth_centred(from), earth_centred(to)),
            PathElement::Arc { centre, radius_m, .. } => Self::new(centre, radius_m),
        }
    }

    /// The geodesic stays as near to the chord's middle as half the chord and the height of its bulge.
    fn around_line(a: [f64; 3], b: [f64; 3]) -> Self {
        let half_m = squared_distance_m2(a, b).sqrt() / 2.0;
        let below_m = (MIN_CURVATURE_M * MIN_CURVATURE_M - half_m * half_m).max(0.0).sqrt();
        let mut middle_m = a;
        for (m, b) in middle_m.iter_mut().zip(b) {
            *m = (*m + b) / 2.0;
        }
        Self { middle_m, radius_m: half_m + (MIN_CURVATURE_M - below_m) + ROUNDING_M }
    }

    /// All of some balls; `None`: there are none. What is not a number may be anywhere.
    pub fn around_all(mut balls: impl Iterator<Item = Self>) -> Option<Self> {
        let mut whole = balls.next()?;
        for ball in balls {
            let reach_m = squared_distance_m2(whole.middle_m, ball.middle_m).sqrt() + ball.radius_m;
            if reach_m.is_nan() {
                return Some(Self { middle_m: [f64::NAN; 3], radius_m: 0.0 });
            }
            whole.radius_m = whole.radius_m.max(reach_m + ROUNDING_M);
        }
        Some(whole)
    }

    /// Larger by a distance, metres.
    pub fn grown(self, by_m: f64) -> Self {
        Self { radius_m: self.radius_m + by_m, ..self }
    }

    /// Earth-centred coordinates, metres.
    pub fn middle_m(&self) -> [f64; 3] {
        self.middle_m
    }

    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// Straight distance between the two, metres; negative if they overlap.
    pub fn gap_m(&self, other: &Ball) -> f64 {
        squared_distance_m2(self.middle_m, other.middle_m).sqrt() - self.radius_m - other.radius_m
    }

    /// Whether there may be a point in both; what is not a number may be anywhere.
    #[inline]
    pub fn meets(&self, other: &Ball) -> bool {
        let reach_m = self.radius_m + other.radius_m;
        let apart_m2 = squared_distance_m2(self.middle_m, other.middle_m);
        apart_m2 <= reach_m * reach_m || apart_m2.is_nan()
    }
}

/// Coordinates in space of a position on the ellipsoid, metres.
pub(super) fn earth_centred(p: LatLon) -> [f64; 3] {
    let (sin_lat, cos_lat) = p.lat_deg.to_radians().sin_cos();
    let (sin_lon, cos_lon) = p.lon_deg.to_radians().sin_cos();
    let n_m = A_M / (1.0 - E2 * sin_lat * sin_lat).sqrt();
    [n_m * cos_lat * cos_lon, n_m * cos_lat * sin_lon, n_m * (1.0 - E2) * sin_lat]
}

fn squared_distance_m2(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}
