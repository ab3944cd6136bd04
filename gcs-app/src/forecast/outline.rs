//! What map and profile need to know of a long path, worked out once for each forecast: where it is on the map, in blocks that can be
//! passed over as a whole, and the line for each zoom. A frame then looks only at what it shows.

use super::Point;
use crate::map::view::{Area, Mercator};
use std::collections::HashSet;
use std::ops::Range;
use std::sync::OnceLock;

/// Points of a block.
pub(super) const BLOCK: usize = 128;
/// Octaves of the zoom for which a line is kept: more than a map has.
const OCTAVES: usize = 32;
/// At the largest scale of an octave a line is drawn at most once in such a square, screen points.
const CELL: f64 = 1.5;
/// Where its points are farther apart than so many squares, a line hardly ever goes through the same two again.
const SPARSE: f64 = 4.0;

/// Each part is worked out when it is first asked for.
#[derive(Debug, Clone, Default)]
pub struct Outline {
    places: OnceLock<Places>,
    waypoints: OnceLock<Places>,
    heights: OnceLock<Vec<Heights>>,
    lines: [OnceLock<Line>; OCTAVES],
}

/// It follows from the path.
impl PartialEq for Outline {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

impl Outline {
    /// Where the points of the path are.
    pub(super) fn places(&self, points: &[Point]) -> &Places {
        self.places.get_or_init(|| Places::of(points.iter().map(|point| point.position.into()).collect()))
    }

    /// Where the waypoints are.
    pub(super) fn waypoints(&self, at: impl Iterator<Item = Mercator>) -> &Places {
        self.waypoints.get_or_init(|| Places::of(at.collect()))
    }

    /// The path as it is drawn in views of an octave ([`View::octave`](crate::map::view::View::octave)); `None`: no map has that.
    pub(super) fn line(&self, points: &[Point], octave: i32) -> Option<&Line> {
        let kept = self.lines.get(usize::try_from(octave).ok()?)?;
        Some(kept.get_or_init(|| Line::of(&self.places(points).at, CELL / 2f64.powi(octave + 1))))
    }

    /// The lowest and the highest of each block of points.
    pub(super) fn heights(&self, points: &[Point]) -> &[Heights] {
        self.heights.get_or_init(|| points.chunks(BLOCK).map(Heights::of).collect())
    }

    /// Works out what was asked about the former path, so that no frame has to wait for it. True: where the waypoints are, too.
    pub(super) fn prepare(&self, points: &[Point], former: &Self) -> bool {
        self.heights(points);
        self.places(points);
        for (octave, line) in (0..).zip(&former.lines) {
            if line.get().is_some() {
                self.line(points, octave);
            }
        }
        former.waypoints.get().is_some()
    }
}

/// Places in an order, block by block.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Places {
    /// All of them.
    pub at: Vec<Mercator>,
    /// Around each block and the way to the next one.
    areas: Vec<Area>,
}

impl Places {
    fn of(at: Vec<Mercator>) -> Self {
        let blocks = (0..at.len()).step_by(BLOCK);
        let areas = blocks.map(|first| {
            let end = (first + BLOCK + 1).min(at.len());
            Area::around(at.get(first..end).unwrap_or_default())
        });
        Self { areas: areas.collect(), at }
    }

    /// The numbers of those in an area.
    pub fn within(&self, area: Area) -> impl Iterator<Item = usize> {
        let blocks = self.blocks(area).flatten();
        blocks.filter(move |index| self.at.get(*index).is_some_and(|at| area.has(*at)))
    }

    /// The blocks that reach into an area.
    fn blocks(&self, area: Area) -> impl Iterator<Item = Range<usize>> {
        let all = self.areas.iter().enumerate();
        let near = all.filter(move |(_, of_block)| of_block.overlaps(&area));
        near.map(|(block, _)| block * BLOCK..((block + 1) * BLOCK).min(self.at.len()))
    }
}

/// A line without what could not be told apart at its zoom: where it goes along itself again, it is there once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Line {
    places: Places,
    /// No line leads to these from the one before.
    begins: Vec<bool>,
}

impl Line {
    /// With squares of this side, in the unit square of the projection.
    fn of(line: &[Mercator], side: f64) -> Self {
        let square = |m: &Mercator| ((m.x / side).floor() as i64, (m.y / side).floor() as i64);
        let is_sparse = mean_step(line) > SPARSE * side;
        let (mut at, mut begins) = (Vec::new(), Vec::new());
        let mut drawn = HashSet::new();
        let mut before: Option<(Mercator, (i64, i64))> = None;
        // the last place that is kept is the one before
        let mut goes_on = false;
        for (index, place) in line.iter().enumerate() {
            let here = square(place);
            if let Some((from, there)) = before {
                // the end of the path stays where it is
                if here == there && index + 1 < line.len() {
                    continue;
                }
                let is_new = is_sparse || drawn.insert((here.min(there), here.max(there)));
                if is_new && !goes_on {
                    at.push(from);
                    begins.push(true);
                }
                if is_new {
                    at.push(*place);
                    begins.push(false);
                }
                goes_on = is_new;
            }
            before = Some((*place, here));
        }
        Self { places: Places::of(at), begins }
    }

