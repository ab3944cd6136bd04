//! Rectangles on the plane that touches the earth at a zone: whether a ball can reach a long and narrow zone takes two products.

use super::ball::{Ball, earth_centred};
use crate::{LatLon, Vec2};

/// Seen from straight above the origin, what is 100 km (a frame's radius) away comes nearer by 4.1 m, and by some centimetres more
/// or less because the earth is flattened, metres.
const FORESHORTENED_M: f64 = 10.0;

/// Everything that lies on the earth within a rectangle along the meridian of its origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plate {
    origin_m: [f64; 3],
    east: [f64; 3],
    north: [f64; 3],
    least_m: Vec2,
    most_m: Vec2,
}

impl Plate {
    /// Around corners in a frame, metres from its origin.
    pub fn around(origin: LatLon, corners: &[Vec2]) -> Self {
        let (sin_lat, cos_lat) = origin.lat_deg.to_radians().sin_cos();
        let (sin_lon, cos_lon) = origin.lon_deg.to_radians().sin_cos();
        let extreme = |least: f64, of: fn(&Vec2) -> f64, pick: fn(f64, f64) -> f64| {
            corners.iter().map(of).fold(least, pick)
        };
        Self {
            origin_m: earth_centred(origin),
            east: [-sin_lon, cos_lon, 0.0],
            north: [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            least_m: Vec2::new(
                extreme(f64::INFINITY, |c| c.e, f64::min),
                extreme(f64::INFINITY, |c| c.n, f64::min),
            ),
            most_m: Vec2::new(
                extreme(f64::NEG_INFINITY, |c| c.e, f64::max),
                extreme(f64::NEG_INFINITY, |c| c.n, f64::max),
            ),
        }
    }

    /// Whether something in a ball may be nearer than a margin, metres; what is not a number may be anywhere.
    #[inline]
    pub fn may_be_near(&self, ball: &Ball, margin_m: f64) -> bool {
        let reach_m = ball.radius_m() + margin_m + FORESHORTENED_M;
        let middle_m = ball.middle_m();
        let along = |axis: &[f64; 3]| -> f64 {
            axis.iter().zip(middle_m).zip(self.origin_m).map(|((axis, m), origin)| axis * (m - origin)).sum()
        };
        let is_beyond =
            |at_m: f64, least_m: f64, most_m: f64| at_m < least_m - reach_m || at_m > most_m + reach_m;
        !is_beyond(along(&self.east), self.least_m.e, self.most_m.e)
            && !is_beyond(along(&self.north), self.least_m.n, self.most_m.n)
    }
}
