//! A parallel scan, track by track, and its regeneration in flight.
//!
//! Each track gives two fly-by points: one before the area, one beyond it, so far out that the turns between tracks stay outside
//! and every metre inside is flown on the line. The points of a turn lie side by side, so that it is made of two right angles.

use super::track::Approach;
use super::{ExpandError, Expansion, Point};
use crate::path::PathState;
use crate::world::World;
use flight_plan::{Area, Leg, LegKind, Scan};
use geometry::polygon::Polygon;
use geometry::scan::{Entry, Scan as Pattern, ScanParameters};
use geometry::{LatLon, LocalFrame, Vec2};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock};

/// Most tracks flown before a regeneration that are remembered, the latest ones.
const MOST_FLOWN: u64 = 512;
/// So near to a flown one a track has not moved, metres.
const UNMOVED_M: f64 = 2.0;
/// Circles become polygons within this, metres.
const CIRCLE_TOLERANCE_M: f64 = 2.0;
/// Tracks computed at a time.
const CHUNK: u64 = 64;

/// The area and the values that make a pattern.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Recipe {
    area: Outline,
    spacing_m: f64,
    /// `None`: left to the pattern.
    heading_deg: Option<f64>,
    overshoot_m: f64,
    turn_radius_m: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Outline {
    Circle { centre: LatLon, radius_m: f64 },
    Polygon { corners: Vec<LatLon>, holes: Vec<Vec<LatLon>> },
}

/// A scan being flown.
#[derive(Debug, Serialize, Deserialize)]
pub struct Sweep {
    recipe: Recipe,
    /// The pattern begins near here.
    entry: LatLon,
    /// Track that is flown first; then those after it, then those before it, backwards.
    first: u64,
    /// The first track is flown along the heading; the others alternate.
    along_first: bool,
    /// Places in that order that are left out, ascending: flown already and not moved.
    left_out: Vec<u64>,
    /// How many tracks are flown.
    tracks: u64,
    /// Tracks flown before the regeneration, the latest ones.
    flown: Vec<(LatLon, LatLon)>,
    #[serde(skip)]
    laid_out: OnceLock<Option<Arc<LaidOut>>>,
}

/// The pattern itself: made again from the recipe after a restart.
#[derive(Debug)]
struct LaidOut {
    pattern: Pattern,
    frame: LocalFrame,
    along: Vec2,
    chunk: Mutex<Chunk>,
}

/// The ends of some tracks in flight order, both seen along the heading.
#[derive(Debug, Default)]
struct Chunk {
    start: u64,
    ends: Vec<Option<(Vec2, Vec2)>>,
}

impl Clone for Sweep {
    fn clone(&self) -> Self {
        Self {
            recipe: self.recipe.clone(),
            left_out: self.left_out.clone(),
            flown: self.flown.clone(),
            laid_out: self.laid_out.clone(),
            ..*self
        }
    }
}

impl PartialEq for Sweep {
    fn eq(&self, other: &Self) -> bool {
        let key = |s: &Self| (s.entry, s.first, s.along_first, s.tracks);
        self.recipe == other.recipe && key(self) == key(other) && self.left_out == other.left_out
    }
}

impl Recipe {
    fn of(scan: &Scan, airspeed_mps: f64, world: &World) -> Result<Self, ExpandError> {
        let area = match &scan.area {
            Area::Circle { centre, radius_m } => {
                Outline::Circle { centre: world.place(centre)?, radius_m: world.number(radius_m)? }
            }
            Area::Polygon { corners, holes } => {
                Outline::Polygon { corners: corners.clone(), holes: holes.clone() }
            }
            Area::Expression(source) => {
                Outline::Polygon { corners: world.polygon(source)?, holes: Vec::new() }
            }
        };
        Ok(Self {
            area,
            spacing_m: world.spacing_m(&scan.spacing)?,
            heading_deg: scan.heading_deg.as_ref().map(|h| world.number(h)).transpose()?,
            overshoot_m: world.number(&scan.overshoot_m)?,
            turn_radius_m: world.turn_radius_m(airspeed_mps),
        })
    }

