//! The gateway as a whole.

pub mod flights;
mod links;
mod other_autopilot;
mod shell;
