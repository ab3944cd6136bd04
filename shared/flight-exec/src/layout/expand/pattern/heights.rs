//! The altitudes of a contour: all its loops at one after the other, or each loop at one of its own.

use super::super::ExpandError;
use super::recipe::whole;
use crate::layout::path::Level;
use crate::layout::world::World;
use flight_plan::Value;
use serde::{Deserialize, Serialize};

/// Altitudes, one step after the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Heights {
    first: Level,
    /// Metres, upwards.
    step_m: f64,
    /// At how many of them the whole pattern is flown; `None`: each loop has its own.
    rounds: Option<u64>,
}

impl Heights {
    /// Those of a leg, from the altitude at which it begins; `None`: it has but that one.
    ///
    /// # Errors
    /// Values that can't be computed.
    pub fn of(
        levels: Option<&Value<f64>>,
        step_m: Option<&Value<f64>>,
        first: Level,
        world: &World,
    ) -> Result<Option<Self>, ExpandError> {
        let Some(step_m) = step_m else { return Ok(None) };
        let rounds = levels.map(|n| whole("levels", world.number(n)?)).transpose()?;
        Ok(Some(Self { first, step_m: world.number(step_m)?, rounds }))
    }

    /// How often the whole pattern is flown.
    pub fn rounds(&self) -> u64 {
        self.rounds.unwrap_or(1)
    }

    /// The altitude of a loop: `round` and the number of its distance from the edge, both from 0.
    pub fn level(&self, round: u64, distance: u64) -> Level {
        let steps = if self.rounds.is_some() { round } else { distance };
        Level { metres: self.first.metres + steps as f64 * self.step_m, ..self.first }
    }
}
