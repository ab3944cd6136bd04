//! What goes into the executor and what comes out of it.

use flight_plan::{Cause, Id, VariableValue};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Monotonic time since an arbitrary start; in simulation, simulated time.
pub type Time = std::time::Duration;

/// Number of a waypoint of this flight: counts up from 1 and is never used twice, across plan
/// updates, emergencies and restarts.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Default,
    Serialize,
    Deserialize,
    schemars::JsonSchema,
)]
#[serde(transparent)]
pub struct Token(pub u64);

/// What the autopilot does at or towards a waypoint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Action {
    /// Take off along a heading and climb to the waypoint's altitude.
    TakeOff {
        /// Runway heading, degrees true.
        heading_deg: f64,
    },
    /// Fly to it.
    Fly,
    /// Circle it until told otherwise (radius positive; direction by sign: positive clockwise).
    Loiter {
        /// Signed radius, metres.
        radius_m: f64,
    },
    /// Land here (touch-down point), rolling out along a heading.
    Land {
        /// Runway heading, degrees true.
        heading_deg: f64,
    },
}

/// A waypoint, as sent to the gateway.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Waypoint {
    /// Its number.
    pub token: Token,
    /// Where.
    pub position: LatLon,
    /// Metres above mean sea level.
    pub altitude_amsl_m: f64,
    /// Airspeed towards it, m/s.
    pub airspeed_mps: f64,
    /// What to do.
    pub action: Action,
    /// Cross it before turning.
    pub fly_over: bool,
    /// The leg it belongs to.
    pub leg: Id,
    /// Flying it ends the plan: no waypoint will follow.
    pub end_of_plan: bool,
}

/// What the gateway tells the executor about the flight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct AircraftState {
    /// Where it is.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Direction of travel over the ground, degrees true.
    pub track_deg: f64,
    /// Over the ground, m/s.
    pub ground_speed_mps: f64,
    /// Through the air, m/s.
    pub airspeed_mps: f64,
    /// Where the wind blows to, m/s east and north.
    pub wind_east_mps: f64,
    /// See `wind_east_mps`.
    pub wind_north_mps: f64,
    /// Share of the energy left, 0..1.
    pub battery: f64,
    /// On the ground.
    pub on_ground: bool,
}

impl AircraftState {
    /// Every number is one, and the position is on Earth.
    pub fn is_sound(&self) -> bool {
        let numbers = [
            self.altitude_amsl_m,
            self.track_deg,
            self.ground_speed_mps,
            self.airspeed_mps,
            self.wind_east_mps,
            self.wind_north_mps,
            self.battery,
        ];
        self.position.is_valid() && numbers.iter().all(|n| n.is_finite())
    }
}

/// One step of a nest of loops.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
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

/// Which part of the document is being flown.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Branching {
    /// The main plan.
    Main,
    /// An emergency plan.
    Emergency(Id),
}

/// Where the flight is in the plan: survives update, restart and hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
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

/// What the executor is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
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
}

/// A snapshot for people and services.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Status {
    /// What it is doing.
    pub phase: Phase,
    /// Hash of the active plan (hex SHA-256 of its canonical bytes), if any.
    pub plan: Option<Arc<str>>,
    /// Counts accepted plans and changes of this flight.
    pub revision: u64,
    /// Where in the plan.
    pub place: Option<PlacePointer>,
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

/// What an intersection asks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct BranchOption {
    /// Its identifier.
    pub branch: Id,
    /// What the operator reads.
    pub label: String,
    /// The first positions of the path, from the last one before the intersection on: 2 km of it, at most twenty.
    pub preview: Vec<LatLon>,
}

/// What people and services may ask of the executor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
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
    /// Make the proposed plan the active one.
    Commit {
        /// Hash of the proposal.
        hash: Arc<str>,
        /// The leg to enter, when the current leg is gone.
        entry: Option<Id>,
    },
}

