//! From a leg to the points it flies through.
//!
//! An [`Expansion`] is made when the path arrives at a leg, with the values its expressions have then, and is asked for
//! its points one by one. Long patterns are generated as they are asked for.

pub mod arc;
mod area;
mod course;
pub mod holding;
pub mod orbit;
pub mod pattern;
mod regenerated;
pub mod runway;
pub mod scan;
mod spacing;
pub mod track;
pub mod trail;
pub mod until_altitude;

use crate::api::Action;
use crate::layout::path::Level;
use flight_plan::EvalError;
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// One point of a leg.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Where.
    pub position: LatLon,
    /// Cross it before turning.
    pub fly_over: bool,
    /// A corner of the polygon around an arc.
    #[serde(default)]
    pub on_arc: bool,
    /// What to do there.
    pub action: Action,
    /// Its own altitude, when it is not the leg's.
    pub level: Option<Level>,
    /// Its own airspeed, when it is not the leg's, m/s.
    pub airspeed_mps: Option<f64>,
}

impl Point {
    /// A fly-by point at the leg's altitude and speed.
    pub fn fly(position: LatLon) -> Self {
        Self {
            position,
            fly_over: false,
            on_arc: false,
            action: Action::Fly,
            level: None,
            airspeed_mps: None,
        }
    }
}

/// Why a leg can't be flown as it stands.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExpandError {
    /// One of its expressions has no value.
    #[error(transparent)]
    Value(#[from] EvalError),
    /// Its geometry is impossible.
    #[error("{0}")]
    Geometry(String),
    /// A take-off or landing lacks what it is performed with.
    #[error("give this stage a `runway` of the plan, and a take-off an `altitude`")]
    Incomplete,
}

/// The points of one passage of a leg.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub enum Expansion {
    /// A short list.
    Points(Vec<Point>),
    /// A racetrack: lead-in and first lap, then laps as long as they are wanted.
    Holding(holding::Racetrack),
    /// A circle.
    Orbit(orbit::Circle),
    /// A track until an altitude is reached.
    UntilAltitude(until_altitude::Track),
    /// A scan: one sweep, or two at right angles.
    Scan(Box<scan::Sweeps>),
    /// Another pattern.
    Pattern(Box<pattern::Flight>),
    /// A pattern flown backwards, to where it began.
    Reversed {
        /// The pattern, forwards.
        pattern: Arc<Expansion>,
        /// How many points it has.
        points: u64,
        /// Where the path was before it.
        start: Point,
    },
}

impl Expansion {
    /// The point number `index`; `None` after the last one.
    pub fn point(&self, index: u64) -> Option<Point> {
        match self {
            Expansion::Points(points) => points.get(usize::try_from(index).ok()?).copied(),
            Expansion::Holding(racetrack) => racetrack.point(index),
            Expansion::Orbit(circle) => circle.point(index),
            Expansion::UntilAltitude(track) => track.point(index),
            Expansion::Scan(sweeps) => sweeps.point(index).map(|point| self.crossed_at_the_end(index, point)),
            Expansion::Pattern(flight) => {
                flight.point(index).map(|point| self.crossed_at_the_end(index, point))
            }
            // its last point is where the path is already
            Expansion::Reversed { pattern, points, start } => match points.checked_sub(index + 2) {
                Some(mirrored) => {
                    pattern.point(mirrored).map(|point| pattern.crossed_backwards(mirrored, point))
                }
                None => (index + 1 == (*points).max(1)).then_some(*start),
            },
        }
    }

    fn crossed_backwards(&self, index: u64, point: Point) -> Point {
        Point { fly_over: index == 0 || (point.fly_over && !self.is_last(index)), ..point }
    }

    fn is_last(&self, index: u64) -> bool {
        self.count().is_some_and(|points| index + 1 == points)
    }

    /// The last track is flown to its end, however sharply the path turns to what follows.
    fn crossed_at_the_end(&self, index: u64, point: Point) -> Point {
        Point { fly_over: point.fly_over || self.is_last(index), ..point }
    }

