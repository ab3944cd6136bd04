//! What can be asked, and how it is refused.

use flight_plan::{Cause, Id, VariableValue};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What people and services may ask of the executor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "command", rename_all = "kebab-case")]
pub enum Command {
    /// Begin the main plan at its first stage.
    Start,
    /// Hold here.
    Hold,
    /// Go on from the place where `Hold` was given.
    Resume,
    /// Leave the current leg at once for the next. A holding until released is left at the next crossing of its fix (asked
    /// once more: at once); a wait at the end of a leg is over.
    SkipLeg,
    /// Go to the start of a leg of the plan being flown.
    GoTo {
        /// The leg.
        leg: Id,
    },
    /// Set a loop's count for its present activation.
    SetCount {
        /// The iterative leg.
        leg: Id,
        /// The new count.
        count: u64,
    },
    /// Take a branch.
    Decide {
        /// The intersection leg.
        leg: Id,
        /// The branch.
        branch: Id,
    },
    /// Write a variable.
    SetVariable {
        /// Its name.
        name: Id,
        /// Its new value.
        value: VariableValue,
    },
    /// Fly an emergency plan: the named one, else the one in force here for the cause.
    Emergency {
        /// Why.
        cause: Cause,
        /// Which, if it must be a certain one.
        plan: Option<Id>,
    },
    /// Leave an emergency plan for a leg of the main plan.
    ReturnToMain {
        /// The leg to go to.
        leg: Id,
    },
    /// Have the gateway fly the aircraft to safety, whatever the plan says: its Safe mode, which a command of the gateway ends. A
    /// plan that is being flown holds until it is resumed.
    AbortToSafe,
    /// Forget the flight that was begun: the plan stands at its start again. On the ground only.
    Rewind,
    /// Make the proposed plan the active one.
    Commit {
        /// Hash of the proposal.
        hash: Arc<str>,
        /// The leg to enter, when the current leg is gone.
        entry: Option<Id>,
    },
}

/// Why a command was refused; the sentence says what to do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{code}: {reason}")]
pub struct Refusal {
    /// Short, stable, for programs: `no-plan`, `unknown-leg`, `stale-revision`, …
    pub code: String,
    /// For people.
    pub reason: String,
}
