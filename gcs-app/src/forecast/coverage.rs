//! How alarms would end, all along a path.

use super::Forecast;
use flight_exec::rehearse::{Reach, is_near_runway};
use flight_plan::{Cause, StageKind};
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Seconds between points of a coverage, at least, and most points.
const EVERY_S: f64 = 5.0;
const MAX_POINTS: f64 = 150.0;

/// One point in so many is found out first, then those halfway between, and so on. A power of two.
const COARSEST: usize = 8;

/// How the worst alarm would end at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ending {
    /// How.
    pub reach: Reach,
    /// Which alarm that is.
    pub cause: Cause,
    /// What is being flown there.
    pub stage: StageKind,
}

impl Ending {
    /// An engine failure near the runway: there no plan makes it end better, and no problem is told of it.
    fn is_engine_near_runway(&self) -> bool {
        self.cause == Cause::Engine && is_near_runway(self.stage)
    }
}

/// How the worst alarm would end at points of a path that are equally far apart in time. It grows as it is worked out, from coarse
/// to fine.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    every_s: f64,
    /// The points in the order in which they are found out.
    order: Arc<[usize]>,
    known: BTreeMap<usize, Option<Ending>>,
}

impl Coverage {
    /// Of a path, of which nothing is known yet.
    pub fn of(forecast: &Forecast) -> Self {
        let duration_s = forecast.duration_s();
        let every_s = (duration_s / MAX_POINTS).max(EVERY_S);
        let mut order: Vec<usize> = (0..(duration_s / every_s).ceil() as usize).collect();
        let coarseness = |point: usize| point.trailing_zeros().min(COARSEST.trailing_zeros());
        order.sort_by_key(|point| Reverse(coarseness(*point)));
        Self { every_s, order: order.into(), known: BTreeMap::new() }
    }

    fn next(&self) -> Option<usize> {
        self.order.get(self.known.len()).copied()
    }

    /// The time of the next point to be found out, seconds since the start.
    pub fn next_s(&self) -> Option<f64> {
        self.next().map(|point| (point as f64 + 0.5) * self.every_s)
    }

    /// The answer for that point; `None`: the aircraft is on the runway, or about to be.
    pub fn push(&mut self, worst: Option<Ending>) {
        if let Some(point) = self.next() {
            self.known.insert(point, worst);
        }
    }

    /// Every point is known.
    pub fn is_complete(&self) -> bool {
        self.next().is_none()
    }

    /// How much of it is known, 0..=1.
    pub fn progress(&self) -> f64 {
        self.known.len() as f64 / self.order.len().max(1) as f64
    }

    /// How the worst alarm would end at a time, and which that is, as finely as that is known; `None` where it is not known or not
    /// asked.
    pub fn at(&self, time_s: f64) -> Option<Ending> {
        let point = (time_s / self.every_s).max(0.0) as usize;
        let coarser = std::iter::successors(Some(1), |step| (*step < COARSEST).then_some(step * 2));
        let mut nearest = coarser.map(|step| point - point % step);
        nearest.find_map(|point| self.known.get(&point)).copied().flatten()
    }

    /// Share of the points judged that end like this, 0..=1.
    pub fn share(&self, reach: Reach) -> f64 {
        self.share_of(|ending| ending.reach == reach)
    }

    /// The alarms that end so, the one that does on most of the path first.
    pub fn causes(&self, reach: Reach) -> Vec<Cause> {
        let share = |cause: Cause| self.share_of(|ending| ending.reach == reach && ending.cause == cause);
        let mut shares: Vec<(Cause, f64)> = Cause::ALL.iter().map(|cause| (*cause, share(*cause))).collect();
        shares.retain(|(_, share)| *share > 0.0);
        shares.sort_by(|(_, one), (_, other)| other.total_cmp(one));
        shares.into_iter().map(|(cause, _)| cause).collect()
    }

    /// What of that share is nothing but an engine failure near the runway, 0..=1, and the kinds of stages there, in the order of a flight.
    pub fn near_runway(&self, reach: Reach) -> (f64, Vec<StageKind>) {
        let is_near = |ending: &Ending| ending.reach == reach && ending.is_engine_near_runway();
        let flown = [StageKind::Departure, StageKind::Arrival, StageKind::Approach];
        let is_there =
            |kind: &StageKind| self.share_of(|ending| is_near(ending) && ending.stage == *kind) > 0.0;
        (self.share_of(is_near), flown.into_iter().filter(is_there).collect())
    }

    fn share_of(&self, is_meant: impl Fn(&Ending) -> bool) -> f64 {
        let judged = self.known.values().flatten();
        let all = judged.clone().count().max(1);
        judged.filter(|ending| is_meant(ending)).count() as f64 / all as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forecast::Point;

    fn forecast(duration_s: f64) -> Forecast {
        let point = |time_s| Point {
            time_s,
            distance_m: 0.0,
            position: geometry::LatLon::new(0.0, 0.0),
            altitude_amsl_m: 0.0,
            ground_amsl_m: None,
            passage: 0,
        };
        Forecast { points: vec![point(0.0), point(duration_s)], ..Forecast::default() }
    }

    #[test]
    fn it_grows_from_coarse_to_fine_to_the_whole_path() {
        let mut coverage = Coverage::of(&forecast(62.0));
        let ending = |reach, cause| Some(Ending { reach, cause, stage: StageKind::Mission });
        let (out, good) = (ending(Reach::Out, Cause::Engine), ending(Reach::Good, Cause::Link));
        let mut times = Vec::new();
        for answer in [None, out, good, good] {
            times.extend(coverage.next_s());
            coverage.push(answer);
        }
        assert_eq!(times, [2.5, 42.5, 22.5, 62.5]);
        assert_eq!((coverage.at(1.0), coverage.at(44.0), coverage.at(52.0)), (None, out, out));
        assert_eq!((coverage.at(18.0), coverage.at(29.0)), (None, good), "the nearest known before");
        assert!((coverage.share(Reach::Out) - 1.0 / 3.0).abs() < 1e-9 && !coverage.is_complete());
        while coverage.next_s().is_some() {
            coverage.push(out);
        }
        assert!(coverage.is_complete() && coverage.progress() == 1.0);
        assert_eq!((coverage.at(28.0), coverage.at(999.0)), (out, None));
    }

    #[test]
    fn a_long_path_has_no_more_points() {
        let mut coverage = Coverage::of(&forecast(1e6));
        while coverage.next_s().is_some() {
            coverage.push(None);
        }
        assert_eq!(coverage.known.len(), MAX_POINTS as usize);
        assert!(Coverage::of(&Forecast::default()).is_complete(), "of nothing");
    }
}
