//! Plans: put forward, active, and their variables.

use crate::{Id, VariableValue};
use geodesy::LatLon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// FP Manager invocation `propose`: a whole document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Propose {
    /// The plan's XML.
    pub xml: String,
    /// Revision that the proposer saw; refused if it has moved on. `None`: don't care.
    pub seen_revision: Option<u64>,
}

/// What a proposed plan would do, or why it can't be flown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProposalReport {
    /// Hash of the proposal.
    pub hash: Arc<str>,
    /// May be committed.
    pub acceptable: bool,
    /// Errors and warnings, one sentence each.
    pub problems: Vec<String>,
    /// Legs that are only in the new plan.
    pub added: Vec<Id>,
    /// Legs that are only in the active plan.
    pub removed: Vec<Id>,
    /// Legs that differ.
    pub changed: Vec<Id>,
    /// How many legs and stages stay as they are.
    pub unchanged: usize,
    /// The leg the aircraft would fly next.
    pub next_leg: Option<Id>,
    /// The position it would fly to next.
    pub next_position: Option<LatLon>,
    /// Metres to that position.
    pub next_in_m: Option<f64>,
    /// Seconds to that position.
    pub next_in_s: Option<f64>,
    /// Metres of the present path that would still be flown before the first waypoint that is another one; `None`: none is, as far
    /// ahead as waypoints are handed out.
    pub differs_in_m: Option<f64>,
    /// The same in seconds.
    pub differs_in_s: Option<f64>,
    /// The current leg is gone: the commit must name an entry leg.
    pub entry_needed: bool,
    /// Then: where the aircraft would go for each leg that may be named (the first two dozen).
    #[serde(default)]
    pub entries: Vec<EntryReport>,
}

/// A leg that a commit may name, and the way there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EntryReport {
    /// The leg.
    pub leg: Id,
    /// The position the aircraft would fly to next.
    pub position: LatLon,
    /// Metres to that position.
    pub in_m: f64,
    /// Seconds to that position.
    pub in_s: f64,
}

/// FP Manager variable `plan`: which plan is active. The document itself: invocation `plan`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct PlanInfo {
    /// What people call it.
    pub name: String,
    /// Hash of the active plan (hex SHA-256 of its canonical bytes), if any.
    pub hash: Option<String>,
    /// Counts accepted plans and changes of this flight.
    pub revision: u64,
}

/// Answer of FP Manager invocation `plan`: the active plan's document.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct PlanDocument {
    /// Which it is.
    pub info: PlanInfo,
    /// Its canonical XML; empty if there is none.
    pub xml: String,
}

/// FP Manager variable `variables`: the plan's variables as they are now.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct PlanVariables {
    /// In the order of the plan.
    pub variables: Vec<PlanVariable>,
}

/// A plan's variable as it is now.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlanVariable {
    /// Its name.
    pub name: Id,
    /// Its value.
    pub value: VariableValue,
    /// Unit of a number, for the reader.
    pub unit: String,
    /// Least value of a number.
    pub min: Option<f64>,
    /// Greatest value of a number.
    pub max: Option<f64>,
}