    /// At this point of a pattern, which is there to be seen along its tracks, the path may turn so sharply that a fly-by leaves out far
    /// too much of them. From a scan's track to the next one it never does: those are right angles.
    pub fn may_turn_sharply(&self, index: u64) -> bool {
        match self {
            Expansion::Scan(sweeps) => sweeps.is_beside_tracks(index),
            Expansion::Pattern(_) => true,
            Expansion::Reversed { pattern, points, .. } => {
                index == 0
                    || points.checked_sub(index + 2).is_none_or(|mirrored| pattern.may_turn_sharply(mirrored))
            }
            _ => false,
        }
    }

    /// How many points it has; `None`: no end of its own (what is left by a choice).
    pub fn count(&self) -> Option<u64> {
        match self {
            Expansion::Points(points) => Some(points.len() as u64),
            Expansion::Holding(_) | Expansion::UntilAltitude(_) => None,
            Expansion::Orbit(circle) => Some(circle.count()),
            Expansion::Scan(sweeps) => Some(sweeps.count()),
            Expansion::Pattern(flight) => Some(flight.count()),
            Expansion::Reversed { points, .. } => Some((*points).max(1)),
        }
    }

    /// Where something that is left by a choice may be left: the number of that place, if `flown` points lead to one.
    pub fn crossing(&self, flown: u64) -> Option<u64> {
        match self {
            Expansion::Holding(racetrack) => racetrack.crossing(flown).filter(|_| !racetrack.once),
            Expansion::UntilAltitude(track) => track.passing(flown),
            _ => None,
        }
    }

    /// The point it goes on at, when it takes the place of one of which `given` points are given out.
    pub fn goes_on_at(&self, given: u64) -> u64 {
        match self {
            Expansion::Scan(_) => 0,
            Expansion::Pattern(flight) => flight.goes_on_at(given),
            _ => given,
        }
    }

    /// Laid out again as another one was, of which `given` points are given out: what that one did not begin with is put right,
    /// so that the two can be compared.
    pub fn as_flown_by(self, old: &Expansion, given: u64) -> Expansion {
        match (self, old) {
            (Expansion::Holding(fresh), Expansion::Holding(old)) => {
                Expansion::Holding(holding::Racetrack { flown: old.flown, ..fresh })
            }
            (Expansion::UntilAltitude(fresh), Expansion::UntilAltitude(old)) if old.is_on_track(given) => {
                Expansion::UntilAltitude(fresh.begun_as(old))
            }
            (fresh, _) => fresh,
        }
    }

    /// Takes the place of one of which `given` points are given out, the path being `here`: laps count on, and a track whose
    /// fix is behind is not begun again there.
    pub fn after(self, old: &Expansion, given: u64, here: LatLon) -> Expansion {
        match (self, old) {
            (Expansion::Holding(fresh), Expansion::Holding(old)) => {
                Expansion::Holding(holding::Racetrack { flown: old.laps(given), ..fresh })
            }
            (Expansion::UntilAltitude(fresh), Expansion::UntilAltitude(old)) if old.is_on_track(given) => {
                Expansion::UntilAltitude(fresh.from_here(here))
            }
            (fresh, _) => fresh,
        }
    }

    /// Where it ends, flown backwards; `None`: where that is doesn't depend on the leg before it.
    pub fn led_back_to(&self) -> Option<LatLon> {
        match self {
            Expansion::Points(points) => points.last().map(|point| point.position),
            Expansion::Reversed { start, .. } => Some(start.position),
            _ => None,
        }
    }

    /// The same, flown backwards, with another end.
    pub fn leading_back_to(&self, end: Point) -> Expansion {
        match self {
            Expansion::Reversed { pattern, points, .. } => {
                Expansion::Reversed { pattern: pattern.clone(), points: *points, start: end }
            }
            Expansion::Points(points) => {
                let before = points.split_last().map_or(&[][..], |(_, before)| before);
                Expansion::Points(before.iter().copied().chain([end]).collect())
            }
            _ => Expansion::Points(vec![end]),
        }
    }

    /// The same pattern backwards, ending at `start`; `with_last`: beginning with its last point, because the path isn't there.
    pub fn reversed(self: &Arc<Self>, start: Point, with_last: bool) -> Expansion {
        let points = self.count().unwrap_or(0) + u64::from(with_last);
        Expansion::Reversed { pattern: self.clone(), points, start }
    }
}
