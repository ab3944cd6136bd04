//! What survives a crash: files that are whole or absent, written one after the other beside the service's steps.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tokio::task::JoinHandle;

/// An answer waits for the disk so long at most: the flight does not.
const PATIENCE: Duration = Duration::from_millis(500);
/// Pause before a disk that failed is tried again.
const RETRY: Duration = Duration::from_secs(1);

/// A service's folder.
#[derive(Debug)]
pub(crate) struct Folder {
    path: Option<PathBuf>,
    /// Latest content of each file that isn't on the disk yet.
    waiting: BTreeMap<&'static str, Vec<u8>>,
    writing: Option<Writing>,
    /// When the last write failed, or took too long.
    failing: Option<Instant>,
    /// That it fails was told.
    told: bool,
}

#[derive(Debug)]
struct Writing {
    name: &'static str,
    /// Gives the content back with what became of it.
    task: JoinHandle<(Vec<u8>, io::Result<()>)>,
}

impl Folder {
    /// At a path; `None`: nothing is kept.
    pub(crate) fn new(path: Option<PathBuf>) -> Self {
        Self { path, waiting: BTreeMap::new(), writing: None, failing: None, told: false }
    }

    /// Keeps a file soon.
    pub(crate) fn keep(&mut self, name: &'static str, bytes: Vec<u8>) {
        if self.path.is_some() {
            self.waiting.insert(name, bytes);
        }
    }

    /// Goes on with writing; never waits.
    pub(crate) async fn work(&mut self) {
        if self.writing.as_ref().is_some_and(|writing| !writing.task.is_finished()) {
            return;
        }
        self.written().await;
        if self.failing.is_none_or(|since| since.elapsed() >= RETRY) {
            self.begin();
        }
    }

    fn begin(&mut self) {
        let Some(folder) = self.path.clone() else { return };
        if let Some((name, bytes)) = self.waiting.pop_first() {
            let task = tokio::task::spawn_blocking(move || {
                let result = write(&folder, name, &bytes);
                (bytes, result)
            });
            self.writing = Some(Writing { name, task });
        }
    }

    /// Waits for what is being written. May be cancelled.
    async fn written(&mut self) {
        let Some(Writing { name, task }) = &mut self.writing else { return };
        let name = *name;
        let outcome = task.await;
        self.writing = None;
        match outcome {
            Ok((_, Ok(()))) => self.note(Ok(())),
            Ok((bytes, Err(error))) => {
                // unless there is something newer, it is tried again
                self.waiting.entry(name).or_insert(bytes);
                self.note(Err(error));
            }
            Err(error) => self.note(Err(io::Error::other(error))),
        }
    }

    /// Writes everything given so far, and waits for it; what fails is not tried again. May be cancelled.
    pub(crate) async fn finish(&mut self) {
        self.written().await;
        for _ in 0..self.waiting.len() {
            self.begin();
            self.written().await;
        }
    }

    /// The same, but not for long, and for a disk that fails not at all: that is told by [`Self::news`].
    pub(crate) async fn settle(&mut self) {
        if self.failing.is_some() {
            return self.work().await;
        }
        if tokio::time::timeout(PATIENCE, self.finish()).await.is_err() {
            self.note(Err(io::Error::new(io::ErrorKind::TimedOut, "the disk is slow")));
        }
    }

    /// Whether what is kept comes to the disk, when that has changed.
    pub(crate) fn news(&mut self) -> Option<bool> {
        let fails = self.failing.is_some();
        (std::mem::replace(&mut self.told, fails) != fails).then_some(!fails)
    }

    /// A full disk is told once, and the flight goes on.
    fn note(&mut self, result: io::Result<()>) {
        match result {
            Ok(()) => self.failing = None,
            Err(error) => {
                if self.failing.is_none() {
                    tracing::error!(%error, "the service's state can't be stored; make room on the disk. The flight goes on");
                }
                self.failing = Some(Instant::now());
            }
        }
    }
}

/// What an earlier process kept, as `read` understands it. A file that it doesn't understand is set aside.
pub(crate) fn load<T, E: std::fmt::Display>(
    folder: &Path,
    name: &str,
    read: impl FnOnce(&[u8]) -> Result<T, E>,
) -> Option<T> {
    let path = folder.join(name);
    let bytes = fs::read(&path).ok()?;
    let error = match read(&bytes) {
        Ok(content) => return Some(content),
        Err(error) => error,
    };
    let aside = path.with_file_name(format!("{name}.bad"));
    tracing::warn!(%error, file = %aside.display(), "a stored file can't be read; set aside, starting without it");
    if let Err(error) = fs::rename(&path, &aside) {
        tracing::warn!(%error, "nor can it be set aside");
    }
    None
}

/// Temporary file, fsync, rename, fsync of the folder.
fn write(folder: &Path, name: &str, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let (path, temporary) = (folder.join(name), folder.join(format!("{name}.new")));
    let mut file = File::create(&temporary)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    fs::rename(&temporary, &path)?;
    File::open(folder)?.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(folder: &Path, name: &str) -> Option<String> {
        load(folder, name, |bytes| String::from_utf8(bytes.to_vec()))
    }

    #[tokio::test]
    async fn disk_that_fails_is_told_once_and_that_it_is_well_again_too() {
        let directory = tempfile::tempdir().unwrap();
        // a file where the folder should be: nobody can write there, not even root
        let path = directory.path().join("state");
        std::fs::write(&path, b"").unwrap();
        let mut folder = Folder::new(Some(path.clone()));
        for told in [Some(false), None] {
            folder.keep("a", b"old".to_vec());
            folder.settle().await;
            folder.finish().await;
            assert_eq!(folder.news(), told);
        }
        assert_eq!(text(&path, "a"), None);
        std::fs::remove_file(&path).unwrap();
        // what failed is not lost, unless something newer came
        folder.keep("b", b"other".to_vec());
        folder.finish().await;
        assert_eq!(folder.news(), Some(true));
        assert_eq!((text(&path, "a").as_deref(), text(&path, "b").as_deref()), (Some("old"), Some("other")));
    }

    #[tokio::test]
    async fn a_file_comes_back_and_a_broken_one_is_set_aside() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().to_owned();
        let mut folder = Folder::new(Some(path.clone()));
        assert_eq!(text(&path, "a.json"), None);
        folder.keep("a.json", b"first".to_vec());
        folder.keep("a.json", b"second".to_vec());
        folder.finish().await;
        assert_eq!(text(&path, "a.json").as_deref(), Some("second"));
        std::fs::write(path.join("a.json"), [0xff]).unwrap();
        assert_eq!(text(&path, "a.json"), None);
        assert!(path.join("a.json.bad").exists());
    }
}
