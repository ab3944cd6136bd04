//! Shell: FCS Gateway, FP Manager, storage and their supervisor.

pub mod cli;
pub mod config;
pub mod doctor;
pub mod exposure;
pub mod fp_manager;
pub mod gateway;
pub mod inside;
mod key_file;
pub mod registry;
pub mod services;
pub mod supervisor;

pub use service::{Shutdown, Trigger, shutdown, single_instance};
