//! Reads a file from its beginning to its end.
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod contents;
mod source;

use crate::bytes::{Content, HEAD_BYTES, MAGIC, op};
use crate::{Damage, Finding};
pub use contents::{Attachment, Channel, Contents, Ending, Message};
use source::Source;
use std::collections::HashMap;
use std::io::{self, Read};
use std::sync::Arc;

/// Longer records are left out, bytes.
const RECORD_MAX: u64 = 256 << 20;
/// Findings that are listed; the others are counted.
const FINDINGS_MAX: usize = 100;
/// Metadata and attachments that are listed.
const LISTED_MAX: usize = 1000;
/// Longest name of a channel, schema, encoding or attachment, bytes.
const NAME_MAX: usize = 64 << 10;
/// Schemas, metadata and names of a file that are held in memory, bytes.
const HELD_MAX: usize = 64 << 20;

/// Reads a file and calls `each` with every message that can be read, in the order of the file.
///
/// # Errors
/// The source can't be read. What the bytes are is no error: see [`Contents::findings`].
pub fn scan(source: impl Read, each: &mut dyn FnMut(&Message<'_>)) -> io::Result<Contents> {
    let mut scanner = Scanner::new(each);
    let mut source = Source::new(source);
    scanner.file(&mut source)?;
    scanner.contents.bytes = source.offset;
    Ok(scanner.contents)
}

#[derive(Clone)]
struct Schema {
    name: String,
    encoding: String,
    data: Arc<[u8]>,
}

/// Where in the file it is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Data,
    Summary,
    End,
}

struct Scanner<'a> {
    each: &'a mut dyn FnMut(&Message<'_>),
    contents: Contents,
    schemas: HashMap<u16, Schema>,
    held: usize,
    section: Section,
    /// Where the record that is looked at begins.
    at: u64,
}

