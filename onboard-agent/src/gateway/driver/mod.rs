//! Pure: drivers. A driver is all that knows one kind of autopilot: bytes in, bytes out, orders in, reports out.
//!
//! It owns the codec, the modes, the strategy for the autopilot's list and what is known of its abilities; the
//! core knows waypoints and intentions ([`super::order`]), and the link carries bytes. [`DRIVERS`] lists them.
//! `mavlink` is the driver of MAVLink autopilots; `arduplane` and `px4` are the dialects that it knows ([`DIALECTS`]).

mod arduplane;
pub mod examination;
mod mavlink;
mod px4;
#[cfg(test)]
mod transfers;

use super::order::{Order, OrderId, Report, Time};
use autopilot_link::Outbox;
use autopilot_link::signing::Signing;
use examination::Examination;
pub use mavlink::courier::Courier;
use mavlink::dialect::Dialect;

/// What a link brings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FromLink<'a> {
    /// A new connection: what was left of the one before belongs to nothing.
    Connected,
    /// A piece of a stream.
    Stream(&'a [u8]),
    /// A datagram: it stands for itself.
    Datagram(&'a [u8]),
}

/// A state machine without socket and clock that speaks with one autopilot.
pub trait Driver: Send + Sync {
    /// Takes in what a link brought, by its number; [`Self::process`] handles it.
    fn receive(&mut self, link: usize, incoming: FromLink<'_>);

    /// Handles the next message of what was received, so that what it leads to is done before the one after
    /// it. False: there is no whole message left.
    fn process(&mut self, now: Time) -> bool;

    /// Takes an order; the report with its number comes later.
    fn order(&mut self, now: Time, id: OrderId, order: Order);

    /// Time passed.
    fn tick(&mut self, now: Time);

    /// The next report.
    fn next_report(&mut self) -> Option<Report>;

    /// Hands over the frames to be sent.
    fn send(&mut self, outbox: &mut Outbox);

    /// A simulator waits for the answer to this step (its time, ns).
    fn take_step(&mut self) -> Option<i64> {
        None
    }

    /// Answers a step: everything due at its time was done.
    fn answer_step(&mut self, _step_ns: i64) {}

    /// Says that we are here, out of turn: for a simulator that waits to be spoken to.
    fn hello(&mut self) {}
}

/// What a driver is made for.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    /// In lockstep the simulator asks before each step.
    pub lockstep: bool,
    /// Addresses of the links, as people gave them; a link is known by its place among them.
    pub links: Vec<String>,
    /// Behind the links to the autopilot comes one to another ground station's program, which may only watch.
    pub mirror: bool,
    /// What is sent is signed, and what is not is refused.
    pub signing: Option<Signing>,
}

/// What a datagram has to be signed with, and the time since the start; `None`: nothing is signed.
pub type SignedBy<'a> = Option<(&'a mut Signing, Time)>;

/// A driver in the list of drivers.
#[derive(Debug, Clone, Copy)]
pub struct Registration {
    /// Its name in the configuration.
    pub name: &'static str,
    /// A datagram is from such an autopilot: its sender becomes the link's partner, or stays it. With a key, only what is signed
    /// with it and newer than what was recognised before.
    pub recognises: fn(&[u8], SignedBy<'_>) -> bool,
    /// Makes a driver that has received nothing. It reports in [`Report::Capability`] whether it can fly the
    /// autopilot at the other end.
    pub make: fn(&Setup) -> Box<dyn Driver>,
    /// Makes an examination, for `doctor`; `None`: it can't look an autopilot over.
    pub examine: Option<MakeExamination>,
}

/// Makes an examination for an autopilot.
pub type MakeExamination = fn(&Setup) -> Box<dyn Examination>;

/// The drivers: a new one is a line here.
pub const DRIVERS: &[Registration] = &[mavlink::driver::REGISTRATION];

/// The driver that is used unless the configuration names another.
pub const DEFAULT: Registration = mavlink::driver::REGISTRATION;

/// The kinds of MAVLink autopilots: a new one is a line here.
const DIALECTS: &[&Dialect] = &[&arduplane::DIALECT, &px4::FIXED_WING, &px4::VTOL];

/// The driver with this name.
pub fn by_name(name: &str) -> Option<Registration> {
    DRIVERS.iter().copied().find(|driver| driver.name == name)
}

/// The names of all drivers, for people.
pub fn names() -> String {
    DRIVERS.iter().map(|driver| driver.name).collect::<Vec<_>>().join(", ")
}
