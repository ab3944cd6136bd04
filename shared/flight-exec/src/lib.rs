//! Pure: the virtual machine that flies a compiled plan, and the preview that flies it ahead of time.
//!
//! [`api`] is the whole conversation: inputs and outputs are closed enums, time is an argument,
//! waypoints carry tokens and answers carry them back.

pub mod api;

pub use api::*;
