//! Finds the cells of a concave area, line by line.

use super::super::outline::{Span, Sweep, spans};
use super::super::{Scan, ScanError, ScanParameters};
use crate::Vec2;
use crate::polygon::{EdgeBudget, Interior};
use std::ops::Range;

/// Most lines of a concave area: each is examined.
const MAX_LINES: u64 = 1_000_000;
/// Most cells.
const MAX_CELLS: usize = 2_000;
/// Edges compared to find out where cells end.
const MAX_EDGES: u64 = 40_000_000;

/// A cell that is not yet part of a flight.
#[derive(Debug, Clone)]
pub struct Found {
    pub lines: Range<u64>,
    /// Which of its lines' pieces are its own: from a line on, this one.
    pub pieces: Vec<(u64, usize)>,
    /// The ends of its first and its last piece.
    pub first: (Vec2, Vec2),
    pub last: (Vec2, Vec2),
    /// Cells that adjoin it.
    pub neighbours: Vec<usize>,
}

/// A piece of the last line, and its cell.
type Open = (Span, usize);

/// Proceeds from line to line.
pub struct Finder<'a> {
    scan: &'a Scan,
    interior: &'a Interior,
    /// Longest extension of a track to where its neighbour ends, metres.
    most_jump_m: f64,
    budget: EdgeBudget,
    cells: Vec<Found>,
    open: Vec<Open>,
    too_intricate: ScanError,
}

impl<'a> Finder<'a> {
    pub fn new(scan: &'a Scan, interior: &'a Interior, p: &ScanParameters) -> Self {
        Self {
            scan,
            interior,
            most_jump_m: p.overshoot_m.max(2.0 * p.turn_radius_m).max(scan.lines.spacing_m()),
            budget: EdgeBudget::new(MAX_EDGES),
            cells: Vec::new(),
            open: Vec::new(),
            too_intricate: ScanError::TooIntricate { corners: interior.area().edges().count() },
        }
    }

    pub fn cells(mut self) -> Result<Vec<Found>, ScanError> {
        let scan = self.scan;
        if scan.lines.count() > MAX_LINES {
            return Err(ScanError::TooManyLines(scan.lines.spacing_m()));
        }
        let mut sweep = Sweep::default();
        let mut pieces: Vec<Span> = Vec::new();
        for line in 0..scan.lines.count() {
            let across_m = scan.lines.across_m(line);
            let alike = sweep.is_between_corners(across_m);
            sweep.go_to(&scan.outline, across_m, scan.strip_m, scan.overshoot_m);
            pieces.clear();
            pieces.extend(spans(sweep.bounds_m()));
            self.add(line, &pieces, alike)?;
        }
        Ok(self.cells)
    }

    /// Adds a line; `alike`: no corner of the area is between it and the one before.
    fn add(&mut self, line: u64, pieces: &[Span], alike: bool) -> Result<(), ScanError> {
        // prolonged pieces may join and part anywhere, others only at corners
        if alike && self.scan.overshoot_m == 0.0 && self.open.len() == pieces.len() {
            self.go_on_with_all(line, pieces);
            return Ok(());
        }
        let before = std::mem::take(&mut self.open);
        let partners = meetings(&before, pieces);
        let mut met = vec![0_usize; before.len()];
        partners.iter().flatten().for_each(|&i| met.iter_mut().skip(i).take(1).for_each(|n| *n += 1));
        for (number, (piece, partners)) in pieces.iter().zip(partners).enumerate() {
            let alone = match partners.as_slice() {
                [one] if met.get(*one) == Some(&1) => before.get(*one).copied(),
                _ => None,
            };
            let ends = self.scan.ends_of(self.scan.lines.across_m(line), *piece);
            let goes_on = match alone {
                Some((old, cell)) if alike || self.leads_on(line, old, *piece)? => Some(cell),
                _ => None,
            };
            let cell = match goes_on {
                Some(cell) => self.go_on(cell, line, number, ends),
                None => self.begin(line, number, ends)?,
            };
            if goes_on.is_none() {
                let others = partners.iter().filter_map(|i| before.get(*i)).map(|(_, other)| *other);
                others.for_each(|other| self.are_neighbours(cell, other));
            }
            self.open.push((*piece, cell));
        }
        Ok(())
    }

    fn go_on_with_all(&mut self, line: u64, pieces: &[Span]) {
        let across_m = self.scan.lines.across_m(line);
        let mut open = std::mem::take(&mut self.open);
        for (number, ((old, cell), piece)) in open.iter_mut().zip(pieces).enumerate() {
            *old = *piece;
            self.go_on(*cell, line, number, self.scan.ends_of(across_m, *piece));
        }
        self.open = open;
    }

    /// Whether the turns between pieces of two lines stay near the area.
    fn leads_on(&mut self, line: u64, old: Span, new: Span) -> Result<bool, ScanError> {
        let jump_m = (old.start_m - new.start_m).abs().max((old.end_m - new.end_m).abs());
        if jump_m <= self.most_jump_m {
            return Ok(true);
        }
        let place = |line: u64, span| self.scan.ends_of(self.scan.lines.across_m(line), span);
        let (from, to) = (place(line.saturating_sub(1), old), place(line, new));
        let mut straight = |a, b| self.interior.is_straight(a, b, &mut self.budget).ok_or(self.too_intricate);
        Ok(straight(from.0, to.0)? && straight(from.1, to.1)?)
    }

    fn go_on(&mut self, number: usize, line: u64, piece: usize, ends: (Vec2, Vec2)) -> usize {
        if let Some(cell) = self.cells.get_mut(number) {
            if cell.pieces.last().is_none_or(|(_, last)| *last != piece) {
                cell.pieces.push((line, piece));
            }
            (cell.lines.end, cell.last) = (line + 1, ends);
        }
        number
    }

    fn begin(&mut self, line: u64, piece: usize, ends: (Vec2, Vec2)) -> Result<usize, ScanError> {
        let pieces = vec![(line, piece)];
        let neighbours = Vec::new();
        self.cells.push(Found { lines: line..line + 1, pieces, first: ends, last: ends, neighbours });
        if self.cells.len() > MAX_CELLS {
            return Err(self.too_intricate);
        }
        Ok(self.cells.len() - 1)
    }

    fn are_neighbours(&mut self, one: usize, other: usize) {
        for (of, to) in [(one, other), (other, one)] {
            self.cells.iter_mut().skip(of).take(1).for_each(|cell| cell.neighbours.push(to));
        }
    }
}

/// Which pieces of the line before each piece adjoins; both lists ascend.
fn meetings(before: &[Open], line: &[Span]) -> Vec<Vec<usize>> {
    let mut met: Vec<Vec<usize>> = vec![Vec::new(); line.len()];
    let (mut i, mut j) = (0, 0);
    while let (Some((old, _)), Some(new)) = (before.get(i), line.get(j)) {
        if old.start_m < new.end_m && new.start_m < old.end_m {
            met.iter_mut().skip(j).take(1).for_each(|met| met.push(i));
        }
        if old.end_m < new.end_m { i += 1 } else { j += 1 }
    }
    met
}
