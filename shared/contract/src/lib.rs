//! Pure: the service contract as a document of its own: keys, topics, every payload that services exchange, and how a service
//! describes itself.
//!
//! Nothing here behaves. A payload service, in Rust, depends on this crate for the types and on `usal` for the session, and
//! compiles neither plan nor executor. Angles are in degrees, the rest in SI units, and units are part of the field names.
//! The type names and the documentation of the payloads are part of their JSON Schemas, which a golden file keeps.

mod admission;
mod alarm;
mod basic;
mod clock;
mod command;
mod describe;
mod foresight;
mod gateway;
mod keys;
mod plan;
mod plan_event;
mod recording;
pub mod spec;
mod status;
mod telemetry;
pub mod topics;
mod value;
mod waypoint;

pub use admission::{ANONYMOUS, OPERATOR, OTHER_VERSION, VERSION, check_caller, check_version};
pub use alarm::{Alarm, Cause, Severity};
pub use basic::{Empty, FileManifest, Refusal, Stamped};
pub use clock::{ClockAck, ClockTick};
pub use command::Command;
pub use describe::{Description, Primitive};
pub use foresight::{Foresee, Foresight, PathPoint};
pub use gateway::{
    AutopilotKind, Circle, GatewayEvent, GatewayRequest, GatewayState, GatewayStatus, Navigation,
    SafeParameters, SafeRunway, TimedGatewayEvent,
};
pub use geodesy::LatLon;
pub use keys::{Key, KeyError, Kind, every_name, every_service, is_segment};
pub use plan::{EntryReport, PlanDocument, PlanInfo, PlanVariable, PlanVariables, ProposalReport, Propose};
pub use plan_event::{FpManagerEvent, PlanEvent, ResolvedAct};
pub use recording::Recording;
pub use status::{
    BranchOption, Branching, DecisionRequest, Heartbeat, IterationPlace, Phase, PlacePointer, PlanStatus,
};
pub use telemetry::{Air, Attitude, AutopilotLink, AutopilotLinks, Engine, Gps, Position, Power};
pub use value::{Id, VariableValue};
pub use waypoint::{Action, Ahead, Feed, FeedAnswer, Join, JoinAnswer, Token, Waypoint};
