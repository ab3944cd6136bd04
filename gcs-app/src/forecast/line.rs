//! The line of a long path for one zoom: without what could not be told apart there.
//!
//! Points near the straight line between others are left out first. What is left is laid into a grid, piece by piece; a piece that is
//! near what is there already in all of its length is not drawn again. So a path that is flown a hundred times has no more pieces than
//! the screen has room for.

use super::Places;
use crate::map::view::{Area, Mercator};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::Range;

/// At the largest scale of its zoom a line is drawn again where it is farther than about this from itself, screen points.
const APART: f64 = 1.5;
/// At the largest scale the line is so near to every point that is left out of it, screen points.
const STRAIGHT: f64 = 0.3;
/// Where the points of a path are farther apart than so many times [`APART`], it hardly ever goes through the same place twice, and the
/// grid would be large.
const SPARSE: f64 = 4.0;

/// A line without what could not be told apart at its zoom: where it goes along itself again, it is there once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Line {
    places: Places,
    /// No line leads to these from the one before.
    begins: Vec<bool>,
}

impl Line {
    /// For views of an octave ([`View::octave`](crate::map::view::View::octave)).
    pub fn for_octave(line: &[Mercator], octave: i32) -> Self {
        Self::of(line, 2f64.powi(octave.saturating_add(1)))
    }

