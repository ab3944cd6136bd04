//! A scan cell by cell: the arms of a concave area, and the sides of a hole, are finished one after the other instead of being
//! flown over on every line (boustrophedon decomposition, Choset and Pignon 1997).

use super::{MOST_STORED, PatternError, Stored, Vertex};
use crate::scan::{Corner, Entry, Order, Scan, ScanParameters};
use crate::{Polygon, Vec2};

/// A scan whose tracks are the scanning pieces of a [`Scan`]'s lines, cell by cell; between cells there is a transit. Where an
/// area has no gaps, it is that scan.
#[derive(Debug, Clone, PartialEq)]
pub struct CellScan {
    stored: Stored,
    cells: usize,
}

/// A scanning piece of a line.
#[derive(Debug, Clone, Copy)]
struct Piece {
    line: u64,
    /// Its ends, in the direction of the heading.
    low: Vec2,
    high: Vec2,
    /// Where these are along the heading, metres.
    low_m: f64,
    high_m: f64,
}

/// Pieces of neighbouring lines, one each.
type Cell = Vec<Piece>;

impl CellScan {
    /// Lays it out. It begins in the cell, and each cell at the corner, nearest to where the aircraft is; lines nearer
    /// than twice the turn radius are interleaved in each cell.
    ///
    /// # Errors
    /// A parameter that makes no sense; more waypoints than can be stored.
    pub fn new(area: &Polygon, p: &ScanParameters) -> Result<Self, PatternError> {
        let as_asked = Scan::new(area, p)?;
        let mut at = match p.entry {
            Entry::Nearest(point) => point,
            Entry::Corner(_) => as_asked.ends_of_track(0).map(|ends| ends.0).unwrap_or_default(),
        };
        // track by track from the left
        let in_order = ScanParameters { entry: Entry::Corner(Corner::StartLeft), turn_radius_m: 0.0, ..*p };
        let mut left = cells_of(&Scan::new(area, &in_order)?)?;
        let cells = left.len();
        let mut stored = Stored::default();
        while let Some((cell, corner)) = nearest(&left, at) {
            at = fly(&mut stored, &left.swap_remove(cell), corner, p)?.unwrap_or(at);
        }
        Ok(Self { stored, cells })
    }

    /// How many cells it has.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        self.stored.count()
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        self.stored.vertex(index)
    }
}

/// Divides the pieces of all lines: a cell goes on as long as one piece of a line meets one of the next, and no other.
fn cells_of(scan: &Scan) -> Result<Vec<Cell>, PatternError> {
    let along = Vec2::from_bearing_rad(scan.heading_deg().to_radians());
    let mut pieces = Vec::new();
    for s in scan.segments(0..scan.tracks()).filter(|s| s.scanning) {
        let (from_m, to_m) = (s.from.dot(along), s.to.dot(along));
        pieces.push(if from_m <= to_m {
            Piece { line: s.line, low: s.from, high: s.to, low_m: from_m, high_m: to_m }
        } else {
            Piece { line: s.line, low: s.to, high: s.from, low_m: to_m, high_m: from_m }
        });
        if pieces.len() > MOST_STORED / 2 {
            return Err(PatternError::TooMany { most: MOST_STORED as u64 });
        }
    }
    let mut cells: Vec<Cell> = Vec::new();
    // the cell of each piece of the line before, ascending
    let mut before: Vec<(Piece, usize)> = Vec::new();
    for line in pieces.chunk_by_mut(|a, b| a.line == b.line) {
        line.sort_by(|a, b| a.low_m.total_cmp(&b.low_m));
        let continued = continued(&before, line);
        before.clear();
        for (piece, cell) in line.iter().zip(continued) {
            let cell = cell.unwrap_or(cells.len());
            if cell == cells.len() {
                cells.push(Cell::new());
            }
            if let Some(cell) = cells.get_mut(cell) {
                cell.push(*piece);
            }
            before.push((*piece, cell));
        }
    }
    Ok(cells)
}

/// The cell that each piece of a line goes on with, if it does.
fn continued(before: &[(Piece, usize)], line: &[Piece]) -> Vec<Option<usize>> {
    let mut met_before = vec![0_usize; before.len()];
    let mut met: Vec<Vec<usize>> = vec![Vec::new(); line.len()];
    let (mut i, mut j) = (0, 0);
    while let (Some((old, _)), Some(new)) = (before.get(i), line.get(j)) {
        if old.low_m < new.high_m
            && new.low_m < old.high_m
            && let (Some(count), Some(partners)) = (met_before.get_mut(i), met.get_mut(j))
        {
            *count += 1;
            partners.push(i);
        }
        if old.high_m < new.high_m { i += 1 } else { j += 1 }
    }
    let only_partner = |partners: Vec<usize>| match partners[..] {
        [one] if met_before.get(one) == Some(&1) => before.get(one).map(|(_, cell)| *cell),
        _ => None,
    };
    met.into_iter().map(only_partner).collect()
}

