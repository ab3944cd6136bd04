//! Shell: the links between an autopilot and what steers it, and the decoder of MAVLink frames.
//! The agent and the simulator share it.
//!
//! A [`Link`] carries bytes: it knows sockets and addresses, and no protocol. [`frame`] and [`tlog`] are pure: they cut
//! bytes and logs into MAVLink frames; so is [`signing`], which signs them and checks signatures. Whose datagrams are believed is decided by the driver, which knows the protocol.

mod address;
pub mod frame;
mod link;
mod outbox;
pub mod signing;
pub mod tlog;

pub use address::{Address, AddressError, Line};
pub use link::{Event, Link, Partners, Peer, Stats};
pub use outbox::Outbox;
