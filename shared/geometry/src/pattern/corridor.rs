//! A corridor: parallel tracks along a route.

use super::{PatternError, Route, Stored, Vertex, not_negative, positive};
use crate::Vec2;
use crate::scan::{Corner, Entry, Lines, Order};
use serde::{Deserialize, Serialize};

/// What makes a corridor, besides its route.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CorridorParameters {
    /// Its width, metres: half of it on each side of the route.
    pub width_m: f64,
    /// Greatest distance between neighbouring tracks, metres: as few as that allows are spread evenly over the width.
    pub spacing_m: f64,
    /// How far tracks go on beyond the route's ends, metres.
    pub overshoot_m: f64,
    /// Where it begins; the route is the heading.
    pub entry: Entry,
    /// Radius of the turns between tracks, metres: nearer tracks are interleaved (see [`crate::scan::ScanParameters`]).
    pub turn_radius_m: f64,
}

/// A corridor, ready to be flown.
#[derive(Debug, Clone, PartialEq)]
pub struct Corridor {
    stored: Stored,
}

impl Corridor {
    /// Lays it out.
    ///
    /// # Errors
    /// A parameter that makes no sense; more waypoints than can be stored.
    pub fn new(route: &Route, p: &CorridorParameters) -> Result<Self, PatternError> {
        positive("width", p.width_m)?;
        positive("spacing", p.spacing_m)?;
        not_negative("overshoot", p.overshoot_m)?;
        not_negative("turn radius", p.turn_radius_m)?;
        let lines = Lines::even((-p.width_m / 2.0, p.width_m / 2.0), p.spacing_m)?;
        route.check_paths(lines.count())?;
        let order =
            Order::interleaved(lines.count(), p.turn_radius_m, lines.spacing_m(), corner(route, p, &lines)?);
        let mut stored = Stored::default();
        for track in 0..lines.count() {
            let mut path = route.beside(lines.across_m(order.line(track)), p.overshoot_m);
            if !order.along_heading(track) {
                path.reverse();
            }
            stored.push(path)?;
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

/// The corner to begin at.
fn corner(route: &Route, p: &CorridorParameters, lines: &Lines) -> Result<Corner, PatternError> {
    let near = match p.entry {
        Entry::Corner(corner) => return Ok(corner),
        Entry::Nearest(point) => point,
    };
    super::finite("point that the corridor should begin near to", near.length())?;
    let mut best = (f64::INFINITY, Corner::StartLeft);
    for (line, at_start, at_end) in [
        (0, Corner::StartLeft, Corner::EndLeft),
        (lines.count().saturating_sub(1), Corner::StartRight, Corner::EndRight),
    ] {
        let path = route.beside(lines.across_m(line), p.overshoot_m);
        for (end, corner) in [(path.first(), at_start), (path.last(), at_end)] {
            let distance_m = end.map_or(f64::INFINITY, |&end: &Vec2| (end - near).length());
            if distance_m < best.0 {
                best = (distance_m, corner);
            }
        }
    }
    Ok(best.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters() -> CorridorParameters {
        CorridorParameters {
            width_m: 400.0,
            spacing_m: 100.0,
            overshoot_m: 0.0,
            entry: Entry::Corner(Corner::StartLeft),
            turn_radius_m: 0.0,
        }
    }

    fn north() -> Route {
        Route::new(&[Vec2::default(), Vec2::new(0.0, 2000.0), Vec2::new(0.0, 3000.0)]).unwrap()
    }

    fn ends(p: &CorridorParameters) -> Vec<(i64, i64)> {
        let corridor = Corridor::new(&north(), p).unwrap();
        let vertices = (0..corridor.count()).map(|i| corridor.vertex(i).unwrap());
        vertices.map(|v| (v.at.e.round() as i64, v.at.n.round() as i64)).filter(|v| v.1 != 2000).collect()
    }

    #[test]
    fn tracks_begin_half_a_spacing_inside() {
        let tracks =
            [(-150, 0), (-150, 3000), (-50, 3000), (-50, 0), (50, 0), (50, 3000), (150, 3000), (150, 0)];
        assert_eq!(ends(&parameters()), tracks);
        let long = CorridorParameters { overshoot_m: 20.0, ..parameters() };
        assert_eq!(ends(&long)[..2], [(-150, -20), (-150, 3020)]);
        let narrow = CorridorParameters { width_m: 80.0, ..parameters() };
        assert_eq!(ends(&narrow), [(0, 0), (0, 3000)]);
    }

    #[test]
    fn it_begins_at_the_nearest_corner() {
        for (near, first) in [
            ((-500.0, -10.0), (-150, 0)),
            ((10.0, -500.0), (150, 0)),
            ((500.0, 2900.0), (150, 3000)),
            ((-10.0, 9000.0), (-150, 3000)),
        ] {
            let p = CorridorParameters { entry: Entry::Nearest(Vec2::new(near.0, near.1)), ..parameters() };
            assert_eq!(ends(&p)[0], first);
        }
    }

    #[test]
    fn tight_turns_are_interleaved() {
        let p = CorridorParameters { turn_radius_m: 100.0, ..parameters() };
        let tracks: Vec<i64> = ends(&p).chunks(2).map(|t| t[0].0).collect();
        assert_eq!(tracks, [-150, 50, -50, 150]);
    }

    #[test]
    fn a_million_tracks_are_refused() {
        let p = CorridorParameters { spacing_m: 1e-4, ..parameters() };
        assert!(matches!(Corridor::new(&north(), &p), Err(PatternError::TooMany { .. })));
        let p = CorridorParameters { spacing_m: 1e-300, ..parameters() };
        assert!(Corridor::new(&north(), &p).is_err());
    }
}
