//! Whether a glide leads above the ground: there is nothing to pull up with.

use aircraft::glide::GlidePoint;
use aircraft::glide_in::WayIn;
use geometry::near::distance_m;
use terrain::Terrain;

/// Height above the ground that a glide keeps on its way, metres: as Safe mode's.
const SPARE_M: f64 = 15.0;
/// Less where it begins and ends: this share of the way from there.
const NEAR_SHARE: f64 = 0.02;
/// So near to where it begins and ends it is taken to be above the ground, whatever the elevation model says, metres.
const NEAR_M: f64 = 200.0;
/// As close together the ground is looked at, metres, and no oftener than so on one leg.
const SPACING_M: f64 = 45.0;
const MAX_SAMPLES: f64 = 2000.0;

/// A way in to a threshold, which is so high, metres AMSL, is above the ground as high as it glides, and as low as its end may be told.
/// Emergency plans and Safe mode ask this alike: by such a way a runway is reached.
pub fn clears_way_in(terrain: &dyn Terrain, way: &WayIn, elevation_amsl_m: f64) -> bool {
    let lowest = way.lowest_end(elevation_amsl_m);
    let ways = [Some(way.points.as_slice()), lowest.as_ref().map(|leg| leg.as_slice())];
    ways.into_iter().flatten().all(|points| clears_ground(terrain, points))
}

/// It is above all ground that is known under its points, and between them.
pub fn clears_ground(terrain: &dyn Terrain, points: &[GlidePoint]) -> bool {
    let Some((begin, end)) = points.first().zip(points.last()) else { return true };
    points.windows(2).all(|pair| {
        let [from, to] = pair else { return true };
        let way = from.position.inverse(to.position);
        let samples = (way.distance_m / SPACING_M).ceil().clamp(1.0, MAX_SAMPLES);
        (0..=samples as u32).all(|i| {
            let share = f64::from(i) / samples;
            let place = from.position.destination(way.bearing_start_deg, way.distance_m * share);
            let height_m = from.altitude_amsl_m + share * (to.altitude_amsl_m - from.altitude_amsl_m);
            let near_m = distance_m(place, begin.position).min(distance_m(place, end.position));
            let spare_m = SPARE_M.min(NEAR_SHARE * near_m);
            near_m < NEAR_M || terrain.elevation_m(place).is_none_or(|ground_m| height_m > ground_m + spare_m)
        })
    })
}
