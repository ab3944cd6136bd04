//! Straight tracks over an area, track by track, and their regeneration in flight.
//!
//! Each track gives two fly-by points: one before the area, one beyond it, so far out that the turns between tracks stay outside
//! and every metre inside is flown on the line. The points of a turn lie side by side, so that it is made of two right angles.
//!
//! A concave area is flown cell by cell (`geometry::scan::CellScan`). Tracks come in *stretches* of neighbours; before each stretch come
//! the corners of the shortest path inside that leads there. So every point can be addressed by number: a scan can be resumed, flown
//! backwards and regenerated.

mod layout;
mod recipe;
mod regeneration;
mod stretches;
mod sweeps;

pub use sweeps::Sweeps;

use super::regenerated::Regenerated;
use super::{ExpandError, Point};
use geometry::{LatLon, Vec2};
use layout::{Ends, LaidOut, Line};
use recipe::Recipe;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use stretches::{Order, Spot, Stretches};

/// So near to a flown one a track has not moved, metres.
const UNMOVED_M: f64 = 2.0;
/// Tracks computed at a time.
const CHUNK: u64 = 512;

/// Parallel tracks being flown.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Sweep {
    recipe: Recipe,
    /// The pattern begins near here.
    entry: LatLon,
    /// It follows on another sweep of the same area: the way from `entry` stays inside as well.
    follows: bool,
    /// Track that is flown first; then those after it, then those before it, backwards.
    first: u64,
    /// The first track is flown along the heading; the others alternate, as far as they are neighbours.
    along_first: bool,
    /// Places in that order that are left out, ascending: flown already and not moved.
    left_out: Vec<u64>,
    /// How many tracks are flown.
    tracks: u64,
    /// Tracks flown before the regeneration, the latest ones.
    flown: Vec<(LatLon, LatLon)>,
    #[serde(skip)]
    laid_out: Regenerated<LaidOut>,
    #[serde(skip)]
    stretches: Regenerated<Stretches>,
}

impl Sweep {
    /// All tracks, begun at the corner nearest to `from` if none is asked for; `follows`: another sweep ends there.
    ///
    /// # Errors
    /// Values that make no pattern.
    fn new(recipe: Recipe, from: LatLon, follows: bool) -> Result<Self, ExpandError> {
        let laid_out = recipe.lay_out(from)?;
        let along_first = laid_out.pattern.along_heading(0);
        Self::begun(recipe, laid_out, (from, follows), (0, along_first), (Vec::new(), Vec::new()))
    }

    /// Begun with a track in a direction, without those left out because they are flown.
    fn begun(
        recipe: Recipe,
        laid_out: LaidOut,
        (entry, follows): (LatLon, bool),
        (first, along_first): (u64, bool),
        (left_out, flown): (Vec<u64>, Vec<(LatLon, LatLon)>),
    ) -> Result<Self, ExpandError> {
        let tracks = laid_out.pattern.tracks().saturating_sub(left_out.len() as u64);
        let mut sweep = Self {
            recipe,
            entry,
            follows,
            first,
            along_first,
            left_out,
            tracks,
            flown,
            laid_out: Regenerated::default(),
            stretches: Regenerated::default(),
        };
        sweep.stretches = Regenerated::of(Stretches::of(&sweep.order(&laid_out), &laid_out)?);
        sweep.laid_out = Regenerated::of(laid_out);
        Ok(sweep)
    }

    /// How many points it has.
    fn count(&self) -> u64 {
        self.stretches().map_or(0, Stretches::count)
    }

    /// The point number `index`: two a track, and the corners of the ways between cells.
    fn point(&self, index: u64) -> Option<Point> {
        let (laid_out, stretches) = (self.laid_out()?, self.stretches()?);
        let (place, end) = match stretches.spot(index)? {
            Spot::Way(corner) => return Some(Point::fly(corner)),
            Spot::Track { place, end } => (place, end),
        };
        let (from, to) = laid_out.cached(place, || {
            let start = place - place % CHUNK;
            (start, self.lines(start..(start + CHUNK).min(self.tracks), laid_out, stretches))
        })?;
        let point = Point::fly(if end { to } else { from });
        Some(Point { fly_over: stretches.is_broken_off(place, end), ..point })
    }

    /// A corner of a way between cells.
    fn is_on_a_way(&self, index: u64) -> bool {
        self.stretches().is_some_and(|stretches| matches!(stretches.spot(index), Some(Spot::Way(_))))
    }

    fn laid_out(&self) -> Option<&LaidOut> {
        self.laid_out.get(|| self.recipe.lay_out(self.entry))
    }

    fn stretches(&self) -> Option<&Stretches> {
        let laid_out = self.laid_out()?;
        self.stretches.get(|| Stretches::of(&self.order(laid_out), laid_out))
    }

    fn order(&self, laid_out: &LaidOut) -> Order<'_> {
        Order {
            all: laid_out.pattern.tracks(),
            first: self.first,
            along_first: self.along_first,
            left_out: &self.left_out,
            from: self.follows.then_some(self.entry),
        }
    }

    /// Where the turns before and after tracks are, in flight direction.
    fn lines(&self, places: Range<u64>, laid_out: &LaidOut, stretches: &Stretches) -> Vec<Option<Line>> {
        let first = places.start.saturating_sub(1);
        let ends = self.compute(first..(places.end + 1).min(self.tracks), laid_out);
        let of = |place: u64| ends.get(usize::try_from(place - first).ok()?).copied().flatten();
        let line = |place: u64| {
            let neighbours = stretches.around(place);
            let before = if place > neighbours.start { of(place - 1) } else { None };
            let after = if place + 1 < neighbours.end { of(place + 1) } else { None };
            let along = laid_out.along;
            let (from, to) = self.turns(stretches.is_along(place), [before, of(place), after], along)?;
            Some((laid_out.frame.to_geo(from), laid_out.frame.to_geo(to)))
        };
        places.map(line).collect()
    }

    /// Where the turns before and after a track are, in flight direction, given the ends of the one before it, its own and those
    /// of the one after it.
    fn turns(&self, forward: bool, [before, own, after]: [Option<Ends>; 3], direction: Vec2) -> Option<Ends> {
        let (low, high) = own?;
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
        let order = self.order(laid_out);
        let track = |place| order.track(place).unwrap_or(u64::MAX);
        laid_out.pattern.ends(places.map(track)).collect()
    }
}
