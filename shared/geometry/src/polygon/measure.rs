//! Areas, distances and widths of a polygon.

use super::{Polygon, crosses_odd, ring_edges};
use crate::Vec2;

impl Polygon {
    /// Area without the holes, square metres.
    pub fn area_m2(&self) -> f64 {
        let holes: f64 = self.holes().iter().map(|h| signed_area_m2(h).abs()).sum();
        signed_area_m2(self.outer()).abs() - holes
    }

    /// Centre of gravity of the area without the holes; it may lie outside a concave polygon.
    pub fn centroid(&self) -> Vec2 {
        let (moment, area_m2) = first_moment(self.outer());
        let sign = area_m2.signum();
        let mut sum = (moment * sign, area_m2 * sign);
        for hole in self.holes() {
            let (moment, area_m2) = first_moment(hole);
            let sign = area_m2.signum();
            sum = (sum.0 - moment * sign, sum.1 - area_m2 * sign);
        }
        sum.0 * sum.1.recip()
    }

    /// Whether a point is in the area (and in no hole). Edges may count either way.
    pub fn contains(&self, p: Vec2) -> bool {
        crosses_odd(self.edges(), p)
    }

    /// Distance from a point to the nearest edge of any ring, metres.
    pub fn distance_to_edge_m(&self, p: Vec2) -> f64 {
        self.edges().map(|(a, b)| distance_to_segment_m(a, b, p)).fold(f64::INFINITY, f64::min)
    }

    /// How far outside the area a point is, metres; 0 inside.
    pub fn distance_outside_m(&self, p: Vec2) -> f64 {
        if self.contains(p) { 0.0 } else { self.distance_to_edge_m(p) }
    }

    /// Whether it has no hole and turns one way only.
    pub fn is_convex(&self) -> bool {
        let outer = self.outer();
        let turns =
            || ring_edges(outer).zip(outer.iter().cycle().skip(2)).map(|((a, b), &c)| (b - a).cross(c - b));
        self.holes().is_empty() && (turns().all(|t| t >= 0.0) || turns().all(|t| t <= 0.0))
    }

    /// Extent across a heading, metres: what tracks along that heading have to cover.
    pub fn width_m(&self, heading_deg: f64) -> f64 {
        let across = Vec2::from_bearing_rad((heading_deg + 90.0).to_radians());
        let (low, high) = extent(self.outer(), across);
        high - low
    }

    /// The heading of the fewest parallel tracks, each of them as often as holes and bays divide it: degrees in 0..180.
    ///
    /// Tracks cross the edges as often as those are long across the heading. That sum is concave from the heading of one edge to that
    /// of the next, so that it is smallest along one of them; for a convex area that is [`Self::narrowest_heading_deg`].
    pub fn fewest_tracks_heading_deg(&self) -> f64 {
        let mut ways: Vec<Vec2> = self.edges().map(|(a, b)| b - a).collect();
        for way in &mut ways {
            if way.e < 0.0 || (way.e == 0.0 && way.n < 0.0) {
                *way = *way * -1.0;
            }
        }
        let narrowest_deg = self.narrowest_heading_deg();
        let across = Vec2::from_bearing_rad((narrowest_deg + 90.0).to_radians());
        let mut best = (ways.iter().map(|way| way.dot(across).abs()).sum::<f64>(), narrowest_deg);
        ways.sort_by(|a, b| a.bearing_rad().total_cmp(&b.bearing_rad()));
        let (mut before, mut after) =
            (Vec2::default(), ways.iter().fold(Vec2::default(), |sum, way| sum + *way));
        for way in ways {
            after = after - way;
            let sum_m = (way * way.length().recip()).cross(after - before).abs();
            // rounding must not make equal ones differ
            if sum_m < best.0 - 1e-3 {
                best = (sum_m, way.bearing_rad().to_degrees().rem_euclid(180.0));
            }
            before = before + way;
        }
        best.1
    }

    /// The heading across which the extent is smallest: degrees in 0..180. It is that of an edge of the convex hull (rotating
    /// calipers); of equal ones, the first.
    pub fn narrowest_heading_deg(&self) -> f64 {
        let hull = hull(self.outer());
        let n = hull.len();
        let corner = |i: usize| hull.get(i % n.max(1)).copied().unwrap_or_default();
        let mut far = 1;
        let mut best = (f64::INFINITY, 0.0);
        for i in 0..n {
            let (a, way) = (corner(i), corner(i + 1) - corner(i));
            let away = |p: Vec2| way.cross(p - a);
            while far < i + n && away(corner(far + 1)) > away(corner(far)) {
                far += 1;
            }
            let width_m = away(corner(far)) / way.length();
            // a millimetre: rounding must not make equal widths differ
            if width_m < best.0 - 1e-3 {
                best = (width_m, way.bearing_rad().to_degrees().rem_euclid(180.0));
            }
        }
        best.1
    }
}

/// Least and greatest coordinate along a direction.
pub(crate) fn extent(corners: &[Vec2], direction: Vec2) -> (f64, f64) {
    corners
        .iter()
        .map(|c| c.dot(direction))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Shoelace formula, relative to the first corner for accuracy; positive anticlockwise.
pub(crate) fn signed_area_m2(ring: &[Vec2]) -> f64 {
    let origin = ring.first().copied().unwrap_or_default();
    ring_edges(ring).map(|(a, b)| (a - origin).cross(b - origin)).sum::<f64>() / 2.0
}

/// First moment and area, both signed.
fn first_moment(ring: &[Vec2]) -> (Vec2, f64) {
    let origin = ring.first().copied().unwrap_or_default();
    let mut moment = Vec2::default();
    for (a, b) in ring_edges(ring) {
        let (a, b) = (a - origin, b - origin);
        moment = moment + (a + b) * (a.cross(b) / 6.0);
    }
    let area_m2 = signed_area_m2(ring);
    (moment + origin * area_m2, area_m2)
}

/// Distance from a point to a straight piece, metres.
pub(crate) fn distance_to_segment_m(a: Vec2, b: Vec2, p: Vec2) -> f64 {
    (p - foot(a, b, p)).length()
}

/// The place of a straight piece that is nearest to a point.
pub(super) fn foot(a: Vec2, b: Vec2, p: Vec2) -> Vec2 {
    let way = b - a;
    let share = ((p - a).dot(way) / way.dot(way)).clamp(0.0, 1.0);
    a + way * share
}

/// Convex hull, anticlockwise, without collinear corners (monotone chain).
fn hull(corners: &[Vec2]) -> Vec<Vec2> {
    let mut sorted = corners.to_vec();
    sorted.sort_by(|a, b| a.e.total_cmp(&b.e).then(a.n.total_cmp(&b.n)));
    let mut lower = half_hull(sorted.iter().copied());
    let mut upper = half_hull(sorted.iter().rev().copied());
    // each half ends where the other begins
    lower.pop();
    upper.pop();
    lower.append(&mut upper);
    lower
}

fn half_hull(corners: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut half: Vec<Vec2> = Vec::new();
    for c in corners {
        while let [.., a, b] = half.as_slice()
            && (*b - *a).cross(c - *b) <= 0.0
        {
            half.pop();
        }
        half.push(c);
    }
    half
}
