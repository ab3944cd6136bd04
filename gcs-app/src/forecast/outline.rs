//! What map and profile need to know of a long path, worked out once for each forecast: where it is on the map, in blocks that can be
//! passed over as a whole, and the line for each zoom. A frame then looks only at what it shows.

use super::{Line, Point};
use crate::map::view::{Area, Mercator};
use std::ops::Range;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, Ordering};

/// Points of a block.
pub(super) const BLOCK: usize = 128;
/// Octaves of the zoom for which a line is kept: more than a map has.
const OCTAVES: usize = 32;

/// Each part is worked out when it is first asked for; the lines when somebody has the time for that.
#[derive(Debug, Default)]
pub struct Outline {
    places: OnceLock<Places>,
    waypoints: OnceLock<Places>,
    heights: OnceLock<Vec<Heights>>,
    lines: [OnceLock<Line>; OCTAVES],
    /// One more than the octave that was drawn last; 0: none was.
    drawn: AtomicI32,
}

impl Clone for Outline {
    fn clone(&self) -> Self {
        Self {
            places: self.places.clone(),
            waypoints: self.waypoints.clone(),
            heights: self.heights.clone(),
            lines: self.lines.clone(),
            drawn: AtomicI32::new(self.drawn.load(Ordering::Relaxed)),
        }
    }
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

    /// The path as it is drawn in views of an octave ([`View::octave`](crate::map::view::View::octave)), as soon as that is worked out.
    pub(super) fn line(&self, octave: i32) -> Option<&Line> {
        self.drawn.store(octave.saturating_add(1), Ordering::Relaxed);
        self.kept(octave)?.get()
    }

    /// Beyond what a map has, the last one.
    fn kept(&self, octave: i32) -> Option<&OnceLock<Line>> {
        self.lines.get(octave.clamp(0, OCTAVES as i32 - 1) as usize)
    }

    /// The nearest octave for which the line is worked out, and that line.
    pub(super) fn line_near(&self, octave: i32) -> Option<(i32, &Line)> {
        let known = (0..).zip(&self.lines).filter_map(|(of, line)| Some((of, line.get()?)));
        known.min_by_key(|(of, _)| octave.abs_diff(*of))
    }

    /// Works out the line for an octave.
    pub(super) fn work_out_line(&self, points: &[Point], octave: i32) {
        if let Some(kept) = self.kept(octave) {
            kept.get_or_init(|| Line::for_octave(&self.places(points).at, octave));
        }
    }

    /// The lowest and the highest of each block of points.
    pub(super) fn heights(&self, points: &[Point]) -> &[Heights] {
        self.heights.get_or_init(|| points.chunks(BLOCK).map(Heights::of).collect())
    }

    /// Works out what was asked about the former path, so that no frame has to wait for it. True: where the waypoints are, too.
    pub(super) fn prepare(&self, points: &[Point], former: &Self) -> bool {
        self.heights(points);
        self.places(points);
        let drawn = former.drawn.load(Ordering::Relaxed);
        if drawn > 0 {
            self.work_out_line(points, drawn - 1);
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
    pub(super) fn of(at: Vec<Mercator>) -> Self {
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

    /// The numbers of those from which the straight way to the next one may go through an area.
    pub fn ways_within(&self, area: Area) -> impl Iterator<Item = usize> {
        let blocks = self.blocks(area).flatten();
        blocks.filter(move |index| {
            self.at.get(*index..index + 2).is_some_and(|ends| Area::around(ends).overlaps(&area))
        })
    }

    /// The blocks that reach into an area.
    pub(super) fn blocks(&self, area: Area) -> impl Iterator<Item = Range<usize>> {
        let all = self.areas.iter().enumerate();
        let near = all.filter(move |(_, of_block)| of_block.overlaps(&area));
        near.map(|(block, _)| block * BLOCK..((block + 1) * BLOCK).min(self.at.len()))
    }
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

    fn points() -> Vec<Point> {
        let point = |i: u32| Point {
            time_s: f64::from(i),
            distance_m: f64::from(i),
            position: LatLon::new(46.0 + f64::from(i % 2) * 1e-3, 8.0 + f64::from(i) * 1e-3),
            altitude_amsl_m: 500.0,
            ground_amsl_m: None,
            passage: 0,
        };
        (0..1000).map(point).collect()
    }

    #[test]
    fn nobody_who_asks_for_a_line_waits_for_it_and_the_nearest_one_stands_in() {
        let (points, outline) = (points(), Outline::default());
        assert_eq!((outline.line(12), outline.line_near(12)), (None, None));
        for octave in [9, 14] {
            outline.work_out_line(&points, octave);
        }
        assert_eq!(outline.line(12), None);
        assert!(outline.line(14).is_some());
        assert_eq!(
            [8, 11, 12, 30].map(|octave| outline.line_near(octave).map(|(of, _)| of)),
            [9, 9, 14, 14].map(Some)
        );
        // no map has this
        outline.work_out_line(&points, 99);
        assert!(outline.line(99).is_some() && outline.line(1000).is_some());
    }

    #[test]
    fn the_next_path_is_known_in_the_octave_that_was_drawn_last() {
        let (points, outline) = (points(), Outline::default());
        outline.prepare(&points, &Outline::default());
        assert_eq!(outline.line_near(12), None);
        outline.line(12);
        let next = Outline::default();
        next.prepare(&points, &outline);
        assert!(next.line(12).is_some());
    }
}
