//! The file system as the journal uses it: a trait, so that its faults are tests.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::PathBuf;

/// A folder of the journal's own files. What was written survives this process; what was synced survives
/// a loss of power, names by [`Storage::sync_names`].
pub trait Storage {
    /// Names of the files.
    ///
    /// # Errors
    /// The folder can't be read.
    fn names(&mut self) -> io::Result<Vec<String>>;

    /// A file's content.
    ///
    /// # Errors
    /// It can't be read, or is longer than `at_most` bytes.
    fn read(&mut self, name: &str, at_most: u64) -> io::Result<Vec<u8>>;

    /// Makes an empty file, in place of an older one of that name; appends and syncs go to it.
    ///
    /// # Errors
    /// It can't be made.
    fn create(&mut self, name: &str) -> io::Result<()>;

    /// Appends to a file.
    ///
    /// # Errors
    /// Not everything could be written: a part of it may have been.
    fn append(&mut self, name: &str, bytes: &[u8]) -> io::Result<()>;

    /// Has a file's content on the disk.
    ///
    /// # Errors
    /// It may not be there, and a later success would not say that it is.
    fn sync(&mut self, name: &str) -> io::Result<()>;

    /// Gives a file another name, in place of an older one of that name, at once or not at all.
    ///
    /// # Errors
    /// It has the old name.
    fn rename(&mut self, from: &str, to: &str) -> io::Result<()>;

    /// Has the names on the disk.
    ///
    /// # Errors
    /// They may not be there.
    fn sync_names(&mut self) -> io::Result<()>;

    /// Removes a file.
    ///
    /// # Errors
    /// It is still there.
    fn remove(&mut self, name: &str) -> io::Result<()>;
}

/// A folder on the disk, made when it is first written to.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// The file appended to last.
    open: Option<(String, File)>,
}

impl Folder {
    /// At a path.
    pub fn new(path: PathBuf) -> Self {
        Self { path, open: None }
    }

    fn file(&mut self, name: &str) -> io::Result<&mut File> {
        let open = match self.open.take() {
            Some((open, file)) if open == name => (open, file),
            _ => (name.to_owned(), OpenOptions::new().append(true).open(self.path.join(name))?),
        };
        Ok(&mut self.open.insert(open).1)
    }
}

impl Storage for Folder {
    fn names(&mut self) -> io::Result<Vec<String>> {
        let entries = match fs::read_dir(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let names = entries.map(|entry| Ok(entry?.file_name().into_string().ok()));
        names.filter_map(Result::transpose).collect()
    }

    fn read(&mut self, name: &str, at_most: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        File::open(self.path.join(name))?.take(at_most + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > at_most {
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, "it is larger than any of ours"));
        }
        Ok(bytes)
    }

    fn create(&mut self, name: &str) -> io::Result<()> {
        fs::create_dir_all(&self.path)?;
        let file = File::create(self.path.join(name))?;
        self.open = Some((name.to_owned(), file));
        Ok(())
    }

    fn append(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.file(name)?.write_all(bytes)
    }

    fn sync(&mut self, name: &str) -> io::Result<()> {
        self.file(name)?.sync_data()
    }

    fn rename(&mut self, from: &str, to: &str) -> io::Result<()> {
        fs::rename(self.path.join(from), self.path.join(to))?;
        if let Some((open, _)) = self.open.as_mut().filter(|(open, _)| open == from) {
            *open = to.to_owned();
        }
        Ok(())
    }

    fn sync_names(&mut self) -> io::Result<()> {
        File::open(&self.path)?.sync_all()
    }

    fn remove(&mut self, name: &str) -> io::Result<()> {
        fs::remove_file(self.path.join(name))
    }
}
