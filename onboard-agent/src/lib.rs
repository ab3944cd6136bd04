//! Shell: FCS Gateway, FP Manager and their supervisor.

pub mod clock;
pub mod config;
pub mod fp_manager;
pub mod gateway;
pub mod shutdown;
pub mod single_instance;
pub mod supervisor;

pub use shutdown::{Shutdown, Trigger, shutdown};
