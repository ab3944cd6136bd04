//! What the FP Manager itself has recorded.

use crate::fp_manager::plan_history::PlanHistory;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use usal::contract::GatewayRequest;

/// What the FP Manager remembers beside the executor.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ManagerState {
    /// Wanted of the gateway and not granted yet.
    pub wanted: Option<GatewayRequest>,
    /// The gateway or the pilot flies.
    pub controlled: bool,
    /// Alarms of the gateway that were answered by an emergency plan, or found none.
    pub answered_alarms: BTreeSet<String>,
    /// The plans of this flight.
    #[serde(default)]
    pub plan_history: PlanHistory,
}

/// As [`::journal::Entry`].
pub type Entry = ::journal::Entry<ManagerState>;
/// As [`::journal::Record`].
pub type Record = ::journal::Record<ManagerState>;
/// As [`::journal::Saved`].
pub type Saved = ::journal::Saved<ManagerState>;
/// As [`::journal::Chapter`].
pub type Chapter = ::journal::Chapter<ManagerState>;
