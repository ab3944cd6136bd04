//! Waypoints as comma-separated values (RFC 4180).

use crate::Export;
use crate::losses::{self, Kept};
use crate::note::Notes;
use flight_exec::{Action, Waypoint};
use std::fmt::Write;

/// Names of the columns that every table of waypoints has, behind a number.
pub const COLUMNS: &str = "leg,latitude_deg,longitude_deg,altitude_amsl_m,airspeed_mps,action,fly_over";

/// What is in these columns; identifiers need no quotes.
pub fn columns(w: &Waypoint) -> String {
    format!(
        "{},{:.9},{:.9},{:.4},{:.3},{},{}",
        w.leg,
        w.position.lat_deg,
        w.position.lon_deg,
        w.altitude_amsl_m,
        w.airspeed_mps,
        action(&w.action),
        w.fly_over
    )
}

/// Writes a line for each waypoint, below a line of names.
pub fn write(export: &Export<'_>, notes: &mut Notes) -> Vec<u8> {
    losses::note_losses(export, Kept { speeds: true, ..Kept::default() }, &|_| false, notes);
    let mut text = format!("number,{COLUMNS},passage\r\n");
    for (index, step) in export.steps.iter().enumerate() {
        // writing to a string can't fail
        let _ = write!(text, "{},{},{}\r\n", index + 1, columns(&step.waypoint), step.passage);
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
