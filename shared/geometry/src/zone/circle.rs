//! Circles: distances are those of geodesics.

use super::ball::Ball;
use super::{Worst, ZoneError};
use crate::geodesy::normalise_360;
use crate::{LatLon, PathElement};

/// Zones are smaller than that, metres: farther, the nearest point of a line is not well defined.
const LARGEST_M: f64 = 1_000_000.0;

/// Everything up to a distance from a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    centre: LatLon,
    radius_m: f64,
}

impl Circle {
    pub fn new(centre: LatLon, radius_m: f64) -> Result<Self, ZoneError> {
        let good = centre.is_valid() && radius_m > 0.0 && radius_m < LARGEST_M;
        if good { Ok(Self { centre, radius_m }) } else { Err(ZoneError::Circle(radius_m)) }
    }

    pub fn ball(&self) -> Ball {
        Ball::new(self.centre, self.radius_m)
    }

    /// How far a position is outside, metres; 0 inside.
    pub fn outside_m(&self, p: LatLon) -> f64 {
        (self.centre.distance_m(p) - self.radius_m).max(0.0)
    }

    /// The deepest point inside, the circle being larger by a margin.
    pub fn deepest(&self, element: &PathElement, margin_m: f64) -> Option<Worst> {
        let near = element.nearest(self.centre);
        let wrong_m = self.radius_m + margin_m - near.separation_m;
        (wrong_m > 0.0).then_some(Worst { along_m: near.distance_m, wrong_m })
    }

    /// The farthest point outside, the circle being smaller by a margin.
    pub fn farthest(&self, element: &PathElement, margin_m: f64) -> Option<Worst> {
        let length_m = element.length_m();
        let outside = |along_m: f64, p: LatLon| Worst {
            along_m,
            wrong_m: self.centre.distance_m(p) - (self.radius_m - margin_m),
        };
        // along a geodesic the distance from a point has no greatest value but at an end
        let mut worst = outside(0.0, element.start()).or(outside(length_m, element.end()));
        if let PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } = *element {
            let away_deg = centre.bearing_deg(self.centre) + 180.0;
            let swept_deg = normalise_360(1.0_f64.copysign(sweep_deg) * (away_deg - start_bearing_deg));
            if swept_deg < sweep_deg.abs() {
                let along_m = radius_m * swept_deg.to_radians();
                worst = worst.or(outside(along_m, element.point_at(along_m)));
            }
        }
        (worst.wrong_m > 0.0).then_some(worst)
    }
}
