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
    /// A file of this name counts towards the quota.
    counts: fn(&str) -> bool,
    current: Option<File>,
    /// Names of the files of this run, in their order.
    own: Vec<String>,
    /// Nothing was appended to the current file yet.
    is_empty: bool,
    /// May be written before the room is looked at again, bytes.
    allowed: u64,
    /// What syncing has cost so far.
    pub cost: SyncCost,
}

impl Disk {
    /// A folder of recordings. It is made when the first file is begun.
    pub fn new(folder: &Path, limits: Limits) -> Self {
        Self::of(folder, limits, recording::is_recording)
    }

    /// A folder of files that are known by their names.
    pub fn of(folder: &Path, limits: Limits, counts: fn(&str) -> bool) -> Self {
        Self {
            folder: folder.into(),
            limits,
            counts,
            current: None,
            own: Vec::new(),
            is_empty: false,
            allowed: 0,
            cost: SyncCost::default(),
        }
    }

    /// Does what the recorder wants; [`Output::Tell`] is not the disk's.
    ///
    /// # Errors
    /// It could not be done. The file is left as it is; an empty one is removed.
    pub fn perform(&mut self, output: Output) -> io::Result<()> {
        let done = match output {
            Output::Begin { name } => self.begin(name),
            Output::Append { bytes } => self.append(&bytes),
            Output::Finish => self.finish(),
            Output::Tell(_) => Ok(()),
        };
        if done.is_err() {
            self.give_up();
        }
        done
    }

    fn begin(&mut self, name: String) -> io::Result<()> {
        (self.allowed, self.current) = (0, None);
        self.make_folder()?;
        self.make_room(0)?;
        self.current = Some(File::options().write(true).create_new(true).open(self.folder.join(&name))?);
        self.own.push(name);
        self.is_empty = true;
        sync_folder(&self.folder)
    }

    /// Where something else stands in its place, that is no file whose name is taken: another kind of error.
    fn make_folder(&self) -> io::Result<()> {
        let cannot = |e| io::Error::other(format!("can't make the folder {}: {e}", self.folder.display()));
        fs::create_dir_all(&self.folder).map_err(cannot)
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.make_room(bytes.len() as u64)?;
        let Some(file) = &mut self.current else { return Err(io::ErrorKind::NotFound.into()) };
        file.write_all(bytes)?;
        let began = Instant::now();
        file.sync_data()?;
        let took = began.elapsed();
        self.is_empty = false;
        self.cost = SyncCost {
            count: self.cost.count + 1,
            total: self.cost.total + took,
            longest: self.cost.longest.max(took),
        };
        Ok(())
    }

    /// Leaves the current file as it is. One in which nothing stands would be one more at each new try.
    fn give_up(&mut self) {
        if self.current.take().is_some()
            && self.is_empty
            && let Some(name) = self.own.pop()
        {
            // where nothing can be written, it may not be removable either
            let _ = fs::remove_file(self.folder.join(name));
        }
    }

