//! Shell: FCS Gateway, FP Manager and their supervisor.

pub mod config;
pub mod fp_manager;
pub mod gateway;
pub mod registry;
pub mod supervisor;

pub use service::{Shutdown, Trigger, shutdown, single_instance};
