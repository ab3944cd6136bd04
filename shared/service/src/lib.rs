//! Shell: runs a service that is declared.
//!
//! A service says what it is ([`Service::SPEC`]), what it serves and follows ([`Service::wire`]), and what it does with
//! each thing that happens ([`Service::step`], which is pure). [`run`] does the rest: the network session, one instance
//! at a time, the machine's clock or the simulator's, dispatch through bounded queues, `describe`, liveliness, the
//! variables at their rates, files that survive a crash, the audit trail, the log, and the end.
//!
//! What touches the world beyond that (a link, a camera, a journal) is an [`Adapter`].

mod adapter;
mod audit;
mod board;
mod clock;
mod folder;
pub mod logging;
mod out;
mod request;
mod run;
mod runtime;
mod shutdown;
pub mod single_instance;
mod statistics;
mod tasks;
mod versions;
mod wiring;

pub use adapter::{Adapter, NoAdapter};
pub use audit::{Audit, audit};
pub use board::Board;
pub use clock::Time;
pub use logging::{LogLine, log};
pub use out::Out;
pub use request::{Reply, Request};
pub use run::{Beginning, Config, Timing, run, run_alone};
pub use shutdown::{Shutdown, Trigger, shutdown};
pub use single_instance::AlreadyRunning;
pub use tasks::Tasks;
pub use wiring::{Topic, Wiring, followed};

use std::convert::Infallible;
use usal::Spec;

/// What a service never wants of an adapter that it doesn't have.
pub type Never = Infallible;

/// A service: declared by what it is and follows, and pure in what it does.
pub trait Service: Send + 'static {
    /// All that can happen to it.
    type Input: Send + 'static;
    /// All that it can want of its adapter; [`Never`] for a service without one.
    type Output: Send + 'static;
    /// What it is called, and what it says.
    const SPEC: Spec;

    /// What it serves and follows, each with the input that comes of it.
    fn wire(wiring: &mut Wiring<Self::Input>);

    /// Something happened. Pure: what has to be done about it goes into `out`.
    fn step(&mut self, now: Time, input: Self::Input, out: &mut Out<Self::Input, Self::Output>);

    /// Its variables and files as they are now. Called after each step (in lockstep, by a participant, at each beat); the
    /// board sees to the rates of the declaration, and asks for no value that isn't due.
    fn publish(&mut self, now: Time, board: &mut Board) {
        let _ = (now, board);
    }

    /// It is asked to end: whether it may now. If not it goes on, until it may or somebody insists.
    fn may_end(&self) -> bool {
        true
    }
}
