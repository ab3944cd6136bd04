//! Where the flight is in the plan, what the FP Manager is doing, and what it asks.

use crate::{Id, Token};
use geodesy::LatLon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A snapshot for people and services.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Status")]
pub struct PlanStatus {
    /// What it is doing.
    pub phase: Phase,
    /// Hash of the active plan (hex SHA-256 of its canonical bytes), if any.
    pub plan: Option<Arc<str>>,
    /// Counts accepted plans and changes of this flight.
    pub revision: u64,
    /// Where in the plan.
    pub place: Option<PlacePointer>,
    /// Emergency plan being flown.
    #[serde(default)]
    pub emergency: Option<Id>,
    /// Emergency plan in force for this place (what a fallback-cause emergency would fly).
    pub emergency_in_force: Option<Id>,
    /// Next token to be flown.
    pub current: Option<Token>,
    /// Waypoints handed out and not flown yet.
    pub outstanding: usize,
    /// The decision that is being asked for, if any.
    pub decision: Option<DecisionRequest>,
    /// A hash that was proposed and may be committed.
    pub proposed: Option<Arc<str>>,
    /// Seconds left to be circled at the end of the leg, while an action lets the aircraft wait there.
    pub wait_left_s: Option<f64>,
}

/// What the executor is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// No plan, or a plan that was not started.
    Idle,
    /// Flying.
    Flying,
    /// Holding by command.
    Holding,
    /// Waiting at an intersection that has neither decision nor default.
    AwaitingDecision,
    /// The last waypoint was flown.
    Finished,
    /// Standing at the end of a flight behind which the plan has another one: a start begins that.
    Grounded,
}

/// Where the flight is in the plan: survives update, restart and hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlacePointer {
    /// Main plan or which emergency plan.
    pub plan: Branching,
    /// The stage.
    pub stage: Id,
    /// The leg being flown.
    pub leg: Id,
    /// Loops around it, outermost first.
    pub iterations: Vec<IterationPlace>,
    /// Flown backwards.
    pub reverse: bool,
    /// Way already made on this passage of the leg, metres.
    pub distance_m: f64,
}

/// Which part of the document is being flown.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Branching {
    /// The main plan.
    Main,
    /// An emergency plan.
    Emergency(Id),
}

/// One step of a nest of loops.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct IterationPlace {
    /// The iterative leg.
    pub leg: Id,
    /// Arrivals at the final leg's end so far, plus one: the pass being flown, from 1.
    pub iteration: u64,
    /// The count, if there is one.
    pub of: Option<u64>,
    /// Flown backwards now.
    pub reverse: bool,
}

/// What an intersection asks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DecisionRequest {
    /// The intersection leg.
    pub leg: Id,
    /// The branches.
    pub options: Vec<BranchOption>,
    /// Taken at the deadline.
    pub default: Option<Id>,
    /// Metres of path left until the decision is due.
    pub distance_left_m: f64,
    /// Estimated seconds left until then.
    pub time_left_s: f64,
}

/// One way on from an intersection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BranchOption {
    /// Its identifier.
    pub branch: Id,
    /// What the operator reads.
    pub label: String,
    /// The first positions of the path, from the last one before the intersection on: 2 km of it, at most twenty.
    pub preview: Vec<LatLon>,
}

/// FP Manager variable `heartbeat`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Heartbeat {
    /// Counts up.
    pub count: u64,
    /// Plan being flown.
    pub plan: Option<String>,
}
