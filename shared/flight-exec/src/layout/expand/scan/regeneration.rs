//! A sweep with other values, in flight.

use super::super::ExpandError;
use super::super::track::Approach;
use super::Sweep;
use super::layout::LaidOut;
use super::recipe::Recipe;
use crate::layout::world::World;
use flight_plan::Scan;
use geometry::LatLon;
use std::ops::Range;

/// Most tracks flown before a regeneration that are remembered, the latest ones.
const MAX_FLOWN: u64 = 512;

impl Sweep {
    /// The sweep with the values of now, begun at the unflown track nearest to `at`, without the tracks that are
    /// flown (`given` of its points are) and haven't moved. `None`: the values are the same.
    ///
    /// # Errors
    /// The new values can't be computed or make no pattern.
    pub fn regenerated(
        &self,
        (scan, second): (&Scan, bool),
        (given, at, follows): (u64, LatLon, bool),
        approach: &Approach,
        world: &World,
    ) -> Result<Option<Self>, ExpandError> {
        let mut recipe = Recipe::of(scan, second, approach, world)?;
        recipe.turn_radius_m = self.recipe.turn_radius_m;
        if scan.heading_deg.is_none() {
            // a direction once chosen stays: turning the tracks would make all of them new
            let chosen_deg = || self.laid_out().map(|l| self.recipe.heading_of(l));
            recipe.heading_deg = self.recipe.heading_deg.or_else(chosen_deg);
        }
        let turned = scan.heading_deg.is_some() && recipe.heading_deg != self.recipe.heading_deg;
        recipe.grid = self.recipe.grid;
        if !turned && recipe.is_but_for_its_heading(&self.recipe) {
            return Ok(None);
        }
        // so do the tracks' places: to spread them anew would move all of them
        let stays = !turned && recipe.spacing_m == self.recipe.spacing_m;
        recipe.grid = self.laid_out().filter(|_| stays).map(LaidOut::grid);
        let laid_out = recipe.lay_out(at)?;
        Self::resumed(recipe, laid_out, self.flown_until(given), (at, follows)).map(Some)
    }

    fn resumed(
        recipe: Recipe,
        laid_out: LaidOut,
        flown: Vec<(LatLon, LatLon)>,
        (from, follows): (LatLon, bool),
    ) -> Result<Self, ExpandError> {
        let all = laid_out.pattern.tracks();
        let mut done: Vec<u64> = flown.iter().filter_map(|f| laid_out.unmoved(f)).collect();
        done.sort_unstable();
        done.dedup();
        let at = laid_out.frame.to_local(from);
        let first = laid_out.pattern.nearest_track(at, |t| done.binary_search(&t).is_err()).unwrap_or(0);
        let place_of = |t: u64| if t >= first { t - first } else { all - 1 - t };
        let mut left_out: Vec<u64> = done.iter().map(|t| place_of(*t)).collect();
        left_out.sort_unstable();
        let nearer_low =
            laid_out.ends_of(first).is_none_or(|(low, high)| (low - at).length() <= (high - at).length());
        Self::begun(recipe, laid_out, (from, follows), (first, nearer_low), (left_out, flown))
    }

    /// The latest tracks that are flown when `given` points are.
    fn flown_until(&self, given: u64) -> Vec<(LatLon, LatLon)> {
        let complete = self.stretches().map_or(0, |s| s.complete(given));
        let latest = complete.saturating_sub(MAX_FLOWN)..complete;
        let old = (MAX_FLOWN - (latest.end - latest.start)) as usize;
        let before = self.flown.iter().skip(self.flown.len().saturating_sub(old)).copied();
        before.chain(self.ends_of(latest)).collect()
    }

    /// The ends of the tracks at places of the flight order.
    fn ends_of(&self, places: Range<u64>) -> Vec<(LatLon, LatLon)> {
        let to_geo = |laid_out: &LaidOut| {
            let ends = self.compute(places, laid_out).into_iter().flatten();
            ends.map(|(a, b)| (laid_out.frame.to_geo(a), laid_out.frame.to_geo(b))).collect()
        };
        self.laid_out().map_or_else(Vec::new, to_geo)
    }
}
