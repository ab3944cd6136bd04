//! What makes rings a polygon, and who is to blame when they are none.

use super::{MAX_CORNERS, crosses_odd, ring_edges};
use crate::local::RADIUS_M;
use crate::{LatLon, LocalFrame, Vec2};

/// Why rings are no polygon. Rings count from 0 (the outer ring), then come the holes; corners and
/// edges count from 0, edge `i` leaving corner `i`.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PolygonError {
    /// Fewer than three corners.
    #[error("ring {ring} has {corners} corners: give it at least 3")]
    TooFewCorners {
        /// The ring.
        ring: usize,
        /// How many it has.
        corners: usize,
    },
    /// More than [`MAX_CORNERS`] in all.
    #[error("the area has {corners} corners: simplify it to at most {MAX_CORNERS}")]
    TooManyCorners {
        /// How many there are.
        corners: usize,
    },
    /// NaN or infinite.
    #[error("corner {corner} of ring {ring} is not a position")]
    NotFinite {
        /// The ring.
        ring: usize,
        /// The corner.
        corner: usize,
    },
    /// Outside the local frame's radius, as large as it is away from the poles.
    #[error("corner {corner} of ring {ring} is {distance_m:.0} m from the middle: split the area")]
    TooFar {
        /// The ring.
        ring: usize,
        /// The corner.
        corner: usize,
        /// How far.
        distance_m: f64,
    },
    /// Outside the local frame's radius, which is so small because a pole is near.
    #[error(
        "corner {corner} of ring {ring} is {distance_m:.0} m from the middle, and so near the pole areas reach {most_m:.0} m at most: make it smaller, or move it away from the pole"
    )]
    NearPole {
        /// The ring.
        ring: usize,
        /// The corner.
        corner: usize,
        /// How far.
        distance_m: f64,
        /// How far it may be there.
        most_m: f64,
    },
    /// A corner lies on the next one.
    #[error("corner {corner} of ring {ring} lies on the one after it: remove one of them")]
    RepeatedCorner {
        /// The ring.
        ring: usize,
        /// The first of them.
        corner: usize,
    },
    /// Two edges of a ring cross, touch or overlap.
    #[error("edges {edge_a} and {edge_b} of ring {ring} cross: move a corner between them")]
    SelfCrossing {
        /// The ring.
        ring: usize,
        /// One edge.
        edge_a: usize,
        /// The other, later one.
        edge_b: usize,
    },
    /// Edges of two rings cross or touch.
    #[error("edge {edge_a} of ring {ring_a} crosses edge {edge_b} of ring {ring_b}: move them apart")]
    RingsCross {
        /// One ring.
        ring_a: usize,
        /// Its edge.
        edge_a: usize,
        /// The other, later ring.
        ring_b: usize,
        /// Its edge.
        edge_b: usize,
    },
    /// A hole is not inside the outer ring.
    #[error("hole {ring} is outside the area: move or remove it")]
    HoleOutside {
        /// The hole's ring.
        ring: usize,
    },
    /// A hole is inside another hole.
    #[error("hole {inner} is inside hole {outer}: remove it")]
    HoleInHole {
        /// The inner hole's ring.
        inner: usize,
        /// The outer hole's ring.
        outer: usize,
    },
    /// A circle's radius or tolerance is not a positive number.
    #[error("a circle needs a positive radius and a positive tolerance")]
    Circle,
}

/// A corner in a frame, if it is one and near enough.
pub(super) fn local_corner(
    frame: &LocalFrame,
    p: LatLon,
    ring: usize,
    corner: usize,
) -> Result<Vec2, PolygonError> {
    if !p.is_valid() {
        return Err(PolygonError::NotFinite { ring, corner });
    }
    // the frame's series mean nothing far away: ask whether it is near before using them
    let distance_m = frame.origin().distance_m(p);
    let most_m = frame.radius_m();
    if distance_m > RADIUS_M {
        return Err(PolygonError::TooFar { ring, corner, distance_m });
    }
    if distance_m > most_m {
        return Err(PolygonError::NearPole { ring, corner, distance_m, most_m });
    }
    Ok(frame.to_local(p))
}

/// Checks every rule; the cheap ones first.
pub(super) fn check(rings: &[Vec<Vec2>]) -> Result<(), PolygonError> {
    let corners = rings.iter().map(Vec::len).sum();
    if corners > MAX_CORNERS {
        return Err(PolygonError::TooManyCorners { corners });
    }
    for (ring, corners) in rings.iter().enumerate() {
        check_ring(ring, corners)?;
    }
    check_crossings(rings)?;
    check_nesting(rings)
}

