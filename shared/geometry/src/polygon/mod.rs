//! Simple polygons with holes, in a local frame.

mod measure;
mod shortest_path;
mod validity;

pub(crate) use measure::{distance_to_segment_m, signed_area_m2};
pub use shortest_path::{EdgeBudget, Interior};
pub use validity::PolygonError;

use crate::{Flattening, LatLon, LocalFrame, Vec2};
use std::f64::consts::TAU;

/// Corners of all rings together; bounds what checking an outline from outside can cost.
pub const MAX_CORNERS: usize = 10_000;

/// A simple polygon, convex or concave, with simple holes inside it that do not touch each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    /// The outer ring, then the holes; not closed.
    rings: Vec<Vec<Vec2>>,
}

impl Polygon {
    /// From its rings, in either direction, closed or not (a last corner that repeats the
    /// first is dropped).
    ///
    /// # Errors
    /// The first rule that is broken, with the culprit's place.
    pub fn new(outer: Vec<Vec2>, holes: Vec<Vec<Vec2>>) -> Result<Self, PolygonError> {
        let mut rings = Vec::with_capacity(holes.len() + 1);
        rings.push(outer);
        rings.extend(holes);
        for ring in &mut rings {
            if ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
        }
        validity::check(&rings)?;
        Ok(Self { rings })
    }

    /// From positions, seen in a frame (see [`LocalFrame::around`]).
    ///
    /// # Errors
    /// As [`Polygon::new`], and [`PolygonError::TooFar`] or [`PolygonError::NearPole`] for a corner outside the frame's radius.
    pub fn from_geo(
        frame: &LocalFrame,
        outer: &[LatLon],
        holes: &[Vec<LatLon>],
    ) -> Result<Self, PolygonError> {
        let ring = |index: usize, corners: &[LatLon]| -> Result<Vec<Vec2>, PolygonError> {
            corners
                .iter()
                .enumerate()
                .map(|(corner, &p)| validity::local_corner(frame, p, index, corner))
                .collect()
        };
        let outer = ring(0, outer)?;
        let holes: Result<Vec<_>, _> = holes.iter().enumerate().map(|(i, hole)| ring(i + 1, hole)).collect();
        Self::new(outer, holes?)
    }

    /// A regular polygon around a circle: every point of the circle is inside, and no corner is
    /// outside by more than the tolerance (metres), as far as 3600 corners allow.
    ///
    /// # Errors
    /// [`PolygonError::Circle`] if radius or tolerance is not a positive number.
    pub fn circle(centre: Vec2, radius_m: f64, tolerance_m: f64) -> Result<Self, PolygonError> {
        const MOST: usize = 3600;
        if !(radius_m > 0.0 && tolerance_m > 0.0 && radius_m.is_finite()) {
            return Err(PolygonError::Circle);
        }
        let n = Flattening::Circumscribed.segments(radius_m, 360.0, tolerance_m).min(MOST);
        let step = TAU / n as f64;
        let corner_m = radius_m / (step / 2.0).cos();
        let corners =
            (0..n).map(|i| centre + Vec2::from_bearing_rad(step * (i as f64 + 0.5)) * corner_m).collect();
        Self::new(corners, Vec::new())
    }

    /// The outer ring, not closed.
    pub fn outer(&self) -> &[Vec2] {
        self.rings.first().map_or(&[], Vec::as_slice)
    }

    /// The holes' rings, not closed.
    pub fn holes(&self) -> &[Vec<Vec2>] {
        self.rings.get(1..).unwrap_or_default()
    }

    /// The outer ring alone.
    pub fn without_holes(&self) -> Self {
        Self { rings: self.rings.iter().take(1).cloned().collect() }
    }

    /// Every edge of every ring.
    pub fn edges(&self) -> impl Iterator<Item = (Vec2, Vec2)> + '_ {
        self.rings.iter().flat_map(|ring| ring_edges(ring))
    }
}

/// The edges of a ring that is not closed: edge `i` leaves corner `i`.
fn ring_edges(ring: &[Vec2]) -> impl Iterator<Item = (Vec2, Vec2)> + '_ {
    let next = ring.iter().cycle().skip(1);
    ring.iter().copied().zip(next.copied())
}

/// Whether a point is in an area that is given by its rings.
pub(crate) fn contains(rings: &[Vec<Vec2>], p: Vec2) -> bool {
    crosses_odd(rings.iter().flat_map(|ring| ring_edges(ring)), p)
}

/// Whether a point is in a ring that is not closed, by the even-odd rule.
pub fn is_in_ring(ring: &[Vec2], p: Vec2) -> bool {
    crosses_odd(ring_edges(ring), p)
}

/// Even-odd rule: a ray to the east crosses the edges an odd number of times.
fn crosses_odd(edges: impl Iterator<Item = (Vec2, Vec2)>, p: Vec2) -> bool {
    edges
        .filter(|(a, b)| (a.n > p.n) != (b.n > p.n))
        .filter(|(a, b)| p.e < a.e + (p.n - a.n) / (b.n - a.n) * (b.e - a.e))
        .count()
        % 2
        == 1
}

#[cfg(test)]
pub(crate) mod tests;