impl<'a> Scanner<'a> {
    fn new(each: &'a mut dyn FnMut(&Message<'_>)) -> Self {
        let contents = Contents::new();
        Self { each, contents, schemas: HashMap::new(), held: 0, section: Section::Data, at: 0 }
    }

    fn find(&mut self, damage: Damage) {
        // compressed chunks are as many as there are chunks: one tells enough
        let known = |f: &Finding| matches!((&f.damage, &damage), (Damage::Compressed { with: a }, Damage::Compressed { with: b }) if a == b);
        if self.contents.findings.len() < FINDINGS_MAX && !self.contents.findings.iter().any(known) {
            self.contents.findings.push(Finding { offset: self.at, damage });
        } else {
            self.contents.more_findings += 1;
        }
    }

    /// The content of a record that is none.
    fn malformed(&mut self, what: &'static str) {
        self.find(Damage::Malformed { what });
    }

    fn file(&mut self, source: &mut Source<impl Read>) -> io::Result<()> {
        if source.next(MAGIC.len() as u64)? != MAGIC {
            self.find(Damage::Foreign);
            return Ok(());
        }
        while self.section != Section::End {
            self.at = source.offset;
            if self.section == Section::Data {
                self.contents.ending = Ending::Torn { good_bytes: self.at };
            }
            if !self.record(source)? {
                return Ok(());
            }
        }
        self.end(source)
    }

    /// One record; `false` if nothing behind it can be read.
    fn record(&mut self, source: &mut Source<impl Read>) -> io::Result<bool> {
        let before = source.hasher.clone();
        let head = source.next(HEAD_BYTES as u64)?;
        let (had, mut head) = (head.len() as u64, Content(head));
        let (Some(opcode), Some(length)) = (head.u8(), head.u64()) else {
            self.find(if had == 0 { Damage::Unfinished } else { Damage::Torn { bytes: had } });
            return Ok(false);
        };
        if opcode == 0 || (op::LAST + 1..op::PRIVATE).contains(&opcode) {
            self.find(Damage::NoRecord { opcode });
            return Ok(false);
        }
        let too_long = length > RECORD_MAX;
        let read = if too_long { source.skip(length)? } else { source.next(length)?.len() as u64 };
        if read < length {
            self.find(Damage::Torn { bytes: had + read });
            return Ok(false);
        }
        if too_long {
            self.find(Damage::TooLong { bytes: length });
            return Ok(true);
        }
        if opcode == op::DATA_END {
            self.data_end(Content(&source.body), before.finalize());
        } else {
            self.content(opcode, Content(&source.body));
        }
        Ok(true)
    }

    fn content(&mut self, opcode: u8, content: Content<'_>) {
        let read = match (self.section, opcode) {
            (_, op::FOOTER) => {
                self.section = Section::End;
                Some(())
            }
            (Section::Summary, op::STATISTICS) => self.statistics(content),
            // the summary repeats what the data have told
            (Section::Summary | Section::End, _) => Some(()),
            (Section::Data, op::HEADER) => self.header(content),
            (Section::Data, op::CHUNK) => self.chunk(content),
            (Section::Data, op::METADATA) => self.metadata(content),
            (Section::Data, op::ATTACHMENT) => self.attachment(content),
            (Section::Data, _) => return self.datum(opcode, content),
        };
        if read.is_none() {
            self.malformed(name(opcode));
        }
    }

    /// What stands in chunks and outside of them.
    fn datum(&mut self, opcode: u8, content: Content<'_>) {
        let read = match opcode {
            op::SCHEMA => self.schema(content),
            op::CHANNEL => self.channel(content),
            op::MESSAGE => self.message(content),
            _ => Some(()),
        };
        if read.is_none() {
            self.malformed(name(opcode));
        }
    }

    fn header(&mut self, mut content: Content<'_>) -> Option<()> {
        let (profile, library) = (content.text()?, content.text()?);
        (self.contents.profile, self.contents.library) = (self.held(profile)?, self.held(library)?);
        Some(())
    }

    fn chunk(&mut self, mut content: Content<'_>) -> Option<()> {
        let (_start, _end, size, crc) = (content.u64()?, content.u64()?, content.u64()?, content.u32()?);
        let compression = content.text()?;
        let records = content.long_bytes()?;
        if !compression.is_empty() {
            let with = compression.chars().take(20).collect();
            self.find(Damage::Compressed { with });
            return Some(());
        }
        if crc != 0 && crc != crc32fast::hash(records) {
            self.find(Damage::Checksum { what: "chunk, which is left out," });
            return Some(());
        }
        if size != records.len() as u64 {
            self.malformed("chunk");
        }
        self.contents.chunks += 1;
        let mut records = Content(records);
        while !records.0.is_empty() {
            let (opcode, content) = records.record()?;
            self.datum(opcode, content);
        }
        Some(())
    }

    fn schema(&mut self, mut content: Content<'_>) -> Option<()> {
        let id = content.u16()?;
        let (name, encoding, data) = (content.text()?, content.text()?, content.bytes()?);
        if let Some(known) = self.schemas.get(&id) {
            if (known.name.as_str(), known.encoding.as_str(), &*known.data) != (name, encoding, data) {
                self.find(Damage::Redefined { what: "schema", id });
            }
            return Some(());
        }
        let (name, encoding) = (self.held(name)?, self.held(encoding)?);
        if !self.hold(data.len()) {
            return Some(());
        }
        self.schemas.insert(id, Schema { name, encoding, data: data.into() });
        Some(())
    }

    fn channel(&mut self, mut content: Content<'_>) -> Option<()> {
        let (id, schema_id) = (content.u16()?, content.u16()?);
        let (topic, encoding) = (content.text()?, content.text()?);
        let metadata = content.texts()?;
        if let Some(known) = self.contents.channels.get(&id) {
            if (known.topic.as_str(), known.encoding.as_str()) != (topic, encoding) {
                self.find(Damage::Redefined { what: "channel", id });
            }
            return Some(());
        }
        let none = || Schema { name: String::new(), encoding: String::new(), data: Arc::default() };
        let schema = self.schemas.get(&schema_id).cloned();
        if schema_id != 0 && schema.is_none() {
            self.find(Damage::Unknown { what: "schema", id: schema_id });
        }
        let schema = schema.unwrap_or_else(none);
        let (topic, encoding) = (self.held(topic)?, self.held(encoding)?);
        if !self.hold(metadata.iter().map(|(k, v)| k.len() + v.len()).sum()) {
            return Some(());
        }
        let channel = Channel {
            id,
            topic,
            encoding,
            schema: schema.name,
            schema_encoding: schema.encoding,
            schema_data: schema.data,
            metadata,
            messages: 0,
        };
        self.contents.channels.insert(id, channel);
        Some(())
    }

    fn message(&mut self, mut content: Content<'_>) -> Option<()> {
        let (id, sequence) = (content.u16()?, content.u32()?);
        let (log_ns, publish_ns) = (content.u64()?, content.u64()?);
        let Some(channel) = self.contents.channels.get_mut(&id) else {
            self.find(Damage::Unknown { what: "channel", id });
            return Some(());
        };
        channel.messages += 1;
        self.contents.messages += 1;
        let (first, last) = self.contents.span_ns.unwrap_or((log_ns, log_ns));
        self.contents.span_ns = Some((first.min(log_ns), last.max(log_ns)));
        (self.each)(&Message { channel, sequence, log_ns, publish_ns, data: content.0 });
        Some(())
    }

    fn metadata(&mut self, mut content: Content<'_>) -> Option<()> {
        let (name, texts) = (content.text()?, content.texts()?);
        let bytes = texts.iter().map(|(k, v)| k.len() + v.len()).sum();
        let name = self.held(name)?;
        if self.contents.metadata.len() >= LISTED_MAX {
            self.find(Damage::TooMany { what: "metadata" });
        } else if self.hold(bytes) {
            self.contents.metadata.push((name, texts));
        }
        Some(())
    }

    fn attachment(&mut self, content: Content<'_>) -> Option<()> {
        let whole = content.0;
        let mut content = content;
        let (_log, _created) = (content.u64()?, content.u64()?);
        let (name, media_type) = (content.text()?, content.text()?);
        let bytes = content.long_bytes()?.len() as u64;
        let covered = whole.get(..whole.len() - content.0.len())?;
        let crc = content.u32()?;
        if crc != 0 && crc != crc32fast::hash(covered) {
            self.find(Damage::Checksum { what: "attachment" });
        }
        let (name, media_type) = (self.held(name)?, self.held(media_type)?);
        if self.contents.attachments.len() >= LISTED_MAX {
            self.find(Damage::TooMany { what: "attachments" });
        } else {
            self.contents.attachments.push(Attachment { name, media_type, bytes });
        }
        Some(())
    }

    fn data_end(&mut self, mut content: Content<'_>, crc: u32) {
        match content.u32() {
            None => self.malformed(name(op::DATA_END)),
            Some(told) if told != 0 && told != crc => self.find(Damage::Checksum { what: "data" }),
            Some(_) => {}
        }
        if self.section == Section::Data {
            self.section = Section::Summary;
        }
    }

    fn statistics(&mut self, mut content: Content<'_>) -> Option<()> {
        let (told, read) = (content.u64()?, self.contents.messages);
        if told != read {
            self.find(Damage::Count { told, read });
        }
        Some(())
    }

    /// Behind the footer there is the magic, and nothing else.
    fn end(&mut self, source: &mut Source<impl Read>) -> io::Result<()> {
        self.at = source.offset;
        let magic = source.next(MAGIC.len() as u64)?;
        if magic != MAGIC {
            let bytes = magic.len() as u64;
            self.find(Damage::Torn { bytes });
            return Ok(());
        }
        self.contents.ending = Ending::Finished;
        self.at = source.offset;
        if source.skip(u64::MAX)? > 0 {
            self.find(Damage::Behind);
        }
        Ok(())
    }

    /// A name, if it is no longer than a name may be.
    fn held(&mut self, text: &str) -> Option<String> {
        (text.len() <= NAME_MAX && self.hold(text.len())).then(|| text.to_owned())
    }

    /// Whether so many bytes more may be held in memory.
    fn hold(&mut self, bytes: usize) -> bool {
        let fits = self.held.saturating_add(bytes) <= HELD_MAX;
        if fits {
            self.held += bytes;
        } else {
            self.find(Damage::TooMany { what: "names, schemas and metadata" });
        }
        fits
    }
}

fn name(opcode: u8) -> &'static str {
    match opcode {
        op::HEADER => "header",
        op::SCHEMA => "schema",
        op::CHANNEL => "channel",
        op::MESSAGE => "message",
        op::CHUNK => "chunk",
        op::ATTACHMENT => "attachment",
        op::STATISTICS => "summary's count",
        op::METADATA => "metadata record",
        op::DATA_END => "mark of the data's end",
        _ => "record",
    }
}
