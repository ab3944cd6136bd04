//! Where the aircraft must stay, and where it must not be.

use super::{Altitude, Id};
use geometry::LatLon;
use serde::{Deserialize, Serialize};

/// Inside or outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ZoneKind {
    /// The flight stays inside the union of these.
    KeepIn,
    /// The flight stays outside each of these.
    KeepOut,
}

/// A zone that the whole path respects, turns and holdings included.
#[derive(Debug, Clone, PartialEq)]
pub struct Zone {
    /// Its identifier.
    pub id: Id,
    /// What people call it.
    pub name: String,
    /// Keep in or keep out.
    pub kind: ZoneKind,
    /// Its outline.
    pub shape: ZoneShape,
    /// Its lower limit (a constant); `None`: the ground.
    pub floor: Option<Altitude>,
    /// Its upper limit (a constant); `None`: none.
    pub ceiling: Option<Altitude>,
    /// When it is active; empty: always.
    pub active: Vec<ZoneTime>,
}

/// The outline of a zone.
#[derive(Debug, Clone, PartialEq)]
pub enum ZoneShape {
    /// A circle.
    Circle {
        /// Its centre.
        centre: LatLon,
        /// Its radius, metres.
        radius_m: f64,
    },
    /// A simple polygon, not closed.
    Polygon(Vec<LatLon>),
}

/// A period in which a zone is active, UTC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ZoneTime {
    /// Seconds since 1970-01-01T00:00:00Z.
    pub from_unix_s: i64,
    /// Seconds since 1970-01-01T00:00:00Z.
    pub until_unix_s: i64,
}
