//! One MCAP file, as the bytes that are to be appended to it.
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use mcap::write::NoSeek;
use mcap::{WriteOptions, Writer, records::MessageHeader};
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Channels of a file; more are not taken in.
const CHANNELS_MAX: usize = 4096;

/// Why a message is not in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refused {
    TooManyChannels,
    Writer(String),
}

/// A schema's name and its text.
pub type Schema<'a> = (&'a str, Cow<'a, [u8]>);

/// A channel as it is to be introduced, with the schema that it has then.
#[derive(Clone, Copy)]
pub struct Channel<'a> {
    pub topic: &'a str,
    pub schema: &'a dyn Fn() -> Option<Schema<'a>>,
}

/// A file that is being written.
pub struct File {
    writer: Writer<NoSeek<Outbox>>,
    outbox: Outbox,
    channels: HashMap<String, (u16, u32)>,
    /// Bytes that were given out.
    bytes: u64,
    chunk: Chunk,
}

/// The chunk that is open.
#[derive(Debug, Clone, Copy, Default)]
pub struct Chunk {
    /// When its first message came, by the recorder's clock.
    pub since: Option<Duration>,
    /// Bytes of its messages.
    pub bytes: usize,
    /// Its messages.
    pub messages: u64,
}

impl File {
    /// A file that begins with what is said `about` it.
    pub fn new(about: BTreeMap<String, String>) -> Result<Self, Refused> {
        let outbox = Outbox::default();
        let options = WriteOptions::new()
            .profile("legwork")
            .compression(None)
            // when a chunk is closed is decided by its age
            .chunk_size(None)
            .disable_seeking(true);
        let mut writer = options.create(NoSeek::new(outbox.clone())).map_err(told)?;
        writer
            .write_metadata(&mcap::records::Metadata { name: "legwork".into(), metadata: about })
            .map_err(told)?;
        Ok(Self { writer, outbox, channels: HashMap::new(), bytes: 0, chunk: Chunk::default() })
    }

    /// Takes a message into the open chunk. `log`: since 1970.
    pub fn write(
        &mut self,
        now: Duration,
        channel: Channel<'_>,
        log: Duration,
        data: &[u8],
    ) -> Result<(), Refused> {
        let (channel_id, sequence) = self.channel(channel)?;
        let log_time = u64::try_from(log.as_nanos()).unwrap_or(u64::MAX);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        self.writer.write_to_known_channel(&header, data).map_err(told)?;
        self.chunk.since.get_or_insert(now);
        self.chunk.bytes += data.len();
        self.chunk.messages += 1;
        Ok(())
    }

    /// Its number, and the message's number on it.
    fn channel(&mut self, channel: Channel<'_>) -> Result<(u16, u32), Refused> {
        if let Some((id, sequence)) = self.channels.get_mut(channel.topic) {
            *sequence = sequence.wrapping_add(1);
            return Ok((*id, *sequence));
        }
        if self.channels.len() >= CHANNELS_MAX {
            return Err(Refused::TooManyChannels);
        }
        let schema = match (channel.schema)() {
            Some((name, text)) => self.writer.add_schema(name, "jsonschema", &text).map_err(told)?,
            None => 0,
        };
        let id = self.writer.add_channel(schema, channel.topic, "json", &BTreeMap::new()).map_err(told)?;
        self.channels.insert(channel.topic.to_owned(), (id, 0));
        Ok((id, 0))
    }

    /// The chunk that is open.
    pub fn chunk(&self) -> Chunk {
        self.chunk
    }

    /// Bytes of the file so far, without the open chunk.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Closes the open chunk; gives what is to be appended.
    pub fn flush(&mut self) -> Result<Vec<u8>, Refused> {
        self.chunk = Chunk::default();
        self.writer.flush().map_err(told)?;
        Ok(self.taken())
    }

    /// Ends the file with its summary; gives what is to be appended.
    pub fn finish(mut self) -> Result<Vec<u8>, Refused> {
        self.writer.finish().map_err(told)?;
        Ok(self.taken())
    }

    fn taken(&mut self) -> Vec<u8> {
        let bytes = self.outbox.take();
        self.bytes += bytes.len() as u64;
        bytes
    }
}

fn told(error: mcap::McapError) -> Refused {
    Refused::Writer(error.to_string())
}

/// Where the library writes to, and we take from.
#[derive(Debug, Clone, Default)]
struct Outbox(Arc<Mutex<Vec<u8>>>);

impl Outbox {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Outbox {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
