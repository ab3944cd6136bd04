//! What the recorder is told, and what it wants done.

use crate::{Frame, Level};
use std::fmt;
use std::time::Duration;

/// How it records.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// The vehicle's name: part of files' and channels' names.
    pub vehicle: String,
    /// What is said about the recording in each file: name and value.
    pub about: Vec<(String, String)>,
    /// A file is ended when it is so large, bytes.
    pub file_bytes: u64,
    /// A chunk is closed when its first message is so old: what is not in a closed chunk is lost in a crash.
    pub chunk_age: Duration,
    /// A chunk is closed when its messages have so many bytes.
    pub chunk_bytes: usize,
    /// Larger messages are not recorded, bytes.
    pub message_bytes: usize,
    /// Path and plan are drawn again so often, for those who open the file in its middle.
    pub map_every: Duration,
}

impl Config {
    /// The usual one: files of 64 MiB, chunks of 50 ms.
    pub fn new(vehicle: &str) -> Self {
        Self {
            vehicle: vehicle.into(),
            about: Vec::new(),
            file_bytes: 64 << 20,
            chunk_age: Duration::from_millis(50),
            chunk_bytes: 256 << 10,
            message_bytes: 16 << 20,
            map_every: Duration::from_secs(60),
        }
    }
}

/// How the payloads of a key are built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema {
    /// The key, of any vehicle.
    pub key: String,
    /// What the schema is called.
    pub name: String,
    /// JSON Schema.
    pub text: Vec<u8>,
}

/// What happens to the recorder.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// The time of day, since 1970: first of all, then now and then.
    Clock(Duration),
    /// How the payloads of a key are built: before the first of them.
    Schema(Schema),
    /// Something was said.
    Frame(Frame),
    /// Something was said that every file has to know: the latest of its key stands at the beginning of each.
    Document(Frame),
    /// The plan as a drawing: a GeoJSON document.
    Plan(String),
    /// A line for the log, from the recorder's own process.
    Line {
        /// How much it matters.
        level: Level,
        /// What.
        message: String,
    },
    /// Frames were lost before they came here.
    Missed {
        /// So many.
        count: u64,
        /// Why.
        why: &'static str,
    },
    /// What was put out last could not be done; nothing behind it was.
    Failed {
        /// Why.
        why: String,
        /// The name of the file to begin is taken: another one will do.
        is_taken: bool,
    },
    /// Time has passed.
    Wake,
    /// The recording is over.
    Close,
}

/// What the disk has to do, in this order.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// Begin a file; one of this name must not be there yet.
    Begin {
        /// Its name.
        name: String,
    },
    /// Append to the file, and see to it that it is on the disk.
    Append {
        /// What.
        bytes: Vec<u8>,
    },
    /// Close the file.
    Finish,
    /// Tell somebody.
    Tell(Report),
}

/// What somebody should know. It stands in the recording's log, too.
#[derive(Debug, Clone, PartialEq)]
pub enum Report {
    /// Messages are not in the recording.
    Missed {
        /// So many.
        count: u64,
        /// Why: the latest reason.
        why: String,
    },
    /// Nothing can be written.
    Failed {
        /// Why.
        why: String,
    },
    /// It can be written again.
    Recovered {
        /// Messages that were not recorded meanwhile.
        missed: u64,
    },
    /// The time of day was changed; a new file has the new one.
    ClockJumped {
        /// By so many seconds.
        by_s: f64,
    },
}

impl Report {
    /// How much it matters.
    pub fn level(&self) -> Level {
        match self {
            Self::Failed { .. } => Level::Error,
            Self::Missed { .. } | Self::ClockJumped { .. } => Level::Warning,
            Self::Recovered { .. } => Level::Info,
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missed { count, why } => write!(f, "{count} messages were not recorded: {why}"),
            Self::Failed { why } => write!(f, "recording has stopped: {why}"),
            Self::Recovered { missed } => {
                write!(f, "recording goes on; {missed} messages were not recorded meanwhile")
            }
            Self::ClockJumped { by_s } => write!(f, "the machine's clock was set by {by_s:+.1} s"),
        }
    }
}

/// How the recording goes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Status {
    /// The file that is being written.
    pub file: Option<String>,
    /// Its bytes, without the chunk that is open.
    pub file_bytes: u64,
    /// Messages recorded since the start, of all files.
    pub messages: u64,
    /// Messages that were not recorded.
    pub missed: u64,
    /// Why nothing can be written now.
    pub failure: Option<String>,
}
