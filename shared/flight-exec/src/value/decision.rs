//! What was decided at an intersection.

use super::By;
use flight_plan::Id;
use serde::{Deserialize, Serialize};

/// A decision for one passing of an intersection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Decision {
    /// The intersection leg.
    pub leg: Id,
    /// Which passing, from 1.
    pub crossing: u64,
    /// The branch.
    pub branch: Id,
    /// Who decided.
    pub by: By,
}
