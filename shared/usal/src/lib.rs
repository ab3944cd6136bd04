//! Shell: sessions that speak the service [`contract`] over Zenoh; the only crate that knows Zenoh.
//!
//! A [`Session`] speaks for one vehicle. What may be said is listed, typed, in [`topics`]:
//! variables, events, invocations and files of each service. Everything that is received is put into
//! channels and cells that can be polled without blocking, so that a window can use them from
//! its drawing thread; [`Config::wake`] tells it when to look.
//!
//! Nothing undecodable stops a session: it is counted ([`Session::health`]), logged at a limited
//! rate and ignored; an undecodable request is answered with what was wrong with it.

mod audit;
mod call;
mod clock;
mod codec;
mod endpoint;
mod error;
mod event;
mod file;
mod health;
mod instance;
mod invocation;
mod liveliness;
mod raw;
mod senders;
mod session;
mod stand_in;
mod variable;

pub use ::contract::{self, Description, Key, KeyError, Kind, Primitive, spec, topics};
pub use audit::{Audited, Document};
pub use call::PendingCall;
pub use clock::{Conductor, Participant};
pub use codec::Format;
pub use contract::spec::{Rate, Said, Spec};
pub use endpoint::check_endpoint;
pub use error::{CallError, SessionError};
pub use event::{EventPublisher, EventSubscriber, Occurrence, Start};
pub use file::{Download, FILE_BYTES_MAX, FileError, FileOffer};
pub use health::{Health, HealthCount};
pub use instance::{Gate, Instance, NoInstance};
pub use invocation::{Incoming, Server};
pub use liveliness::{Announcement, Presence};
pub use raw::{Everything, Raw};
pub use senders::Senders;
pub use session::{Config, DEFAULT_ENDPOINT, Role, Session, Wake};
pub use variable::{Received, Untyped, VariablePublisher, VariableSubscriber};
