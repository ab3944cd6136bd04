//! Parallel scans over any simple polygon, generated as they are flown.
//!
//! A scan is a set of parallel *lines* across the polygon, numbered from its left edge, flown as
//! *tracks*, numbered in flight order. A line that crosses a gap (a hole, a bay of a concave
//! outline) has several scanning segments. [`Scan`] goes line by line and marks the gaps as transit. [`CellScan`] is what an
//! aircraft flies to stay over the area: cell by cell, with a path inside the area from one cell to the next.
//! Nothing is stored per line: a million tracks take the memory of the polygon.
//!
//! What leads outside the area: the overshoot, and beyond it only turns, that is one turn radius beyond the ends of tracks and
//! as far aside as the next track.
//!
//! Tracks can be addressed by number, so a scan can be resumed anywhere, flown backwards, or regenerated in flight.

mod camera;
mod cells;
mod coverage;
mod order;
mod outline;
mod segments;

pub use camera::camera_spacing_m;
pub use cells::CellScan;
pub use coverage::coverage;
pub(crate) use order::Order;
pub use segments::{ScanWaypoint, Segment, Segments, Waypoints};

use crate::polygon::Polygon;
use crate::{LocalFrame, Vec2};
use outline::{Outline, Sweep};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// More lines than this can't be numbered exactly in an `f64`.
const MAX_LINES: f64 = 9e15;

/// How a polygon is to be scanned.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ScanParameters {
    /// Greatest distance between neighbouring lines, metres. As few lines as that allows are spread evenly over the
    /// polygon's extent, the first and the last one half their distance inside.
    pub spacing_m: f64,
    /// For a scan that replaces another one and keeps its lines: a place on the border between two of the old strips
    /// ([`Scan::grid`]). Lines are then `spacing_m` apart, counted from there. The outermost ones lie in the middle of what is
    /// left of their strips, so they may be nearer to their neighbours, down to half the spacing. An area that one line covers
    /// has one, in its middle.
    pub grid: Option<Vec2>,
    /// Direction of the lines, degrees true; `None`: the one with the fewest lines.
    pub heading_deg: Option<f64>,
    /// How far a track goes on beyond the area's edge, metres. No point of a scanning segment is
    /// farther outside the area. With half the spacing or more, every point of the area is
    /// within half the spacing of a scanning segment, for any shape of the area: where the edge is
    /// slanted, tracks are extended as far as their strip needs it.
    pub overshoot_m: f64,
    /// Where the pattern begins.
    pub entry: Entry,
    /// Radius of the turns between tracks, metres. If neighbouring lines are nearer than twice this radius, each turn skips
    /// to a line k or more away, k · spacing ≥ 2 · radius, and the lines between are flown later. 0: each line after its
    /// neighbour.
    pub turn_radius_m: f64,
}

/// Where a scan begins.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Entry {
    /// At the corner whose first waypoint is nearest to a point.
    Nearest(Vec2),
    /// At a certain corner.
    Corner(Corner),
}

/// A corner of the pattern, seen along its heading: at the lines' start or end, left or right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Corner {
    /// Leftmost line, flown along the heading.
    StartLeft,
    /// Rightmost line, flown along the heading.
    StartRight,
    /// Leftmost line, flown against the heading.
    EndLeft,
    /// Rightmost line, flown against the heading.
    EndRight,
}

impl Corner {
    const ALL: [Corner; 4] = [Corner::StartLeft, Corner::StartRight, Corner::EndLeft, Corner::EndRight];
    fn is_right(self) -> bool {
        matches!(self, Corner::StartRight | Corner::EndRight)
    }
    fn is_end(self) -> bool {
        matches!(self, Corner::EndLeft | Corner::EndRight)
    }
}

