//! What a file holds.

use crate::Finding;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a message's channel is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Its number in the file.
    pub id: u16,
    /// Its name: a key of the contract, or another program's.
    pub topic: String,
    /// How its messages are encoded: `json`, `cbor`, `protobuf`, …
    pub encoding: String,
    /// Name of their schema; empty without one.
    pub schema: String,
    /// How the schema is written: `jsonschema`, …
    pub schema_encoding: String,
    /// The schema itself.
    pub schema_data: Arc<[u8]>,
    /// What else is said about it.
    pub metadata: BTreeMap<String, String>,
    /// Messages that were read.
    pub messages: u64,
}

/// A message, as it stands in the file.
#[derive(Debug, Clone, Copy)]
pub struct Message<'a> {
    /// Its channel, as far as it is known by then.
    pub channel: &'a Channel,
    /// Its number on the channel.
    pub sequence: u32,
    /// When it was recorded, nanoseconds since 1970.
    pub log_ns: u64,
    /// When it was published, nanoseconds since 1970.
    pub publish_ns: u64,
    /// Its payload.
    pub data: &'a [u8],
}

/// Something that is attached to a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its size, bytes.
    pub bytes: u64,
}

/// How a file ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// As it should: what tools with an index need is there.
    Finished,
    /// Its writer died, or is still writing.
    Torn {
        /// Bytes from the beginning that are whole records.
        good_bytes: u64,
    },
    /// It is no MCAP file.
    Foreign,
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents {
    /// What kind of recording it says to be.
    pub profile: String,
    /// Which program wrote it.
    pub library: String,
    /// By number.
    pub channels: BTreeMap<u16, Channel>,
    /// Named lists of texts.
    pub metadata: Vec<(String, BTreeMap<String, String>)>,
    /// Attachments, without what is in them.
    pub attachments: Vec<Attachment>,
    /// Messages that were read.
    pub messages: u64,
    /// Earliest and latest time of recording, nanoseconds since 1970.
    pub span_ns: Option<(u64, u64)>,
    /// Chunks that were read.
    pub chunks: u64,
    /// The file's size, bytes.
    pub bytes: u64,
    /// How it ends.
    pub ending: Ending,
    /// What is wrong with it, in the order of the file.
    pub findings: Vec<Finding>,
    /// More findings than are listed.
    pub more_findings: u64,
}

impl Contents {
    /// Of a file that nothing was read of yet.
    pub(super) fn new() -> Self {
        Self {
            profile: String::new(),
            library: String::new(),
            channels: BTreeMap::new(),
            metadata: Vec::new(),
            attachments: Vec::new(),
            messages: 0,
            span_ns: None,
            chunks: 0,
            bytes: 0,
            ending: Ending::Foreign,
            findings: Vec::new(),
            more_findings: 0,
        }
    }
}
