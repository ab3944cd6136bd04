//! Records of an MCAP file as bytes. Numbers are little-endian, texts and lists are behind their length in bytes.
//! Source: the specification at mcap.dev/spec.
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::collections::BTreeMap;

/// First and last bytes of every file.
pub const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n'];
/// Bytes before a record's content: opcode and length.
pub const HEAD_BYTES: usize = 9;

/// Bytes that every finished file ends with: its footer and the magic.
pub const END_BYTES: u64 = (HEAD_BYTES + 20 + MAGIC.len()) as u64;

/// The last [`END_BYTES`] of a file are those of a finished one.
pub fn is_end(bytes: &[u8]) -> bool {
    bytes.len() as u64 == END_BYTES && bytes.first() == Some(&op::FOOTER) && bytes.ends_with(&MAGIC)
}

/// The kinds of records that are read.
pub mod op {
    pub const HEADER: u8 = 0x01;
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const ATTACHMENT: u8 = 0x09;
    pub const STATISTICS: u8 = 0x0b;
    pub const METADATA: u8 = 0x0c;
    pub const DATA_END: u8 = 0x0f;
    /// The last kind that the specification knows.
    pub const LAST: u8 = 0x0f;
    /// From here on kinds are private: to be skipped.
    pub const PRIVATE: u8 = 0x80;
}

/// The content of a record that hasn't been read yet.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a>(pub &'a [u8]);

impl<'a> Content<'a> {
    pub fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    pub fn u8(&mut self) -> Option<u8> {
        self.array::<1>().map(|[byte]| byte)
    }

    pub fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Bytes behind a length of four.
    pub fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = usize::try_from(self.u32()?).ok()?;
        self.take(length)
    }

    /// Bytes behind a length of eight.
    pub fn long_bytes(&mut self) -> Option<&'a [u8]> {
        let length = usize::try_from(self.u64()?).ok()?;
        self.take(length)
    }

    pub fn text(&mut self) -> Option<&'a str> {
        std::str::from_utf8(self.bytes()?).ok()
    }

    pub fn texts(&mut self) -> Option<BTreeMap<String, String>> {
        let mut inner = Content(self.bytes()?);
        let mut texts = BTreeMap::new();
        while !inner.0.is_empty() {
            texts.insert(inner.text()?.to_owned(), inner.text()?.to_owned());
        }
        Some(texts)
    }

    /// The next record of a chunk: its kind and its content.
    pub fn record(&mut self) -> Option<(u8, Content<'a>)> {
        let opcode = self.u8()?;
        Some((opcode, Content(self.long_bytes()?)))
    }
}
