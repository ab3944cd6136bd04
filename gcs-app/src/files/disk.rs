//! Where files are read and written: the machine's disk, or in tests a slow or a full one.

use super::saving::{Stamp, write_whole};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Files by their paths. It may be slow: only threads of [`super::Files`] ask it.
pub trait Disk: Send + Sync {
    /// How long a file is, bytes; `None`: what is there is no file.
    ///
    /// # Errors
    /// There is nothing, or it can't be seen.
    fn length(&self, path: &Path) -> io::Result<Option<u64>>;

    /// Opens a file.
    ///
    /// # Errors
    /// It can't be opened.
    fn open(&self, path: &Path) -> io::Result<Box<dyn Read>>;

    /// Writes all of a file in the place of what is there, or nothing; gives its state then.
    ///
    /// # Errors
    /// It can't be written: what was there is as it was.
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<Option<Stamp>> {
        write_whole(path, bytes)
    }
}

/// The machine's own.
#[derive(Debug)]
pub struct Machine;

impl Disk for Machine {
    fn length(&self, path: &Path) -> io::Result<Option<u64>> {
        let meta = std::fs::metadata(path)?;
        Ok(meta.is_file().then_some(meta.len()))
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Read>> {
        Ok(Box::new(File::open(path)?))
    }
}
