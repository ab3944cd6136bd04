//! The polygon's edges in the pattern's axes, and the spans in which a line crosses it.

use super::Axes;
use crate::polygon::Polygon;

/// An edge, from its left to its right end (across the heading).
#[derive(Debug, Clone, Copy)]
struct Edge {
    left_m: f64,
    right_m: f64,
    /// Along the heading, at the left and the right end.
    along_left_m: f64,
    along_right_m: f64,
    slope: f64,
}

impl Edge {
    fn new((across_a, along_a): (f64, f64), (across_b, along_b): (f64, f64)) -> Self {
        let ((left_m, along_left_m), (right_m, along_right_m)) = if across_a <= across_b {
            ((across_a, along_a), (across_b, along_b))
        } else {
            ((across_b, along_b), (across_a, along_a))
        };
        let run_m = right_m - left_m;
        Self {
            left_m,
            right_m,
            along_left_m,
            along_right_m,
            slope: if run_m > 0.0 { (along_right_m - along_left_m) / run_m } else { 0.0 },
        }
    }

    #[inline]
    fn along_at(&self, across_m: f64) -> f64 {
        self.along_left_m + (across_m - self.left_m) * self.slope
    }

    /// Extent along the heading of the part between two places across it.
    fn extent_between(&self, left_m: f64, right_m: f64) -> Span {
        let a = if left_m > self.left_m { self.along_at(left_m) } else { self.along_left_m };
        let b = if right_m < self.right_m { self.along_at(right_m) } else { self.along_right_m };
        Span { start_m: a.min(b), end_m: a.max(b) }
    }
}

/// An interval along a line, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub start_m: f64,
    pub end_m: f64,
}

/// The edges, findable by where they begin and where they end.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    /// Sorted by left end.
    edges: Vec<Edge>,
    /// Indices of `edges`, sorted by right end.
    by_right: Vec<u32>,
    /// Where corners are, across the heading, sorted.
    corners_m: Vec<f64>,
}

impl Outline {
    pub fn new(polygon: &Polygon, axes: Axes) -> Self {
        let place = |p: crate::Vec2| (p.dot(axes.across), p.dot(axes.along));
        let mut edges: Vec<Edge> = polygon.edges().map(|(a, b)| Edge::new(place(a), place(b))).collect();
        edges.sort_by(|a, b| a.left_m.total_cmp(&b.left_m));
        let mut order: Vec<(f64, u32)> = (0..).zip(&edges).map(|(i, e)| (e.right_m, i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut corners_m: Vec<f64> = edges.iter().flat_map(|e| [e.left_m, e.right_m]).collect();
        corners_m.sort_by(f64::total_cmp);
        corners_m.dedup();
        Self { edges, by_right: order.into_iter().map(|(_, i)| i).collect(), corners_m }
    }

    /// Leftmost and rightmost corner.
    pub fn extent(&self) -> (f64, f64) {
        let first = self.corners_m.first().copied().unwrap_or_default();
        (first, self.corners_m.last().copied().unwrap_or(first))
    }

    fn right_of(&self, index: u32) -> f64 {
        self.edges.get(index as usize).map_or(f64::NAN, |e| e.right_m)
    }

    /// The corners' places before and after a line.
    fn slab(&self, across_m: f64) -> (f64, f64) {
        let after = self.corners_m.partition_point(|&c| c <= across_m);
        let at = |i: usize| self.corners_m.get(i).copied();
        let low = after.checked_sub(1).and_then(at);
        (low.unwrap_or(f64::NEG_INFINITY), at(after).unwrap_or(f64::INFINITY))
    }
}

/// The edges between two places across the heading, kept up to date as these move.
#[derive(Debug, Clone, Default)]
struct Window {
    edges: Vec<Edge>,
    /// Edges of the outline that begin left of the window's right side.
    begun: usize,
    /// Edges of the outline that end left of the window's left side.
    ended: usize,
}

impl Window {
    /// Holds the edges that begin at or before `right_m` and end after `left_m`. What it costs
    /// is what comes and goes, in either direction.
    fn move_to(&mut self, outline: &Outline, left_m: f64, right_m: f64) {
        let begun = outline.edges.partition_point(|e| e.left_m <= right_m);
        let ended = outline.by_right.partition_point(|&i| outline.right_of(i) <= left_m);
        self.edges.retain(|e| e.left_m <= right_m && e.right_m > left_m);
        let come = outline.edges.get(self.begun..begun).unwrap_or_default();
        self.edges.extend(come.iter().filter(|e| e.right_m > left_m));
        let back = outline.by_right.get(ended..self.ended).unwrap_or_default();
        let back = back.iter().filter_map(|&i| outline.edges.get(i as usize));
        self.edges.extend(back.filter(|e| e.left_m <= right_m));
        (self.begun, self.ended) = (begun, ended);
    }
}

/// A line moved across an outline, and where it scans there.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    /// Edges crossed by the line, in order along it: edges of a simple polygon keep their order
    /// between two corners.
    crossed: Window,
    /// Corners before and after the line: as long as it stays between them nothing changes.
    slab: (f64, f64),
    strip: Window,
    bounds_m: Vec<f64>,
    /// Room for joining spans; empty between calls.
    spans: Vec<Span>,
}

impl Default for Sweep {
    fn default() -> Self {
        Self {
            crossed: Window::default(),
            slab: (f64::INFINITY, f64::NEG_INFINITY),
            strip: Window::default(),
            bounds_m: Vec::new(),
            spans: Vec::new(),
        }
    }
}

impl Sweep {
    /// Where the line scans: start and end of the first span, of the second, and so on,
    /// ascending.
    pub fn bounds_m(&self) -> &[f64] {
        &self.bounds_m
    }

