//! Laying out: from a place in the plan and the values of now to a stretch of waypoints. Pure functions.
//!
//! Each module may use those above it:
//! [`path`] and [`world`], [`expand`] (one leg), [`cursor`] (from leg to leg), [`stretch`] (waypoint after waypoint).

pub(crate) mod above_ground;
pub mod cursor;
pub(crate) mod elevations;
pub mod expand;
pub(crate) mod homeward;
pub mod path;
pub mod stretch;
pub(crate) mod touch_down;
pub(crate) mod translate;
mod way_back;
pub mod world;
