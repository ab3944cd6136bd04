//! From a leg to the points it flies through.
//!
//! An [`Expansion`] is made when the path arrives at a leg, with the values its expressions have then, and is asked for
//! its points one by one. Long patterns are generated as they are asked for.

pub mod arc;
pub mod holding;
pub mod orbit;
pub mod runway;
pub mod scan;
pub mod track;

use crate::api::Action;
use crate::path::Level;
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
    /// What to do there.
    pub action: Action,
    /// Its own altitude, when it is not the leg's.
    pub level: Option<Level>,
}

impl Point {
    /// A fly-by point at the leg's altitude.
    pub fn fly(position: LatLon) -> Self {
        Self { position, fly_over: false, action: Action::Fly, level: None }
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
    /// A name that the plan should have.
    #[error("the plan has no runway for this stage: name one in its `runway` attribute")]
    NoRunway,
}

/// The points of one passage of a leg.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Expansion {
    /// A short list.
    Points(Vec<Point>),
    /// A racetrack: lead-in and first lap, then laps as long as they are wanted.
    Holding(holding::Racetrack),
    /// A circle.
    Orbit(orbit::Circle),
    /// A scan.
    Scan(Box<scan::Sweep>),
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
            Expansion::Scan(sweep) => sweep.point(index),
            // its last point is where the path is already
            Expansion::Reversed { pattern, points, start } => match points.checked_sub(index + 2) {
                Some(mirrored) => pattern.point(mirrored),
                None => (index + 1 == (*points).max(1)).then_some(*start),
            },
        }
    }

    /// How many points it has; `None`: no end (a holding that is left by decision).
    pub fn count(&self) -> Option<u64> {
        match self {
            Expansion::Points(points) => Some(points.len() as u64),
            Expansion::Holding(_) => None,
            Expansion::Orbit(circle) => Some(circle.count()),
            Expansion::Scan(sweep) => Some(sweep.count()),
            Expansion::Reversed { points, .. } => Some((*points).max(1)),
        }
    }

    /// The same pattern backwards, ending at `start`; `with_last`: beginning with its last point, because the path isn't there.
    pub fn reversed(self: &Arc<Self>, start: Point, with_last: bool) -> Expansion {
        match self.count() {
            Some(points) => {
                let points = points + u64::from(with_last);
                Expansion::Reversed { pattern: self.clone(), points, start }
            }
            None => Expansion::Points(vec![start]),
        }
    }
}
