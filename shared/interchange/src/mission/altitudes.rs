//! Frames of mission items, as altitudes of the plan.

use super::commands::{
    FRAME_GLOBAL, FRAME_GLOBAL_INT, FRAME_RELATIVE, FRAME_RELATIVE_INT, FRAME_TERRAIN, FRAME_TERRAIN_INT,
};
use crate::note::Notes;
use crate::synthetic::altitude;
use flight_plan::{Altitude, AltitudeReference};

/// Highest altitude that is believed, metres either way.
const MAX_M: f64 = 100_000.0;

/// What the altitudes of a mission count from.
#[derive(Debug, Clone, Copy)]
pub struct Datum {
    /// Elevation of home, metres AMSL.
    pub home_amsl_m: Option<f64>,
    /// The plan has a take-off, so that `home` means something in it.
    pub has_take_off: bool,
}

impl Datum {
    /// An altitude in a frame; `None`, with a note, if it can't be understood.
    pub fn altitude(self, frame: u16, metres: f64, place: &str, notes: &mut Notes) -> Option<Altitude> {
        if !metres.is_finite() || metres.abs() > MAX_M {
            notes.push(
                "bad-altitude",
                place,
                format!("altitude {metres} m is left out: it is taken from the leg before"),
            );
            return None;
        }
        match frame {
            FRAME_GLOBAL | FRAME_GLOBAL_INT => Some(altitude(metres, AltitudeReference::Amsl)),
            FRAME_RELATIVE | FRAME_RELATIVE_INT => Some(self.relative(metres, place, notes)),
            FRAME_TERRAIN | FRAME_TERRAIN_INT => Some(altitude(metres, AltitudeReference::Agl)),
            other => {
                let message = format!(
                    "altitude {metres} m in frame {other} is left out: it is taken from the leg before"
                );
                notes.push("unknown-frame", place, message);
                None
            }
        }
    }

    /// An altitude above home.
    pub fn relative(self, metres: f64, place: &str, notes: &mut Notes) -> Altitude {
        match self.home_amsl_m {
            _ if self.has_take_off => altitude(metres, AltitudeReference::Home),
            Some(home_m) => altitude(home_m + metres, AltitudeReference::Amsl),
            None => {
                notes.again(
                    "no-home",
                    place,
                    "altitude above home is taken as above ground: the file doesn't say how high home is",
                );
                altitude(metres, AltitudeReference::Agl)
            }
        }
    }
}
