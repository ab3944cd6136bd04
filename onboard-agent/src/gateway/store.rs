//! Shell: what survives a restart of the gateway, in a file that is complete or absent.

use super::core::Snapshot;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tokio::task::{JoinError, JoinHandle};

const FILE: &str = "gateway.json";
/// An answer waits for the disk so long at most: the flight does not.
const PATIENCE: Duration = Duration::from_millis(500);
/// Pause before a disk that failed is tried again.
const RETRY: Duration = Duration::from_secs(1);

/// Writes snapshots, one at a time, the latest wins.
pub struct Store {
    folder: Option<PathBuf>,
    writing: Option<JoinHandle<io::Result<()>>>,
    next: Option<Snapshot>,
    /// When the last write failed, or took too long.
    failing: Option<Instant>,
    /// That it fails was told.
    told: bool,
}

impl Store {
    /// In a folder; `None`: nothing is kept.
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { folder, writing: None, next: None, failing: None, told: false }
    }

    /// What an earlier gateway stored. A file that can't be understood is set aside.
    pub fn load(&self) -> Option<Snapshot> {
        let path = self.folder.as_ref()?.join(FILE);
        let bytes = fs::read(&path).ok()?;
        match serde_json::from_slice(&bytes) {
            Ok(snapshot) => Some(snapshot),
            Err(error) => {
                let aside = path.with_extension("json.bad");
                tracing::warn!(%error, file = %aside.display(), "the stored state can't be read; set aside, starting without it");
                if let Err(error) = fs::rename(&path, &aside) {
                    tracing::warn!(%error, "nor can it be set aside");
                }
                None
            }
        }
    }

    /// Stores a snapshot soon.
    pub fn save(&mut self, snapshot: Snapshot) {
        self.next = Some(snapshot);
    }

    /// Goes on with writing; never waits.
    pub async fn work(&mut self) {
        if self.writing.as_ref().is_some_and(|w| !w.is_finished()) {
            return;
        }
        self.written().await;
        self.begin();
    }

    fn begin(&mut self) {
        if let (Some(folder), Some(snapshot)) = (self.folder.clone(), self.next.take()) {
            self.writing = Some(tokio::task::spawn_blocking(move || write(&folder, &snapshot)));
        }
    }

    /// Waits for what is being written. May be cancelled.
    async fn written(&mut self) {
        if let Some(writing) = &mut self.writing {
            let outcome: Result<_, JoinError> = writing.await;
            self.writing = None;
            self.note(outcome.unwrap_or_else(|e| Err(io::Error::other(e))));
        }
    }

    /// Writes everything given so far, and waits for it. May be cancelled.
    pub async fn finish(&mut self) {
        self.written().await;
        self.begin();
        self.written().await;
    }

    /// The same, but not for long, and for a disk that fails not at all: that is told by [`Self::news`].
    pub async fn settle(&mut self) {
        if self.failing.is_some() {
            return self.work().await;
        }
        if tokio::time::timeout(PATIENCE, self.finish()).await.is_err() {
            self.note(Err(io::Error::new(io::ErrorKind::TimedOut, "the disk is slow")));
        }
    }

    /// What could not be written should be given again.
    pub fn wants_again(&self) -> bool {
        let idle = self.writing.is_none() && self.next.is_none();
        idle && self.failing.is_some_and(|since| since.elapsed() >= RETRY)
    }

    /// Whether what is given comes to the disk, when that has changed.
    pub fn news(&mut self) -> Option<bool> {
        let fails = self.failing.is_some();
        (std::mem::replace(&mut self.told, fails) != fails).then_some(!fails)
    }

    /// A full disk is told once, and the flight goes on.
    fn note(&mut self, result: io::Result<()>) {
        match result {
            Ok(()) => self.failing = None,
            Err(error) => {
                if self.failing.is_none() {
                    tracing::error!(%error, "the gateway's state can't be stored; make room on the disk. The flight goes on");
                }
                self.failing = Some(Instant::now());
            }
        }
    }
}

/// Temporary file, fsync, rename, fsync of the folder.
fn write(folder: &Path, snapshot: &Snapshot) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let (path, temporary) = (folder.join(FILE), folder.join("gateway.json.new"));
    let mut file = File::create(&temporary)?;
    file.write_all(&serde_json::to_vec(snapshot)?)?;
    file.sync_all()?;
    fs::rename(&temporary, &path)?;
    File::open(folder)?.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gateway::core::Intent;
    use usal::contract::{SafeParameters, Token};

    fn snapshot() -> Snapshot {
        Snapshot {
            runways: vec![],
            safe: SafeParameters::default(),
            highest: Token(7),
            intent: Intent::Fly,
            waypoints: vec![],
            plan: Some("abc".into()),
            terminated: false,
        }
    }

    #[tokio::test]
    async fn disk_that_fails_is_told_once_and_that_it_is_well_again_too() {
        let directory = tempfile::tempdir().unwrap();
        // a file where the folder should be: nobody can write there, not even root
        let folder = directory.path().join("state");
        std::fs::write(&folder, b"").unwrap();
        let mut store = Store::new(Some(folder.clone()));
        for told in [Some(false), None] {
            store.save(snapshot());
            store.settle().await;
            store.finish().await;
            assert_eq!(store.news(), told);
        }
        assert_eq!(store.load(), None);
        std::fs::remove_file(&folder).unwrap();
        store.save(snapshot());
        store.finish().await;
        assert_eq!((store.news(), store.load()), (Some(true), Some(snapshot())));
    }

    #[tokio::test]
    async fn a_snapshot_comes_back_and_a_broken_file_is_set_aside() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_owned();
        let snapshot = snapshot();
        let mut store = Store::new(Some(path.clone()));
        assert_eq!(store.load(), None);
        store.save(snapshot.clone());
        store.finish().await;
        assert_eq!(Store::new(Some(path.clone())).load(), Some(snapshot));
        std::fs::write(path.join(FILE), b"{half").unwrap();
        assert_eq!(store.load(), None);
        assert!(path.join("gateway.json.bad").exists());
    }
}
