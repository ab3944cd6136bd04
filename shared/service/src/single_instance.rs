//! Shell: each service runs once. Two that write to one folder, or fly one aircraft, would undo each other's work.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;
use std::time::Duration;
use tokio::time::Instant;
use usal::Session;

/// A process that was killed is gone from the folder, and a frozen one from the network (Zenoh's lease of two seconds),
/// within this time.
const PATIENCE: Duration = Duration::from_secs(3);
const PAUSE: Duration = Duration::from_millis(50);

/// Another one is there: a restart would not help.
#[derive(Debug, thiserror::Error)]
pub enum AlreadyRunning {
    /// On the same folder.
    #[error(
        "another {service} uses the state directory {folder}: end that one, or name another directory with --state-dir"
    )]
    Folder {
        /// The service's name.
        service: &'static str,
        /// The folder.
        folder: String,
    },
    /// On the same vehicle's network.
    #[error(
        "another {service} flies the vehicle {vehicle}: end that one, or name another vehicle or endpoint"
    )]
    Vehicle {
        /// The service's name.
        service: &'static str,
        /// The vehicle's name.
        vehicle: String,
    },
}

/// Holds a folder for one service, until dropped or the process ends, however it ends.
pub struct Lock(#[expect(dead_code, reason = "the system holds the lock as long as the file is open")] File);

/// Has the folder for this service alone. A folder that can't be written to can't be spoilt either: it is told elsewhere
/// and flown without.
///
/// # Errors
/// Another process has it.
pub async fn lock(folder: Option<&Path>, service: &'static str) -> Result<Option<Lock>, AlreadyRunning> {
    match folder {
        Some(folder) => lock_within(PATIENCE, folder, service).await,
        None => Ok(None),
    }
}

async fn lock_within(
    patience: Duration,
    folder: &Path,
    service: &'static str,
) -> Result<Option<Lock>, AlreadyRunning> {
    let path = folder.join(format!("{service}.lock"));
    let unlocked = |error: std::io::Error| {
        tracing::warn!(%error, file = %path.display(), "the state directory can't be kept for this process alone");
        Ok(None)
    };
    let opened = std::fs::create_dir_all(folder)
        .and_then(|()| OpenOptions::new().create(true).truncate(false).write(true).open(&path));
    let file = match opened {
        Ok(file) => file,
        Err(error) => return unlocked(error),
    };
    let since = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(Some(Lock(file))),
            Err(TryLockError::WouldBlock) if since.elapsed() < patience => tokio::time::sleep(PAUSE).await,
            Err(TryLockError::WouldBlock) => {
                return Err(AlreadyRunning::Folder { service, folder: folder.display().to_string() });
            }
            Err(TryLockError::Error(error)) => return unlocked(error),
        }
    }
}

/// Sees to it that nobody announces this service on the session's network, as far as its hub is there.
///
/// # Errors
/// Somebody does ([`AlreadyRunning`]), or the session is closed.
pub async fn expect_nobody(session: &Session, service: &'static str) -> anyhow::Result<()> {
    let since = Instant::now();
    while session.is_announced(service).await? {
        if since.elapsed() >= PATIENCE {
            return Err(AlreadyRunning::Vehicle { service, vehicle: session.vehicle().to_owned() }.into());
        }
        tokio::time::sleep(PAUSE).await;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn folder_is_had_by_one_of_a_kind_until_it_lets_go() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path().join("made/when/needed");
        let lock = async |service| lock_within(Duration::ZERO, &folder, service).await;
        let first = lock("gateway").await.unwrap();
        assert!(first.is_some());
        assert!(lock("fp-manager").await.unwrap().is_some());
        let refused = lock("gateway").await.err().expect("taken");
        assert!(refused.to_string().contains("made/when/needed"), "{refused}");
        drop(first);
        assert!(lock("gateway").await.unwrap().is_some());
    }

    #[tokio::test]
    async fn folder_that_cannot_be_written_to_is_nobodys() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("file");
        std::fs::write(&file, b"").unwrap();
        assert!(lock(Some(&file), "gateway").await.unwrap().is_none());
        assert!(lock(None, "gateway").await.unwrap().is_none());
    }
}
