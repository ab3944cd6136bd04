//! A scan cell by cell: the arms of a concave area and the sides of a hole are finished one after the other, and what lies between
//! them is not flown across (boustrophedon decomposition, Choset and Pignon 1997).

use super::outline::{Span, Sweep, spans};
use super::{Corner, Entry, Order, Scan, ScanError, ScanParameters};
use crate::Vec2;
use crate::polygon::{Interior, Looks, Polygon, distance_to_segment_m};
use std::ops::Range;

/// Lines that a concave area may have: each is looked at to find the cells.
const MOST_LINES: u64 = 1_000_000;
/// Cells that it may have.
const MOST_CELLS: usize = 2_000;
/// Edges looked at to find out where cells end.
const MOST_LOOKS: u64 = 40_000_000;

/// A scan whose tracks are the scanning pieces of a [`Scan`]'s lines, cell by cell. A cell goes on as long as one piece of a line
/// meets one of the next, and no other. A convex area is one cell, of any number of lines, and its tracks are those of the scan.
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
    /// A parameter that makes no sense; a concave area that is too intricate, or has too many lines.
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

    /// Whether a turn at their ends leads from one track to another; otherwise there is a way between them.
    pub fn turns_into(&self, track: u64, next: u64) -> bool {
        let cell = |track| self.cell(track).map(|(number, _)| number);
        track.abs_diff(next) == 1 && cell(track) == cell(next)
    }

    /// Corners of the area; 0: of a convex one, which is one cell.
    pub fn corners(&self) -> usize {
        self.interior.as_ref().map_or(0, |interior| interior.area().edges().count())
    }

    /// The corners of the shortest way inside the area between two places at ends of tracks; `None`: the area is too intricate.
    pub fn way(&self, from: Vec2, to: Vec2, looks: &mut Looks) -> Option<Vec<Vec2>> {
        self.interior.as_ref().map_or(Some(Vec::new()), |interior| interior.way(from, to, looks))
    }

    /// Both ends of tracks as they lie along the heading; `None` for what is no track.
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

/// A cell that is not yet part of a flight.
#[derive(Debug, Clone)]
struct Found {
    lines: Range<u64>,
    pieces: Vec<(u64, usize)>,
    /// The ends of its first and its last piece.
    first: (Vec2, Vec2),
    last: (Vec2, Vec2),
    /// Cells that pieces of it meet.
    neighbours: Vec<usize>,
}

/// A piece of the line looked at last, and its cell.
type Open = (Span, usize);

/// Goes from line to line.
struct Finder<'a> {
    scan: &'a Scan,
    interior: &'a Interior,
    /// Longest prolongation of a track to where its neighbour ends, metres.
    most_jump_m: f64,
    looks: Looks,
    cells: Vec<Found>,
    open: Vec<Open>,
    too_intricate: ScanError,
}

impl<'a> Finder<'a> {
    fn new(scan: &'a Scan, interior: &'a Interior, p: &ScanParameters) -> Self {
        Self {
            scan,
            interior,
            most_jump_m: p.overshoot_m.max(2.0 * p.turn_radius_m).max(scan.lines.spacing_m()),
            looks: Looks::new(MOST_LOOKS),
            cells: Vec::new(),
            open: Vec::new(),
            too_intricate: ScanError::TooIntricate { corners: interior.area().edges().count() },
        }
    }

