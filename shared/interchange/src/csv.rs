//! Waypoints as comma-separated values (RFC 4180).

use crate::Export;
use crate::losses::{self, Kept};
use crate::note::Notes;
use flight_exec::Action;
use std::fmt::Write;

/// Writes a line for each waypoint, below a line of names.
pub fn write(export: &Export<'_>, notes: &mut Notes) -> Vec<u8> {
    losses::tell(export, Kept { speeds: true, ..Kept::default() }, &|_| false, notes);
    let mut text =
        "number,leg,passage,latitude_deg,longitude_deg,altitude_amsl_m,airspeed_mps,action,fly_over\r\n"
            .to_owned();
    for (index, step) in export.steps.iter().enumerate() {
        let w = &step.waypoint;
        // writing to a string can't fail; identifiers need no quotes
        let _ = write!(
            text,
            "{},{},{},{:.9},{:.9},{:.4},{:.3},{},{}\r\n",
            index + 1,
            w.leg,
            step.passage,
            w.position.lat_deg,
            w.position.lon_deg,
            w.altitude_amsl_m,
            w.airspeed_mps,
            action(&w.action),
            w.fly_over
        );
    }
    text.into_bytes()
}

/// What is done at a waypoint, in a word.
pub fn action(action: &Action) -> &'static str {
    match action {
        Action::TakeOff { .. } => "take-off",
        Action::Fly => "fly",
        Action::Loiter { .. } => "loiter",
        Action::Land { .. } => "land",
    }
}
