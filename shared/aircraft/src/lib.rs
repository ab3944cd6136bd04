//! Pure: performance profiles, fixed-wing point mass, wind, energy and the waypoint-following
//! guidance that simulator and preview share.
//!
//! One aircraft, flown by everybody: `dynamics` moves it, `autopilot` steers it along waypoints,
//! the checks read its `profile`. No clock, no randomness: time is an argument.

pub mod profile;

pub use profile::Profile;
