//! The recordings' folder: what the recorder wants done is done here, and the disk never fills.

use recording::{Limits, Output, Stored, excess};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// After so many bytes the room on the disk is looked at again.
const LOOK_EVERY: u64 = 4 << 20;

/// What syncing costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SyncCost {
    /// How often it was done.
    pub count: u64,
    /// All of them together.
    pub total: Duration,
    /// The longest.
    pub longest: Duration,
}

/// The folder, and the file that is being written.
pub struct Disk {
    folder: PathBuf,
    limits: Limits,
    current: Option<(String, File)>,
    /// May be written before the room is looked at again, bytes.
    allowed: u64,
    /// What syncing has cost so far.
    pub cost: SyncCost,
}

impl Disk {
    /// A folder, which is made if need be.
    ///
    /// # Errors
    /// It can't be made.
    pub fn new(folder: &Path, limits: Limits) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let cost = SyncCost::default();
        Ok(Self { folder: folder.into(), limits, current: None, allowed: 0, cost })
    }

    /// Does what the recorder wants; [`Output::Tell`] is not the disk's.
    ///
    /// # Errors
    /// It could not be done. The file is left as it is.
    pub fn perform(&mut self, output: Output) -> io::Result<()> {
        let done = match output {
            Output::Begin { name } => self.begin(name),
            Output::Append { bytes } => self.append(&bytes),
            Output::Finish => self.finish(),
            Output::Tell(_) => Ok(()),
        };
        if done.is_err() {
            self.current = None;
        }
        done
    }

    fn begin(&mut self, name: String) -> io::Result<()> {
        self.allowed = 0;
        self.make_room(0)?;
        let file = File::options().write(true).create_new(true).open(self.folder.join(&name))?;
        sync_folder(&self.folder)?;
        self.current = Some((name, file));
        Ok(())
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.make_room(bytes.len() as u64)?;
        let Some((_, file)) = &mut self.current else { return Err(io::ErrorKind::NotFound.into()) };
        file.write_all(bytes)?;
        let began = Instant::now();
        file.sync_data()?;
        let took = began.elapsed();
        self.cost = SyncCost {
            count: self.cost.count + 1,
            total: self.cost.total + took,
            longest: self.cost.longest.max(took),
        };
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        match self.current.take() {
            Some((_, file)) => file.sync_all(),
            None => Ok(()),
        }
    }

    /// Removes the oldest recordings where there is too little room for more.
    fn make_room(&mut self, bytes: u64) -> io::Result<()> {
        if bytes <= self.allowed && self.allowed > 0 {
            self.allowed -= bytes;
            return Ok(());
        }
        let wanted = bytes.max(LOOK_EVERY);
        let current = self.current.as_ref().map(|(name, _)| name.as_str());
        let room = excess(stored(&self.folder)?, current, free_bytes(&self.folder), wanted, self.limits);
        for name in &room.remove {
            tracing::info!("removing {name}: the recordings' quota or the disk is used up");
            fs::remove_file(self.folder.join(name))?;
        }
        if room.full {
            let reserve = self.limits.reserve_bytes >> 20;
            return Err(io::Error::other(format!("the disk is full up to its reserve of {reserve} MiB")));
        }
        self.allowed = wanted - bytes;
        Ok(())
    }
}

/// The recordings of a folder.
pub fn stored(folder: &Path) -> io::Result<Vec<Stored>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let Ok(name) = entry.file_name().into_string() else { continue };
        // what has gone meanwhile takes no room
        let Ok(metadata) = entry.metadata() else { continue };
        if metadata.is_file() && recording::is_recording(&name) {
            let modified =
                metadata.modified().ok().and_then(|at| at.duration_since(SystemTime::UNIX_EPOCH).ok());
            found.push(Stored { name, bytes: metadata.len(), modified: modified.unwrap_or_default() });
        }
    }
    Ok(found)
}

/// Free for us on the disk of a folder, bytes; `None`: the system doesn't say.
#[cfg(unix)]
fn free_bytes(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}

#[cfg(not(unix))]
fn free_bytes(_: &Path) -> Option<u64> {
    None
}

/// A new name is on the disk when its folder is.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { quota_bytes: 10 << 20, reserve_bytes: 0 };

    fn begin(disk: &mut Disk, name: &str) -> io::Result<()> {
        disk.perform(Output::Begin { name: name.into() })
    }

    #[test]
    fn oldest_recordings_go_and_strangers_stay() {
        let folder = tempfile::tempdir().unwrap();
        for (name, seconds) in [("old.mcap", 1), ("new.mcap", 2), ("notes.txt", 0)] {
            let file = File::create(folder.path().join(name)).unwrap();
            file.set_len(4 << 20).unwrap();
            file.set_modified(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)).unwrap();
        }
        let mut disk = Disk::new(folder.path(), LIMITS).unwrap();
        begin(&mut disk, "current.mcap").unwrap();
        disk.perform(Output::Append { bytes: vec![0; 5 << 20] }).unwrap();
        let mut left: Vec<_> = stored(folder.path()).unwrap().into_iter().map(|s| s.name).collect();
        left.sort();
        assert_eq!(left, ["current.mcap", "new.mcap"]);
        assert!(folder.path().join("notes.txt").exists());
        assert_eq!(disk.cost.count, 1);
    }

    #[test]
    fn reserve_is_kept_and_what_fails_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let mut disk = Disk::new(folder.path(), Limits { reserve_bytes: u64::MAX >> 1, ..LIMITS }).unwrap();
        assert!(begin(&mut disk, "a.mcap").unwrap_err().to_string().contains("reserve"));
        let mut disk = Disk::new(folder.path(), LIMITS).unwrap();
        begin(&mut disk, "a.mcap").unwrap();
        assert!(begin(&mut disk, "a.mcap").is_err(), "it is there already");
        assert!(
            disk.perform(Output::Append { bytes: vec![1] }).is_err(),
            "and no file is open after a failure"
        );
        let file = folder.path().join("file");
        fs::write(&file, b"").unwrap();
        assert!(Disk::new(&file, LIMITS).is_err(), "a file is no folder");
    }
}
