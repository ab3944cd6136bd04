//! The order in which cells are flown.

use super::super::{Corner, Entry, Order, Scan, ScanParameters};
use super::Cell;
use super::find::Found;
use crate::Vec2;

/// The cells in flight order.
pub fn in_flight_order(found: Vec<Found>, scan: &Scan, p: &ScanParameters) -> Vec<Cell> {
    let mut left: Vec<bool> = vec![true; found.len()];
    let mut cells = Vec::with_capacity(found.len());
    let mut first_track = 0;
    let mut next = begin(&found, p.entry);
    while let Some((number, corner)) = next {
        let Some(cell) = found.get(number) else { break };
        left.iter_mut().skip(number).take(1).for_each(|left| *left = false);
        let lines = cell.lines.end - cell.lines.start;
        let order = Order::interleaved(lines, p.turn_radius_m, scan.lines.spacing_m(), corner);
        let flown = Cell { first_track, first_line: cell.lines.start, pieces: cell.pieces.clone(), order };
        let at = flown.end(scan).unwrap_or(cell.last.1);
        cells.push(flown);
        first_track += lines;
        let near = nearest_left(&found, &left, number);
        next = nearest_corner(near.into_iter().filter_map(|i| Some((i, found.get(i)?))), at);
    }
    cells
}

/// Where to begin: at the nearest corner of a cell, or at a corner of the whole pattern.
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

/// The remaining cells that are the fewest cells away from one; all remaining cells, if none is connected to it.
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
