//! What goes into the executor and what comes out of it.

mod act;
mod command;
mod event;
mod foresight;
mod place;
mod proposal;
mod waypoint;

pub use act::ResolvedAct;
pub use command::{Command, Refusal};
pub use event::Event;
pub use foresight::{Foresight, PathPoint};
pub use place::{BranchOption, Branching, DecisionRequest, IterationPlace, Phase, PlacePointer, Status};
pub use proposal::{EntryReport, ProposalReport};
pub use waypoint::{Action, AircraftState, FARTHEST_M, TERRAIN_MARGIN_M, TURN_HEIGHT_M, Token, Waypoint};

use flight_plan::Id;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Monotonic time since an arbitrary start; in simulation, simulated time.
pub type Time = std::time::Duration;

/// Correlates a request with its one answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
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
    /// `None`: everything issued has been flown.
    Progress {
        /// The waypoint steered to.
        current: Option<Token>,
    },
    /// The aircraft has landed, but not as the plan does: the pilot or the gateway's Safe mode brought it down. What is ahead is not
    /// flown any more.
    Landed,
    /// The take-off did not come about, and nobody waits for it any more: the plan stands where it stood before its start.
    NotLaunched,
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
    /// The gateway shall bring the aircraft home: Safe mode.
    Safe,
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

/// A good answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// Done.
    Done,
    /// What a proposal would do.
    Proposal(Box<ProposalReport>),
}
