//! The ground under a straight way: looked at as finely as it is known, but only where it may be high enough to matter.

use geometry::LatLon;
use geometry::geodesy::normalise_180;
use terrain::Terrain;

/// Spacing at which ground is sampled of which it is not said how finely it is known, and the finest, metres.
const STEP_M: f64 = 45.0;
const FINEST_STEP_M: f64 = 10.0;
/// Most samples of one way.
const MAX_SAMPLES: f64 = 4000.0;
/// A way is looked at in parts of this length, metres: over most of them nothing is high enough.
const PART_M: f64 = 1000.0;
/// A straight part is nowhere so far outside of the box around its ends, degrees.
const BULGE_DEG: f64 = 1e-4;

/// A place on a way, with its share of it.
pub(super) type Sample = (f64, LatLon);

/// Places along the straight way between two, both included, as close together as the elevations are known: half their spacing misses
/// nothing that is interpolated between them.
pub(super) fn along(terrain: &dyn Terrain, from: LatLon, to: LatLon) -> impl Iterator<Item = Sample> {
    parts(terrain, from, to).into_iter().flat_map(|part| part.samples())
}

/// The same, without the parts of it for which `is_low` says that nothing there matters, by the highest ground that there can be and the
/// shares of the way between which it is.
pub(super) fn along_high(
    terrain: &dyn Terrain,
    from: LatLon,
    to: LatLon,
    is_low: impl Fn(f64, [f64; 2]) -> bool,
) -> impl Iterator<Item = Sample> {
    let matters =
        move |part: &Part| part.at_most_m(terrain).is_none_or(|most_m| !is_low(most_m, part.shares));
    parts(terrain, from, to).into_iter().filter(matters).flat_map(|part| part.samples())
}

/// A part of a way.
struct Part {
    ends: [LatLon; 2],
    shares: [f64; 2],
    steps: u32,
}

impl Part {
    fn samples(self) -> impl Iterator<Item = Sample> {
        let [from, to] = self.ends;
        let way = from.inverse(to);
        let [begins, ends] = self.shares;
        (0..=self.steps).map(move |i| {
            let share = f64::from(i) / f64::from(self.steps);
            let place = from.destination(way.bearing_start_deg, way.distance_m * share);
            (begins + share * (ends - begins), place)
        })
    }

    /// Metres that no ground here is above; `None`: that is not known.
    fn at_most_m(&self, terrain: &dyn Terrain) -> Option<f64> {
        let [a, b] = self.ends;
        if normalise_180(a.lon_deg - b.lon_deg) != a.lon_deg - b.lon_deg {
            return None;
        }
        let corner = |pick: fn(f64, f64) -> f64, by_deg: f64| {
            LatLon::new(pick(a.lat_deg, b.lat_deg) + by_deg, pick(a.lon_deg, b.lon_deg) + by_deg)
        };
        terrain.at_most_m(corner(f64::min, -BULGE_DEG), corner(f64::max, BULGE_DEG))
    }
}

fn parts(terrain: &dyn Terrain, from: LatLon, to: LatLon) -> Vec<Part> {
    let way = from.inverse(to);
    let known_m = [from, to].into_iter().filter_map(|place| terrain.spacing_m(place)).reduce(f64::min);
    let step_m = known_m.map_or(STEP_M, |m| 0.5 * m).max(FINEST_STEP_M).max(way.distance_m / MAX_SAMPLES);
    let count = (way.distance_m / PART_M).ceil().clamp(1.0, MAX_SAMPLES);
    let steps = (way.distance_m / count / step_m).ceil().max(1.0) as u32;
    let at = |i: f64| way.distance_m * i / count;
    let place = |i: f64| from.destination(way.bearing_start_deg, at(i));
    (0..count as u32)
        .map(f64::from)
        .map(|i| Part { ends: [place(i), place(i + 1.0)], shares: [i / count, (i + 1.0) / count], steps })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::HOME;
    use super::*;

    /// Known every so many metres.
    struct Fine(f64);

    impl Terrain for Fine {
        fn elevation_m(&self, _: LatLon) -> Option<f64> {
            Some(0.0)
        }

        fn spacing_m(&self, _: LatLon) -> Option<f64> {
            Some(self.0)
        }
    }

    #[test]
    fn a_way_is_sampled_from_end_to_end_as_finely_as_the_ground_is_known_and_no_more_often_than_so() {
        for (spacing_m, way_m, most_m) in
            [(90.0, 12_345.0, 45.0), (30.0, 12_345.0, 15.0), (1.0, 5000.0, 10.0), (30.0, 400_000.0, 100.0)]
        {
            let to = HOME.destination(70.0, way_m);
            let samples: Vec<Sample> = along(&Fine(spacing_m), HOME, to).collect();
            let ends = [samples.first(), samples.last()].map(|sample| sample.unwrap());
            assert!(ends[0].1.distance_m(HOME) < 0.01 && ends[1].1.distance_m(to) < 0.1 && ends[1].0 == 1.0);
            for pair in samples.windows(2) {
                let apart_m = pair[0].1.distance_m(pair[1].1);
                assert!(apart_m < most_m + 0.1 && pair[0].0 <= pair[1].0, "{spacing_m}: {apart_m} m");
            }
            assert!(samples.len() <= 4900, "{}", samples.len());
        }
        assert_eq!(along(&Fine(90.0), HOME, HOME).count(), 2);
    }

    /// It is low north of here, and that is known.
    struct LowNorth;

    impl Terrain for LowNorth {
        fn elevation_m(&self, _: LatLon) -> Option<f64> {
            Some(0.0)
        }

        fn at_most_m(&self, south_west: LatLon, _: LatLon) -> Option<f64> {
            (south_west.lat_deg > HOME.lat_deg + 0.02).then_some(0.0)
        }
    }

    #[test]
    fn where_nothing_is_high_enough_to_matter_nothing_is_looked_at() {
        let to = HOME.destination(0.0, 20_000.0);
        let northmost = |is_low: fn(f64, [f64; 2]) -> bool| {
            let lats = along_high(&LowNorth, HOME, to, is_low).map(|(_, place)| place.lat_deg - HOME.lat_deg);
            lats.fold(0.0, f64::max)
        };
        assert!((0.02..0.04).contains(&northmost(|most_m, _| most_m < 100.0)));
        assert!((0.09..0.11).contains(&northmost(|most_m, shares| most_m < 100.0 && shares[0] > 0.5)));
        assert!(northmost(|_, _| false) > 0.17);
    }

    /// A box across the line of the date would go round the other way.
    #[test]
    fn across_the_line_of_the_date_nothing_is_known_of_a_part_as_a_whole() {
        let lat_deg = HOME.lat_deg + 1.0;
        let known = |from_deg: f64, to_deg: f64| {
            let parts = parts(&LowNorth, LatLon::new(lat_deg, from_deg), LatLon::new(lat_deg, to_deg));
            parts.iter().filter(|part| part.at_most_m(&LowNorth).is_none()).count()
        };
        assert_eq!(known(179.0, 179.99), 0);
        assert_eq!(known(179.99, -179.99), 1);
    }
}
