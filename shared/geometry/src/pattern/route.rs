//! A route in the plane, and the paths parallel to it.

use super::{MAX_STORED, PatternError};
use crate::Vec2;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

/// Most points of a route; bounds the cost of laying out parallel tracks.
pub(super) const MAX_POINTS: usize = 10_000;
/// Corners up to this turn are mitred on their outside; sharper ones rounded.
const MITRED_RAD: f64 = FRAC_PI_2;
/// Greatest turn between waypoints of a rounded corner.
const ROUND_STEP_RAD: f64 = FRAC_PI_3;
/// Nearer to straight ahead than this, edges count as parallel (sine of the angle).
const PARALLEL: f64 = 1e-9;

/// A way through at least two points, none of them twice in a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    edges: Vec<Edge>,
}

/// From a point to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    from: Vec2,
    to: Vec2,
    /// Unit vectors.
    along: Vec2,
    right: Vec2,
}

/// An edge parallel to the route: where the path arrives on it through the points of a join.
#[derive(Debug, Clone)]
struct Piece {
    edge: Edge,
    /// Number of the edge in the route.
    number: usize,
    /// From the edge before to this one; the last is where this piece starts.
    join: Vec<Vec2>,
}

impl Route {
    /// Checks points.
    ///
    /// # Errors
    /// Fewer than two or too many; a point that is not a number or lies on the one before.
    pub fn new(points: &[Vec2]) -> Result<Self, PatternError> {
        if !(2..=MAX_POINTS).contains(&points.len()) {
            return Err(PatternError::RoutePoints { points: points.len() });
        }
        if let Some(point) = points.iter().position(|p| !p.length().is_finite()) {
            return Err(PatternError::RoutePoint { point });
        }
        let mut edges = Vec::with_capacity(points.len());
        for (i, pair) in points.windows(2).enumerate() {
            let &[from, to] = pair else { continue };
            let way = to - from;
            // a micrometre has no direction
            if way.length() < 1e-6 {
                return Err(PatternError::RoutePoint { point: i + 1 });
            }
            let along = way * way.length().recip();
            edges.push(Edge { from, to, along, right: Vec2::new(along.n, -along.e) });
        }
        Ok(Self { edges })
    }

    /// Its points.
    pub fn points(&self) -> impl Iterator<Item = Vec2> + '_ {
        let first = self.edges.first().map(|e| e.from);
        first.into_iter().chain(self.edges.iter().map(|e| e.to))
    }

    /// Refuses more parallel paths than can be laid out at once.
    pub(super) fn check_paths(&self, paths: u64) -> Result<(), PatternError> {
        let points = (self.edges.len() as u64 + 1).saturating_mul(paths);
        if points > MAX_STORED as u64 {
            return Err(PatternError::TooMany { most: MAX_STORED as u64 });
        }
        Ok(())
    }

    /// The path a distance to its right (negative: left), prolonged at both ends, metres.
    ///
    /// Outer corners are mitred up to a right angle, else rounded by waypoints on tangents. Inner corners are where the edges
    /// parallel to the route meet; an edge too short for the corners at its ends is left out, so that there are no loops. A route
    /// that comes back near itself gets no special treatment: its parallel tracks cross each other there.
    pub fn beside(&self, right_m: f64, prolonged_m: f64) -> Vec<Vec2> {
        let mut pieces: Vec<Piece> = Vec::with_capacity(self.edges.len());
        for number in 0..self.edges.len() {
            self.append(&mut pieces, number, right_m);
        }
        let Some(end) = self.edges.last().map(|e| e.to + e.right * right_m) else {
            return Vec::new();
        };
        while pieces.len() > 1 && pieces.last().is_some_and(|p| p.reaches(end) < 0.0) {
            pieces.pop();
        }
        let mut path: Vec<Vec2> = pieces.iter().flat_map(|p| p.join.iter().copied()).collect();
        if let Some(last) = pieces.last() {
            path.push(last.foot(end) + last.edge.along * prolonged_m);
        }
        if let (Some(start), Some(first)) = (path.first_mut(), pieces.first()) {
            *start = *start - first.edge.along * prolonged_m;
        }
        path
    }

    /// Adds a parallel edge, and removes those before it that have no room left.
    fn append(&self, pieces: &mut Vec<Piece>, number: usize, right_m: f64) {
        let Some(&edge) = self.edges.get(number) else { return };
        let beside =
            Edge { from: edge.from + edge.right * right_m, to: edge.to + edge.right * right_m, ..edge };
        while let Some(last) = pieces.last() {
            let join = if last.number + 1 == number {
                corner(&last.edge, &beside, edge.from, right_m)
            } else {
                meeting(&last.edge, &beside)
            };
            let room_m = join.first().map_or(0.0, |&first| last.reaches(first));
            if room_m >= 0.0 {
                pieces.push(Piece { edge: beside, number, join });
                return;
            }
            pieces.pop();
        }
        // the beginning of the path is abreast of the beginning of the route
        let start = self.edges.first().map_or(beside.from, |first| first.from + first.right * right_m);
        let foot = beside.from + edge.along * (start - beside.from).dot(edge.along);
        pieces.push(Piece { edge: beside, number, join: vec![foot] });
    }
}

impl Piece {
    fn start(&self) -> Vec2 {
        self.join.last().copied().unwrap_or(self.edge.from)
    }
    /// How far ahead of its start a point lies, metres.
    fn reaches(&self, point: Vec2) -> f64 {
        (point - self.start()).dot(self.edge.along)
    }
    /// The nearest point of its line.
    fn foot(&self, point: Vec2) -> Vec2 {
        self.start() + self.edge.along * self.reaches(point)
    }
}

