//! What every service uses.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value with the time at which it was true and how long it may be believed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stamped<T> {
    /// Source time, seconds since the source's start (simulated time in simulation).
    pub time_s: f64,
    /// Seconds after `time_s` at which the value has expired.
    pub validity_s: f64,
    /// The value.
    pub value: T,
}

/// A request or an answer that says nothing more; an absent payload counts as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Empty {}

/// Why a command was refused; the sentence says what to do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, thiserror::Error)]
#[error("{code}: {reason}")]
pub struct Refusal {
    /// Short, stable, for programs: `no-plan`, `unknown-leg`, `stale-revision`, …
    pub code: String,
    /// For people.
    pub reason: String,
}

/// What a file consists of: answer at its key, and variable `file.<name>` of its service.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FileManifest {
    /// Bytes of the whole file, at most 64 MiB.
    pub size_bytes: u64,
    /// Bytes of each chunk; the last one may be shorter.
    pub chunk_bytes: u32,
    /// Number of chunks; an empty file has none.
    pub chunks: u32,
    /// Hex SHA-256 of the whole file.
    pub sha256: String,
}
