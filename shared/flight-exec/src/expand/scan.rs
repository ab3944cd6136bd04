//! Straight tracks over an area, track by track, and their regeneration in flight.
//!
//! Each track gives two fly-by points: one before the area, one beyond it, so far out that the turns between tracks stay outside
//! and every metre inside is flown on the line. The points of a turn lie side by side, so that it is made of two right angles.

mod layout;
mod recipe;
mod regeneration;
mod sweeps;

pub use sweeps::Sweeps;

use super::remade::Remade;
use super::{ExpandError, Point};
use geometry::{LatLon, Vec2};
use layout::{Ends, LaidOut, Line};
use recipe::Recipe;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// So near to a flown one a track has not moved, metres.
const UNMOVED_M: f64 = 2.0;
/// Tracks computed at a time.
const CHUNK: u64 = 256;

/// Parallel tracks being flown.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Sweep {
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
    laid_out: Remade<LaidOut>,
}

impl Sweep {
    /// All tracks, begun at the corner nearest to `from` if none is asked for.
    ///
    /// # Errors
    /// Values that make no pattern.
    fn new(recipe: Recipe, from: LatLon) -> Result<Self, ExpandError> {
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
            laid_out: Remade::of(laid_out),
        })
    }

    /// How many points it has.
    fn count(&self) -> u64 {
        self.tracks.saturating_mul(2)
    }

    /// The point number `index`: two a track.
    fn point(&self, index: u64) -> Option<Point> {
        let place = index / 2;
        let laid_out = self.laid_out()?;
        let (from, to) = laid_out.cached(place, || {
            let start = place - place % CHUNK;
            (start, self.lines(start..(start + CHUNK).min(self.tracks), laid_out))
        })?;
        Some(Point::fly(if index.is_multiple_of(2) { from } else { to }))
    }

    fn laid_out(&self) -> Option<&LaidOut> {
        self.laid_out.get(|| self.recipe.lay_out(self.entry))
    }

    /// Where the turns before and after tracks are, in flight direction.
    fn lines(&self, places: Range<u64>, laid_out: &LaidOut) -> Vec<Option<Line>> {
        let first = places.start.saturating_sub(1);
        let ends = self.compute(first..(places.end + 1).min(self.tracks), laid_out);
        let of = |place: u64| ends.get(usize::try_from(place - first).ok()?).copied().flatten();
        let line = |place: u64| {
            let before = if place > first { of(place - 1) } else { None };
            let (from, to) = self.turns(place, [before, of(place), of(place + 1)], laid_out.along)?;
            Some((laid_out.frame.to_geo(from), laid_out.frame.to_geo(to)))
        };
        places.map(line).collect()
    }

    /// Where the turns before and after a track are, in flight direction, given the ends of the one before it, its own and those
    /// of the one after it.
    fn turns(&self, place: u64, [before, own, after]: [Option<Ends>; 3], direction: Vec2) -> Option<Ends> {
        let (low, high) = own?;
        let forward = self.along_first == place.is_multiple_of(2);
        let along = |p: Vec2| p.dot(direction);
        let lead_m = self.recipe.lead_m();
        // neighbours that turn on the same side share the farther of both ends
        let (at_low, at_high) = if forward { (before, after) } else { (after, before) };
        let low_m = at_low.map_or(0.0, |(l, _)| (along(low) - along(l)).max(0.0)) + lead_m;
        let high_m = at_high.map_or(0.0, |(_, h)| (along(h) - along(high)).max(0.0)) + lead_m;
        let (low, high) = (low - direction * low_m, high + direction * high_m);
        Some(if forward { (low, high) } else { (high, low) })
    }

    /// The ends of tracks at places of the flight order, as they lie along the heading.
    fn compute(&self, places: Range<u64>, laid_out: &LaidOut) -> Vec<Option<Ends>> {
        let plain = self.left_out.is_empty() && self.first == 0;
        if plain {
            laid_out.in_order(places)
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
}
