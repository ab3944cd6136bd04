//! The executor flown by an instant autopilot: small plans, golden sequences of legs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod changes;
mod commands;
#[path = "../common/grid.rs"]
mod grid;
mod legs;
mod loops;
mod rig;