    /// The parts of it that reach into an area.
    pub fn parts(&self, area: Area) -> impl Iterator<Item = &[Mercator]> {
        let mut parts: Vec<Range<usize>> = Vec::new();
        for block in self.places.blocks(area) {
            // with the way to the next block
            for index in block.start..(block.end + 1).min(self.begins.len()) {
                let begins = self.begins.get(index).copied().unwrap_or(true);
                match parts.last_mut() {
                    Some(part) if index < part.end => {}
                    Some(part) if index == part.end && !begins => part.end += 1,
                    _ => parts.push(index..index + 1),
                }
            }
        }
        parts.into_iter().filter_map(|part| self.places.at.get(part))
    }
}

/// Between two places of a line, in the unit square.
fn mean_step(line: &[Mercator]) -> f64 {
    let steps = line.iter().zip(line.iter().skip(1)).map(|(a, b)| (a.x - b.x).abs() + (a.y - b.y).abs());
    steps.sum::<f64>() / line.len().max(1) as f64
}

/// Between which heights a part of the path and the ground below it are, metres AMSL.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heights {
    /// The lowest of path and ground.
    pub low_m: f64,
    /// The highest of them.
    pub high_m: f64,
}

impl Heights {
    /// Of nothing.
    pub const NONE: Self = Self { low_m: f64::INFINITY, high_m: f64::NEG_INFINITY };

    /// Of some points.
    pub fn of(points: &[Point]) -> Self {
        points.iter().fold(Self::NONE, |found, point| {
            let ground_m = point.ground_amsl_m.unwrap_or(point.altitude_amsl_m);
            found.with(Self { low_m: ground_m, high_m: point.altitude_amsl_m.max(ground_m) })
        })
    }

    /// Of both.
    pub fn with(self, other: Self) -> Self {
        Self { low_m: self.low_m.min(other.low_m), high_m: self.high_m.max(other.high_m) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    fn circle(times: u32) -> Vec<Mercator> {
        let middle = LatLon::new(46.0, 8.0);
        (0..times * 360).map(|i| middle.destination(f64::from(i), 300.0).into()).collect()
    }

    #[test]
    fn a_line_that_is_flown_again_and_again_is_drawn_once() {
        let scale = 256.0 * 2f64.powi(12);
        let once = Line::of(&circle(1), CELL / scale);
        let often = Line::of(&circle(200), CELL / scale);
        assert!(often.places.at.len() < once.places.at.len() + 10, "{}", often.places.at.len());
        assert!((1..4).contains(&often.parts(Area::around(&circle(1))).count()));
        let far = |m: &Mercator| {
            let to = |k: &Mercator| (k.x - m.x).hypot(k.y - m.y) * scale;
            often.places.at.iter().map(to).fold(f64::INFINITY, f64::min)
        };
        assert!(circle(1).iter().all(|m| far(m) < 3.0), "no place of the path is far from the line");
    }

    #[test]
    fn what_is_in_an_area_is_found_by_its_blocks() {
        let line: Vec<Mercator> =
            (0..10_000).map(|i| LatLon::new(0.0, f64::from(i) * 1e-3 - 5.0).into()).collect();
        let kept = Line::of(&line, 1e-9);
        assert_eq!(kept.places.at, line);
        let area = Area::around(&line[5000..5010]);
        let parts: Vec<&[Mercator]> = kept.parts(area).collect();
        assert_eq!(parts.len(), 1);
        assert!(parts[0].len() <= 2 * BLOCK + 1, "{}", parts[0].len());
        assert!(line[5000..5010].iter().all(|m| parts[0].contains(m)));
        assert!(kept.places.within(area).eq(5000..5010));
        assert_eq!(kept.parts(Area::around(&[LatLon::new(60.0, 90.0).into()])).count(), 0);
    }

    /// The way from a block to the next belongs to it, however far that is.
    #[test]
    fn a_way_between_two_blocks_is_found_in_its_middle() {
        let place = |i: usize| LatLon::new(0.0, i as f64 * 1e-4 + if i < BLOCK { 0.0 } else { 50.0 });
        let line: Vec<Mercator> = (0..2 * BLOCK).map(|i| place(i).into()).collect();
        let kept = Line::of(&line, 1e-9);
        let middle = Area::around(&[LatLon::new(0.0, 25.0).into()]);
        let parts: Vec<&[Mercator]> = kept.parts(middle).collect();
        assert_eq!(parts.len(), 1);
        assert!(parts[0].ends_with(&line[BLOCK - 1..=BLOCK]));
    }
}