/// Why a polygon can't be scanned with these parameters.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ScanError {
    /// Not a positive number.
    #[error("the spacing is {0} m: it must be a positive number")]
    Spacing(f64),
    /// Not a number.
    #[error("the heading is {0}: it must be a number of degrees")]
    Heading(f64),
    /// Negative or not a number.
    #[error("the overshoot is {0} m: it must be 0 or more")]
    Overshoot(f64),
    /// Negative or not a number.
    #[error("the turn radius is {0} m: it must be 0 or more")]
    TurnRadius(f64),
    /// The entry point is not a number.
    #[error("the point that the scan should begin near to is not a position")]
    EntryPoint,
    /// The border of the strips is not a number.
    #[error("the place on the border between two strips is not a position")]
    Grid,
    /// More lines than can be counted.
    #[error("a spacing of {0} m gives more lines than can be counted: widen it")]
    TooManyLines(f64),
    /// A concave area with too many cells, or a search for paths inside that ran out of its budget.
    #[error(
        "an area of {corners} corners is too intricate to be flown cell by cell: simplify it, or give an overshoot of half its gaps"
    )]
    TooIntricate {
        /// Of the area.
        corners: usize,
    },
    /// The camera is not above the ground.
    #[error("the camera is {0} m above the ground: it must be a positive number")]
    CameraHeight(f64),
    /// Not between 0 and 180 degrees.
    #[error("the camera's field of view is {0}°: it must be between 0 and 180")]
    FieldOfView(f64),
    /// Not between 0 and 1: strips that overlap completely never cover new ground.
    #[error("the side overlap is {0}: it must be 0 or more and below 1")]
    SideOverlap(f64),
}

/// A scan, ready to be flown.
#[derive(Debug, Clone)]
pub struct Scan {
    outline: Outline,
    axes: Axes,
    lines: Lines,
    order: Order,
    heading_deg: f64,
    overshoot_m: f64,
    /// Half-width of the strip that a track covers and is extended for, metres.
    strip_m: f64,
}

/// Directions of the pattern: `along` its lines, and `across` them to the right.
#[derive(Debug, Clone, Copy)]
struct Axes {
    along: Vec2,
    across: Vec2,
}

impl Axes {
    fn new(heading_deg: f64) -> Self {
        let along = Vec2::from_bearing_rad(heading_deg.to_radians());
        Self { along, across: Vec2::new(along.n, -along.e) }
    }
}

/// Where the lines are, across the heading: each in the middle of the strip that it covers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lines {
    /// Where the first strip begins: at the left edge or, on a given grid, outside it.
    begin_m: f64,
    /// Width of a strip.
    spacing_m: f64,
    count: u64,
    /// The first and the last line: in the middle of what is left of their strips.
    first_m: f64,
    last_m: f64,
}