/// Why a command was refused; the sentence says what to do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema, thiserror::Error)]
#[error("{code}: {reason}")]
pub struct Refusal {
    /// Short, stable, for programs: `no-plan`, `unknown-leg`, `stale-revision`, …
    pub code: String,
    /// For people.
    pub reason: String,
}

/// What a proposed plan would do, or why it can't be flown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
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
}

/// Correlates a request with its one answer.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(transparent)]
pub struct RequestId(pub u64);

/// Everything that can happen to the executor. Serialisable for the journal, but for proposals: of them
/// the document is kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Input {
    /// Time passed (drives deadlines; also sent when nothing else happens).
    Tick,
    /// A new plan is put forward (checked and compiled by the shell's call to `flight_plan`).
    #[serde(skip)]
    Propose {
        /// For the answer.
        request: RequestId,
        /// The compiled plan.
        program: Arc<flight_plan::Program>,
        /// The revision that the proposer has seen; refused if that has moved on since. `None`: don't care.
        based_on: Option<u64>,
        /// What the shell found besides (zones along the whole path, for instance): reported, and with an error among them the plan
        /// can't be committed.
        objections: Vec<flight_plan::Problem>,
    },
    /// A command.
    Command {
        /// For the answer.
        request: RequestId,
        /// Who asks: a service's name, `operator` for people.
        by: Arc<str>,
        /// What is asked.
        command: Command,
    },
    /// Fresh state of the aircraft.
    Aircraft(AircraftState),
    /// The aircraft is now steering to `current`; everything before it has been flown.
    /// `None`: everything handed out has been flown.
    Progress {
        /// The waypoint steered to.
        current: Option<Token>,
    },
    /// The gateway refused a batch that began with this token, whole; its buffer is as it was.
    Rejected {
        /// First token of the batch.
        first: Token,
        /// Why.
        reason: String,
    },
    /// True: the gateway entered a mode in which it controls the flight itself and takes no waypoints
    /// (Safe, Manual). False: it left it; everything ahead is fed again with new tokens.
    GatewayControls(bool),
}

/// What the executor wants done.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// Forget every waypoint after this token (`Token(0)`: all), then append these; one
    /// transaction. `cancel_after: None` just appends.
    Feed {
        /// Last waypoint to be kept.
        cancel_after: Option<Token>,
        /// What follows it.
        waypoints: Vec<Waypoint>,
    },
    /// Hold where the aircraft is.
    Hold,
    /// The one answer to a request.
    Answer {
        /// Which.
        request: RequestId,
        /// How it went.
        result: Result<Answer, Refusal>,
    },
    /// An action of the plan is due: somebody else does it.
    Act {
        /// The leg it belongs to.
        leg: Id,
        /// Which passage of it; of a loop: which activation. With the leg unique in a flight.
        passage: u64,
        /// What is to be done.
        act: ResolvedAct,
    },
    /// Something that services and people want to know.
    Event(Event),
}

/// What an action does, its numbers and values computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(tag = "act", rename_all = "kebab-case")]
pub enum ResolvedAct {
    /// Takes one picture.
    Photo,
    /// Starts a series of pictures.
    PhotoSeries {
        /// Metres of ground track between pictures.
        every_m: f64,
    },
    /// Ends the series of pictures.
    PhotoStop,
    /// Starts recording video.
    VideoStart,
    /// Stops recording video.
    VideoStop,
    /// Has written a variable (the executor has done it).
    Set {
        /// Its name.
        variable: Id,
        /// Its value.
        value: VariableValue,
    },
    /// Calls a service; nobody waits for the answer.
    Invoke {
        /// The service.
        service: String,
        /// Its operation.
        operation: String,
        /// JSON text of the request; empty: `null`.
        argument: String,
    },
    /// Circles at the end of the leg (the executor does it; only told as an event).
    Wait {
        /// Seconds.
        seconds: f64,
    },
}

