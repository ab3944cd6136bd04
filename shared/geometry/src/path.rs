//! Path elements: what a leg is made of before it becomes waypoints.

use crate::LatLon;
use serde::{Deserialize, Serialize};

/// One piece of ground path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum PathElement {
    /// The geodesic between two positions.
    Line {
        /// Where it starts.
        from: LatLon,
        /// Where it ends.
        to: LatLon,
    },
    /// A constant-radius arc.
    Arc {
        /// Its centre.
        centre: LatLon,
        /// Its radius, metres.
        radius_m: f64,
        /// Bearing from the centre to the arc's start, degrees true.
        start_bearing_deg: f64,
        /// Angle swept, degrees; positive clockwise (a right turn), negative anticlockwise.
        sweep_deg: f64,
    },
}
