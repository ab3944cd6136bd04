//! What a flight would do from now on.

use crate::{Command, Id};
use geodesy::LatLon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// FP Manager invocation `foresee`: what would follow? Nothing is done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Foresee {
    /// After this command; `None`: if the flight goes on as it is.
    pub command: Option<Command>,
}

/// What a flight under way would do from now on: as it is, or after a command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Foresight {
    /// The path from the aircraft on; of a long one, every so-manieth point.
    pub path: Vec<PathPoint>,
    /// The leg that would be flown next.
    pub next_leg: Option<Id>,
    /// Legs, or passes of them, that the flight as it is would still fly and this one would not.
    pub left_out: Vec<Id>,
    /// So many metres below its altitude the first waypoint would be reached: a climb that is not done.
    pub short_of_altitude_m: Option<f64>,
    /// Least height above the ground until the approach, metres, where the ground is known.
    pub clearance_m: Option<f64>,
    /// What is wrong with the path and was not before, one sentence each.
    pub problems: Vec<String>,
    /// Seconds until it ends.
    pub time_s: f64,
    /// Metres over the ground until it ends.
    pub distance_m: f64,
    /// Share of the energy left then, 0..1.
    pub battery_left: f64,
    /// It ends on the ground.
    pub landed: bool,
    /// Why it ends too early, if it does.
    pub cut_short: Option<String>,
}

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PathPoint {
    /// Seconds from now.
    pub time_s: f64,
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
}
