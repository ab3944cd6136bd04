//! The accepted plan and the place in it, on disk: saved whole or not at all, by a thread of its
//! own, so that a slow or full disk never holds up the flight.

use anyhow::Context;
use flight_exec::Snapshot;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

const FILE: &str = "fp-manager.cbor";
/// Larger files are not ours, bytes.
const FILE_MAX: u64 = 64 << 20;
/// A disk that refuses is complained of no more often than this.
const COMPLAINT: Duration = Duration::from_secs(10);

/// Everything needed to go on with a flight.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Saved {
    /// Canonical XML of the active plan, if any.
    pub plan: Option<Arc<str>>,
    /// Where the executor was.
    pub snapshot: Snapshot,
    /// The take-off was ordered and not yet confirmed.
    pub launch_wanted: bool,
    /// Alarms of the gateway that were answered by an emergency plan, or found none.
    #[serde(default)]
    pub answered_alarms: BTreeSet<String>,
}

/// The directory where a flight is kept.
pub struct Store {
    desk: Arc<Desk>,
    /// Number of the last state written (or given up).
    written: watch::Receiver<u64>,
    requested: u64,
}

/// Where the writer finds the newest state.
#[derive(Default)]
struct Desk {
    slot: Mutex<Slot>,
    changed: Condvar,
}

#[derive(Default)]
struct Slot {
    next: Option<(u64, Saved)>,
    closed: bool,
}

impl Store {
    /// Opens the directory, making it if needed, and reads what is there. A file that cannot be
    /// read is set aside and told.
    ///
    /// # Errors
    /// The directory can't be made.
    pub fn open(directory: &Path) -> anyhow::Result<(Self, Option<Saved>)> {
        fs::create_dir_all(directory).with_context(|| {
            format!("state directory {}: make it, or name another by --state-dir", directory.display())
        })?;
        let path = file(directory);
        let saved = load(&path);
        let desk = Arc::<Desk>::default();
        let (sender, written) = watch::channel(0);
        let writer = desk.clone();
        std::thread::Builder::new()
            .name("fp-manager-disk".into())
            .spawn(move || write_all(&path, &writer, &sender))
            .context("the thread that writes the state")?;
        Ok((Self { desk, written, requested: 0 }, saved))
    }

    /// Has a state written, soon; of several that wait only the last is.
    pub fn save(&mut self, saved: Saved) {
        self.requested += 1;
        self.desk.slot.lock().unwrap_or_else(PoisonError::into_inner).next = Some((self.requested, saved));
        self.desk.changed.notify_one();
    }

    /// Waits until everything is on disk, at most so long.
    pub async fn flushed(&mut self, at_most: Duration) {
        let requested = self.requested;
        let done = self.written.wait_for(|written| *written >= requested);
        if tokio::time::timeout(at_most, done).await.is_err() {
            tracing::warn!("the disk is slow: the plan's state is not saved yet");
        }
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        self.desk.slot.lock().unwrap_or_else(PoisonError::into_inner).closed = true;
        self.desk.changed.notify_one();
    }
}

impl Desk {
    /// The newest state; `None` when there will be no more.
    fn take(&self) -> Option<(u64, Saved)> {
        let slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        let idle = |slot: &mut Slot| slot.next.is_none() && !slot.closed;
        self.changed.wait_while(slot, idle).unwrap_or_else(PoisonError::into_inner).next.take()
    }
}

fn write_all(path: &Path, desk: &Desk, written: &watch::Sender<u64>) {
    let mut complained: Option<Instant> = None;
    while let Some((number, saved)) = desk.take() {
        if let Err(error) = write(path, &saved)
            && complained.is_none_or(|at| at.elapsed() >= COMPLAINT)
        {
            complained = Some(Instant::now());
            tracing::error!(
                "the flight's state cannot be saved ({error:#}): free some space; the flight goes on"
            );
        }
        written.send_replace(number);
    }
}

/// Temporary file, fsync, rename, fsync of the directory.
fn write(path: &Path, saved: &Saved) -> anyhow::Result<()> {
    let mut bytes = Vec::new();
    ciborium::into_writer(saved, &mut bytes).context("writing the state down")?;
    let temporary = path.with_extension("tmp");
    replace(path, &temporary, &bytes).with_context(|| path.display().to_string())
}

fn replace(path: &Path, temporary: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(temporary)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    fs::rename(temporary, path)?;
    match path.parent() {
        Some(directory) => File::open(directory)?.sync_all(),
        None => Ok(()),
    }
}

