//! What the executor remembers from one step to the next.

use crate::api::{AircraftState, Phase};
use crate::executor::actions::{Passage, Wait};
use crate::executor::questions::Ahead;
use crate::layout::cursor::{Cursor, LayoutError};
use crate::layout::stretch::{Continuation, IssuedWaypoint};
use crate::value::{Decision, LoopCount};
use flight_plan::{Cause, Id, Variables};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Everything that a snapshot keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    pub phase: Phase,
    pub variables: Variables,
    /// Those written since the last flight.
    pub written: Vec<Id>,
    pub issued: VecDeque<IssuedWaypoint>,
    /// Where the path goes on after the last waypoint issued.
    pub tail: Option<Cursor>,
    pub continuation: Continuation,
    /// True if choices were made after the last waypoint.
    pub tail_has_choices: bool,
    /// Highest token used so far.
    pub last_token: u64,
    /// Highest passage number used so far.
    pub last_passage: u64,
    /// Passage (and its leg) whose beginning was announced. A wait at an intersection has the number of
    /// the passage that follows it: hence the leg.
    pub announced: Option<(u64, Id)>,
    pub decisions: Vec<Decision>,
    pub requested: Vec<(Id, u64)>,
    /// Those of them that came into sight after their deadline.
    pub late: Vec<(Id, u64)>,
    /// A question about an intersection beyond what is issued.
    pub ahead: Option<Ahead>,
    pub counts: Vec<LoopCount>,
    /// See [`crate::layout::world::World::released`].
    pub released: Option<u64>,
    /// See [`crate::layout::world::World::waited`].
    pub waited: Option<u64>,
    /// Passages under way that have actions, outermost first.
    pub passages: Vec<Passage>,
    /// When actions were looked after last, by the executor's clock.
    pub acted_s: f64,
    pub wait: Option<Wait>,
    pub emergency: Option<Emergency>,
    /// Where the aircraft was when it was told to hold.
    pub held_at: Option<LatLon>,
    pub gateway_controls: bool,
    pub aircraft: Option<AircraftState>,
    pub revision: u64,
    /// The active plan came in flight: only what was ahead then has been looked at.
    pub seen_ahead_only: bool,
    /// Seconds of the executor's own clock: goes on from a snapshot.
    pub clock_s: f64,
    pub started_s: Option<f64>,
    pub refresh_due_s: Option<f64>,
    pub last_refresh_s: Option<f64>,
    pub review_due_s: f64,
    /// What didn't work lately, the latest first, so that it is told once.
    pub told: Vec<LayoutError>,
}

/// The emergency being flown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Emergency {
    pub cause: Cause,
    pub plan: Id,
    /// Leg of the main plan on which it was raised.
    pub from_leg: Option<Id>,
}

impl Default for State {
    fn default() -> Self {
        Self {
            phase: Phase::Idle,
            variables: Variables::default(),
            written: Vec::new(),
            issued: VecDeque::new(),
            tail: None,
            continuation: Continuation::Open,
            tail_has_choices: false,
            last_token: 0,
            last_passage: 0,
            announced: None,
            decisions: Vec::new(),
            requested: Vec::new(),
            late: Vec::new(),
            ahead: None,
            counts: Vec::new(),
            released: None,
            waited: None,
            passages: Vec::new(),
            acted_s: 0.0,
            wait: None,
            emergency: None,
            held_at: None,
            gateway_controls: false,
            aircraft: None,
            revision: 0,
            seen_ahead_only: false,
            clock_s: 0.0,
            started_s: None,
            refresh_due_s: None,
            last_refresh_s: None,
            review_due_s: 0.0,
            told: Vec::new(),
        }
    }
}
