//! Shell: what survives a restart of the gateway, in a file that is complete or absent.

use super::core::Snapshot;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tokio::task::JoinHandle;

const FILE: &str = "gateway.json";

/// Writes snapshots, one at a time, the latest wins.
pub struct Store {
    folder: Option<PathBuf>,
    writing: Option<JoinHandle<io::Result<()>>>,
    next: Option<Snapshot>,
    failing: bool,
}

impl Store {
    /// In a folder; `None`: nothing is kept.
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { folder, writing: None, next: None, failing: false }
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
        if let Some(done) = self.writing.take() {
            self.note(done.await.unwrap_or_else(|e| Err(io::Error::other(e))));
        }
        if let (Some(folder), Some(snapshot)) = (self.folder.clone(), self.next.take()) {
            self.writing = Some(tokio::task::spawn_blocking(move || write(&folder, &snapshot)));
        }
    }

    /// Writes what is left, at the end.
    pub async fn finish(&mut self) {
        if let Some(writing) = self.writing.take() {
            self.note(writing.await.unwrap_or_else(|e| Err(io::Error::other(e))));
        }
        if let (Some(folder), Some(snapshot)) = (self.folder.clone(), self.next.take()) {
            self.note(write(&folder, &snapshot));
        }
    }

    /// A full disk is told once, and the flight goes on.
    fn note(&mut self, result: io::Result<()>) {
        match result {
            Ok(()) => self.failing = false,
            Err(error) if !self.failing => {
                tracing::error!(%error, "the gateway's state can't be stored; make room on the disk. The flight goes on");
                self.failing = true;
            }
            Err(_) => {}
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
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::gateway::core::Intent;
    use usal::contract::{SafeParameters, Token};

    #[tokio::test]
    async fn a_snapshot_comes_back_and_a_broken_file_is_set_aside() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_owned();
        let snapshot = Snapshot {
            runways: vec![],
            safe: SafeParameters::default(),
            highest: Token(7),
            intent: Intent::Fly,
            waypoints: vec![],
            plan: Some("abc".into()),
            terminated: false,
        };
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
