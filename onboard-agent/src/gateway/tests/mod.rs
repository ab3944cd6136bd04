//! The gateway as a whole.

mod flights;
mod links;
mod other_autopilot;
mod shell;
