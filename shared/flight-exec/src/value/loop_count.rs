//! How often a loop is flown, if not as often as the plan says.

use flight_plan::Id;
use serde::{Deserialize, Serialize};

/// A loop's count that is not the plan's.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LoopCount {
    /// The iterative leg.
    pub leg: Id,
    /// Which activation of the loop: the number of the last passage before it; `None`: each of them.
    pub activation: Option<u64>,
    /// The count.
    pub count: u64,
}
