//! Tiles on the disk: a file for each, no more than there is room for, the oldest thrown away first.

use super::{Folder, MAX_BYTES};
use crate::files::write_whole;
use crate::tiles::TileId;
use std::collections::hash_map::DefaultHasher;
use std::fs::File;
use std::hash::{Hash, Hasher};
use std::io::Read;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, SystemTime};

/// So much of the disk is used, for all servers together, bytes.
const MOST_BYTES: u64 = 256 << 20;
/// What was not fetched for so long is thrown away.
const OLDEST: Duration = Duration::from_secs(90 * 24 * 3600);
/// So many tiles are kept between two looks at how much there is.
const PERIOD: usize = 200;
/// Longest first line of a file, bytes.
const HEAD: usize = 512;

/// A tile as it is kept: first a line of numbers, then its bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// When the server gave it or said that it is still right, seconds since 1970.
    pub fetched_s: u64,
    /// It stays fresh for so long from then on, seconds.
    pub lifetime_s: u64,
    /// The server's mark of its version.
    pub tag: String,
    /// The picture; none, if the server has none there.
    pub bytes: Vec<u8>,
}

impl Stored {
    /// The server need not be asked.
    pub fn is_fresh(&self, now_s: u64) -> bool {
        // a clock that was put back makes nothing fresh for ever
        self.fetched_s <= now_s && now_s - self.fetched_s < self.lifetime_s
    }

    fn write(&self) -> Vec<u8> {
        let tag: String = self.tag.chars().filter(|c| !c.is_control()).collect();
        let mut file = format!("tile {} {} {tag}\n", self.fetched_s, self.lifetime_s).into_bytes();
        file.extend_from_slice(&self.bytes);
        file
    }

    fn read(file: &[u8]) -> Option<Self> {
        let end = file.iter().take(HEAD).position(|byte| *byte == b'\n')?;
        let (head, bytes) = file.split_at_checked(end)?;
        let mut words = std::str::from_utf8(head).ok()?.splitn(4, ' ');
        let mut next = || words.next();
        if next()? != "tile" {
            return None;
        }
        let (fetched_s, lifetime_s) = (next()?.parse().ok()?, next()?.parse().ok()?);
        let tag = next().unwrap_or_default().to_owned();
        Some(Self { fetched_s, lifetime_s, tag, bytes: bytes.get(1..)?.to_vec() })
    }
}

/// The time of day, seconds since 1970.
pub fn now_s() -> u64 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// The tiles of one server, in a folder that all servers share.
#[derive(Debug)]
pub struct Cache {
    folder: Folder,
    server: u64,
    kept: AtomicUsize,
}

impl Cache {
    /// As soon as the folder is known; until then nothing is kept.
    pub fn new(folder: Folder, server: &str) -> Self {
        let mut hasher = DefaultHasher::new();
        server.hash(&mut hasher);
        Self { folder, server: hasher.finish(), kept: AtomicUsize::new(0) }
    }

    fn path(&self, tile: TileId) -> Option<PathBuf> {
        let name = format!("{:016x}-{}-{}-{}.tile", self.server, tile.zoom, tile.x, tile.y);
        Some(self.folder.get()?.join(name))
    }

    /// The tile, if it is there and whole.
    pub fn get(&self, tile: TileId) -> Option<Stored> {
        let mut bytes = Vec::new();
        let file = File::open(self.path(tile)?).ok()?;
        file.take((MAX_BYTES + HEAD) as u64).read_to_end(&mut bytes).ok()?;
        Stored::read(&bytes)
    }

    /// Keeps a tile. A disk that can't is no reason not to show it.
    pub fn put(&self, tile: TileId, stored: &Stored) {
        let (Some(folder), Some(path)) = (self.folder.get(), self.path(tile)) else { return };
        let written = std::fs::create_dir_all(folder).and_then(|()| write_whole(&path, &stored.write()));
        if let Err(error) = written {
            tracing::debug!(%error, "a tile is not kept");
        }
        if self.kept.fetch_add(1, Ordering::Relaxed).is_multiple_of(PERIOD) {
            self.tidy();
        }
    }

    fn tidy(&self) {
        let Some(entries) = self.folder.get().and_then(|folder| std::fs::read_dir(folder).ok()) else {
            return;
        };
        let file = |entry: std::io::Result<std::fs::DirEntry>| {
            let entry = entry.ok()?;
            let meta = entry.metadata().ok().filter(|meta| meta.is_file())?;
            let age = meta.modified().ok()?.elapsed().unwrap_or_default();
            Some((age, meta.len(), entry.path()))
        };
        for path in too_many(entries.filter_map(file).collect(), MOST_BYTES) {
            // another window may have been faster
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Which files, each with its age and length, have to go.
fn too_many(mut files: Vec<(Duration, u64, PathBuf)>, most: u64) -> Vec<PathBuf> {
    files.sort();
    let total: u64 = files.iter().map(|(_, length, _)| length).sum();
    // with some room, so that it is not looked at for each tile
    let most = if total > most { most / 4 * 3 } else { most };
    let mut sum = 0;
    let gone = files.into_iter().filter(|(age, length, _)| {
        sum += length;
        sum > most || *age > OLDEST
    });
    gone.map(|(_, _, path)| path).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_oldest_go_first_and_the_very_old_in_any_case() {
        let file = |days: u64, length, name: &str| (Duration::from_secs(days * 86_400), length, name.into());
        let files = vec![file(3, 40, "c"), file(1, 40, "a"), file(2, 40, "b"), file(91, 1, "old")];
        assert_eq!(too_many(files.clone(), 1000), [PathBuf::from("old")]);
        assert_eq!(too_many(files, 110), ["c", "old"].map(PathBuf::from));
    }

    #[test]
    fn a_tile_of_the_future_is_not_fresh() {
        let stored = Stored { fetched_s: 100, lifetime_s: 10, tag: String::new(), bytes: Vec::new() };
        assert_eq!([99, 100, 109, 110].map(|now_s| stored.is_fresh(now_s)), [false, true, true, false]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn what_is_written_is_read_and_damage_does_not_panic(
            fetched_s: u64, lifetime_s: u64, tag in "[ -~]{0,40}", bytes: Vec<u8>, cut in 0usize..80,
        ) {
            let stored = Stored { fetched_s, lifetime_s, tag, bytes };
            let mut file = stored.write();
            prop_assert_eq!(Stored::read(&file), Some(stored));
            file.truncate(file.len().saturating_sub(cut));
            let _ = Stored::read(&file);
        }
    }
}
