//! Pure: geodesy on WGS84, local frames, turns, arcs, holdings, polygons, scans and the other patterns.
//!
//! Knows nothing of plans or autopilots. Angles are radians inside formulas and degrees at the
//! edges; the unit is always in the name.

pub mod arc;
pub mod holding;
pub mod intercept;
pub mod local;
pub mod near;
pub mod path;
pub mod pattern;
mod plane;
pub mod polygon;
pub mod scan;
#[cfg(test)]
mod testing;
pub mod turn;
pub mod zone;

pub use ::geodesy::{self, LatLon};
pub use arc::Flattening;
pub use local::{LocalFrame, Vec2};
pub use path::PathElement;
pub use pattern::Pattern;
pub use polygon::Polygon;
pub use turn::Turn;