    /// Moves to a line. `strip_m`: half-width of the strip whose whole extent is to be scanned;
    /// `overshoot_m`: by how much the line itself goes on.
    #[inline]
    pub fn go_to(&mut self, outline: &Outline, across_m: f64, strip_m: f64, overshoot_m: f64) {
        if !self.is_between_corners(across_m) {
            self.enter_slab(outline, across_m);
        }
        self.bounds_m.clear();
        let crossings = self.crossed.edges.iter().map(|e| e.along_at(across_m));
        self.bounds_m.extend(crossings);
        if overshoot_m > 0.0 {
            self.prolong(outline, across_m, strip_m, overshoot_m);
        } else if !self.bounds_m.is_sorted_by(|a, b| a < b) {
            self.tidy();
        }
    }

    /// Whether no corner of the outline is between the line it is at and another one.
    pub fn is_between_corners(&self, across_m: f64) -> bool {
        self.slab.0 <= across_m && across_m < self.slab.1
    }

    fn enter_slab(&mut self, outline: &Outline, across_m: f64) {
        self.slab = outline.slab(across_m);
        self.crossed.move_to(outline, across_m, across_m);
        let middle_m = (self.slab.0 + self.slab.1) / 2.0;
        self.crossed.edges.sort_by(|a, b| a.along_at(middle_m).total_cmp(&b.along_at(middle_m)));
    }

    fn prolong(&mut self, outline: &Outline, across_m: f64, strip_m: f64, overshoot_m: f64) {
        self.bounds_m.sort_unstable_by(f64::total_cmp);
        self.spans.extend(
            spans(&self.bounds_m)
                .map(|s| Span { start_m: s.start_m - overshoot_m, end_m: s.end_m + overshoot_m }),
        );
        let (left_m, right_m) = (across_m - strip_m, across_m + strip_m);
        self.strip.move_to(outline, left_m, right_m);
        let edges = self.strip.edges.iter();
        self.spans.extend(edges.map(|e| e.extent_between(left_m, right_m)));
        self.join();
    }

    /// A line through a corner: rounding may have swapped crossings, spans may be empty or touch.
    #[cold]
    fn tidy(&mut self) {
        self.bounds_m.sort_unstable_by(f64::total_cmp);
        let spans = spans(&self.bounds_m).filter(|s| s.start_m < s.end_m);
        self.spans.extend(spans);
        self.join();
    }

    fn join(&mut self) {
        merge(&mut self.spans);
        self.bounds_m.clear();
        let joined = self.spans.drain(..);
        self.bounds_m.extend(joined.flat_map(|s| [s.start_m, s.end_m]));
    }
}

/// The spans between bounds that come in pairs.
pub(super) fn spans(bounds_m: &[f64]) -> impl Iterator<Item = Span> + '_ {
    bounds_m.chunks_exact(2).filter_map(|pair| match pair {
        &[start_m, end_m] => Some(Span { start_m, end_m }),
        _ => None,
    })
}

/// Sorts spans and joins those that overlap.
pub(super) fn merge(spans: &mut Vec<Span>) {
    spans.sort_unstable_by(|a, b| a.start_m.total_cmp(&b.start_m));
    spans.dedup_by(|next, kept| {
        let joined = next.start_m <= kept.end_m;
        if joined {
            kept.end_m = kept.end_m.max(next.end_m);
        }
        joined
    });
}
