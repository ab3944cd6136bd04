//! How much of a scanned area was seen.

use super::record::{Area, PassageKey, Track};
use geometry::polygon::is_in_ring;
use geometry::{LatLon, LocalFrame, Vec2};

/// Cells a side of the grid on which coverage is counted.
const CELLS: usize = 300;

/// What part of an area was seen in one passage.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    /// The area.
    pub label: String,
    /// The passage that scanned it.
    pub passage: PassageKey,
    /// Share of the area within half a spacing of the flown track, 0..=1.
    pub share: f64,
    /// The area's size, m².
    pub area_m2: f64,
}

/// Counts the cells of a grid over the area that lie near the track of its passage; `None` if that passage
/// was not flown or the area is none.
pub fn of(area: &Area, flown: &Track) -> Option<Coverage> {
    let passage = flown.passages().iter().position(|p| p.key == area.passage)?;
    let frame = LocalFrame::new(*area.outline.first()?);
    let ring = |ring: &Vec<LatLon>| ring.iter().map(|p| frame.to_local(*p)).collect::<Vec<Vec2>>();
    let outline = ring(&area.outline);
    let holes: Vec<Vec<Vec2>> = area.holes.iter().map(ring).collect();
    let track: Vec<Vec2> =
        flown.points().get(flown.range(passage))?.iter().map(|p| frame.to_local(p.position)).collect();
    let grid = Grid::around(&outline)?;
    let mut seen = vec![false; CELLS * CELLS];
    let reach_m = area.spacing_m * 0.5;
    for ends in track.windows(2) {
        grid.mark(&mut seen, ends[0], ends[1], reach_m);
    }
    let inside: Vec<bool> = (0..CELLS * CELLS)
        .map(|i| grid.centre(i))
        .map(|p| is_in_ring(&outline, p) && !holes.iter().any(|hole| is_in_ring(hole, p)))
        .collect();
    let total = inside.iter().filter(|i| **i).count();
    let covered = inside.iter().zip(&seen).filter(|(i, s)| **i && **s).count();
    (total > 0).then(|| Coverage {
        label: area.label.clone(),
        passage: area.passage.clone(),
        share: covered as f64 / total as f64,
        area_m2: total as f64 * grid.cell.e * grid.cell.n,
    })
}

/// Square cells over the box of an outline.
struct Grid {
    corner: Vec2,
    cell: Vec2,
}

impl Grid {
    fn around(outline: &[Vec2]) -> Option<Self> {
        let fold = |f: fn(f64, f64) -> f64, start| {
            outline.iter().fold(Vec2::new(start, start), |a, p| Vec2::new(f(a.e, p.e), f(a.n, p.n)))
        };
        let (min, max) = (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY));
        let cell = (max - min) * (1.0 / CELLS as f64);
        (cell.e > 0.0 && cell.n > 0.0 && cell.e.is_finite() && cell.n.is_finite())
            .then_some(Self { corner: min, cell })
    }

    fn centre(&self, index: usize) -> Vec2 {
        let (row, column) = (index / CELLS, index % CELLS);
        self.corner + Vec2::new((column as f64 + 0.5) * self.cell.e, (row as f64 + 0.5) * self.cell.n)
    }

    /// Marks the cells whose centre is within `reach_m` of a segment.
    fn mark(&self, seen: &mut [bool], a: Vec2, b: Vec2, reach_m: f64) {
        let columns = span(a.e, b.e, reach_m, self.corner.e, self.cell.e);
        for row in span(a.n, b.n, reach_m, self.corner.n, self.cell.n) {
            for column in columns.clone() {
                let index = row * CELLS + column;
                if !seen[index] && distance_m(a, b, self.centre(index)) <= reach_m {
                    seen[index] = true;
                }
            }
        }
    }
}

/// Cells along one axis that may be within reach of two ends.
fn span(a: f64, b: f64, reach: f64, corner: f64, cell: f64) -> std::ops::Range<usize> {
    // a float below 0 becomes cell 0
    let from = ((a.min(b) - reach - corner) / cell) as usize;
    let to = ((a.max(b) + reach - corner) / cell + 1.0) as usize;
    from.min(CELLS)..to.min(CELLS)
}

fn distance_m(a: Vec2, b: Vec2, p: Vec2) -> f64 {
    let along = b - a;
    let length2 = along.dot(along);
    let t = if length2 > 0.0 { ((p - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (p - a - along * t).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::record::TrackPoint;

    fn key() -> PassageKey {
        PassageKey { leg: "sweep".into(), iterations: String::new(), reverse: false, occurrence: 0 }
    }

    /// A square of 1 km and tracks over it at the given distances from its southern edge.
    fn scanned(norths_m: &[f64]) -> Option<Coverage> {
        scanned_around(norths_m, &[])
    }

    fn scanned_around(norths_m: &[f64], hole: &[(f64, f64)]) -> Option<Coverage> {
        let frame = LocalFrame::new(LatLon::new(36.3, -84.2));
        let at = |e: f64, n: f64| frame.to_geo(Vec2::new(e, n));
        let outline = vec![at(0.0, 0.0), at(1000.0, 0.0), at(1000.0, 1000.0), at(0.0, 1000.0)];
        let mut flown = Track::default();
        flown.begin(key(), "scan", String::new());
        for (i, north) in norths_m.iter().enumerate() {
            for east in if i % 2 == 0 { [-50.0, 1050.0] } else { [1050.0, -50.0] } {
                flown.push(TrackPoint { time_s: 0.0, position: at(east, *north), altitude_amsl_m: 0.0 });
            }
        }
        let holes = vec![hole.iter().map(|&(e, n)| at(e, n)).collect()];
        of(&Area { label: "square".into(), outline, holes, spacing_m: 200.0, passage: key() }, &flown)
    }

    #[test]
    fn shares() {
        for (tracks, share) in [
            (&[100.0, 300.0, 500.0, 700.0, 900.0][..], 1.0),
            (&[105.0, 295.0, 505.0, 695.0, 895.0], 1.0),
            (&[100.0, 300.0, 500.0, 700.0], 0.81),
            (&[100.0, 300.0, 700.0, 900.0], 0.82),
        ] {
            let found = scanned(tracks).unwrap();
            // the way from one track to the next covers a little of a gap as well
            assert!((found.share - share).abs() < 0.04, "{tracks:?}: {}", found.share);
            assert!((found.area_m2 - 1e6).abs() < 1e3);
        }
    }

    #[test]
    fn a_hole_is_not_to_be_seen() {
        let hole = [(0.0, 400.0), (1000.0, 400.0), (1000.0, 600.0), (0.0, 600.0)];
        let found = scanned_around(&[100.0, 300.0, 700.0, 900.0], &hole).unwrap();
        assert!(found.share > 0.99 && (found.area_m2 - 8e5).abs() < 4e3, "{found:?}");
    }

    #[test]
    fn nothing_to_measure() {
        let (label, outline, holes) = (String::new(), vec![], vec![]);
        let empty = Area { label, outline, holes, spacing_m: 10.0, passage: key() };
        assert_eq!(of(&empty, &Track::default()), None);
    }
}