fn check_ring(ring: usize, corners: &[Vec2]) -> Result<(), PolygonError> {
    if corners.len() < 3 {
        return Err(PolygonError::TooFewCorners { ring, corners: corners.len() });
    }
    if let Some(corner) = corners.iter().position(|c| !c.length().is_finite()) {
        return Err(PolygonError::NotFinite { ring, corner });
    }
    match ring_edges(corners).position(|(a, b)| a == b) {
        Some(corner) => Err(PolygonError::RepeatedCorner { ring, corner }),
        None => Ok(()),
    }
}

/// An edge with its place.
struct Placed {
    ring: usize,
    edge: usize,
    of: usize,
    a: Vec2,
    b: Vec2,
}

impl Placed {
    fn west(&self) -> f64 {
        self.a.e.min(self.b.e)
    }
    fn east(&self) -> f64 {
        self.a.e.max(self.b.e)
    }
    fn overlaps_north(&self, o: &Placed) -> bool {
        self.a.n.min(self.b.n) <= o.a.n.max(o.b.n) && o.a.n.min(o.b.n) <= self.a.n.max(self.b.n)
    }
    /// Cross, touch or overlap other than in the corner that neighbours share.
    fn conflicts(&self, o: &Placed) -> bool {
        if self.ring == o.ring && (self.edge + 1) % self.of == o.edge {
            return folds_back(self.a, self.b, o.b);
        }
        if self.ring == o.ring && (o.edge + 1) % o.of == self.edge {
            return folds_back(o.a, o.b, self.b);
        }
        touch(self.a, self.b, o.a, o.b)
    }
    fn error(&self, o: &Placed) -> PolygonError {
        let (x, y) = if (self.ring, self.edge) <= (o.ring, o.edge) { (self, o) } else { (o, self) };
        if x.ring == y.ring {
            return PolygonError::SelfCrossing { ring: x.ring, edge_a: x.edge, edge_b: y.edge };
        }
        PolygonError::RingsCross { ring_a: x.ring, edge_a: x.edge, ring_b: y.ring, edge_b: y.edge }
    }
}

/// Sweeps from west to east; only edges that overlap in both coordinates are compared.
fn check_crossings(rings: &[Vec<Vec2>]) -> Result<(), PolygonError> {
    let mut edges: Vec<Placed> = Vec::new();
    for (ring, corners) in rings.iter().enumerate() {
        let of = corners.len();
        edges.extend(ring_edges(corners).enumerate().map(|(edge, (a, b))| Placed { ring, edge, of, a, b }));
    }
    edges.sort_by(|x, y| x.west().total_cmp(&y.west()));
    for (i, edge) in edges.iter().enumerate() {
        let later = edges.iter().skip(i + 1);
        let culprit = later
            .take_while(|o| o.west() <= edge.east())
            .find(|o| edge.overlaps_north(o) && edge.conflicts(o));
        if let Some(other) = culprit {
            return Err(edge.error(other));
        }
    }
    Ok(())
}

/// Whether the edge after `a`→`b` goes back over it.
fn folds_back(a: Vec2, b: Vec2, c: Vec2) -> bool {
    (b - a).cross(c - b) == 0.0 && (b - a).dot(c - b) < 0.0
}

fn touch(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> bool {
    let side = |p: Vec2, q: Vec2, r: Vec2| (q - p).cross(r - p);
    let (c_side, d_side) = (side(a, b, c), side(a, b, d));
    let (a_side, b_side) = (side(c, d, a), side(c, d, b));
    // collinear edges get here only if their bounding boxes overlap: then they do, too
    c_side * d_side <= 0.0 && a_side * b_side <= 0.0
}

fn check_nesting(rings: &[Vec<Vec2>]) -> Result<(), PolygonError> {
    let inside = |ring: &[Vec2], p: Vec2| crosses_odd(ring_edges(ring), p);
    let Some((outer, holes)) = rings.split_first() else {
        return Ok(());
    };
    for (i, hole) in holes.iter().enumerate() {
        let Some(&corner) = hole.first() else {
            continue;
        };
        if !inside(outer, corner) {
            return Err(PolygonError::HoleOutside { ring: i + 1 });
        }
        let around = |(j, other): (usize, &Vec<Vec2>)| i != j && inside(other, corner);
        if let Some(j) = holes.iter().enumerate().position(around) {
            return Err(PolygonError::HoleInHole { inner: i + 1, outer: j + 1 });
        }
    }
    Ok(())
}