    fn finish(&mut self) -> io::Result<()> {
        match self.current.take() {
            Some(file) => file.sync_all(),
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
        let current = self.own.last().filter(|_| self.current.is_some()).map(String::as_str);
        let mut stored = files(&self.folder, self.counts)?;
        stored.iter_mut().for_each(|file| self.date(file));
        let room = excess(stored, current, free_bytes(&self.folder), wanted, self.limits);
        for name in &room.remove {
            tracing::info!("removing {name}: the quota of {} or the disk is used up", self.folder.display());
            fs::remove_file(self.folder.join(name))?;
        }
        if room.full {
            let reserve = self.limits.reserve_bytes >> 20;
            return Err(io::Error::other(format!("the disk is full up to its reserve of {reserve} MiB")));
        }
        self.allowed = wanted - bytes;
        Ok(())
    }

    /// The files of this run are the newest, in their order, whatever the machine's clock says.
    fn date(&self, file: &mut Stored) {
        if let Some(age) = self.own.iter().rev().position(|name| *name == file.name) {
            file.modified = Duration::from_secs(u64::MAX - age as u64);
        }
    }
}

/// The recordings of a folder.
pub fn stored(folder: &Path) -> io::Result<Vec<Stored>> {
    files(folder, recording::is_recording)
}

fn files(folder: &Path, counts: fn(&str) -> bool) -> io::Result<Vec<Stored>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let Ok(name) = entry.file_name().into_string() else { continue };
        // what has gone meanwhile takes no room
        let Ok(metadata) = entry.metadata() else { continue };
        if metadata.is_file() && counts(&name) {
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
        let mut disk = Disk::new(folder.path(), LIMITS);
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
        let mut disk = Disk::new(folder.path(), Limits { reserve_bytes: u64::MAX >> 1, ..LIMITS });
        assert!(begin(&mut disk, "a.mcap").unwrap_err().to_string().contains("reserve"));
        let mut disk = Disk::new(folder.path(), LIMITS);
        begin(&mut disk, "a.mcap").unwrap();
        assert!(begin(&mut disk, "a.mcap").is_err(), "it is there already");
        assert!(
            disk.perform(Output::Append { bytes: vec![1] }).is_err(),
            "and no file is open after a failure"
        );
    }

    #[test]
    fn folder_is_made_as_soon_as_it_can_be() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("state").join("recordings");
        fs::write(outer.path().join("state"), b"a file is no folder").unwrap();
        let mut disk = Disk::new(&folder, LIMITS);
        assert!(begin(&mut disk, "a.mcap").is_err());
        fs::remove_file(outer.path().join("state")).unwrap();
        begin(&mut disk, "a.mcap").unwrap();
        assert!(folder.join("a.mcap").exists());
    }

    #[test]
    fn file_in_which_nothing_could_be_written_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let mut disk = Disk::new(folder.path(), LIMITS);
        begin(&mut disk, "empty.mcap").unwrap();
        disk.limits.reserve_bytes = u64::MAX >> 1;
        disk.allowed = 0;
        assert!(disk.perform(Output::Append { bytes: vec![1] }).is_err());
        assert_eq!(stored(folder.path()).unwrap(), []);
        disk.limits.reserve_bytes = 0;
        begin(&mut disk, "good.mcap").unwrap();
        disk.perform(Output::Append { bytes: vec![1] }).unwrap();
        disk.limits.reserve_bytes = u64::MAX >> 1;
        disk.allowed = 0;
        assert!(disk.perform(Output::Append { bytes: vec![1] }).is_err());
        assert_eq!(stored(folder.path()).unwrap().len(), 1, "what was written stays");
    }

    #[test]
    fn files_of_this_run_go_last_whatever_the_clock_says() {
        let folder = tempfile::tempdir().unwrap();
        let earlier = File::create(folder.path().join("from-the-future.mcap")).unwrap();
        earlier.set_len(4 << 20).unwrap();
        earlier.set_modified(SystemTime::now() + Duration::from_secs(1 << 20)).unwrap();
        let mut disk = Disk::new(folder.path(), LIMITS);
        for name in ["b.mcap", "a.mcap"] {
            begin(&mut disk, name).unwrap();
            disk.perform(Output::Append { bytes: vec![0; 4 << 20] }).unwrap();
            disk.perform(Output::Finish).unwrap();
        }
        let left = || {
            let mut names: Vec<_> = stored(folder.path()).unwrap().into_iter().map(|s| s.name).collect();
            names.sort();
            names
        };
        assert_eq!(left(), ["a.mcap", "b.mcap"]);
        begin(&mut disk, "c.mcap").unwrap();
        disk.perform(Output::Append { bytes: vec![0; 4 << 20] }).unwrap();
        assert_eq!(left(), ["a.mcap", "c.mcap"], "the first of this run goes first");
    }
}
