//! Patterns besides the plain scan: each is laid out in a plane from numbers, and gives its waypoints by number.
//!
//! A cursor can so bookmark a place, go on from it, and fly a pattern backwards. Patterns that follow a formula store nothing
//! but their parameters; those along a route or a polygon's edge store their waypoints, at most [`MAX_STORED`].

mod contour;
mod corridor;
mod creeping;
mod criss_cross;
mod expanding_square;
mod figure_eight;
mod route;
mod sector;
mod spiral;
#[cfg(test)]
mod tests;
mod track_line;

pub use contour::{ContourParameters, Contours, Side};
pub use corridor::{Corridor, CorridorParameters};
pub use creeping::creeping_heading_deg;
pub use criss_cross::CrissCross;
pub use expanding_square::{ExpandingSquare, SquareParameters};
pub use figure_eight::{FigureEight, FigureEightParameters};
pub use route::Route;
pub use sector::{PASS_TURN_DEG, SectorParameters, SectorSearch};
pub use spiral::{Spiral, SpiralParameters};
pub use track_line::{TrackLine, TrackLineParameters};

use crate::Vec2;
use crate::polygon::PolygonError;
use crate::scan::{Scan, ScanError};

/// Waypoints that a pattern which follows a formula may have.
pub const MAX_VERTICES: u64 = 1_000_000_000;
/// Waypoints that a pattern which stores them may have: 24 MB.
pub const MAX_STORED: usize = 1_000_000;

/// A waypoint of a pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Where, in the frame of the parameters.
    pub at: Vec2,
    /// Number of the track (scan line, lap, loop, side, pass or leg) that it belongs to, from 0 in flight order.
    pub track: u64,
    /// The segment from the waypoint before is part of that track; otherwise it leads there from elsewhere
    /// else. Backwards, the way *from* it is.
    pub on_track: bool,
}

/// A pattern, ready to be flown. Waypoints are numbered from 0 in flight order.
#[derive(Debug, Clone)]
pub enum Pattern {
    /// Parallel tracks over a polygon; also the creeping line. Gaps are flown over: see [`Scan::segments`].
    Scan(Scan),
    /// Two scans at right angles.
    CrissCross(CrissCross),
    /// Round and round about a centre.
    Spiral(Spiral),
    /// Growing squares about a centre.
    ExpandingSquare(ExpandingSquare),
    /// Triangles with a common corner.
    SectorSearch(SectorSearch),
    /// Out and back, parallel to a route.
    TrackLine(TrackLine),
    /// Parallel tracks along a route.
    Corridor(Corridor),
    /// Loops along a polygon's edge.
    Contours(Contours),
    /// Two circles that touch.
    FigureEight(FigureEight),
}

impl Pattern {
    /// How many waypoints it has.
    pub fn count(&self) -> u64 {
        match self {
            Pattern::Scan(p) => criss_cross::scan_count(p),
            Pattern::CrissCross(p) => p.count(),
            Pattern::Spiral(p) => p.count(),
            Pattern::ExpandingSquare(p) => p.count(),
            Pattern::SectorSearch(p) => p.count(),
            Pattern::TrackLine(p) => p.count(),
            Pattern::Corridor(p) => p.count(),
            Pattern::Contours(p) => p.count(),
            Pattern::FigureEight(p) => p.count(),
        }
    }

    /// The waypoint of a number; `None` from [`Pattern::count`] on. It costs the same for every number: nothing before
    /// it is computed (a scan examines every edge of its polygon).
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        match self {
            Pattern::Scan(p) => criss_cross::scan_vertex(p, index),
            Pattern::CrissCross(p) => p.vertex(index),
            Pattern::Spiral(p) => p.vertex(index),
            Pattern::ExpandingSquare(p) => p.vertex(index),
            Pattern::SectorSearch(p) => p.vertex(index),
            Pattern::TrackLine(p) => p.vertex(index),
            Pattern::Corridor(p) => p.vertex(index),
            Pattern::Contours(p) => p.vertex(index),
            Pattern::FigureEight(p) => p.vertex(index),
        }
    }

    /// How many tracks it has.
    pub fn tracks(&self) -> u64 {
        let last = self.count().checked_sub(1).and_then(|last| self.vertex(last));
        last.map_or(0, |v| v.track + 1)
    }
}

