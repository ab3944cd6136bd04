//! The gateway as a whole.

mod flights;
mod other_autopilot;
mod shell;