    /// For scales up to this, screen points per unit of the unit square.
    fn of(line: &[Mercator], scale: f64) -> Self {
        let is_sparse = mean_step(line) > SPARSE * APART / scale;
        let straight = straightened(line, STRAIGHT / scale);
        let mut drawn = Grid::new(APART / 2.0 / scale);
        let mut kept = Kept::default();
        for (from, to) in straight.iter().zip(straight.iter().skip(1)) {
            let is_new = is_sparse || drawn.lay(*from, *to);
            let is_short = (to.x - from.x).hypot(to.y - from.y) < APART / scale;
            match is_new {
                true => kept.take(*from, *to),
                false => kept.leave_out(is_short),
            }
        }
        Self { places: Places::of(kept.at), begins: kept.begins }
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

/// Pieces of a line that are drawn, one after the other.
#[derive(Default)]
struct Kept {
    at: Vec<Mercator>,
    begins: Vec<bool>,
    gap: Gap,
}

/// What is left out between the last piece that was kept and the next one.
#[derive(Default, Clone, Copy, PartialEq)]
enum Gap {
    Nothing,
    /// Too short to begin a new part behind it.
    Short,
    #[default]
    Wide,
}

impl Kept {
    fn take(&mut self, from: Mercator, to: Mercator) {
        if self.gap != Gap::Nothing {
            self.push(from, self.gap == Gap::Wide);
        }
        self.push(to, false);
        self.gap = Gap::Nothing;
    }

    fn push(&mut self, place: Mercator, begins: bool) {
        self.at.push(place);
        self.begins.push(begins);
    }

    fn leave_out(&mut self, is_short: bool) {
        self.gap = if is_short && self.gap == Gap::Nothing { Gap::Short } else { Gap::Wide };
    }
}

/// Between two places of a line, in the unit square.
fn mean_step(line: &[Mercator]) -> f64 {
    let steps = line.iter().zip(line.iter().skip(1)).map(|(a, b)| (a.x - b.x).abs() + (a.y - b.y).abs());
    steps.sum::<f64>() / line.len().max(1) as f64
}

/// Without places to which the line between those that stay comes nearer than about `near`, in one walk along it. The ends stay.
fn straightened(line: &[Mercator], near: f64) -> Vec<Mercator> {
    let Some((first, rest)) = line.split_first() else { return Vec::new() };
    let mut kept = vec![*first];
    let mut sleeve = Sleeve::from(*first);
    let mut before = *first;
    for place in rest {
        if !sleeve.takes(*place, near) {
            kept.push(before);
            sleeve = Sleeve::from(before);
            sleeve.takes(*place, near);
        }
        before = *place;
    }
    kept.extend((!rest.is_empty()).then_some(before));
    kept
}

/// The directions in which a straight line from a place passes near everything since then.
struct Sleeve {
    from: Mercator,
    /// The first and the last of them, turning from x to y; `None`: it may go anywhere.
    sides: Option<[(f64, f64); 2]>,
    /// The farthest place.
    reach: f64,
}

impl Sleeve {
    fn from(from: Mercator) -> Self {
        Self { from, sides: None, reach: 0.0 }
    }

    /// False: the line to this place would not be near all of those before, or would go back.
    fn takes(&mut self, place: Mercator, near: f64) -> bool {
        let way = (place.x - self.from.x, place.y - self.from.y);
        let far = way.0.hypot(way.1);
        if far.is_nan() || far + near < self.reach {
            return false;
        }
        self.reach = self.reach.max(far);
        if far <= near {
            return true;
        }
        let sine = near / far;
        let cosine = (1.0 - sine * sine).sqrt();
        let own = [turned(way, -sine, cosine), turned(way, sine, cosine)];
        let [first, last] = self.sides.unwrap_or(own);
        self.sides = Some([
            if turn(first, own[0]) > 0.0 { own[0] } else { first },
            if turn(last, own[1]) < 0.0 { own[1] } else { last },
        ]);
        turn(first, way) >= 0.0 && turn(way, last) >= 0.0
    }
}

fn turned((x, y): (f64, f64), sine: f64, cosine: f64) -> (f64, f64) {
    (x * cosine - y * sine, y * cosine + x * sine)
}

/// Above zero: the second direction is behind the first, turning from x to y.
fn turn(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0 * b.1 - a.1 * b.0
}

/// Squares that a line goes through, or is near to.
struct Grid {
    /// Of a square, in the unit square of the projection.
    side: f64,
    /// A bit for each square of eight by eight.
    blocks: HashMap<(i32, i32), u64, BuildHasherDefault<Mixer>>,
}

impl Grid {
    fn new(side: f64) -> Self {
        Self { side, blocks: HashMap::default() }
    }

    /// Lays a piece of the line into it. False: all of it is near what is there already.
    fn lay(&mut self, from: Mercator, to: Mercator) -> bool {
        let side = self.side;
        let steps = ((to.x - from.x).abs().max((to.y - from.y).abs()) / side).ceil().max(1.0);
        let square = |step: u32| {
            let share = f64::from(step) / steps;
            let at = |from: f64, to: f64| ((from + (to - from) * share) / side).floor() as i64;
            (at(from.x, to.x), at(from.y, to.y))
        };
        let along = 0..=steps as u32;
        if along.clone().all(|step| self.has(square(step))) {
            return false;
        }
        along.for_each(|step| self.take_around(square(step)));
        true
    }

    fn has(&self, (x, y): (i64, i64)) -> bool {
        self.blocks.get(&block(x, y)).is_some_and(|bits| bits & bit(x, y) != 0)
    }

    /// With its neighbours.
    fn take_around(&mut self, (x, y): (i64, i64)) {
        let beside = |at: i64| [at.saturating_sub(1), at, at.saturating_add(1)];
        for (x, y) in beside(x).into_iter().flat_map(|x| beside(y).map(|y| (x, y))) {
            *self.blocks.entry(block(x, y)).or_default() |= bit(x, y);
        }
    }
}

/// There are fewer blocks than numbers: no map is so large.
fn block(x: i64, y: i64) -> (i32, i32) {
    ((x >> 3) as i32, (y >> 3) as i32)
}

fn bit(x: i64, y: i64) -> u64 {
    1 << ((x & 7) * 8 + (y & 7))
}

/// Spreads the numbers of squares: nobody chooses them to collide, and millions are asked for.
#[derive(Default)]
struct Mixer(u64);

impl Hasher for Mixer {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_i32(i32::from(*byte)));
    }

