//! What the flight recorder tells of itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Storage variable `recording`: how the recording goes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Recording {
    /// Name of the file that is being written; `None`: none is.
    pub file: Option<String>,
    /// Its size, bytes.
    pub file_bytes: u64,
    /// Messages recorded since the start.
    pub messages: u64,
    /// Messages that were not recorded.
    pub missed: u64,
    /// Why nothing can be written now.
    pub failure: Option<String>,
    /// The longest time that the disk took to have a chunk safe, milliseconds.
    pub longest_sync_ms: u64,
}
