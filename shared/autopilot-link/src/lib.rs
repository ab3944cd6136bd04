//! Shell: the links between an autopilot and what steers it, and the decoder of MAVLink frames.
//! The agent and the simulator share it.
//!
//! A [`Link`] carries bytes: it knows sockets and addresses, and no protocol. [`frame`] is pure: it cuts
//! bytes into MAVLink frames. Whose datagrams are believed is decided by the driver, which knows the protocol.

mod address;
pub mod frame;
mod link;
mod outbox;

pub use address::{Address, AddressError, Line};
pub use link::{Event, Link, Partners, Peer, Stats};
pub use outbox::Outbox;
