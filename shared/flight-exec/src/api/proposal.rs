//! What is reported about a proposed plan.

use flight_plan::Id;
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a proposed plan would do, or why it can't be flown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// ahead as waypoints are issued.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
