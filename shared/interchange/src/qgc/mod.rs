//! QGroundControl's `.plan`: JSON with mission, fences and rally points.
//! Source: the QGC developer guide, "Plan File Format"; patterns as QGC 4 saves them.

mod camera;
mod fence;
mod json;
mod old;
mod order;
mod pattern;
mod read;
mod way;
mod write;

pub use read::{bounded_json, read};
pub use write::write;
