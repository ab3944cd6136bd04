//! What the FP Manager tells as it happens.

use crate::{Cause, DecisionRequest, Id, Phase, PlacePointer, Stamped, VariableValue};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "event", rename_all = "kebab-case")]
#[schemars(rename = "Event")]
pub enum PlanEvent {
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
    /// No emergency plan is flown for this: the gateway's Safe mode has to decide.
    EmergencyUnanswered {
        /// Why it was raised.
        cause: Cause,
        /// The plan that is there for it and is not flown. `None`: there is none.
        #[serde(default)]
        plan: Option<Id>,
        /// Why: short, stable, for programs (`no-emergency-plan`, `another-runway-reached`, `glide-into-terrain`).
        #[serde(default)]
        code: String,
        /// For people.
        #[serde(default)]
        reason: String,
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
    /// A command took effect that leads along a way of its own (a go-to, a leg skipped, a return to the main plan), and what is ahead has
    /// this problem now, which it did not have before. It is flown nevertheless unless another command comes. Told by the FP Manager.
    /// Also `glide-shortened`: with the engine out the height does not suffice for all of the emergency plan, and a part is left out.
    /// `glide-long`: with the engine out it comes to its landing so high that it ends beyond the runway.
    ProblemAhead {
        /// The leg, if it is one's.
        leg: Option<Id>,
        /// What is wrong: short, stable, for programs.
        code: String,
        /// For people.
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

/// What an action does, its numbers and values computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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

/// FP Manager event stream `events`: a plan event with its time.
pub type FpManagerEvent = Stamped<PlanEvent>;
