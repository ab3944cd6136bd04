//! The simulated clock.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Clock of a simulated flight: nobody goes on before every participant has acknowledged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClockTick {
    /// Counts up.
    pub count: u64,
    /// Simulated seconds.
    pub time_s: f64,
}

/// A participant has done everything that was due at a tick.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClockAck {
    /// The tick.
    pub count: u64,
}
