//! What a pass back flies: the legs passed on the way out.

use super::Expansion;
use crate::layout::path::{Level, PathEnd};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Legs passed, in order. Every bookmark has one and shares it with the others: one leg more costs the same however many there
/// are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Trail(rpds::VectorSync<Visit>);

/// A leg passed on a forward pass, remembered for the way back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Visit {
    /// Its index in its list.
    pub index: usize,
    /// The highest index up to here: what is beyond it was not passed before.
    pub(crate) highest: usize,
    /// Where the path was before it.
    pub start: PathEnd,
    /// Where the path was after it; for one that was skipped, where the aircraft was.
    pub end: PathEnd,
    /// The altitude it was flown at.
    pub level: Level,
    /// The airspeed it was flown at, m/s.
    pub airspeed_mps: f64,
    /// The trail inside it, if it is a loop.
    pub inner: Option<Trail>,
    /// What was flown, if it is a pattern.
    pub flown: Option<Arc<Expansion>>,
}

impl Visit {
    /// Of a leg that was passed from one point to another.
    pub fn new(index: usize, start: PathEnd, end: PathEnd) -> Self {
        let (level, airspeed_mps) = (end.level, end.airspeed_mps);
        Self { index, highest: index, start, end, level, airspeed_mps, inner: None, flown: None }
    }
}

impl Trail {
    /// One leg more. A leg that was passed before begins the trail anew from there, so that jumps back can't make it grow.
    pub fn pass(&mut self, visit: Visit) {
        let highest = self.0.last().map(|v| v.highest);
        if highest.is_some_and(|highest| highest >= visit.index) {
            let again = self.0.iter().position(|v| v.index == visit.index).unwrap_or(self.0.len());
            while self.0.len() > again && self.0.drop_last_mut() {}
        }
        let highest = self.0.last().map_or(visit.index, |v| v.highest.max(visit.index));
        self.0.push_back_mut(Visit { highest, ..visit });
    }

    /// The legs, the first one first.
    pub fn iter(&self) -> impl Iterator<Item = &Visit> {
        self.0.iter()
    }

    /// The leg passed as number `index`, from 0.
    pub fn get(&self, index: usize) -> Option<&Visit> {
        self.0.get(index)
    }

    /// The first so many legs; `None`: it has fewer.
    pub fn first(&self, legs: usize) -> Option<Self> {
        let mut first = self.clone();
        while first.0.len() > legs && first.0.drop_last_mut() {}
        (first.0.len() == legs).then_some(first)
    }

    /// A trail goes on from this one: legs passed are shared, never changed, so that where one leg is the same all before it are.
    pub fn begins(&self, longer: &Self) -> bool {
        let Some(last) = self.0.len().checked_sub(1) else { return true };
        self.0.get(last).zip(longer.0.get(last)).is_some_and(|(own, other)| std::ptr::eq(own, other))
    }

    /// How many legs.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// No leg at all.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl FromIterator<Visit> for Trail {
    fn from_iter<I: IntoIterator<Item = Visit>>(visits: I) -> Self {
        let mut trail = Self::default();
        visits.into_iter().for_each(|visit| trail.pass(visit));
        trail
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::AltitudeReference;
    use geometry::LatLon;

    #[test]
    fn a_leg_passed_again_begins_it_anew_from_there() {
        let level = Level { metres: 500.0, reference: AltitudeReference::Amsl };
        let at = PathEnd { position: LatLon::new(36.5, -84.2), level, airspeed_mps: 25.0, fly_over: false };
        let trail = |legs: &[usize]| Trail::from_iter(legs.iter().map(|index| Visit::new(*index, at, at)));
        for (passed, left) in [
            (&[0, 1, 2][..], &[0, 1, 2][..]),
            (&[0, 1, 2, 1], &[0, 1]),
            (&[0, 3, 1, 2], &[0, 3, 1, 2]),
            (&[0, 3, 1, 3, 4], &[0, 3, 4]),
            (&[2, 5, 4, 0, 5], &[2, 5]),
            (&[1, 1, 1], &[1]),
        ] {
            let trail = trail(passed);
            assert!(trail.iter().map(|v| v.index).eq(left.iter().copied()), "{passed:?}: {trail:?}");
        }
    }
}
