//! Several terrains over each other.

use crate::Terrain;
use geometry::LatLon;
use std::sync::Arc;
use std::task::Poll;

/// Terrains over each other: the first that knows a place answers for it.
#[derive(Clone, Default)]
pub struct Stack(pub Vec<Arc<dyn Terrain>>);

impl Terrain for Stack {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        self.0.iter().find_map(|terrain| terrain.elevation_m(p))
    }

    fn at_once_m(&self, p: LatLon) -> Poll<Option<f64>> {
        // those below one that is not read yet may not answer for it
        let mut answers = self.0.iter().map(|terrain| terrain.at_once_m(p));
        answers.find(|answer| *answer != Poll::Ready(None)).unwrap_or(Poll::Ready(None))
    }

    fn spacing_m(&self, at: LatLon) -> Option<f64> {
        self.0.iter().filter_map(|terrain| terrain.spacing_m(at)).reduce(f64::min)
    }

    fn at_most_m(&self, south_west: LatLon, north_east: LatLon) -> Option<f64> {
        // any of them may answer for a part of the box
        self.0.iter().try_fold(f64::NEG_INFINITY, |highest, terrain| {
            Some(highest.max(terrain.at_most_m(south_west, north_east)?))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Flat;

    /// Flat ground of some height north of a latitude.
    struct North(f64, f64);
    impl Terrain for North {
        fn elevation_m(&self, p: LatLon) -> Option<f64> {
            (p.lat_deg >= self.0).then_some(self.1)
        }
        fn at_most_m(&self, _: LatLon, north_east: LatLon) -> Option<f64> {
            Some(if north_east.lat_deg >= self.0 { self.1 } else { f64::NEG_INFINITY })
        }
    }

    #[test]
    fn the_first_that_knows_answers_and_a_bound_holds_for_all() {
        let stack = Stack(vec![Arc::new(North(10.0, 300.0)), Arc::new(North(5.0, 800.0))]);
        let elevations = [12.0, 7.0, 3.0].map(|lat| stack.elevation_m(LatLon::new(lat, 0.0)));
        assert_eq!(elevations, [Some(300.0), Some(800.0), None]);
        let bound =
            |south: f64, north: f64| stack.at_most_m(LatLon::new(south, 0.0), LatLon::new(north, 1.0));
        assert_eq!(bound(4.0, 12.0), Some(800.0));
        assert_eq!(bound(1.0, 2.0), Some(f64::NEG_INFINITY), "nothing is known there");
        struct Unbounded;
        impl Terrain for Unbounded {
            fn elevation_m(&self, _: LatLon) -> Option<f64> {
                None
            }
        }
        let stack = Stack(vec![Arc::new(Flat(1.0)), Arc::new(Unbounded)]);
        assert_eq!(stack.at_most_m(LatLon::new(0.0, 0.0), LatLon::new(1.0, 1.0)), None);
    }

    #[test]
    fn one_that_is_not_read_yet_is_waited_for_unless_one_above_it_knows() {
        struct OnDisk;
        impl Terrain for OnDisk {
            fn elevation_m(&self, _: LatLon) -> Option<f64> {
                panic!("it is read")
            }
            fn at_once_m(&self, _: LatLon) -> Poll<Option<f64>> {
                Poll::Pending
            }
        }
        let stack = Stack(vec![Arc::new(North(10.0, 300.0)), Arc::new(OnDisk), Arc::new(Flat(1.0))]);
        assert_eq!(stack.at_once_m(LatLon::new(12.0, 0.0)), Poll::Ready(Some(300.0)));
        assert_eq!(stack.at_once_m(LatLon::new(7.0, 0.0)), Poll::Pending);
        assert_eq!(Stack::default().at_once_m(LatLon::new(7.0, 0.0)), Poll::Ready(None));
    }
}
