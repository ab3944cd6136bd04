//! Shell around a pure core: a simulated fixed-wing autopilot that speaks MAVLink 2 as ArduPlane does, or PX4.
//!
//! [`core`] is the simulator without sockets, clock or threads; [`spawn`] puts it on a thread with a
//! link. It is part of the product: plans are tried on it, and it can be given faults. What differs between the two
//! autopilots is in [`core::personality`].
//!
//! What it imitates: the autopilot's modes, arming, mission list and protocol, parameters, rates of telemetry and
//! answers. What it leaves out: terrain, geofences but a circle around home, rally points, a radio-control transmitter, log download, in
//! lockstep the time an upload takes; its dead reckoning without satellites is perfect, and telemetry comes at 10 Hz at most. Of ArduPlane:
//! automatic landing after RTL. Of PX4: its events (only texts say why), loitering items but the endless one, VTOL.

#![allow(
    deprecated,
    reason = "the autopilots and their clients still use much that the dialect calls deprecated"
)]

pub mod config;
pub mod core;
pub mod frame;
mod link;
mod shell;
mod turns;

pub use config::{Config, Control, Link};
pub use core::autopilot::Home;
pub use core::faults::{Fault, FaultRequest};
pub use core::mode::Mode;
pub use core::personality::Personality;
pub use shell::{Handle, TrackPoint, Truth, spawn};
