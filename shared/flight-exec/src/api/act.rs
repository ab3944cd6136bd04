//! Actions of the plan, as somebody else does them.

use flight_plan::{Id, VariableValue};
use serde::{Deserialize, Serialize};

/// What an action does, its numbers and values computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "act", rename_all = "kebab-case")]
pub enum ResolvedAct {
    /// Takes one picture.
    Photo,
    /// Starts a series of pictures.
    PhotoSeries {
        /// Metres of ground track between pictures.
        every_m: f64,
    },
    /// Ends the series of pictures.
    PhotoStop,
    /// Starts recording video.
    VideoStart,
    /// Stops recording video.
    VideoStop,
    /// Has written a variable (the executor has done it).
    Set {
        /// Its name.
        variable: Id,
        /// Its value.
        value: VariableValue,
    },
    /// Calls a service; nobody waits for the answer.
    Invoke {
        /// The service.
        service: String,
        /// Its operation.
        operation: String,
        /// JSON text of the request; empty: `null`.
        argument: String,
    },
    /// Circles at the end of the leg (the executor does it; only reported as an event).
    Wait {
        /// Seconds.
        seconds: f64,
    },
}

impl std::fmt::Display for ResolvedAct {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ResolvedAct::Photo => write!(f, "photo"),
            ResolvedAct::PhotoSeries { every_m } => write!(f, "photos every {every_m} m"),
            ResolvedAct::PhotoStop => write!(f, "end of the photos"),
            ResolvedAct::VideoStart => write!(f, "video on"),
            ResolvedAct::VideoStop => write!(f, "video off"),
            ResolvedAct::Set { variable, .. } => write!(f, "{variable} set"),
            ResolvedAct::Invoke { service, operation, .. } => write!(f, "{service}/{operation} called"),
            ResolvedAct::Wait { seconds } => write!(f, "waiting for {seconds} s"),
        }
    }
}