    fn write_i32(&mut self, number: i32) {
        // odd, and without a pattern: 2⁶⁴ divided by the golden ratio
        self.0 = (self.0.rotate_left(32) ^ u64::from(number as u32)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
}

#[cfg(test)]
mod tests {
    use super::super::outline::BLOCK;
    use super::*;
    use geometry::LatLon;

    /// Of a view in which a few kilometres are a window.
    const SCALE: f64 = 256.0 * 4096.0;

    fn circle(times: u32) -> Vec<Mercator> {
        let middle = LatLon::new(46.0, 8.0);
        (0..times * 360).map(|i| middle.destination(f64::from(i), 300.0).into()).collect()
    }

    fn parts(line: &Line) -> Vec<&[Mercator]> {
        line.parts(Area::around(&line.places.at)).collect()
    }

    /// How far a place is from the line, screen points at the largest scale.
    fn far(place: &Mercator, parts: &[&[Mercator]]) -> f64 {
        let to_piece = |ends: &[Mercator]| {
            let (a, b) = (ends[0], ends[1]);
            let (x, y) = (b.x - a.x, b.y - a.y);
            let along = ((place.x - a.x) * x + (place.y - a.y) * y) / (x * x + y * y).max(1e-300);
            let along = along.clamp(0.0, 1.0);
            (a.x + x * along - place.x).hypot(a.y + y * along - place.y) * SCALE
        };
        parts.iter().flat_map(|part| part.windows(2).map(to_piece)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_line_that_is_flown_again_and_again_is_drawn_once() {
        let once = Line::of(&circle(1), SCALE);
        let often = Line::of(&circle(200), SCALE);
        assert!(often.places.at.len() < once.places.at.len() + 10, "{}", often.places.at.len());
        assert!((1..4).contains(&parts(&often).len()));
        assert!(
            circle(1).iter().all(|m| far(m, &parts(&often)) < 3.0),
            "no place of the path is far from the line"
        );
    }

    /// A hundred passes over the same field, each a little beside the one before: the field has room for so many pieces.
    #[test]
    fn passes_that_fill_a_field_cost_what_the_field_shows() {
        let corner = Mercator::from(LatLon::new(46.0, 8.0));
        let at = |x: f64, y: f64| Mercator { x: corner.x + x / SCALE, y: corner.y + y / SCALE };
        // 300 screen points wide, three high; a pass is a zigzag with a point in each
        let pass = |n: u32| (0..300).map(move |x| at(f64::from(x), f64::from(n) * 0.03 + f64::from(x % 2)));
        let line: Vec<Mercator> = (0..100).flat_map(pass).collect();
        let kept = Line::of(&line, SCALE);
        assert!(kept.places.at.len() < 2500, "{} of {}", kept.places.at.len(), line.len());
        let parts = parts(&kept);
        let farthest = line.iter().map(|m| far(m, &parts)).fold(0.0, f64::max);
        assert!(farthest < 3.0, "{farthest}");
    }

    #[test]
    fn what_is_straight_has_two_ends_and_what_turns_back_its_turn() {
        let at = |x: f64, y: f64| Mercator { x: 0.5 + x / SCALE, y: 0.5 + y / SCALE };
        for (line, kept) in [
            (vec![], 0),
            (vec![at(0.0, 0.0)], 0),
            ((0..1000).map(|i| at(f64::from(i), 0.2 * f64::from(i % 2))).collect(), 2),
            (vec![at(0.0, 0.0), at(9.0, 9.0), at(18.0, 18.0), at(18.0, 0.0)], 3),
            (vec![at(0.0, 0.0), at(9.0, 0.0), at(30.0, 0.0), at(-8.0, 0.0)], 3),
            (vec![at(0.0, 0.0), at(f64::NAN, 0.0), at(9.0, 0.0)], 3),
        ] {
            assert_eq!(Line::of(&line, SCALE).places.at.len(), kept, "{line:?}");
        }
        let straight = straightened(&circle(1), 1e-7);
        assert!(straight.len() < 120, "{}", straight.len());
        assert!(circle(1).iter().all(|place| far(place, &[&straight]) < 2e-7 * SCALE));
    }

    #[test]
    fn what_is_in_an_area_is_found_by_its_blocks() {
        // no three of them in a line
        let place = |i: i32| LatLon::new(f64::from(i % 2) * 1e-4, f64::from(i) * 1e-3 - 5.0);
        let line: Vec<Mercator> = (0..10_000).map(|i| place(i).into()).collect();
        let kept = Line::of(&line, 1e9);
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
        let place = |i: usize| {
            LatLon::new((i % 2) as f64 * 1e-4, i as f64 * 1e-4 + if i < BLOCK { 0.0 } else { 50.0 })
        };
        let line: Vec<Mercator> = (0..2 * BLOCK).map(|i| place(i).into()).collect();
        let kept = Line::of(&line, 1e9);
        let middle = Area::around(&[LatLon::new(0.0, 25.0).into()]);
        let parts: Vec<&[Mercator]> = kept.parts(middle).collect();
        assert_eq!(parts.len(), 1);
        assert!(parts[0].ends_with(&line[BLOCK - 1..=BLOCK]));
    }
}
