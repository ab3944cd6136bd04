//! What comes in to be recorded.

use std::time::Duration;

/// Something that was said.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// The channel: a key of the contract.
    pub key: String,
    /// When, on the clock of the flight: since the recorder's start, or simulated time.
    pub at: Duration,
    /// What.
    pub payload: Payload,
}

/// A payload as it came over the network.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Payload {
    /// RFC 8949.
    Cbor(Vec<u8>),
    /// RFC 8259.
    Json(Vec<u8>),
}

impl Payload {
    /// Bytes as they came.
    pub fn len(&self) -> usize {
        match self {
            Self::Cbor(bytes) | Self::Json(bytes) => bytes.len(),
        }
    }

    /// There are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
