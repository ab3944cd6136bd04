//! The sweeps of a scan: one, or two at right angles.

use super::super::track::Approach;
use super::super::{ExpandError, Point};
use super::Sweep;
use super::recipe::Recipe;
use crate::layout::world::World;
use flight_plan::{Scan, ScanStyle};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// Sweeps in flight order.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Sweeps {
    sweeps: Vec<Numbered>,
}

/// A sweep, and whether it is the second one of its scan.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Numbered {
    second: bool,
    sweep: Sweep,
}

impl Sweeps {
    /// The whole scan.
    ///
    /// # Errors
    /// Values that can't be computed, or make no pattern.
    pub fn new(scan: &Scan, approach: &Approach, world: &World) -> Result<Self, ExpandError> {
        let mut at = approach.path.last.position;
        let mut sweeps = Vec::new();
        for second in [false, true] {
            if second && scan.style != ScanStyle::CrissCross {
                break;
            }
            let sweep = Sweep::new(Recipe::of(scan, second, approach, world)?, at, second)?;
            at = sweep.end().unwrap_or(at);
            sweeps.push(Numbered { second, sweep });
        }
        Ok(Self { sweeps })
    }

    /// How many points it has.
    pub fn count(&self) -> u64 {
        self.sweeps.iter().map(|s| s.sweep.count()).fold(0, u64::saturating_add)
    }

    /// The point number `index`.
    pub fn point(&self, index: u64) -> Option<Point> {
        let (number, index) = self.locate(index)?;
        self.sweeps.get(number)?.sweep.point(index)
    }

    /// The beginning of a sweep, or a corner on the way from one part of the area to the next.
    pub fn is_beside_tracks(&self, index: u64) -> bool {
        let place = self.locate(index).and_then(|(number, index)| Some((self.sweeps.get(number)?, index)));
        place.is_some_and(|(s, index)| index == 0 || s.sweep.is_on_a_way(index))
    }

    /// The sweep of a point, and its number there.
    fn locate(&self, mut index: u64) -> Option<(usize, u64)> {
        for (number, s) in self.sweeps.iter().enumerate() {
            match index.checked_sub(s.sweep.count()) {
                Some(later) => index = later,
                None => return Some((number, index)),
            }
        }
        None
    }

    /// The scan with the values of now, when `given` of its points are flown: what is left of the sweep being flown first,
    /// then what is left or new of the other one. `None`: the values are the same.
    ///
    /// # Errors
    /// The new values can't be computed or make no pattern.
    pub fn regenerated(
        &self,
        scan: &Scan,
        given: u64,
        approach: &Approach,
        world: &World,
    ) -> Result<Option<Box<Self>>, ExpandError> {
        // between the last point and what follows, the last sweep counts as being flown
        let last = self.sweeps.len().saturating_sub(1);
        let (current, within) =
            self.locate(given).unwrap_or((last, self.sweeps.get(last).map_or(0, |s| s.sweep.count())));
        // the path is over the area already
        let begun = given > 0 || self.sweeps.first().is_some_and(|s| s.sweep.follows);
        let mut at = approach.path.last.position;
        let mut sweeps = Vec::new();
        let numbered = || self.sweeps.iter().enumerate();
        for (number, old) in numbered().skip(current).chain(numbered().take(current)) {
            let flown = match number.cmp(&current) {
                Ordering::Less => old.sweep.count(),
                Ordering::Equal => within,
                Ordering::Greater => 0,
            };
            let follows = begun || !sweeps.is_empty();
            let fresh = old.sweep.regenerated((scan, old.second), (flown, at, follows), approach, world)?;
            let Some(sweep) = fresh else { return Ok(None) };
            at = sweep.end().unwrap_or(at);
            sweeps.push(Numbered { second: old.second, sweep });
        }
        Ok(Some(Box::new(Self { sweeps })))
    }
}

impl Sweep {
    /// Where its last point is.
    fn end(&self) -> Option<LatLon> {
        Some(self.point(self.count().checked_sub(1)?)?.position)
    }
}