    fn lay_out(&self, entry: LatLon) -> Result<LaidOut, ExpandError> {
        let (frame, polygon) = self.polygon()?;
        let parameters = ScanParameters {
            spacing_m: self.spacing_m,
            heading_deg: self.heading_deg,
            overshoot_m: self.overshoot_m,
            entry: Entry::Nearest(frame.to_local(entry)),
            turn_radius_m: self.turn_radius_m,
        };
        let pattern = Pattern::new(&polygon, &parameters).map_err(geometric)?;
        let along = Vec2::from_bearing_rad(pattern.heading_deg().to_radians());
        Ok(LaidOut { pattern, frame, along, chunk: Mutex::default() })
    }

    fn polygon(&self) -> Result<(LocalFrame, Polygon), ExpandError> {
        match &self.area {
            Outline::Circle { centre, radius_m } => {
                let frame = LocalFrame::new(*centre);
                let circle = Polygon::circle(Vec2::default(), *radius_m, CIRCLE_TOLERANCE_M);
                Ok((frame, circle.map_err(geometric)?))
            }
            Outline::Polygon { corners, holes } => {
                let origin = corners.first().copied().unwrap_or(LatLon::new(0.0, 0.0));
                let frame = LocalFrame::new(origin);
                Ok((frame, Polygon::from_geo(&frame, corners, holes).map_err(geometric)?))
            }
        }
    }

    /// How far beyond a track's end its turn begins.
    fn lead_m(&self) -> f64 {
        (self.turn_radius_m - self.overshoot_m).max(0.0)
    }
}

fn geometric(error: impl std::fmt::Display) -> ExpandError {
    ExpandError::Geometry(error.to_string())
}

impl Sweep {
    /// The whole scan, begun at its corner nearest to `from`.
    ///
    /// # Errors
    /// Values that can't be computed, or make no pattern.
    pub fn new(scan: &Scan, from: LatLon, approach: &Approach, world: &World) -> Result<Self, ExpandError> {
        let recipe = Recipe::of(scan, approach.airspeed_mps, world)?;
        let laid_out = recipe.lay_out(from)?;
        let tracks = laid_out.pattern.tracks();
        let begin = laid_out.pattern.segments(0..1).next();
        let along_first = begin.is_none_or(|s| (s.to - s.from).dot(laid_out.along) >= 0.0);
        Ok(Self {
            recipe,
            entry: from,
            first: 0,
            along_first,
            left_out: Vec::new(),
            tracks,
            flown: Vec::new(),
            laid_out: OnceLock::from(Some(Arc::new(laid_out))),
        })
    }

    /// How many points it has.
    pub fn count(&self) -> u64 {
        self.tracks.saturating_mul(2)
    }

    /// The point number `index`: two a track.
    pub fn point(&self, index: u64) -> Option<Point> {
        let place = index / 2;
        if place >= self.tracks {
            return None;
        }
        let laid_out = self.laid_out()?;
        let (from, to) = self.turns_of(place, laid_out)?;
        let position = if index.is_multiple_of(2) { from } else { to };
        Some(Point::fly(laid_out.frame.to_geo(position)))
    }

    fn laid_out(&self) -> Option<&LaidOut> {
        let made = self.laid_out.get_or_init(|| self.recipe.lay_out(self.entry).ok().map(Arc::new));
        made.as_deref()
    }

