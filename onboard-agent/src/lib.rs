//! Shell: FCS Gateway, FP Manager and their supervisor.

pub mod alone;
pub mod clock;
pub mod config;
pub mod fp_manager;
pub mod gateway;
pub mod shutdown;
pub mod supervisor;

pub use shutdown::{Shutdown, Trigger, shutdown};
