//! Loops along a polygon's edge, at growing distances inside or outside it.

mod shapes;
#[cfg(test)]
mod tests;

use super::{PatternError, Stored, Vertex, counted, finite, not_negative, positive};
use crate::polygon::{EdgeBudget, Interior};
use crate::turn::Turn;
use crate::{Polygon, Vec2};
use serde::{Deserialize, Serialize};
use shapes::{Shape, area_m2, contains, grown, minus, rings_of};

/// Distances from the edge at which loops may be flown.
const MAX_LEVELS: u64 = 10_000;
/// Limit of (reflex corners² + corners) · levels: the library's time grows with that, because offsets at reflex corners
/// cross themselves. This takes a second or two.
const MAX_WORK: f64 = 5e5;
/// Edges compared to find the paths between loops: a quarter of a second.
const MAX_EDGES: u64 = 40_000_000;
/// Share of a strip along loops that their sharp corners may leave unseen.
const MAX_UNSEEN: f64 = 0.0015;
/// What is left unseen between loops is flown round if it is larger than a square of this share of the spacing …
const FLOWN_ROUND: f64 = 0.25;
/// … or than this share of a small area.
const FLOWN_ROUND_OF_AREA: f64 = 0.0005;
/// Places on an edge at which a loop may begin.
const MAX_PARTS: f64 = 50.0;
/// Strips are taken to be so much wider, metres: between exact ones films would be left.
const FILM_M: f64 = 0.01;

/// Which side of the edge the loops are on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// In the area, round its holes too, until no room is left.
    Inward,
    /// Around the area; its holes do not count.
    Outward,
}

/// What makes contours, besides their area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ContourParameters {
    /// Distance between neighbouring loops, metres.
    pub spacing_m: f64,
    /// Distance of the first loop from the edge, metres: 0 is the perimeter, half the spacing the first track of a search.
    pub first_m: f64,
    /// Which side of the edge.
    pub side: Side,
    /// At how many distances; inward, fewer where the area ends.
    pub levels: u64,
    /// How loops along the outer edge are flown; those round holes go the other way.
    pub turn: Turn,
    /// Where the aircraft comes from: the first loop begins at its corner nearest to it.
    pub entry: Vec2,
    /// Radius of turns, metres: each further loop begins where it can be turned to from the end of the one before.
    pub turn_radius_m: f64,
    /// How far straight lines may cut a loop's rounded corners, metres.
    pub tolerance_m: f64,
}

/// Closed loops; each is a track that ends where it begins. Inward, loops and the paths between them stay in the area.
#[derive(Debug, Clone, PartialEq)]
pub struct Contours {
    stored: Stored,
    /// The first waypoint of each distance from the edge.
    begins: Vec<u64>,
}

impl Contours {
    /// Lays them out, from the edge on.
    ///
    /// Inward, an area whose middle is farther than half the spacing from its last loop gets one loop more, half a spacing
    /// farther in.
    ///
    /// # Errors
    /// A parameter that makes no sense; more waypoints than can be stored; no room for a loop.
    pub fn new(area: &Polygon, p: &ContourParameters) -> Result<Self, PatternError> {
        lay_out(area, p, false)
    }

    /// As [`Contours::new`], with the spacing as the width of the strip that is seen, so that next to nothing of the area is
    /// missed: where loops have sharp corners, outside of which each of them leaves something unseen, the next one is nearer,
    /// down to half the spacing, and so is the first one to the edge; what is still left between two is flown round.
    ///
    /// # Errors
    /// As [`Contours::new`].
    pub fn covering(area: &Polygon, p: &ContourParameters) -> Result<Self, PatternError> {
        positive("spacing", p.spacing_m)?;
        let first_m = p.first_m.min(reach_m(&[rings_of(area)], p.spacing_m));
        lay_out(area, &ContourParameters { first_m, ..*p }, true)
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        self.stored.count()
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        self.stored.vertex(index)
    }

    /// Which of the distances from the edge, from 0 in flight order, the loop of a waypoint keeps; what is flown round because
    /// two loops leave it unseen counts as the former one's.
    pub fn distance_number(&self, index: u64) -> u64 {
        let begun = self.begins.partition_point(|&begin| begin <= index);
        begun.saturating_sub(1) as u64
    }
}

impl ContourParameters {
    fn check(&self) -> Result<(), PatternError> {
        positive("spacing", self.spacing_m)?;
        not_negative("distance from the edge", self.first_m)?;
        counted("distances from the edge", self.levels, MAX_LEVELS)?;
        finite("entry", self.entry.length())?;
        not_negative("turn radius", self.turn_radius_m)?;
        positive("tolerance", self.tolerance_m)
    }

