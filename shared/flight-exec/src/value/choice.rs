//! Choices that the cursor makes on its way: provisional when a waypoint is issued ahead, final when the aircraft gets there.

use flight_plan::Id;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Who decided at an intersection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum By {
    /// An explicit decision of a person or a service, by name.
    Somebody(Arc<str>),
    /// The first branch whose condition holds.
    Condition,
    /// The declared default.
    Default,
}

impl By {
    /// As events report it.
    pub fn name(&self) -> &str {
        match self {
            By::Somebody(name) => name,
            By::Condition => "condition",
            By::Default => "default",
        }
    }
}

/// One choice.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Choice {
    /// At the end of a loop's pass: once more, or out.
    Loop {
        /// The iterative leg.
        leg: Id,
        /// The arrival this is, from 1.
        arrival: u64,
        /// The count, if there is one.
        of: Option<u64>,
        /// Once more.
        again: bool,
    },
    /// At an intersection.
    Branch {
        /// The intersection leg.
        leg: Id,
        /// Which passing of it this is, from 1.
        crossing: u64,
        /// The branch; `None`: nobody knows, hold and ask.
        branch: Option<Id>,
        /// Who said so (meaningless without a branch).
        by: By,
    },
    /// At the fix of a holding that is left by altitude.
    Hold {
        /// The holding leg.
        leg: Id,
        /// Laps flown.
        lap: u64,
        /// The altitude is reached.
        leaves: bool,
    },
}

impl Choice {
    /// The leg at which it is made.
    pub fn leg(&self) -> &Id {
        match self {
            Choice::Loop { leg, .. } | Choice::Branch { leg, .. } | Choice::Hold { leg, .. } => leg,
        }
    }

    /// The loop that is left by it, if it is one to leave a loop.
    pub fn loop_left(&self) -> Option<&Id> {
        match self {
            Choice::Loop { leg, again: false, .. } => Some(leg),
            _ => None,
        }
    }

    /// The same way on: who decided doesn't matter.
    pub fn leads_as(&self, other: &Choice) -> bool {
        match (self, other) {
            (
                Choice::Branch { leg, crossing, branch, .. },
                Choice::Branch { leg: leg2, crossing: crossing2, branch: branch2, .. },
            ) => (leg, crossing, branch) == (leg2, crossing2, branch2),
            (Choice::Loop { leg, arrival, again, .. }, Choice::Loop { leg: l, arrival: n, again: a, .. }) => {
                (leg, arrival, again) == (l, n, a)
            }
            _ => self == other,
        }
    }
}