impl Lines {
    /// As few lines as possible, evenly spread, no more than `most_m` apart; the outer ones half a spacing inside the edges.
    pub fn even((left_m, right_m): (f64, f64), most_m: f64) -> Result<Self, ScanError> {
        let count = strips(right_m - left_m, most_m)?;
        Ok(Self::strips_of((right_m - left_m) / count as f64, left_m, count, (left_m, right_m)))
    }
    /// Lines of strips of one width, one of which begins at `grid_m`. The outer strips end at the edges. What one strip covers
    /// has one line, even where a border between two strips divides it.
    fn on_grid((left_m, right_m): (f64, f64), spacing_m: f64, grid_m: f64) -> Result<Self, ScanError> {
        // tolerates rounding: a strip that ends at the edge is not in the area
        let first = ((left_m - grid_m) / spacing_m + 1e-9).floor();
        let begin_m = grid_m + first * spacing_m;
        let count = strips(right_m - begin_m, spacing_m)?;
        let lines = Self::strips_of(spacing_m, begin_m, count, (left_m, right_m));
        if strips(right_m - left_m, spacing_m)? > 1 {
            return Ok(lines);
        }
        let middle_m = (left_m + right_m) / 2.0;
        Ok(Self { count: 1, first_m: middle_m, last_m: middle_m, ..lines })
    }
    fn strips_of(spacing_m: f64, begin_m: f64, count: u64, (left_m, right_m): (f64, f64)) -> Self {
        let middle_m = |strip: u64| {
            let begin_m = begin_m + strip as f64 * spacing_m;
            (begin_m.max(left_m) + (begin_m + spacing_m).min(right_m)) / 2.0
        };
        let (first_m, last_m) = (middle_m(0), middle_m(count.saturating_sub(1)));
        Self { begin_m, spacing_m, count, first_m, last_m }
    }
    pub fn count(&self) -> u64 {
        self.count
    }
    pub fn spacing_m(&self) -> f64 {
        self.spacing_m
    }
    #[inline]
    pub fn across_m(&self, line: u64) -> f64 {
        // the middle of a whole strip; the middle of a cut outer strip is farther inside
        (self.begin_m + (line as f64 + 0.5) * self.spacing_m).max(self.first_m).min(self.last_m)
    }
    fn nearest(&self, across_m: f64) -> u64 {
        // a cast of NaN or of a negative number gives 0
        let strip = ((across_m - self.begin_m) / self.spacing_m) as u64;
        let last = self.count.saturating_sub(1);
        let around = [strip.saturating_sub(1), strip, strip.saturating_add(1)].map(|line| line.min(last));
        let off_m = |line: &u64| (self.across_m(*line) - across_m).abs();
        around.into_iter().min_by(|a, b| off_m(a).total_cmp(&off_m(b))).unwrap_or(0)
    }
}

/// How many strips make up a width.
fn strips(width_m: f64, spacing_m: f64) -> Result<u64, ScanError> {
    // tolerates rounding: a width of 10 spacings has 10 strips
    let count = (width_m / spacing_m * (1.0 - 1e-12) - 1e-9).ceil().max(1.0);
    if count > MAX_LINES {
        return Err(ScanError::TooManyLines(spacing_m));
    }
    Ok(count as u64)
}

impl Scan {
    /// Prepares a scan.
    ///
    /// # Errors
    /// An invalid parameter, or too many lines.
    pub fn new(polygon: &Polygon, p: &ScanParameters) -> Result<Self, ScanError> {
        p.check()?;
        let heading_deg = p.heading_deg.unwrap_or_else(|| polygon.fewest_tracks_heading_deg());
        let axes = Axes::new(heading_deg);
        let outline = Outline::new(polygon, axes);
        let lines = match p.grid {
            None => Lines::even(outline.extent(), p.spacing_m)?,
            Some(place) => Lines::on_grid(outline.extent(), p.spacing_m, place.dot(axes.across))?,
        };
        let order = |corner| Order::interleaved(lines.count, p.turn_radius_m, lines.spacing_m, corner);
        let mut scan = Self {
            outline,
            axes,
            lines,
            order: order(Corner::StartLeft),
            heading_deg,
            overshoot_m: p.overshoot_m,
            strip_m: p.overshoot_m.min(lines.spacing_m / 2.0),
        };
        scan.order = order(scan.corner(p.entry));
        Ok(scan)
    }

    fn corner(&self, entry: Entry) -> Corner {
        let near = match entry {
            Entry::Corner(corner) => return corner,
            Entry::Nearest(point) => point,
        };
        let distance_m = |corner: &Corner| {
            let from = self.first_point(*corner);
            from.map_or(f64::INFINITY, |from| (from - near).length())
        };
        let best = Corner::ALL.into_iter().min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
        best.unwrap_or(Corner::StartLeft)
    }