    /// Where the turns before and after a track are, in flight direction.
    fn turns_of(&self, place: u64, laid_out: &LaidOut) -> Option<(Vec2, Vec2)> {
        let ends = |place| self.ends(place, laid_out);
        let (low, high) = ends(place)?;
        let before = place.checked_sub(1).and_then(ends);
        let after = ends(place + 1);
        let forward = self.along_first == place.is_multiple_of(2);
        let along = |p: Vec2| p.dot(laid_out.along);
        let lead_m = self.recipe.lead_m();
        // neighbours that turn on the same side share the farther of both ends
        let (at_low, at_high) = if forward { (before, after) } else { (after, before) };
        let low_m = at_low.map_or(0.0, |(l, _)| (along(low) - along(l)).max(0.0)) + lead_m;
        let high_m = at_high.map_or(0.0, |(_, h)| (along(h) - along(high)).max(0.0)) + lead_m;
        let (low, high) = (low - laid_out.along * low_m, high + laid_out.along * high_m);
        Some(if forward { (low, high) } else { (high, low) })
    }

    /// The ends of the track at a place of the flight order, as they lie along the heading.
    fn ends(&self, place: u64, laid_out: &LaidOut) -> Option<(Vec2, Vec2)> {
        if place >= self.tracks {
            return None;
        }
        // a poisoned cache is still a cache: its content is replaced as a whole
        let mut chunk = laid_out.chunk.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if place < chunk.start || place >= chunk.start + chunk.ends.len() as u64 {
            // one before, for the turn that leads to the first of them
            let start = place.saturating_sub(1);
            let end = (start + CHUNK).min(self.tracks);
            *chunk = Chunk { start, ends: self.compute(start..end, laid_out) };
        }
        let index = usize::try_from(place - chunk.start).ok()?;
        chunk.ends.get(index).copied().flatten()
    }

    fn compute(&self, places: Range<u64>, laid_out: &LaidOut) -> Vec<Option<(Vec2, Vec2)>> {
        let plain = self.left_out.is_empty() && self.first == 0;
        if plain {
            in_order(places, laid_out)
        } else {
            places.map(|p| laid_out.ends_of(self.track(p)?)).collect()
        }
    }

    /// The pattern's track at a place of the flight order.
    fn track(&self, place: u64) -> Option<u64> {
        let mut sequence = place;
        for left_out in &self.left_out {
            if *left_out <= sequence {
                sequence += 1;
            }
        }
        let all = self.laid_out()?.pattern.tracks();
        let onward = all.saturating_sub(self.first);
        if sequence < onward {
            Some(self.first + sequence)
        } else {
            self.first.checked_sub(sequence - onward + 1)
        }
    }

    /// The pattern with the values of now, begun at the unflown track nearest to the end of the path, without the tracks
    /// that are flown (`given` of its points are) and haven't moved. `None`: the values are the same.
    ///
    /// # Errors
    /// The new values can't be computed or make no pattern.
    pub fn regenerated(
        &self,
        leg: &Leg,
        given: u64,
        path: &PathState,
        world: &World,
    ) -> Result<Option<Expansion>, ExpandError> {
        let LegKind::Scan(scan) = &leg.kind else { return Ok(None) };
        let mut recipe = Recipe::of(scan, path.last.airspeed_mps, world)?;
        recipe.turn_radius_m = self.recipe.turn_radius_m;
        if scan.heading_deg.is_none() {
            // a direction once chosen stays: turning the tracks would make all of them new
            recipe.heading_deg = self.recipe.heading_deg.or(self.laid_out().map(|l| l.pattern.heading_deg()));
        }
        let unchanged = Recipe { heading_deg: self.recipe.heading_deg, ..recipe.clone() } == self.recipe
            && (scan.heading_deg.is_none() || recipe.heading_deg == self.recipe.heading_deg);
        if unchanged {
            return Ok(None);
        }
        let laid_out = recipe.lay_out(path.last.position)?;
        let flown = self.flown_until(given);
        Ok(Some(Expansion::Scan(Box::new(Self::resumed(recipe, laid_out, flown, path)))))
    }

