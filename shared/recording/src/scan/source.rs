//! The bytes of a file, with their place and their checksum.

use std::io::{self, Read};

/// The bytes, read once.
pub struct Source<R> {
    inner: R,
    /// Bytes read so far.
    pub offset: u64,
    /// Over all of them.
    pub hasher: crc32fast::Hasher,
    /// What was read last.
    pub body: Vec<u8>,
}

impl<R: Read> Source<R> {
    /// At its beginning.
    pub fn new(inner: R) -> Self {
        Self { inner, offset: 0, hasher: crc32fast::Hasher::new(), body: Vec::new() }
    }

    /// The next bytes, fewer at the end of the file. Memory grows with what is there, not with what is asked for.
    pub fn next(&mut self, length: u64) -> io::Result<&[u8]> {
        self.body.clear();
        let read = self.inner.by_ref().take(length).read_to_end(&mut self.body)?;
        self.offset += read as u64;
        self.hasher.update(&self.body);
        Ok(&self.body)
    }

    /// Passes over bytes; gives how many there were.
    pub fn skip(&mut self, length: u64) -> io::Result<u64> {
        let mut sink = Hashing(&mut self.hasher);
        let skipped = io::copy(&mut self.inner.by_ref().take(length), &mut sink)?;
        self.offset += skipped;
        Ok(skipped)
    }
}

struct Hashing<'a>(&'a mut crc32fast::Hasher);

impl io::Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
