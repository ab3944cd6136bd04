//! The track line search: along a route, on both sides of it.

use super::{PatternError, Route, Stored, Vertex, counted, positive};
use crate::turn::Turn;
use serde::{Deserialize, Serialize};

/// Pairs of passes that may be flown.
const MAX_PAIRS: u64 = 1000;

/// What makes a track line search, besides its route.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrackLineParameters {
    /// Distance between neighbouring passes, metres.
    pub spacing_m: f64,
    /// Ends where it began: out half a spacing to one side of the route, back half a spacing to the other. Otherwise it
    /// ends at the other end: out on the route itself, then back and out a spacing to either side.
    pub returns: bool,
    /// How many pairs of passes are flown, each a spacing farther out. Not returning, 0 is the route alone.
    pub pairs: u64,
    /// Side of the route on which the first pass is.
    pub first_side: Turn,
}

/// A track line search; each pass is a track.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackLine {
    stored: Stored,
}

impl TrackLine {
    /// Lays it out.
    ///
    /// # Errors
    /// A parameter that makes no sense; more waypoints than can be stored.
    pub fn new(route: &Route, p: &TrackLineParameters) -> Result<Self, PatternError> {
        positive("spacing", p.spacing_m)?;
        counted("pairs of passes", p.pairs.saturating_add(u64::from(!p.returns)), MAX_PAIRS)?;
        route.check_paths(2 * p.pairs)?;
        let mut stored = Stored::default();
        if !p.returns {
            stored.push(route.points())?;
        }
        let first_m = if p.returns { 0.5 * p.spacing_m } else { p.spacing_m };
        for pair in 0..p.pairs {
            let aside_m = p.first_side.sign() * (first_m + pair as f64 * p.spacing_m);
            let (mut one, mut other) = (route.beside(aside_m, 0.0), route.beside(-aside_m, 0.0));
            let backwards = if p.returns { &mut other } else { &mut one };
            backwards.reverse();
            stored.push(one)?;
            stored.push(other)?;
        }
        Ok(Self { stored })
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        self.stored.count()
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        self.stored.vertex(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec2;

    fn passes(p: &TrackLineParameters) -> Vec<(i64, i64, u64)> {
        let route = Route::new(&[Vec2::default(), Vec2::new(0.0, 5000.0)]).unwrap();
        let search = TrackLine::new(&route, p).unwrap();
        let vertices = (0..search.count()).map(|i| search.vertex(i).unwrap());
        vertices.map(|v| (v.at.e.round() as i64, v.at.n.round() as i64, v.track)).collect()
    }

    #[test]
    fn returning_it_is_half_a_spacing_to_each_side() {
        let p = TrackLineParameters { spacing_m: 400.0, returns: true, pairs: 1, first_side: Turn::Right };
        assert_eq!(passes(&p), [(200, 0, 0), (200, 5000, 0), (-200, 5000, 1), (-200, 0, 1)]);
        let left = TrackLineParameters { first_side: Turn::Left, pairs: 2, ..p };
        assert_eq!(passes(&left)[..2], [(-200, 0, 0), (-200, 5000, 0)]);
        assert_eq!(passes(&left)[4..6], [(-600, 0, 2), (-600, 5000, 2)]);
    }

    #[test]
    fn not_returning_it_ends_at_the_other_end() {
        let p = TrackLineParameters { spacing_m: 400.0, returns: false, pairs: 1, first_side: Turn::Left };
        let all = [(0, 0, 0), (0, 5000, 0), (-400, 5000, 1), (-400, 0, 1), (400, 0, 2), (400, 5000, 2)];
        assert_eq!(passes(&p), all);
        assert_eq!(passes(&TrackLineParameters { pairs: 0, ..p }), all[..2]);
    }

    #[test]
    fn many_passes_along_many_points_are_refused() {
        let points: Vec<Vec2> = (0..5000).map(|i| Vec2::new(f64::from(i % 2), 10.0 * f64::from(i))).collect();
        let p = TrackLineParameters { spacing_m: 400.0, returns: true, pairs: 500, first_side: Turn::Right };
        let refused = TrackLine::new(&Route::new(&points).unwrap(), &p);
        assert!(matches!(refused, Err(super::super::PatternError::TooMany { .. })));
    }

    #[test]
    fn no_or_endless_passes_are_refused() {
        let route = Route::new(&[Vec2::default(), Vec2::new(0.0, 5000.0)]).unwrap();
        for (pairs, returns, spacing_m) in [
            (0, true, 100.0),
            (2000, false, 100.0),
            (1, true, 0.0),
            (1, true, f64::NAN),
            (u64::MAX, false, 5.0),
        ] {
            let p = TrackLineParameters { spacing_m, returns, pairs, first_side: Turn::Left };
            assert!(TrackLine::new(&route, &p).is_err(), "{p:?}");
        }
    }
}
