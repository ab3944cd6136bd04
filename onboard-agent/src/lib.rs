//! Shell: FCS Gateway, FP Manager and their supervisor.

pub mod gateway;
pub mod shutdown;

pub use shutdown::{Shutdown, Trigger, shutdown};
