//! How often a plan was activated, and what of the active one was reviewed.

use serde::{Deserialize, Serialize};

/// Of the active plan.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Revision {
    number: u64,
    /// The active plan came in flight: only what was ahead then was reviewed.
    reviewed_ahead_only: bool,
}

impl Revision {
    pub fn number(&self) -> u64 {
        self.number
    }

    pub fn is_reviewed_ahead_only(&self) -> bool {
        self.reviewed_ahead_only
    }

    /// Another plan is the active one; gives its number.
    pub fn activate(&mut self, in_flight: bool) -> u64 {
        self.reviewed_ahead_only = in_flight;
        self.number += 1;
        self.number
    }

    pub fn is_equivalent(&self, other: &Self) -> bool {
        let Self { number, reviewed_ahead_only } = self;
        (number, reviewed_ahead_only) == (&other.number, &other.reviewed_ahead_only)
    }
}
