//! The messages that Foxglove shows by itself: places on its map, drawings over it, and its log.
//!
//! As JSON with JSON Schemas, written from the published lists of fields (foxglove.LocationFix, foxglove.GeoJSON, foxglove.Log).

use crate::path::Point;
use serde_json::{Value, json};
use std::time::Duration;

/// A message type of Foxglove's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    LocationFix,
    GeoJson,
    Log,
}

/// How much a line of the log matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// For developers.
    Debug,
    /// Good to know.
    Info,
    /// Something is not as it should be.
    Warning,
    /// Something failed.
    Error,
}

impl Level {
    /// By its name, in any case; what is unknown counts as [`Level::Info`].
    pub fn by_name(name: &str) -> Self {
        let is = |other: &str| name.eq_ignore_ascii_case(other);
        match () {
            () if is("error") => Self::Error,
            () if is("warn") || is("warning") => Self::Warning,
            () if is("debug") || is("trace") => Self::Debug,
            () => Self::Info,
        }
    }

    fn number(self) -> u8 {
        match self {
            Self::Debug => 1,
            Self::Info => 2,
            Self::Warning => 3,
            Self::Error => 4,
        }
    }
}

impl Kind {
    pub fn name(self) -> &'static str {
        match self {
            Self::LocationFix => "foxglove.LocationFix",
            Self::GeoJson => "foxglove.GeoJSON",
            Self::Log => "foxglove.Log",
        }
    }

    /// Its JSON Schema.
    pub fn schema(self) -> Value {
        let number = || json!({"type": "number"});
        let text = || json!({"type": "string"});
        let properties = match self {
            Self::LocationFix => json!({
                "timestamp": time_schema(),
                "frame_id": text(),
                "latitude": number(),
                "longitude": number(),
                "altitude": number(),
                "position_covariance": {"type": "array", "items": {"type": "number"}, "minItems": 9, "maxItems": 9},
                "position_covariance_type": {"type": "integer", "enum": [0, 1, 2, 3]},
            }),
            Self::GeoJson => json!({"geojson": text()}),
            Self::Log => json!({
                "timestamp": time_schema(),
                "level": {"type": "integer", "enum": [0, 1, 2, 3, 4, 5]},
                "message": text(),
                "name": text(),
                "file": text(),
                "line": {"type": "integer", "minimum": 0},
            }),
        };
        let required: Vec<&String> =
            properties.as_object().into_iter().flatten().map(|(name, _)| name).collect();
        json!({"title": self.name(), "type": "object", "required": required, "properties": properties})
    }
}

fn time_schema() -> Value {
    json!({
        "title": "time",
        "type": "object",
        "properties": {
            "sec": {"type": "integer", "minimum": 0},
            "nsec": {"type": "integer", "minimum": 0, "maximum": 999_999_999},
        },
    })
}

fn time(log: Duration) -> Value {
    json!({"sec": log.as_secs(), "nsec": log.subsec_nanos()})
}

/// Where the aircraft is. `log`: since 1970.
pub fn location(log: Duration, vehicle: &str, point: &Point) -> Value {
    json!({
        "timestamp": time(log),
        "frame_id": vehicle,
        "latitude": point.lat_deg,
        "longitude": point.lon_deg,
        "altitude": point.altitude_amsl_m,
        "position_covariance": [0, 0, 0, 0, 0, 0, 0, 0, 0],
        "position_covariance_type": 0,
    })
}

/// A drawing over the map: a GeoJSON document.
pub fn drawing(geojson: &str) -> Value {
    json!({"geojson": geojson})
}

/// A line of the log. `log`: since 1970; `name`: who tells it.
pub fn line(log: Duration, level: Level, name: &str, message: &str) -> Value {
    json!({
        "timestamp": time(log),
        "level": level.number(),
        "message": message,
        "name": name,
        "file": "",
        "line": 0,
    })
}
