//! The executor flown by an instant autopilot: small plans, golden sequences of legs.
#![cfg(test)]

mod changes;
mod commands;
mod damaged;
mod endings;
mod flights;
mod gliding;
mod go_around;
#[path = "../common/grid.rs"]
mod grid;
mod kept;
mod legs;
mod legs_actions;
mod legs_actions_edges;
mod legs_changes;
mod legs_concave;
mod legs_courses;
mod legs_flown;
mod legs_patterns;
mod legs_refreshed;
mod legs_refused;
mod legs_turned;
mod loops;
mod questions;
mod refused_by_gateway;
mod reports;
mod rig;
mod updates;
mod updates_on_the_way_back;
