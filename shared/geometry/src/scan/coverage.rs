//! How much of an area was really seen.

use super::outline::{Span, Sweep, merge, spans};
use super::{Axes, Outline};
use crate::Vec2;
use crate::polygon::Polygon;

/// Rows across the area; each is measured exactly along its length.
const ROWS: usize = 1024;

/// Share (0..=1) of a polygon that lies within `half_width_m` of straight tracks.
///
/// Measured on 1024 evenly spaced east-west rows: along a row the polygon and the reach of each
/// track are intervals, whose union is exact; between rows the midpoint rule is used. No
/// randomness. Tracks that are not numbers count for nothing.
pub fn coverage(polygon: &Polygon, tracks: impl IntoIterator<Item = (Vec2, Vec2)>, half_width_m: f64) -> f64 {
    // rows run east; `across` then points south
    let axes = Axes::new(90.0);
    let outline = Outline::new(polygon, axes);
    let rows = Rows::new(outline.extent());
    let mut seen: Vec<Vec<Span>> = vec![Vec::new(); ROWS];
    for (a, b) in tracks {
        let (a, b) = (in_axes(axes, a), in_axes(axes, b));
        for row in rows.touched(a, b, half_width_m) {
            if let (Some(spans), Some(span)) =
                (seen.get_mut(row), reach(a, b, half_width_m, rows.across_m(row)))
            {
                // instead of growing, join what overlaps: memory follows the pattern, not its age
                if spans.len() == spans.capacity() {
                    merge(spans);
                }
                spans.push(span);
            }
        }
    }
    let mut sweep = Sweep::default();
    let (mut area, mut covered) = (0.0, 0.0);
    for (row, reached) in seen.iter_mut().enumerate() {
        sweep.go_to(&outline, rows.across_m(row), 0.0, 0.0);
        merge(reached);
        let inside: Vec<Span> = spans(sweep.bounds_m()).collect();
        area += inside.iter().map(|s| s.end_m - s.start_m).sum::<f64>();
        covered += overlap_m(&inside, reached);
    }
    if area > 0.0 { covered / area } else { 0.0 }
}

/// (along, across) coordinates.
fn in_axes(axes: Axes, p: Vec2) -> Vec2 {
    Vec2::new(p.dot(axes.along), p.dot(axes.across))
}

struct Rows {
    first_m: f64,
    step_m: f64,
}

impl Rows {
    fn new((low, high): (f64, f64)) -> Self {
        let step_m = (high - low) / ROWS as f64;
        Self { first_m: low + step_m / 2.0, step_m }
    }
    fn across_m(&self, row: usize) -> f64 {
        self.first_m + row as f64 * self.step_m
    }
    /// The rows that a track may reach.
    fn touched(&self, a: Vec2, b: Vec2, half_width_m: f64) -> std::ops::Range<usize> {
        let row = |across_m: f64| (across_m - self.first_m) / self.step_m;
        // a cast of a negative number or NaN gives 0
        let first = row(a.n.min(b.n) - half_width_m).ceil() as usize;
        let end = (row(a.n.max(b.n) + half_width_m).floor() + 1.0) as usize;
        first..end.min(ROWS)
    }
}

/// The part of a row within `r` of the segment a–b: the row's chord of the discs around the ends
/// and of the rectangle between them. Their union is convex, hence one interval.
fn reach(a: Vec2, b: Vec2, r: f64, across_m: f64) -> Option<Span> {
    let mut span = Span { start_m: f64::INFINITY, end_m: f64::NEG_INFINITY };
    let mut include = |along_m: f64| {
        span.start_m = span.start_m.min(along_m);
        span.end_m = span.end_m.max(along_m);
    };
    for end in [a, b] {
        let off_m = across_m - end.n;
        if off_m.abs() <= r {
            let half_chord_m = (r * r - off_m * off_m).sqrt();
            include(end.e - half_chord_m);
            include(end.e + half_chord_m);
        }
    }
    let way = b - a;
    if way.length() > 0.0 {
        let aside = Vec2::new(-way.n, way.e) * (r / way.length());
        for (p, q) in [(a + aside, b + aside), (a - aside, b - aside)] {
            let (low, high) = (p.n.min(q.n), p.n.max(q.n));
            if low <= across_m && across_m <= high && high > low {
                include(p.e + (across_m - p.n) / (q.n - p.n) * (q.e - p.e));
            }
        }
    }
    (span.start_m <= span.end_m).then_some(span)
}

/// Length that two sorted lists of disjoint spans have in common.
fn overlap_m(a: &[Span], b: &[Span]) -> f64 {
    let (mut i, mut j, mut sum) = (0, 0, 0.0);
    while let (Some(x), Some(y)) = (a.get(i), b.get(j)) {
        sum += (x.end_m.min(y.end_m) - x.start_m.max(y.start_m)).max(0.0);
        if x.end_m < y.end_m {
            i += 1;
        } else {
            j += 1;
        }
    }
    sum
}