/// The cell, and its corner, that is nearest to a point.
fn nearest(cells: &[Cell], point: Vec2) -> Option<(usize, Corner)> {
    let corners = |(i, cell): (usize, &Cell)| {
        let (first, last) = (*cell.first()?, *cell.last()?);
        let corners = [
            (first.low, Corner::StartLeft),
            (first.high, Corner::EndLeft),
            (last.low, Corner::StartRight),
            (last.high, Corner::EndRight),
        ];
        Some(corners.map(|(at, corner)| ((at - point).length(), i, corner)))
    };
    let all = cells.iter().enumerate().filter_map(corners).flatten();
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, cell, corner)| (cell, corner))
}

/// Adds a cell's tracks; gives where the last ends.
fn fly(
    stored: &mut Stored,
    cell: &Cell,
    corner: Corner,
    p: &ScanParameters,
) -> Result<Option<Vec2>, PatternError> {
    let lines = cell.len() as u64;
    let order = Order::interleaved(lines, p.turn_radius_m, p.spacing_m, corner);
    let mut end = None;
    for track in 0..lines {
        let piece = usize::try_from(order.line(track)).ok().and_then(|line| cell.get(line));
        let Some(piece) = piece else { continue };
        let ends = if order.along_heading(track) { [piece.low, piece.high] } else { [piece.high, piece.low] };
        stored.push(ends)?;
        end = ends.last().copied();
    }
    Ok(end)
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
            heading_deg: Some(90.0),
            overshoot_m: 0.0,
            entry: Entry::Corner(Corner::StartLeft),
            turn_radius_m: 0.0,
        }
    }

    /// A bay open to the north between two arms.
    fn u_shape() -> Polygon {
        let corners = [
            (0.0, 0.0),
            (900.0, 0.0),
            (900.0, 600.0),
            (600.0, 600.0),
            (600.0, 200.0),
            (300.0, 200.0),
            (300.0, 600.0),
            (0.0, 600.0),
        ];
        Polygon::new(corners.map(|(e, n)| Vec2::new(e, n)).to_vec(), vec![]).unwrap()
    }

    fn tracks(scan: &CellScan) -> Vec<(Vec2, Vec2)> {
        let at: Vec<Vec2> = (0..scan.count()).map(|i| scan.vertex(i).unwrap().at).collect();
        at.chunks(2).map(|ends| (ends[0], ends[1])).collect()
    }

    #[test]
    fn the_arms_of_a_u_are_finished_one_after_the_other() {
        let scan = CellScan::new(&u_shape(), &parameters(100.0)).unwrap();
        assert_eq!(scan.cells(), 3);
        let wests: Vec<i64> = tracks(&scan).iter().map(|(a, b)| a.e.min(b.e).round() as i64).collect();
        // four lines over the western arm, two below the bay, four over the eastern arm
        assert_eq!(wests, [0, 0, 0, 0, 0, 0, 600, 600, 600, 600]);
        let way_m =
            |tracks: &[(Vec2, Vec2)]| tracks.windows(2).map(|w| (w[1].0 - w[0].1).length()).sum::<f64>();
        // from line to line, and from the end of the last line, in the west, to the eastern arm: no transit over the bay
        let to_eastern_arm_m = 600.0_f64.hypot(200.0);
        assert!((way_m(&tracks(&scan)) - (8.0 * 100.0 + to_eastern_arm_m)).abs() < 1e-6);
    }

    #[test]
    fn without_gaps_it_is_the_plain_scan() {
        let corners = [(0.0, 0.0), (900.0, 0.0), (900.0, 600.0), (0.0, 600.0)];
        let area = Polygon::new(corners.map(|(e, n)| Vec2::new(e, n)).to_vec(), vec![]).unwrap();
        for corner in [Corner::StartLeft, Corner::StartRight, Corner::EndLeft, Corner::EndRight] {
            let p =
                ScanParameters { entry: Entry::Corner(corner), turn_radius_m: 120.0, ..parameters(100.0) };
            let plain = Scan::new(&area, &p).unwrap();
            let expected: Vec<_> = (0..plain.tracks()).map(|t| plain.ends_of_track(t).unwrap()).collect();
            assert_eq!(tracks(&CellScan::new(&area, &p).unwrap()), expected);
        }
    }

    #[test]
    fn a_million_pieces_are_refused() {
        let refused = CellScan::new(&u_shape(), &parameters(1e-3));
        assert!(matches!(refused, Err(PatternError::TooMany { .. })));
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
            let flags: Vec<bool> = (0..cells.count()).map(|i| cells.vertex(i).unwrap().on_track).collect();
            prop_assert!(flags.iter().enumerate().all(|(i, &on)| on == (i % 2 == 1)));
        }
    }
}