    fn cells(mut self) -> Result<Vec<Found>, ScanError> {
        let scan = self.scan;
        if scan.lines.count() > MOST_LINES {
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
        let before = std::mem::take(&mut self.open);
        // prolonged ones may join and part anywhere
        let partners = if alike && self.scan.overshoot_m == 0.0 && before.len() == pieces.len() {
            (0..pieces.len()).map(|i| vec![i]).collect()
        } else {
            meetings(&before, pieces)
        };
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

    /// Whether the turns between pieces of two lines need nobody to go far beside the area.
    fn leads_on(&mut self, line: u64, old: Span, new: Span) -> Result<bool, ScanError> {
        let jump_m = (old.start_m - new.start_m).abs().max((old.end_m - new.end_m).abs());
        if jump_m <= self.most_jump_m {
            return Ok(true);
        }
        let place = |line: u64, span| self.scan.ends_of(self.scan.lines.across_m(line), span);
        let (from, to) = (place(line.saturating_sub(1), old), place(line, new));
        let mut straight = |a, b| self.interior.is_straight(a, b, &mut self.looks).ok_or(self.too_intricate);
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
        if self.cells.len() > MOST_CELLS {
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

/// Which pieces of the line before each piece meets: both lists ascend.
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

/// The cells one after the other.
fn in_flight_order(found: Vec<Found>, scan: &Scan, p: &ScanParameters) -> Vec<Cell> {
    let mut left: Vec<bool> = vec![true; found.len()];
    let mut cells = Vec::with_capacity(found.len());
    let mut first_track = 0;
    let mut next = begin(&found, p.entry);
    while let Some((number, corner)) = next {
        let Some(cell) = found.get(number) else { break };
        left.iter_mut().skip(number).take(1).for_each(|left| *left = false);
        let lines = cell.lines.end - cell.lines.start;
        let order = Order::interleaved(lines, p.turn_radius_m, scan.lines.spacing_m(), corner);
        cells.push(Cell { first_track, first_line: cell.lines.start, pieces: cell.pieces.clone(), order });
        first_track += lines;
        let at = cell.end_of(&order, scan);
        let near = nearest_left(&found, &left, number);
        next = nearest_corner(near.into_iter().filter_map(|i| Some((i, found.get(i)?))), at);
    }
    cells
}

/// Where to begin: at the nearest corner of a cell, or at one of the whole pattern.
fn begin(found: &[Found], entry: Entry) -> Option<(usize, Corner)> {
    let cells = || found.iter().enumerate();
    let corner = match entry {
        Entry::Nearest(point) => return nearest_corner(cells(), point),
        Entry::Corner(corner) => corner,
    };
    let last = found.iter().map(|c| c.lines.end).max()?;
    let at_edge =
        cells().filter(|(_, c)| if corner.is_right() { c.lines.end == last } else { c.lines.start == 0 });
    // pieces of a line are numbered along the heading
    let piece = |cell: &Found| {
        let piece = if corner.is_right() { cell.pieces.last() } else { cell.pieces.first() };
        piece.map_or(0, |(_, piece)| *piece)
    };
    let cell = if corner.is_end() {
        at_edge.max_by_key(|(_, c)| piece(c))
    } else {
        at_edge.min_by_key(|(_, c)| piece(c))
    };
    Some((cell?.0, corner))
}

impl Found {
    /// Where it ends when it is flown in an order.
    fn end_of(&self, order: &Order, scan: &Scan) -> Vec2 {
        let track = order.lines().saturating_sub(1);
        let line = self.lines.start + order.line(track);
        let begun = self.pieces.partition_point(|(from, _)| *from <= line);
        let piece = self.pieces.get(begun.saturating_sub(1)).map_or(0, |(_, piece)| *piece);
        let (low, high) = scan.piece(&mut Sweep::default(), line, piece).unwrap_or(self.last);
        if order.along_heading(track) { high } else { low }
    }
}

/// The cells that are left and the fewest cells away from one; all that are left, if it meets none of them.
fn nearest_left(found: &[Found], left: &[bool], from: usize) -> Vec<usize> {
    let is_left = |i: &usize| left.get(*i) == Some(&true);
    let mut seen = vec![false; found.len()];
    let mut ring = vec![from];
    while !ring.is_empty() {
        let there: Vec<usize> = ring.iter().copied().filter(is_left).collect();
        if !there.is_empty() {
            return there;
        }
        let beyond = ring.iter().filter_map(|i| found.get(*i)).flat_map(|c| c.neighbours.iter().copied());
        let fresh = |i: &usize| seen.get_mut(*i).is_some_and(|seen| !std::mem::replace(seen, true));
        ring = beyond.filter(fresh).collect();
    }
    (0..found.len()).filter(is_left).collect()
}

/// The cell, and its corner, that is nearest to a point.
fn nearest_corner<'a>(
    cells: impl Iterator<Item = (usize, &'a Found)>,
    point: Vec2,
) -> Option<(usize, Corner)> {
    let corners = |(i, cell): (usize, &Found)| {
        let places = [cell.first.0, cell.last.0, cell.first.1, cell.last.1];
        let named = places.into_iter().zip(Corner::ALL);
        named.map(|(at, corner)| ((at - point).length(), i, corner)).collect::<Vec<_>>()
    };
    let nearest = cells.flat_map(corners).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, cell, corner)| (cell, corner))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::polygon::tests::any_area;
    use proptest::prelude::*;

    fn parameters(spacing_m: f64) -> ScanParameters {
        ScanParameters {
            spacing_m,
            grid: None,
            heading_deg: Some(90.0),
            overshoot_m: 0.0,
            entry: Entry::Corner(Corner::StartLeft),
            turn_radius_m: 0.0,
        }
    }

    fn polygon(corners: &[(f64, f64)]) -> Polygon {
        Polygon::new(corners.iter().map(|&(e, n)| Vec2::new(e, n)).collect(), vec![]).unwrap()
    }

    /// A bay open to the north between two arms.
    fn u_shape() -> Polygon {
        polygon(&[
            (0.0, 0.0),
            (900.0, 0.0),
            (900.0, 600.0),
            (600.0, 600.0),
            (600.0, 200.0),
            (300.0, 200.0),
            (300.0, 600.0),
            (0.0, 600.0),
        ])
    }

    /// Tracks as they are flown.
    fn tracks(scan: &CellScan) -> Vec<(Vec2, Vec2)> {
        let ends = scan.ends(0..scan.tracks()).map(Option::unwrap).enumerate();
        ends.map(|(i, (low, high))| if scan.along_heading(i as u64) { (low, high) } else { (high, low) })
            .collect()
    }

    #[test]
    fn the_arms_of_a_u_are_finished_one_after_the_other() {
        let scan = CellScan::new(&u_shape(), &parameters(100.0)).unwrap();
        assert_eq!(scan.cells.len(), 3);
        let wests: Vec<i64> = tracks(&scan).iter().map(|(a, b)| a.e.min(b.e).round() as i64).collect();
        // four lines over the western arm, two below the bay, four over the eastern arm
        assert_eq!(wests, [0, 0, 0, 0, 0, 0, 600, 600, 600, 600]);
        let turns: Vec<bool> = (1..10).map(|t| scan.turns_into(t - 1, t)).collect();
        assert_eq!(turns, [true, true, true, false, true, false, true, true, true]);
        // from the end of the last line, in the west, round the corner of the bay to the eastern arm's nearest corner
        let flown = tracks(&scan);
        let way = scan.way(flown[5].1, flown[6].0, &mut Looks::new(10_000)).unwrap();
        assert_eq!((flown[5].1.e.round(), flown[6].0.e.round()), (0.0, 600.0));
        assert_eq!(way.len(), 1);
        assert!((way[0] - Vec2::new(600.0, 200.0)).length() < 1e-9);
    }

    #[test]
    fn a_gap_within_twice_the_overshoot_is_flown_across() {
        let across = ScanParameters { overshoot_m: 150.0, ..parameters(100.0) };
        assert_eq!(CellScan::new(&u_shape(), &across).unwrap().cells.len(), 1);
        let short = ScanParameters { overshoot_m: 149.0, ..across };
        assert_eq!(CellScan::new(&u_shape(), &short).unwrap().cells.len(), 3);
    }

    /// An L is one piece a line, but from one to the other the end jumps by 900 m.
    #[test]
    fn tracks_of_different_lengths_are_not_prolonged_far_beside_the_area() {
        let l = [(0.0, 0.0), (1500.0, 0.0), (1500.0, 300.0), (600.0, 300.0), (600.0, 600.0), (0.0, 600.0)];
        let cells = |p: &ScanParameters| CellScan::new(&polygon(&l), p).unwrap().cells.len();
        assert_eq!(cells(&parameters(100.0)), 2);
        let wide = ScanParameters { turn_radius_m: 450.0, ..parameters(100.0) };
        assert_eq!(cells(&wide), 1);
        let across = ScanParameters { heading_deg: Some(0.0), ..parameters(100.0) };
        assert_eq!(cells(&across), 2);
    }

    #[test]
    fn it_begins_at_the_corner_asked_for() {
        for (corner, first) in [
            (Corner::StartLeft, (0.0, 550.0)),
            (Corner::EndLeft, (900.0, 550.0)),
            (Corner::StartRight, (0.0, 50.0)),
            (Corner::EndRight, (900.0, 50.0)),
        ] {
            let p = ScanParameters { entry: Entry::Corner(corner), ..parameters(100.0) };
            let begin = tracks(&CellScan::new(&u_shape(), &p).unwrap())[0].0;
            assert!((begin - Vec2::new(first.0, first.1)).length() < 1e-6, "{corner:?}: {begin:?}");
            let near = ScanParameters { entry: Entry::Nearest(begin), ..p };
            assert_eq!(tracks(&CellScan::new(&u_shape(), &near).unwrap())[0].0, begin);
        }
    }

    #[test]
    fn a_convex_area_is_the_plain_scan() {
        let area = polygon(&[(0.0, 0.0), (900.0, 0.0), (1100.0, 600.0), (0.0, 600.0)]);
        for corner in Corner::ALL {
            let p =
                ScanParameters { entry: Entry::Corner(corner), turn_radius_m: 120.0, ..parameters(100.0) };
            let plain = Scan::new(&area, &p).unwrap();
            let expected: Vec<_> = (0..plain.tracks()).map(|t| plain.ends_of_track(t).unwrap()).collect();
            assert_eq!(tracks(&CellScan::new(&area, &p).unwrap()), expected);
        }
    }

    #[test]
    fn endless_lines_and_cells_are_refused() {
        let refused = CellScan::new(&u_shape(), &parameters(5e-4));
        assert!(matches!(refused, Err(ScanError::TooManyLines(_))));
        // convex, nothing is stored of them
        assert!(CellScan::new(&polygon(&[(0.0, 0.0), (9.0, 0.0), (9.0, 9.0)]), &parameters(1e-9)).is_ok());
        let teeth = (0..3000).flat_map(|i| {
            let e = f64::from(i) * 4.0;
            [(e, 10.0), (e + 1.0, 100.0), (e + 2.0, 10.0)]
        });
        let mut comb: Vec<(f64, f64)> = teeth.collect();
        comb.extend([(12_000.0, 0.0), (0.0, 0.0)]);
        let refused = CellScan::new(&polygon(&comb), &parameters(20.0));
        assert!(matches!(refused, Err(ScanError::TooIntricate { corners: 9002 })), "{refused:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn every_scanning_piece_is_flown_once(
            area in any_area(), spacing_m in 40.0..400.0, heading_deg in 0.0..360.0, overshoot_m in 0.0..200.0,
            turn_radius_m in 0.0..300.0,
        ) {
            let p = ScanParameters {
                heading_deg: Some(heading_deg), overshoot_m, turn_radius_m, ..parameters(spacing_m)
            };
            let cells = CellScan::new(&area, &p).unwrap();
            let plain = Scan::new(&area, &p).unwrap();
            let sorted = |mut pieces: Vec<(Vec2, Vec2)>| {
                for (a, b) in &mut pieces {
                    if (a.e, a.n) > (b.e, b.n) {
                        std::mem::swap(a, b);
                    }
                }
                pieces.sort_by(|a, b| (a.0.e, a.0.n, a.1.e).partial_cmp(&(b.0.e, b.0.n, b.1.e)).unwrap());
                pieces
            };
            let scanning = plain.segments(0..plain.tracks()).filter(|s| s.scanning).map(|s| (s.from, s.to));
            prop_assert_eq!(sorted(tracks(&cells)), sorted(scanning.collect()));
            // each is the nearest to its own middle, and the whole order can be asked for backwards
            for (number, (from, to)) in tracks(&cells).into_iter().enumerate().step_by(7) {
                let number = number as u64;
                let found = cells.nearest_track((from + to) * 0.5, |_| true);
                prop_assert_eq!(found, Some(number));
            }
        }
    }
}