/// Where the parallel edges at a corner of the route meet, or the points that lead round it.
fn corner(before: &Edge, after: &Edge, vertex: Vec2, right_m: f64) -> Vec<Vec2> {
    let turn_rad = before.along.cross(after.along).atan2(before.along.dot(after.along));
    // anticlockwise is positive: a left turn has its outside on the right
    let outer = turn_rad * right_m > 0.0;
    if outer && turn_rad.abs() > MITRED_RAD {
        return rounded(before, vertex, right_m, turn_rad);
    }
    let cos = before.right.dot(after.right);
    if 1.0 + cos < PARALLEL {
        return vec![before.to, after.from];
    }
    vec![vertex + (before.right + after.right) * (right_m / (1.0 + cos))]
}

/// Waypoints in the middle of equal steps round a corner, where the tangents at the steps' ends meet.
fn rounded(before: &Edge, vertex: Vec2, right_m: f64, turn_rad: f64) -> Vec<Vec2> {
    let steps = (turn_rad.abs() / ROUND_STEP_RAD).ceil().max(1.0);
    let step_rad = turn_rad / steps;
    let out_m = right_m / (step_rad / 2.0).cos();
    (0..steps as usize)
        .map(|i| {
            let (sin, cos) = (step_rad * (i as f64 + 0.5)).sin_cos();
            let out = Vec2::new(
                before.right.e * cos - before.right.n * sin,
                before.right.e * sin + before.right.n * cos,
            );
            vertex + out * out_m
        })
        .collect()
}

/// Where two edges meet that were not neighbours; parallel ones are joined straight.
fn meeting(before: &Edge, after: &Edge) -> Vec<Vec2> {
    let cross = before.along.cross(after.along);
    if cross.abs() < PARALLEL {
        return vec![before.to, after.from];
    }
    let ahead_m = (after.from - before.from).cross(after.along) / cross;
    vec![before.from + before.along * ahead_m]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn route(points: &[(f64, f64)]) -> Route {
        Route::new(&points.iter().map(|&(e, n)| Vec2::new(e, n)).collect::<Vec<_>>()).unwrap()
    }

    fn rounded_to_metres(points: Vec<Vec2>) -> Vec<(i64, i64)> {
        points.iter().map(|p| (p.e.round() as i64, p.n.round() as i64)).collect()
    }

    #[test]
    fn a_corner_is_mitred_outside_and_cut_inside() {
        let right_angle = route(&[(0.0, 0.0), (0.0, 1000.0), (1000.0, 1000.0)]);
        assert_eq!(rounded_to_metres(right_angle.beside(100.0, 0.0)), [(100, 0), (100, 900), (1000, 900)]);
        assert_eq!(
            rounded_to_metres(right_angle.beside(-100.0, 0.0)),
            [(-100, 0), (-100, 1100), (1000, 1100)]
        );
        assert_eq!(rounded_to_metres(right_angle.beside(0.0, 50.0)), [(0, -50), (0, 1000), (1050, 1000)]);
    }

    #[test]
    fn a_sharp_corner_is_rounded_outside() {
        let sharp = route(&[(0.0, 0.0), (0.0, 1000.0), (300.0, 0.0)]);
        let outside = sharp.beside(-100.0, 0.0);
        let vertex = Vec2::new(0.0, 1000.0);
        let reach_m = outside.iter().map(|&p| (p - vertex).length());
        // two edges' ends, and three waypoints on tangents
        assert_eq!(outside.len(), 5);
        assert!(
            reach_m.skip(1).take(3).all(|m| (100.0..100.0 / 30.0_f64.to_radians().cos() + 1e-9).contains(&m))
        );
    }

    #[test]
    fn an_edge_too_short_for_its_corners_is_left_out() {
        // 10 m north before a long leg east: 100 m inside, there is no room for them
        let step = route(&[(0.0, 0.0), (0.0, 1000.0), (50.0, 1050.0), (50.0, 1060.0), (1000.0, 1060.0)]);
        let inside = step.beside(100.0, 0.0);
        assert_eq!(rounded_to_metres(inside), [(100, 0), (100, 959), (101, 960), (1000, 960)]);
    }

    #[test]
    fn ends_too_short_for_their_corner_are_left_out() {
        let hook = route(&[(0.0, 0.0), (0.0, 60.0), (1000.0, 60.0), (1000.0, 0.0)]);
        let inside = hook.beside(100.0, 0.0);
        assert_eq!(rounded_to_metres(inside), [(100, -40), (900, -40)]);
    }

    #[test]
    fn there_and_back_on_one_line_survives() {
        let back = route(&[(0.0, 0.0), (0.0, 1000.0), (0.0, 0.0)]);
        for right_m in [-100.0, 0.0, 100.0] {
            let path = back.beside(right_m, 10.0);
            assert!(path.len() >= 3 && path.iter().all(|p| p.length() < 1200.0), "{path:?}");
        }
    }

    #[test]
    fn bad_routes_name_the_point() {
        let at = |points: &[(f64, f64)]| {
            Route::new(&points.iter().map(|&(e, n)| Vec2::new(e, n)).collect::<Vec<_>>()).unwrap_err()
        };
        assert_eq!(at(&[]), PatternError::RoutePoints { points: 0 });
        assert_eq!(at(&[(0.0, 0.0)]), PatternError::RoutePoints { points: 1 });
        assert_eq!(at(&[(0.0, 0.0), (f64::NAN, 1.0)]), PatternError::RoutePoint { point: 1 });
        assert_eq!(at(&[(0.0, 0.0), (5.0, 1.0), (5.0, 1.0)]), PatternError::RoutePoint { point: 2 });
        let many = vec![(0.0, 0.0); MAX_POINTS + 1];
        assert_eq!(at(&many), PatternError::RoutePoints { points: MAX_POINTS + 1 });
    }
}
