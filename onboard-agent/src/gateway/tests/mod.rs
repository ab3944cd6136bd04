//! The gateway as a whole.

pub mod flights;
mod links;
mod other_autopilot;
mod shell;

/// The session of the FP Manager that flies.
pub fn fp_manager() -> Option<usal::Instance> {
    "f1".parse().ok()
}
