//! The ground under a path.

use crate::Terrain;
use geometry::LatLon;

/// Most samples on one path, so that a bad path cannot take for ever.
const MAX_SAMPLES: f64 = 100_000.0;

/// What lies under a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// The highest elevation met, metres AMSL; `None` if nothing is known anywhere on the path.
    pub highest_m: Option<f64>,
    /// Where that is (the path's start if nothing is known).
    pub at: LatLon,
    /// Share of the sampled points where nothing is known, 0..=1.
    pub unknown: f64,
}

/// Samples the terrain every `spacing_m` metres (and at both ends) of the geodesic from `from` to `to`.
///
/// A spacing that is no positive number, or that would need more than 100,000 points, is widened to
/// what gives that many. Half the data's spacing (about 45 m for 3″) misses nothing that bilinear
/// interpolation would show.
pub fn ground_along(terrain: &dyn Terrain, from: LatLon, to: LatLon, spacing_m: f64) -> Ground {
    let way = from.inverse(to);
    let steps = (way.distance_m / spacing_m).ceil();
    // a spacing of 0 gives infinity or NaN steps
    let steps =
        if steps.is_finite() && steps >= 1.0 { steps.min(MAX_SAMPLES) } else { fallback(way.distance_m) };
    let mut ground = Ground { highest_m: None, at: from, unknown: 0.0 };
    let mut unknown = 0.0;
    for i in 0..=steps as u32 {
        let p = from.destination(way.bearing_start_deg, way.distance_m * f64::from(i) / steps);
        match terrain.elevation_m(p) {
            Some(m) if ground.highest_m.is_none_or(|highest| m > highest) => {
                (ground.highest_m, ground.at) = (Some(m), p);
            }
            Some(_) => {}
            None => unknown += 1.0,
        }
    }
    ground.unknown = unknown / (steps + 1.0);
    ground
}

/// Steps where the spacing asked for makes no sense: none on a path without length.
fn fallback(distance_m: f64) -> f64 {
    if distance_m > 0.0 { MAX_SAMPLES } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ridge 1000 m high along latitude 36.5, sloping 10 m a hundredth of a degree; nothing known north of 36.6.
    struct Ridge;
    impl Terrain for Ridge {
        fn elevation_m(&self, p: LatLon) -> Option<f64> {
            (p.lat_deg <= 36.6).then(|| 1000.0 - (p.lat_deg - 36.5).abs() * 1000.0)
        }
    }

    #[test]
    fn the_ridge_between_two_valleys_is_found() {
        let ground = ground_along(&Ridge, LatLon::new(36.45, -84.2), LatLon::new(36.55, -84.2), 50.0);
        assert!((ground.highest_m.unwrap() - 1000.0).abs() < 0.5, "{ground:?}");
        assert!((ground.at.lat_deg - 36.5).abs() < 0.001);
        assert_eq!(ground.unknown, 0.0);
    }

    #[test]
    fn what_is_unknown_is_said() {
        let half = ground_along(&Ridge, LatLon::new(36.5, -84.2), LatLon::new(36.7, -84.2), 50.0);
        assert!((half.unknown - 0.5).abs() < 0.01, "{half:?}");
        let none = ground_along(&Ridge, LatLon::new(36.65, -84.2), LatLon::new(36.7, -84.2), 50.0);
        assert_eq!((none.highest_m, none.unknown), (None, 1.0));
    }

    #[test]
    fn odd_paths_and_spacings_are_bounded() {
        let (a, b) = (LatLon::new(36.5, -84.2), LatLon::new(36.51, -84.2));
        for spacing in [0.0, -5.0, f64::NAN, f64::INFINITY, 1e-12] {
            assert!(ground_along(&Ridge, a, b, spacing).highest_m.is_some(), "{spacing}");
        }
        assert_eq!(ground_along(&Ridge, a, a, 50.0).highest_m, Some(1000.0));
    }
}