    /// Refuses what would take too long. Inward there are no more levels than half a spacing apart have room in the area.
    fn check_work(&self, area: &Polygon) -> Result<(), PatternError> {
        let room = match self.side {
            Side::Inward => area.width_m(area.narrowest_heading_deg()) / self.spacing_m + 1.0,
            Side::Outward => f64::INFINITY,
        };
        let (corners, levels) = (area.edges().count(), room.min(self.levels as f64).ceil());
        let shape = rings_of(area);
        let drawn_in =
            shape.iter().map(|ring| corners_of(ring).filter(|&(_, turn_rad)| turn_rad < 0.0).count());
        let drawn_in = drawn_in.sum::<usize>() as f64;
        if (drawn_in * drawn_in + corners as f64) * levels <= MAX_WORK {
            return Ok(());
        }
        Err(PatternError::TooIntricate { corners, levels: levels as u64 })
    }

    /// The areas whose edges lie a distance from the polygon's edge.
    fn level(&self, area: &Polygon, offset_m: f64) -> Result<Vec<Shape>, PatternError> {
        match self.side {
            Side::Inward => grown(&[rings_of(area)], -offset_m, self.tolerance_m),
            Side::Outward => grown(&[rings_of(&area.without_holes())], offset_m, self.tolerance_m),
        }
    }
}

fn lay_out(area: &Polygon, p: &ContourParameters, covering: bool) -> Result<Contours, PatternError> {
    p.check()?;
    p.check_work(area)?;
    let mut begins = Vec::new();
    let mut path = Path::new(area, p);
    let mut offset_m = p.first_m;
    let mut level = p.level(area, offset_m)?;
    if covering && p.side == Side::Inward {
        // arms too narrow for any loop
        path.fly(unseen(&[rings_of(area)], &level, p, area.area_m2())?)?;
    }
    for number in 1..=p.levels {
        let half_m = p.spacing_m / 2.0;
        let next_m = offset_m + half_m + if covering { reach_m(&level, p.spacing_m) } else { half_m };
        let last = number == p.levels;
        let next = if last { Vec::new() } else { p.level(area, next_m)? };
        let between = if p.side == Side::Inward && !last {
            // what the loops of this level do not see
            let inner = p.level(area, offset_m + half_m)?;
            if covering {
                unseen(&inner, &next, p, area.area_m2())?
            } else {
                without_loops_inside(inner, &next)
            }
        } else {
            Vec::new()
        };
        begins.push(if number == 1 { 0 } else { path.stored.count() });
        for areas in [level, between] {
            path.fly(areas)?;
        }
        if next.is_empty() {
            break;
        }
        (level, offset_m) = (next, next_m);
    }
    if path.stored.count() == 0 {
        let width_m = area.width_m(area.narrowest_heading_deg());
        return Err(PatternError::TooNarrow { width_m, spacing_m: 2.0 * p.first_m });
    }
    Ok(Contours { stored: path.stored, begins })
}

/// How far beyond the strip that one loop sees the next loop's strip may begin, up to half the spacing, metres.
///
/// At that distance q a corner turned by τ leaves (tan(τ/2) − τ/2) · q² unseen outside it: the kite between its edges and
/// theirs, less a sector. All corners together may leave a share of the strip along the loops.
fn reach_m(level: &[Shape], spacing_m: f64) -> f64 {
    let (mut length_m, mut unseen) = (0.0, 0.0);
    for (edge_m, turn_rad) in level.iter().flatten().flat_map(|ring| corners_of(ring)) {
        length_m += edge_m;
        // the area is on the left: there, corners to the left are its own
        let half_rad = turn_rad.max(0.0) / 2.0;
        unseen += half_rad.tan() - half_rad;
    }
    (MAX_UNSEEN * length_m * spacing_m / unseen).sqrt().min(spacing_m / 2.0)
}

/// Length of each edge, metres, and the turn at its end, radians, positive to the left.
fn corners_of(ring: &[Vec2]) -> impl Iterator<Item = (f64, f64)> + '_ {
    let next = || ring.iter().cycle();
    ring.iter().zip(next().skip(1)).zip(next().skip(2)).map(|((a, b), c)| {
        let (before, after) = (*b - *a, *c - *b);
        (before.length(), before.cross(after).atan2(before.dot(after)))
    })
}

/// What the loops round areas do not see of others, without what is too small to be flown round.
fn unseen(
    of: &[Shape],
    round: &[Shape],
    p: &ContourParameters,
    whole_m2: f64,
) -> Result<Vec<Shape>, PatternError> {
    let seen = grown(round, p.spacing_m / 2.0 + FILM_M, p.tolerance_m)?;
    let side_m = FLOWN_ROUND * p.spacing_m;
    let least_m2 = (side_m * side_m).min(FLOWN_ROUND_OF_AREA * whole_m2);
    let mut left = minus(of, &seen)?;
    left.retain(|shape| area_m2(shape) > least_m2);
    Ok(left)
}