    /// Where a pattern that enters at a corner begins.
    fn first_point(&self, corner: Corner) -> Option<Vec2> {
        let line = if corner.is_right() { self.lines.count.saturating_sub(1) } else { 0 };
        let across_m = self.lines.across_m(line);
        let mut sweep = Sweep::default();
        sweep.go_to(&self.outline, across_m, self.strip_m, self.overshoot_m);
        let bounds_m = sweep.bounds_m();
        let along_m = if corner.is_end() { bounds_m.last() } else { bounds_m.first() };
        along_m.map(|&along_m| self.axes.along * along_m + self.axes.across * across_m)
    }

    /// Direction of the lines, degrees true (0..180 if the scan chose it).
    pub fn heading_deg(&self) -> f64 {
        self.heading_deg
    }

    /// Actual distance between neighbouring lines, metres: at most the requested one.
    pub fn spacing_m(&self) -> f64 {
        self.lines.spacing_m
    }

    /// A place on the border between two strips.
    pub fn grid(&self) -> Vec2 {
        self.axes.across * self.lines.begin_m
    }

    /// Number of tracks; they are numbered from 0 in flight order.
    pub fn tracks(&self) -> u64 {
        self.lines.count
    }

    /// The least number of lines from one track to the next, if there are more than twice as many lines (1: each line after
    /// its neighbour).
    pub fn interleave(&self) -> u64 {
        self.order.step()
    }

    /// The line, counted from the left edge, that a track flies.
    pub fn line_of_track(&self, track: u64) -> u64 {
        self.order.line(track)
    }

    /// The track that flies a line.
    pub fn track_of_line(&self, line: u64) -> u64 {
        self.order.track(line)
    }

    /// The track whose line is nearest to a point, among those that are wanted (for example not
    /// yet flown); of two equally near ones the one flown first. Tries the lines from
    /// the nearest outwards; `None` if none is wanted.
    pub fn nearest_track(&self, point: Vec2, wanted: impl Fn(u64) -> bool) -> Option<u64> {
        let middle = self.lines.nearest(point.dot(self.axes.across));
        let last = self.lines.count.saturating_sub(1);
        let pair = |out: u64| {
            let left = middle.checked_sub(out);
            let right = middle.checked_add(out).filter(|&line| line <= last);
            let tracks = left.into_iter().chain(right).map(|l| self.order.track(l));
            tracks.filter(|&track| wanted(track)).min()
        };
        (0..=middle.max(last - middle)).find_map(pair)
    }

    /// Where a track begins and where it ends, with the gaps between its segments; `None` if there is no such track.
    pub fn ends_of_track(&self, track: u64) -> Option<(Vec2, Vec2)> {
        let mut segments = self.segments(track..track.saturating_add(1));
        let first = segments.next()?;
        Some((first.from, segments.last().unwrap_or(first).to))
    }

    /// The segments of a range of tracks in flight order.
    pub fn segments(&self, tracks: Range<u64>) -> Segments<'_> {
        Segments::new(self, tracks)
    }

    /// The waypoints of a range of tracks in flight order.
    pub fn waypoints(&self, frame: LocalFrame, tracks: Range<u64>) -> Waypoints<'_> {
        Waypoints::new(self.segments(tracks), frame)
    }
}

impl ScanParameters {
    fn check(&self) -> Result<(), ScanError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let not_negative = |x: f64| x >= 0.0 && x.is_finite();
        if !positive(self.spacing_m) {
            return Err(ScanError::Spacing(self.spacing_m));
        }
        if let Some(heading_deg) = self.heading_deg.filter(|h| !h.is_finite()) {
            return Err(ScanError::Heading(heading_deg));
        }
        if !not_negative(self.overshoot_m) {
            return Err(ScanError::Overshoot(self.overshoot_m));
        }
        if !not_negative(self.turn_radius_m) {
            return Err(ScanError::TurnRadius(self.turn_radius_m));
        }
        if self.grid.is_some_and(|place| !place.length().is_finite()) {
            return Err(ScanError::Grid);
        }
        match self.entry {
            Entry::Nearest(point) if !point.length().is_finite() => Err(ScanError::EntryPoint),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
