//! Pure: the flight recorder. What is said on the network in, bytes of MCAP files out; bytes of such a file in, what it
//! holds out. Sockets, clocks and disks are the shell's (`onboard-agent`, `services/storage`).
//!
//! # What is written
//!
//! [`Recorder`] takes [`Frame`]s (a key, a time, a payload) and puts out what the disk has to do. A file is a sequence of
//! small chunks: a chunk is closed when its first message is [`Config::chunk_age`] old or when it is large, so a process that
//! dies loses no more. Chunks are not compressed: no C code is needed, and a chunk that was written is a chunk that can be read.
//!
//! | channel | messages |
//! |---|---|
//! | `legwork/<vehicle>/<service>/<kind>/<name>` | the payload as JSON, with the contract's JSON Schema where it is known |
//! | `foxglove/<vehicle>/location` | `foxglove.LocationFix`, from the gateway's `position` |
//! | `foxglove/<vehicle>/path` | `foxglove.GeoJSON`: the path flown so far, every minute |
//! | `foxglove/<vehicle>/plan` | `foxglove.GeoJSON`: the plan, at each change and every minute |
//! | `foxglove/<vehicle>/log` | `foxglove.Log`: what the recorder and other services tell |
//!
//! # What is read
//!
//! [`scan`] reads any MCAP file from its beginning to its end, whatever its bytes are: it neither panics nor allocates more
//! than the file's own size and fixed limits allow. What is wrong is a [`Finding`] with its byte offset; everything else is
//! given. [`repair`] writes what a torn file holds as a whole one.

mod bytes;
mod file;
mod finding;
mod foxglove;
mod frame;
mod json;
mod names;
mod path;
mod recorder;
mod repair;
mod retention;
mod scan;

pub use bytes::{END_BYTES, is_end};
pub use finding::{Damage, Finding};
pub use foxglove::Level;
pub use frame::{Frame, Payload};
pub use json::from_cbor;
pub use names::{file_name, is_recording, stem};
pub use recorder::{Config, Input, Output, Recorder, Report, Schema, Status};
pub use repair::repair;
pub use retention::{Limits, Room, Stored, excess};
pub use scan::{Attachment, Channel, Contents, Ending, Message, scan};