/// Those areas that contain none of the others.
fn without_loops_inside(mut areas: Vec<Shape>, others: &[Shape]) -> Vec<Shape> {
    areas.retain(|area| !others.iter().any(|other| contains(area, other)));
    areas
}

/// The pattern laid out so far.
struct Path {
    stored: Stored,
    turn: Turn,
    turn_radius_m: f64,
    /// Where it ends.
    at: Vec2,
    /// The end of the last loop, towards there.
    along: Option<Vec2>,
    /// The area, if paths between loops must stay inside it.
    interior: Option<Interior>,
    budget: EdgeBudget,
}

impl Path {
    fn new(area: &Polygon, p: &ContourParameters) -> Self {
        let interior = (p.side == Side::Inward && !area.is_convex()).then(|| Interior::of(area.clone()));
        Self {
            stored: Stored::default(),
            turn: p.turn,
            turn_radius_m: p.turn_radius_m,
            at: p.entry,
            along: None,
            interior,
            budget: EdgeBudget::new(MAX_EDGES),
        }
    }

    /// Adds the loops of areas, always the one nearest to where the last ended.
    fn fly(&mut self, areas: Vec<Shape>) -> Result<(), PatternError> {
        let mut loops: Vec<Vec<Vec2>> = areas.into_iter().flatten().collect();
        if self.turn == Turn::Right {
            loops.iter_mut().for_each(|ring| ring.reverse());
        }
        while let Some((ring, nearest)) = nearest(&loops, self.at) {
            let mut flown = loops.swap_remove(ring);
            match self.along.and_then(|along| self.place_turned_to(&flown, along)) {
                // in the middle of an edge
                Some((edge, begin)) if flown.get(edge) != Some(&begin) => {
                    let corners = flown.len().max(1);
                    flown.rotate_left((edge + 1) % corners);
                    flown.insert(0, begin);
                }
                Some((corner, _)) => flown.rotate_left(corner),
                None => flown.rotate_left(nearest),
            }
            let begin = flown.first().copied().unwrap_or(self.at);
            self.along = flown.last().map(|last| begin - *last);
            flown.push(begin);
            let way = self.way_to(begin)?;
            self.stored.push_after(way, flown)?;
            self.at = begin;
        }
        Ok(())
    }

    /// The nearest place of a loop to which there is room to turn, and from there along the loop; else the one with the most room. With
    /// the number of its edge.
    fn place_turned_to(&self, ring: &[Vec2], along: Vec2) -> Option<(usize, Vec2)> {
        let rated = places(ring, self.turn_radius_m).map(|(edge, place, onward)| {
            let way = place - self.at;
            let need_m = self.turn_radius_m * (half_tangent(along, way) + half_tangent(way, onward));
            let lack_m = (need_m - way.length()).max(0.0);
            (edge, place, lack_m, way.length())
        });
        let best = rated.min_by(|a, b| a.2.total_cmp(&b.2).then(a.3.total_cmp(&b.3)));
        best.map(|(edge, place, ..)| (edge, place))
    }

    /// The corners of the path from one loop to the next one; none before the first loop.
    fn way_to(&mut self, begin: Vec2) -> Result<Vec<Vec2>, PatternError> {
        let Some(interior) = self.interior.as_ref().filter(|_| self.stored.count() > 0) else {
            return Ok(Vec::new());
        };
        let corners = interior.area().edges().count();
        let too_intricate = PatternError::TooIntricate { corners, levels: self.stored.starts.len() as u64 };
        interior.shortest_path(self.at, begin, &mut self.budget).ok_or(too_intricate)
    }
}

/// Corners of a ring and places on its edges, about `every_m` metres apart, each with the number of its edge and the way on along it.
fn places(ring: &[Vec2], every_m: f64) -> impl Iterator<Item = (usize, Vec2, Vec2)> + '_ {
    ring.iter().zip(ring.iter().cycle().skip(1)).enumerate().flat_map(move |(edge, (&from, &to))| {
        let way = to - from;
        let parts = (way.length() / every_m.max(1.0)).clamp(1.0, MAX_PARTS).floor();
        (0..parts as u32).map(move |i| (edge, from + way * (f64::from(i) / parts), way))
    })
}

/// What a turn takes of the segments before and after it, in radii: tan(Δ/2).
fn half_tangent(before: Vec2, after: Vec2) -> f64 {
    (before.cross(after).atan2(before.dot(after)).abs() / 2.0).tan()
}

/// The ring, and its corner, that is nearest to a point.
fn nearest(rings: &[Vec<Vec2>], point: Vec2) -> Option<(usize, usize)> {
    let places = rings.iter().enumerate().flat_map(|(i, ring)| (0..ring.len()).map(move |j| (i, j)));
    let distance_m = |&(i, j): &(usize, usize)| {
        let corner = rings.get(i).and_then(|ring| ring.get(j));
        corner.map_or(f64::INFINITY, |&c| (c - point).length())
    };
    places.min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)))
}