/// Why a pattern can't be laid out.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PatternError {
    /// Zero, negative, infinite or not a number.
    #[error("the {what} is {value}: it must be a positive number")]
    NotPositive {
        /// Which parameter.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// Negative, infinite or not a number.
    #[error("the {what} is {value}: it must be 0 or more")]
    Negative {
        /// Which parameter.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// Infinite or not a number.
    #[error("the {what} is not a number")]
    NotANumber {
        /// Which parameter.
        what: &'static str,
    },
    /// Zero, or more than allowed.
    #[error("{value} {what}: give from 1 to {most}")]
    OutOfRange {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        value: u64,
        /// How many there may be.
        most: u64,
    },
    /// More waypoints than can be handled.
    #[error(
        "the pattern has more than {most} waypoints: widen the spacing or the tolerance, or fly fewer rounds"
    )]
    TooMany {
        /// How many there may be.
        most: u64,
    },
    /// No room for a single track.
    #[error("the pattern is {width_m:.1} m wide, too narrow for tracks {spacing_m:.1} m apart: widen it")]
    TooNarrow {
        /// What there is, metres.
        width_m: f64,
        /// What is asked for, metres.
        spacing_m: f64,
    },
    /// A route needs two points.
    #[error("the route has {points} points: give it from 2 to {}", route::MAX_POINTS)]
    RoutePoints {
        /// How many it has.
        points: usize,
    },
    /// A point of a route is not a number, or lies on the one before.
    #[error("point {point} of the route is no position, or lies on the one before it: move or remove it")]
    RoutePoint {
        /// Which, from 0.
        point: usize,
    },
    /// Not a number of sectors that closes.
    #[error("a search of {0} sectors: it has 3, 4 or 6")]
    Sectors(u32),
    /// The polygon can't be scanned.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// The area is none.
    #[error(transparent)]
    Polygon(#[from] PolygonError),
    /// Loops round so many corners would take too long to compute.
    #[error(
        "an area of {corners} corners is too intricate for {levels} loops round it: simplify it, or widen the spacing"
    )]
    TooIntricate {
        /// Of the area.
        corners: usize,
        /// Distances from its edge.
        levels: u64,
    },
    /// The library for offsets refused the polygon.
    #[error("no loops can be laid along the edge of the area: simplify it")]
    Offset,
}

fn positive(what: &'static str, value: f64) -> Result<(), PatternError> {
    let good = value > 0.0 && value.is_finite();
    if good { Ok(()) } else { Err(PatternError::NotPositive { what, value }) }
}

fn not_negative(what: &'static str, value: f64) -> Result<(), PatternError> {
    let good = value >= 0.0 && value.is_finite();
    if good { Ok(()) } else { Err(PatternError::Negative { what, value }) }
}

fn finite(what: &'static str, value: f64) -> Result<(), PatternError> {
    if value.is_finite() { Ok(()) } else { Err(PatternError::NotANumber { what }) }
}

fn counted(what: &'static str, value: u64, most: u64) -> Result<(), PatternError> {
    let good = (1..=most).contains(&value);
    if good { Ok(()) } else { Err(PatternError::OutOfRange { what, value, most }) }
}

/// A computed number of waypoints as a whole number.
fn whole(count: f64) -> Result<u64, PatternError> {
    if count <= MAX_VERTICES as f64 {
        // rounded up, never negative
        return Ok(count.ceil().max(1.0) as u64);
    }
    Err(PatternError::TooMany { most: MAX_VERTICES })
}

/// The waypoints of tracks in order; the corners of the path to a track come before it.
#[derive(Debug, Clone, Default, PartialEq)]
struct Stored {
    points: Vec<Vec2>,
    /// The index at which the path to each track begins, and the index at which the track begins.
    starts: Vec<(usize, usize)>,
}

impl Stored {
    fn push(&mut self, track: impl IntoIterator<Item = Vec2>) -> Result<(), PatternError> {
        self.push_after([], track)
    }

    fn push_after(
        &mut self,
        way: impl IntoIterator<Item = Vec2>,
        track: impl IntoIterator<Item = Vec2>,
    ) -> Result<(), PatternError> {
        let start = self.points.len();
        self.points.extend(way);
        self.starts.push((start, self.points.len()));
        self.points.extend(track);
        if self.points.len() > MAX_STORED {
            return Err(PatternError::TooMany { most: MAX_STORED as u64 });
        }
        Ok(())
    }

    fn count(&self) -> u64 {
        self.points.len() as u64
    }

    fn vertex(&self, index: u64) -> Option<Vertex> {
        let index = usize::try_from(index).ok()?;
        let at = *self.points.get(index)?;
        let track = self.starts.partition_point(|&(way, _)| way <= index).checked_sub(1)?;
        let on_track = self.starts.get(track).is_some_and(|&(_, begin)| index > begin);
        Some(Vertex { at, track: track as u64, on_track })
    }
}
