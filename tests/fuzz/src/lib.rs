//! What the fuzzer drives: one function a target, from any bytes to a panic or none. The fuzzer's executables and the
//! replay of the corpus call the very same ones.
//!
//! Besides "no panic", each target asserts what must hold whatever the bytes are; hangs and memory are the fuzzer's to
//! bound (`run`).
#![expect(clippy::unwrap_used, reason = "a target fails by panicking")]

mod condition;
mod document;
mod executor;
mod foreign;
mod journal;
mod plans;
mod recording;

pub use condition::cel;
pub use document::xml;
pub use executor::executor;
pub use foreign::{fpxml, geojson, gpx, kml, kmz, plan, waypoints};
pub use journal::journal;
pub use recording::recording;

/// A target: the name of its executable and of its folders, and what it does with bytes.
pub type Target = (&'static str, fn(&[u8]));

/// Every target.
pub const TARGETS: [Target; 12] = [
    ("xml", xml),
    ("cel", cel),
    ("plan", plan),
    ("waypoints", waypoints),
    ("kml", kml),
    ("kmz", kmz),
    ("geojson", geojson),
    ("fpxml", fpxml),
    ("gpx", gpx),
    ("journal", journal),
    ("recording", recording),
    ("executor", executor),
];