impl std::fmt::Display for ResolvedAct {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ResolvedAct::Photo => write!(f, "photo"),
            ResolvedAct::PhotoSeries { every_m } => write!(f, "photos every {every_m} m"),
            ResolvedAct::PhotoStop => write!(f, "end of the photos"),
            ResolvedAct::VideoStart => write!(f, "video on"),
            ResolvedAct::VideoStop => write!(f, "video off"),
            ResolvedAct::Set { variable, .. } => write!(f, "{variable} set"),
            ResolvedAct::Invoke { service, operation, .. } => write!(f, "{service}/{operation} called"),
            ResolvedAct::Wait { seconds } => write!(f, "waiting for {seconds} s"),
        }
    }
}

/// A good answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// Done.
    Done,
    /// What a proposal would do.
    Proposal(Box<ProposalReport>),
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// The aircraft began a leg.
    LegEntered {
        /// Where that is.
        place: PlacePointer,
    },
    /// A pass of a loop ended at its final leg.
    IterationFinished {
        /// The iterative leg.
        leg: Id,
        /// Passes finished.
        finished: u64,
        /// The count, if any.
        of: Option<u64>,
    },
    /// Somebody should decide.
    DecisionRequested(DecisionRequest),
    /// It was decided.
    DecisionTaken {
        /// The intersection leg.
        leg: Id,
        /// The branch.
        branch: Id,
        /// Name of the person or service that decided, `condition` or `default`.
        by: String,
    },
    /// A variable has a new value.
    VariableChanged {
        /// Its name.
        name: Id,
        /// Its value.
        value: VariableValue,
        /// Who wrote it: a service's name, `operator`, or `plan` for an action of the plan.
        by: Arc<str>,
    },
    /// An action of the plan was begun.
    ActionDone {
        /// The leg it belongs to.
        leg: Id,
        /// Which passage of it; of a loop: which activation.
        passage: u64,
        /// What is done.
        act: ResolvedAct,
    },
    /// An action of the plan was due and could not be done; it isn't tried again on this passage.
    ActionRefused {
        /// The leg it belongs to.
        leg: Id,
        /// Which passage of it; of a loop: which activation.
        passage: u64,
        /// Why.
        reason: String,
    },
    /// A pattern could not be regenerated; the old one goes on.
    PatternRefused {
        /// The leg.
        leg: Id,
        /// Why.
        reason: String,
    },
    /// A condition or a number of a leg has no value now (a division by zero, for instance): the condition counts as
    /// false, the number as not given. Told once.
    ExpressionFailed {
        /// The leg.
        leg: Id,
        /// Why, and what to do.
        reason: String,
    },
    /// A plan became the active one.
    PlanActivated {
        /// Its hash.
        hash: Arc<str>,
        /// The revision it makes.
        revision: u64,
    },
    /// An emergency plan is being flown.
    EmergencyStarted {
        /// Why.
        cause: Cause,
        /// Which.
        plan: Id,
        /// The leg it was raised on.
        from_leg: Option<Id>,
    },
    /// No emergency plan applies: the gateway's Safe mode has to decide.
    EmergencyUnanswered {
        /// Why it was raised.
        cause: Cause,
    },
    /// What it is doing changed.
    PhaseChanged {
        /// To this.
        phase: Phase,
    },
    /// Waypoints were refused by the gateway.
    WaypointsRejected {
        /// The leg of the first of them.
        leg: Option<Id>,
        /// Why.
        reason: String,
    },
    /// The gateway does not grant what the flight needs; it is asked again, for the take-off until
    /// it is granted. Told once for each reason, by the FP Manager.
    NotGranted {
        /// `launch`, `hold`, `resume` or `set-runways`.
        request: String,
        /// Why.
        reason: String,
    },
    /// What happens is not recorded (disk full, not writable), or a restart could not use what was: the flight
    /// goes on, its place would not survive another restart. Told once, by the FP Manager.
    NotJournalled {
        /// Why, and what to do.
        reason: String,
    },
    /// What happens is recorded again.
    Journalled,
}
