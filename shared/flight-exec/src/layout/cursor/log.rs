//! What happens between two waypoints without being one.

use crate::layout::elevations;
use crate::value::Choice;
use flight_plan::{EvalError, Id};
use geometry::LatLon;
use serde::{Deserialize, Serialize};

/// Choices, legs passed, and what went wrong, each in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CursorLog {
    /// Choices made.
    pub choices: Vec<Choice>,
    /// Legs with actions that were passed without a waypoint of their own.
    pub silent_legs: Vec<SilentLeg>,
    /// Legs that can't be flown, expressions that have no value.
    pub errors: Vec<LayoutError>,
}

/// A leg that flew nothing, because the path was there already.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SilentLeg {
    /// The leg.
    pub leg: Id,
    /// Its passage.
    pub passage: u64,
}

/// Something of a leg that doesn't work with the values of now.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum LayoutError {
    /// It can't be flown, and is left out.
    Leg {
        /// The leg.
        leg: Id,
        /// Why.
        reason: String,
    },
    /// Its altitude counts from the ground, and nothing is known of the ground ahead: it is left there.
    Ground {
        /// The leg.
        leg: Id,
        /// Where, and what to do about it.
        reason: String,
    },
    /// One of its conditions or numbers has no value: a condition counts as false, a number as not given.
    Expression {
        /// The leg.
        leg: Id,
        /// Why.
        reason: String,
    },
}

impl LayoutError {
    /// Nothing is known of the ground at a position from which a leg's altitude counts.
    pub(super) fn unknown_ground(leg: Id, at: LatLon) -> Self {
        let reason = format!(
            "write this leg's altitude `amsl`, or load {}: nothing is known of the ground above which it counts",
            elevations::wanted_at(at)
        );
        Self::Ground { leg, reason }
    }
}

impl CursorLog {
    /// Nothing that a bookmark would have to come after.
    pub fn is_empty(&self) -> bool {
        self.choices.is_empty() && self.silent_legs.is_empty()
    }

    /// A value, or a note why it has none.
    pub fn value<T>(&mut self, leg: &Id, value: Result<T, EvalError>) -> Option<T> {
        value.map_err(|why| self.no_value(leg, &why)).ok()
    }

    fn no_value(&mut self, leg: &Id, why: &EvalError) {
        self.errors.push(LayoutError::Expression { leg: leg.clone(), reason: why.to_string() });
    }
}
