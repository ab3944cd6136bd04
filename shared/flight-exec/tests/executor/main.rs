//! The executor flown by an instant autopilot: small plans, golden sequences of legs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod changes;
mod commands;
#[path = "../common/grid.rs"]
mod grid;
mod legs;
mod legs_actions;
mod legs_changes;
mod legs_courses;
mod legs_flown;
mod legs_patterns;
mod loops;
mod rig;
