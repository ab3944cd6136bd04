//! The patterns besides scans, and their regeneration in flight.

mod heights;
mod recipe;

use super::regenerated::Regenerated;
use super::track::Approach;
use super::{ExpandError, Point};
use crate::layout::path::{Level, distance_m};
use crate::layout::world::World;
use flight_plan::Pattern as Plan;
use geometry::pattern::Vertex;
use geometry::{LatLon, LocalFrame, Pattern};
use heights::Heights;
use recipe::Recipe;
use serde::{Deserialize, Serialize};

/// So near to a flown one a waypoint has not moved, metres.
const UNMOVED_M: f64 = 2.0;

/// A pattern being flown.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Flight {
    recipe: Recipe,
    /// The pattern begins near here, where it can.
    entry: LatLon,
    /// Waypoints of the pattern that are left out: flown already and not moved.
    first: u64,
    #[serde(skip)]
    laid_out: Regenerated<LaidOut>,
}

/// The pattern itself: made again from the recipe after a restart.
#[derive(Debug)]
struct LaidOut {
    pattern: Pattern,
    frame: LocalFrame,
    heights: Option<Heights>,
    /// It ends where it begins: flown again, it is without its first waypoint.
    closed: bool,
}

impl Flight {
    /// The whole pattern.
    ///
    /// # Errors
    /// Values that can't be computed, or make no pattern.
    pub fn new(pattern: &Plan, approach: &Approach, world: &World) -> Result<Self, ExpandError> {
        let recipe = Recipe::of(pattern, approach, world)?;
        Self::laid_out_from(recipe, approach.path.last.position)
    }

    fn laid_out_from(recipe: Recipe, entry: LatLon) -> Result<Self, ExpandError> {
        let laid_out = recipe.lay_out(entry)?;
        Ok(Self { recipe, entry, first: 0, laid_out: Regenerated::of(laid_out) })
    }

    fn laid_out(&self) -> Option<&LaidOut> {
        self.laid_out.get(|| self.recipe.lay_out(self.entry))
    }

    /// Where a waypoint of the whole pattern is.
    fn at(&self, index: u64) -> Option<LatLon> {
        self.laid_out()?.at(index)
    }

    /// How many points it has.
    pub fn count(&self) -> u64 {
        self.laid_out().map_or(0, |l| l.count().saturating_sub(self.first))
    }

    /// The point number `index`.
    pub fn point(&self, index: u64) -> Option<Point> {
        let (laid_out, index) = (self.laid_out()?, self.first.checked_add(index)?);
        let on_arc = self.recipe.is_curve();
        Some(Point { level: laid_out.level(index), on_arc, ..Point::fly(laid_out.at(index)?) })
    }

    /// The point a regenerated one goes on at, when `given` points of the one before are given out: what goes round and
    /// round goes on at the same angle, anything else has left out what is flown.
    pub fn goes_on_at(&self, given: u64) -> u64 {
        if self.recipe.goes_round() { given.min(self.count()) } else { 0 }
    }

    /// The pattern with the values of now, when `given` of its points are given out. `None`: they are the same.
    ///
    /// As long as its tracks are where they were flown they are left out; it goes on with the first one that has moved or
    /// was not flown. When already the first one has moved, the search begins anew from where the path is.
    ///
    /// # Errors
    /// The new values can't be computed or make no pattern.
    pub fn regenerated(
        &self,
        pattern: &Plan,
        given: u64,
        approach: &Approach,
        world: &World,
    ) -> Result<Option<Box<Self>>, ExpandError> {
        let recipe = Recipe::of(pattern, approach, world)?.with_turns_of(&self.recipe);
        if recipe == self.recipe {
            return Ok(None);
        }
        let mut fresh = Self::laid_out_from(recipe.clone(), self.entry)?;
        if recipe.goes_round() {
            return Ok(Some(Box::new(fresh)));
        }
        fresh.first = fresh.unmoved(self, self.first.saturating_add(given));
        if fresh.first == 0 {
            fresh = Self::laid_out_from(recipe, approach.path.last.position)?;
        }
        Ok(Some(Box::new(fresh)))
    }

    /// How many waypoints from the beginning can be left out, when `flown` of the old ones are flown.
    fn unmoved(&self, old: &Self, flown: u64) -> u64 {
        let stayed = |i: &u64| {
            let both = self.at(*i).zip(old.at(*i));
            both.is_some_and(|(a, b)| distance_m(a, b) <= UNMOVED_M)
        };
        let same = (0..flown).take_while(stayed).count() as u64;
        if same == flown { same } else { self.laid_out().map_or(0, |new| new.beginning_of_track(same)) }
    }
}

impl LaidOut {
    fn new(pattern: Pattern, frame: LocalFrame, heights: Option<Heights>) -> Self {
        let at = |index| pattern.vertex(index).map(|v| v.at);
        let last = pattern.count().checked_sub(1).filter(|last| *last > 0);
        let closed = last.is_some_and(|last| at(last) == at(0));
        Self { pattern, frame, heights, closed }
    }

    fn rounds(&self) -> u64 {
        self.heights.map_or(1, |h| h.rounds())
    }

    /// Waypoints of a round after the first one.
    fn again(&self) -> u64 {
        self.pattern.count().saturating_sub(u64::from(self.closed))
    }

    fn count(&self) -> u64 {
        let later = self.rounds().saturating_sub(1).saturating_mul(self.again());
        self.pattern.count().saturating_add(later)
    }

    /// The round that a waypoint belongs to, and its number there.
    fn locate(&self, index: u64) -> (u64, u64) {
        let again = self.again().max(1);
        match index.checked_sub(self.pattern.count()) {
            None => (0, index),
            Some(later) => (1 + later / again, u64::from(self.closed) + later % again),
        }
    }

    fn vertex(&self, index: u64) -> Option<Vertex> {
        let (round, within) = self.locate(index);
        let vertex = self.pattern.vertex(within).filter(|_| round < self.rounds())?;
        let before = if round == 0 { 0 } else { round.saturating_mul(self.pattern.tracks()) };
        Some(Vertex { track: before.saturating_add(vertex.track), ..vertex })
    }

    fn at(&self, index: u64) -> Option<LatLon> {
        Some(self.frame.to_geo(self.vertex(index)?.at))
    }

    /// The altitude of a waypoint, where it is not the leg's.
    fn level(&self, index: u64) -> Option<Level> {
        let (round, within) = self.locate(index);
        let Pattern::Contours(loops) = &self.pattern else { return None };
        Some(self.heights?.level(round, loops.distance_number(within)))
    }

    /// The first waypoint of the track that a waypoint belongs to.
    fn beginning_of_track(&self, index: u64) -> u64 {
        let track = self.vertex(index).map(|v| v.track);
        let mut begin = index;
        while let Some(before) = begin.checked_sub(1).and_then(|i| self.vertex(i))
            && Some(before.track) == track
        {
            begin -= 1;
        }
        // the first waypoint that is flown to on a track has its beginning before it
        let on_track = self.vertex(begin).is_some_and(|v| v.on_track);
        begin - u64::from(on_track && begin > 0)
    }
}
