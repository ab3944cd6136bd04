//! A scan cell by cell: the arms of a concave area and the sides of a hole are finished one after the other, and the gaps between
//! them are not crossed (boustrophedon decomposition, Choset and Pignon 1997).
//!
//! The scanning pieces of the lines are numbered cell by cell. For a concave area one pass over its lines finds the cells (at most
//! a million lines). A convex area is one cell of any number of lines and costs nothing. From one cell to the next leads the
//! shortest path inside the area ([`Interior`]).

mod find;
mod order;
#[cfg(test)]
mod tests;

use super::outline::{Span, Sweep, spans};
use super::{Order, Scan, ScanError, ScanParameters};
use crate::Vec2;
use crate::polygon::{EdgeBudget, Interior, Polygon, distance_to_segment_m};
use find::Finder;
use order::in_flight_order;
use std::ops::Range;

/// A scan whose tracks are the scanning pieces of a [`Scan`]'s lines, cell by cell. A cell continues as long as one piece of a line
/// adjoins exactly one piece of the next. A convex area is one cell, and its tracks are those of the scan.
#[derive(Debug, Clone)]
pub struct CellScan {
    scan: Scan,
    cells: Vec<Cell>,
    /// `None`: it is convex.
    interior: Option<Interior>,
}

/// Pieces of neighbouring lines, one each.
#[derive(Debug, Clone)]
struct Cell {
    /// Number of its first track.
    first_track: u64,
    first_line: u64,
    /// Which of its lines' pieces are its own: from a line on, this one.
    pieces: Vec<(u64, usize)>,
    order: Order,
}

impl CellScan {
    /// Prepares a scan. Lines nearer than twice the turn radius are interleaved in each cell. It begins at the corner asked for (in the
    /// cell that has the piece there), and each further cell at the corner nearest to where the one before ends; neighbours of
    /// what is flown come first.
    ///
    /// # Errors
    /// An invalid parameter; a concave area that is too intricate, or has too many lines.
    pub fn new(area: &Polygon, p: &ScanParameters) -> Result<Self, ScanError> {
        let scan = Scan::new(area, p)?;
        if area.is_convex() {
            let cell = Cell { first_track: 0, first_line: 0, pieces: vec![(0, 0)], order: scan.order };
            return Ok(Self { scan, cells: vec![cell], interior: None });
        }
        let interior = Interior::of(area.clone());
        let found = Finder::new(&scan, &interior, p).cells()?;
        let cells = in_flight_order(found, &scan, p);
        Ok(Self { scan, cells, interior: Some(interior) })
    }

    /// The scan that it is made of.
    pub fn scan(&self) -> &Scan {
        &self.scan
    }

    /// The tracks of each cell.
    pub fn cells_of_tracks(&self) -> impl Iterator<Item = Range<u64>> {
        self.cells.iter().map(|cell| cell.first_track..cell.first_track + cell.order.lines())
    }

    /// Number of tracks; they are numbered from 0 in flight order.
    pub fn tracks(&self) -> u64 {
        self.cells.last().map_or(0, |last| last.first_track + last.order.lines())
    }

    /// Whether the track is flown along the heading, in the order of their numbers.
    pub fn along_heading(&self, track: u64) -> bool {
        self.cell(track).is_some_and(|(_, cell)| cell.order.along_heading(track - cell.first_track))
    }

    /// Whether one turn leads from a track to another; otherwise a path lies between them.
    pub fn turns_into(&self, track: u64, next: u64) -> bool {
        let cell = |track| self.cell(track).map(|(number, _)| number);
        track.abs_diff(next) == 1 && cell(track) == cell(next)
    }

    /// Number of corners of a concave area; 0 for a convex one, which is one cell.
    pub fn corners(&self) -> usize {
        self.interior.as_ref().map_or(0, |interior| interior.area().edges().count())
    }

