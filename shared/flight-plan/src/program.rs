//! A checked plan, ready for the executor.

use crate::FlightPlan;
use std::sync::Arc;

/// A plan without errors, its expressions compiled and its lookups resolved; immutable.
#[derive(Debug)]
pub struct Program {
    /// The plan it was made from.
    pub plan: FlightPlan,
    /// Hex SHA-256 of the plan's canonical XML.
    pub hash: Arc<str>,
}

impl PartialEq for Program {
    fn eq(&self, other: &Self) -> bool {
        self.hash == other.hash
    }
}