    fn resumed(recipe: Recipe, laid_out: LaidOut, flown: Vec<(LatLon, LatLon)>, path: &PathState) -> Self {
        let all = laid_out.pattern.tracks();
        let mut done: Vec<u64> = flown.iter().filter_map(|f| laid_out.unmoved(f)).collect();
        done.sort_unstable();
        done.dedup();
        let at = laid_out.frame.to_local(path.last.position);
        let first = laid_out.pattern.nearest_track(at, |t| done.binary_search(&t).is_err()).unwrap_or(0);
        let place_of = |t: u64| if t >= first { t - first } else { all - 1 - t };
        let mut left_out: Vec<u64> = done.iter().map(|t| place_of(*t)).collect();
        left_out.sort_unstable();
        let nearer_low =
            laid_out.ends_of(first).is_none_or(|(low, high)| (low - at).length() <= (high - at).length());
        Self {
            tracks: all.saturating_sub(left_out.len() as u64),
            recipe,
            entry: path.last.position,
            first,
            along_first: nearer_low,
            left_out,
            flown,
            laid_out: OnceLock::from(Some(Arc::new(laid_out))),
        }
    }

    /// The latest tracks that are flown when `given` points are.
    fn flown_until(&self, given: u64) -> Vec<(LatLon, LatLon)> {
        let complete = (given / 2).min(self.tracks);
        let latest = complete.saturating_sub(MOST_FLOWN)..complete;
        let old = (MOST_FLOWN - (latest.end - latest.start)) as usize;
        let mut flown: Vec<_> = self.flown.iter().rev().take(old).rev().copied().collect();
        if let Some(laid_out) = self.laid_out() {
            let ends = latest.filter_map(|place| self.ends(place, laid_out));
            flown.extend(ends.map(|(a, b)| (laid_out.frame.to_geo(a), laid_out.frame.to_geo(b))));
        }
        flown
    }
}

/// Tracks in the pattern's own order: one pass over the outline for all of them.
fn in_order(places: Range<u64>, laid_out: &LaidOut) -> Vec<Option<(Vec2, Vec2)>> {
    let mut ends = vec![None; usize::try_from(places.end - places.start).unwrap_or(0)];
    for segment in laid_out.pattern.segments(places.clone()) {
        let index = usize::try_from(segment.track - places.start).unwrap_or(usize::MAX);
        if let Some(slot) = ends.get_mut(index) {
            *slot = Some(laid_out.joined(*slot, segment.from, segment.to));
        }
    }
    ends
}

impl LaidOut {
    fn ends_of(&self, track: u64) -> Option<(Vec2, Vec2)> {
        let segments = self.pattern.segments(track..track + 1);
        segments.fold(None, |ends, s| Some(self.joined(ends, s.from, s.to)))
    }

    /// The outermost ends of pieces of one line.
    fn joined(&self, ends: Option<(Vec2, Vec2)>, a: Vec2, b: Vec2) -> (Vec2, Vec2) {
        let along = |p: Vec2| p.dot(self.along);
        let lower = |p: Vec2, q: Vec2| if along(p) <= along(q) { p } else { q };
        let higher = |p: Vec2, q: Vec2| if along(p) > along(q) { p } else { q };
        let (low, high) = ends.unwrap_or((lower(a, b), higher(a, b)));
        (lower(low, lower(a, b)), higher(high, higher(a, b)))
    }

    /// The track that a flown one covers, if there is one.
    fn unmoved(&self, flown: &(LatLon, LatLon)) -> Option<u64> {
        let (a, b) = (self.frame.to_local(flown.0), self.frame.to_local(flown.1));
        let track = self.pattern.nearest_track((a + b) * 0.5, |_| true)?;
        let (low, high) = self.ends_of(track)?;
        let (a, b) = self.joined(None, a, b);
        let aside = |p: Vec2| (p - low).cross(self.along).abs() <= UNMOVED_M;
        let along = |p: Vec2| p.dot(self.along);
        let covers = along(a) <= along(low) + UNMOVED_M && along(b) >= along(high) - UNMOVED_M;
        (aside(a) && aside(b) && covers).then_some(track)
    }
}