    /// The corners of the shortest path inside the area between two ends of tracks; `None`: the budget did not last, the area is
    /// too intricate.
    pub fn path_inside(&self, from: Vec2, to: Vec2, budget: &mut EdgeBudget) -> Option<Vec<Vec2>> {
        self.interior.as_ref().map_or(Some(Vec::new()), |interior| interior.shortest_path(from, to, budget))
    }

    /// Both ends of tracks in the order along the heading; `None` where there is no such track.
    pub fn ends(&self, tracks: impl Iterator<Item = u64>) -> impl Iterator<Item = Option<(Vec2, Vec2)>> {
        let mut sweep = Sweep::default();
        tracks.map(move |track| {
            let (_, cell) = self.cell(track)?;
            let line = cell.first_line + cell.order.line(track - cell.first_track);
            self.scan.piece(&mut sweep, line, cell.piece_of(line))
        })
    }

    /// The track whose line is nearest to a point, among those that are wanted (for example not yet flown); among several cells
    /// the one whose piece is. `None` if none is wanted.
    pub fn nearest_track(&self, point: Vec2, wanted: impl Fn(u64) -> bool) -> Option<u64> {
        let candidates = self.cells.iter().filter_map(|cell| cell.nearest_track(&self.scan, point, &wanted));
        if self.cells.len() == 1 {
            return candidates.last();
        }
        let off_m = |track: &u64| {
            let ends = self.ends(std::iter::once(*track)).flatten().last();
            ends.map_or(f64::INFINITY, |(low, high)| distance_to_segment_m(low, high, point))
        };
        let measured = candidates.map(|track| (off_m(&track), track));
        measured.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, track)| track)
    }

    fn cell(&self, track: u64) -> Option<(usize, &Cell)> {
        let number = self.cells.partition_point(|cell| cell.first_track <= track).checked_sub(1)?;
        let cell = self.cells.get(number)?;
        (track - cell.first_track < cell.order.lines()).then_some((number, cell))
    }
}

impl Cell {
    fn piece_of(&self, line: u64) -> usize {
        let begun = self.pieces.partition_point(|(from, _)| *from <= line);
        self.pieces.get(begun.saturating_sub(1)).map_or(0, |(_, piece)| *piece)
    }

    /// Where its last track ends.
    fn end(&self, scan: &Scan) -> Option<Vec2> {
        let track = self.order.lines().checked_sub(1)?;
        let line = self.first_line + self.order.line(track);
        let (low, high) = scan.piece(&mut Sweep::default(), line, self.piece_of(line))?;
        Some(if self.order.along_heading(track) { high } else { low })
    }

    fn nearest_track(&self, scan: &Scan, point: Vec2, wanted: impl Fn(u64) -> bool) -> Option<u64> {
        let last = self.order.lines().checked_sub(1)?;
        let nearest = scan.lines.nearest(point.dot(scan.axes.across));
        let middle = nearest.clamp(self.first_line, self.first_line + last) - self.first_line;
        let pair = |out: u64| {
            let left = middle.checked_sub(out);
            let right = middle.checked_add(out).filter(|line| *line <= last);
            let tracks = left.into_iter().chain(right).map(|l| self.first_track + self.order.track(l));
            tracks.filter(|track| wanted(*track)).min()
        };
        (0..=middle.max(last - middle)).find_map(pair)
    }
}

impl Scan {
    /// A piece of a line, both ends as they lie along the heading.
    fn piece(&self, sweep: &mut Sweep, line: u64, piece: usize) -> Option<(Vec2, Vec2)> {
        let across_m = self.lines.across_m(line);
        sweep.go_to(&self.outline, across_m, self.strip_m, self.overshoot_m);
        let span = spans(sweep.bounds_m()).nth(piece)?;
        Some(self.ends_of(across_m, span))
    }

    fn ends_of(&self, across_m: f64, span: Span) -> (Vec2, Vec2) {
        let origin = self.axes.across * across_m;
        (origin + self.axes.along * span.start_m, origin + self.axes.along * span.end_m)
    }
}
