//! A torn file, written again as a whole one.
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use crate::{Channel, Contents, Ending, scan};
use mcap::write::NoSeek;
use mcap::{McapError, WriteOptions, Writer, records::MessageHeader};
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Read, Write};

/// Writes everything that can be read of `torn` to `whole`, with index and summary; says what `torn` held.
///
/// # Errors
/// One of both can't be read or written.
pub fn repair(torn: impl Read, whole: impl Write) -> io::Result<Contents> {
    let writer = WriteOptions::new().profile("legwork").compression(None).disable_seeking(true);
    let mut copy = Copy { writer: writer.create(NoSeek::new(whole)).map_err(broken)?, ids: HashMap::new() };
    let mut outcome = Ok(());
    let contents = scan(torn, &mut |message| {
        if outcome.is_ok() {
            outcome = copy.message(message);
        }
    })?;
    outcome.and_then(|()| copy.end(&contents)).map_err(broken)?;
    Ok(contents)
}

struct Copy<W: Write> {
    writer: Writer<NoSeek<W>>,
    /// The new numbers of channels.
    ids: HashMap<u16, u16>,
}

impl<W: Write> Copy<W> {
    fn message(&mut self, message: &crate::Message<'_>) -> Result<(), McapError> {
        let channel_id = match self.ids.get(&message.channel.id) {
            Some(id) => *id,
            None => self.introduce(message.channel)?,
        };
        let header = MessageHeader {
            channel_id,
            sequence: message.sequence,
            log_time: message.log_ns,
            publish_time: message.publish_ns,
        };
        self.writer.write_to_known_channel(&header, message.data)
    }

    fn introduce(&mut self, channel: &Channel) -> Result<u16, McapError> {
        let schema = match channel.schema.as_str() {
            "" => 0,
            name => self.writer.add_schema(name, &channel.schema_encoding, &channel.schema_data)?,
        };
        let id = self.writer.add_channel(schema, &channel.topic, &channel.encoding, &channel.metadata)?;
        self.ids.insert(channel.id, id);
        Ok(id)
    }

    fn end(&mut self, contents: &Contents) -> Result<(), McapError> {
        for (name, metadata) in &contents.metadata {
            let (name, metadata) = (name.clone(), metadata.clone());
            self.writer.write_metadata(&mcap::records::Metadata { name, metadata })?;
        }
        if let Ending::Torn { good_bytes } = contents.ending {
            let lost = contents.bytes.saturating_sub(good_bytes);
            let metadata: BTreeMap<String, String> = [("torn_at_byte", good_bytes), ("bytes_lost", lost)]
                .map(|(k, v)| (k.into(), v.to_string()))
                .into();
            self.writer
                .write_metadata(&mcap::records::Metadata { name: "legwork.recovered".into(), metadata })?;
        }
        self.writer.finish().map(|_| ())
    }
}

fn broken(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