fn load(path: &Path) -> Option<Saved> {
    match read(path) {
        Ok(saved) => saved,
        Err(error) => {
            set_aside(path, &format!("{error:#}"));
            None
        }
    }
}

fn read(path: &Path) -> anyhow::Result<Option<Saved>> {
    let file = match File::open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        other => other?,
    };
    anyhow::ensure!(file.metadata()?.len() <= FILE_MAX, "it is larger than any state");
    Ok(Some(ciborium::from_reader(io::BufReader::new(file))?))
}

/// Keeps an unusable state for whoever wants to look at it.
pub fn set_aside(path: &Path, reason: &str) {
    let aside = free_name(path);
    match fs::rename(path, &aside) {
        Ok(()) => tracing::error!(
            "unusable state ({reason}) set aside as {}; starting without a plan",
            aside.display()
        ),
        Err(error) => tracing::error!("unusable state in {} ({reason}; {error})", path.display()),
    }
}

fn free_name(path: &Path) -> PathBuf {
    let names = (1..100).map(|n| path.with_extension(format!("unusable-{n}")));
    names.into_iter().find(|p| !p.exists()).unwrap_or_else(|| path.with_extension("unusable"))
}

/// The file in a directory.
pub fn file(directory: &Path) -> PathBuf {
    directory.join(FILE)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use aircraft::Profile;
    use flight_exec::Executor;
    use terrain::Flat;

    fn saved(plan: &str) -> Saved {
        let executor = Executor::new(flight_exec::Config::default(), Arc::new(Flat(0.0)), Profile::default());
        Saved {
            plan: Some(plan.into()),
            snapshot: executor.snapshot(),
            launch_wanted: true,
            answered_alarms: BTreeSet::from(["energy-low".into()]),
        }
    }

    async fn saved_once(directory: &Path, plans: &[&str]) {
        let (mut store, _) = Store::open(directory).unwrap();
        for plan in plans {
            store.save(saved(plan));
        }
        store.flushed(Duration::from_secs(30)).await;
    }

    #[tokio::test]
    async fn the_last_state_comes_back() {
        let directory = tempfile::tempdir().unwrap();
        saved_once(directory.path(), &["<a/>", "<b/>", "<c/>"]).await;
        let (_, found) = Store::open(directory.path()).unwrap();
        let found = found.unwrap();
        assert_eq!(found.plan.as_deref(), Some("<c/>"));
        assert_eq!(found.snapshot, saved("").snapshot);
        assert!(found.launch_wanted);
        assert_eq!(found.answered_alarms, saved("").answered_alarms);
    }

    #[tokio::test]
    async fn damaged_state_is_set_aside() {
        for damage in [&b""[..], b"garbage", &[0x9b, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]] {
            let directory = tempfile::tempdir().unwrap();
            saved_once(directory.path(), &["<a/>"]).await;
            fs::write(file(directory.path()), damage).unwrap();
            assert!(Store::open(directory.path()).unwrap().1.is_none());
            assert!(!file(directory.path()).exists());
            assert_eq!(fs::read(directory.path().join("fp-manager.unusable-1")).unwrap(), damage);
            assert!(Store::open(directory.path()).unwrap().1.is_none());
        }
    }

    #[tokio::test]
    async fn torn_file_of_any_length_is_no_panic() {
        let directory = tempfile::tempdir().unwrap();
        saved_once(directory.path(), &["<a/>"]).await;
        let whole = fs::read(file(directory.path())).unwrap();
        for length in 0..whole.len() {
            fs::write(file(directory.path()), &whole[..length]).unwrap();
            assert!(load(&file(directory.path())).is_none(), "{length} bytes");
        }
    }

    #[tokio::test]
    async fn disk_full_the_old_state_stays_and_saving_goes_on() {
        let directory = tempfile::tempdir().unwrap();
        saved_once(directory.path(), &["<a/>"]).await;
        // a directory in the way of the temporary file fails like a full disk
        fs::create_dir(file(directory.path()).with_extension("tmp")).unwrap();
        saved_once(directory.path(), &["<b/>"]).await;
        assert_eq!(load(&file(directory.path())).unwrap().plan.as_deref(), Some("<a/>"));
        fs::remove_dir(file(directory.path()).with_extension("tmp")).unwrap();
        saved_once(directory.path(), &["<c/>"]).await;
        assert_eq!(load(&file(directory.path())).unwrap().plan.as_deref(), Some("<c/>"));
    }
}
