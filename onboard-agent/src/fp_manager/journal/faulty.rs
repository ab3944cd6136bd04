//! A disk that dies at any byte and fails on request: what was synced stays, of the rest a random part.

use super::storage::Storage;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::rc::Rc;

/// A disk; clones are the same one.
#[derive(Clone, Default)]
pub struct Faulty(Rc<RefCell<Disk>>);

#[derive(Default)]
struct Disk {
    files: Vec<Content>,
    /// Which file a name stands for.
    names: BTreeMap<String, usize>,
    /// The same, at the last sync of the names and after every change since.
    names_since: Vec<BTreeMap<String, usize>>,
    /// So many bytes and operations are left before the process dies.
    fuse: Option<u64>,
    /// What every operation of the kind fails with.
    faults: Vec<(Operation, ErrorKind)>,
    /// Bytes that fit.
    capacity: Option<usize>,
}

#[derive(Default)]
struct Content {
    bytes: Vec<u8>,
    synced: usize,
}

/// What can fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    Names,
    Create,
    Append,
    Sync,
    Rename,
    SyncNames,
    Remove,
}

/// How a process ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Death {
    /// What was written is there.
    Kill,
    /// What was synced is there.
    PowerLoss,
}

/// A small generator of random numbers (SplitMix64): every test prints its seed.
pub struct Random(pub u64);

impl Random {
    fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `end`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.draw() % end.max(1)
    }
}

impl Faulty {
    /// The process dies after so many more bytes and operations.
    pub fn light_fuse(&self, units: u64) {
        self.0.borrow_mut().fuse = Some(units);
    }

    /// The process is dead.
    pub fn is_dead(&self) -> bool {
        self.0.borrow().fuse == Some(0)
    }

    /// Something done outside of the disk, as worthwhile an instant to die at as many a byte; whether the process
    /// survived it.
    pub fn survives(&self) -> bool {
        self.0.borrow_mut().burn(100).is_ok()
    }

    /// From now on an operation fails.
    pub fn fail(&self, operation: Operation, kind: ErrorKind) {
        self.0.borrow_mut().faults.push((operation, kind));
    }

    /// No more than so many bytes fit in all.
    pub fn limit(&self, capacity: usize) {
        self.0.borrow_mut().capacity = Some(capacity);
    }

    /// All is well again.
    pub fn repair(&self) {
        let mut disk = self.0.borrow_mut();
        disk.faults.clear();
        disk.capacity = None;
    }

    /// The process is gone; what a new one finds.
    pub fn reboot(&self, death: Death, random: &mut Random) {
        let mut disk = self.0.borrow_mut();
        disk.fuse = None;
        if death == Death::PowerLoss {
            let pick = random.below(disk.names_since.len() as u64) as usize;
            disk.names = disk.names_since.get(pick).cloned().unwrap_or_default();
            for file in &mut disk.files {
                file.lose_some(random);
            }
        }
        disk.names_since = vec![disk.names.clone()];
    }

    pub fn names_now(&self) -> Vec<String> {
        self.0.borrow().names.keys().cloned().collect()
    }

    /// Bytes of all files.
    pub fn size(&self) -> usize {
        self.0.borrow().size()
    }

    /// Changes the bytes of a file.
    pub fn damage(&self, name: &str, change: impl FnOnce(&mut Vec<u8>)) {
        let mut disk = self.0.borrow_mut();
        let index = disk.names[name];
        change(&mut disk.files[index].bytes);
    }
}

impl Content {
    /// Of what was not synced, the first part is there; behind it there may be zeros.
    fn lose_some(&mut self, random: &mut Random) {
        let unsynced = self.bytes.len() - self.synced;
        let kept = self.synced + random.below(unsynced as u64 + 1) as usize;
        let length = self.bytes.len();
        self.bytes.truncate(kept);
        if random.below(3) == 0 {
            self.bytes.resize(length, 0);
        }
        self.synced = self.bytes.len();
    }
}

impl Disk {
    /// Pays for something; on death, with how much is still done.
    fn burn(&mut self, units: u64) -> Result<(), u64> {
        let Some(left) = self.fuse else { return Ok(()) };
        self.fuse = Some(left.saturating_sub(units));
        if left <= units { Err(left) } else { Ok(()) }
    }

    fn attempt(&mut self, operation: Operation) -> io::Result<()> {
        self.burn(1).map_err(|_| io::Error::other("dead"))?;
        match self.faults.iter().find(|(failing, _)| *failing == operation) {
            Some((_, kind)) => Err((*kind).into()),
            None => Ok(()),
        }
    }

    fn renamed(&mut self) -> io::Result<()> {
        if self.names_since.is_empty() {
            self.names_since.push(BTreeMap::new());
        }
        self.names_since.push(self.names.clone());
        // it is done, but who asked for it may not live to see it
        self.burn(1).map_err(|_| io::Error::other("dead"))
    }

    fn file(&mut self, name: &str) -> io::Result<&mut Content> {
        let index = *self.names.get(name).ok_or(ErrorKind::NotFound)?;
        Ok(&mut self.files[index])
    }

    fn size(&self) -> usize {
        self.names.values().map(|index| self.files[*index].bytes.len()).sum()
    }
}

impl Storage for Faulty {
    fn names(&mut self) -> io::Result<Vec<String>> {
        self.0.borrow_mut().attempt(Operation::Names)?;
        Ok(self.names_now())
    }

    fn read(&mut self, name: &str, at_most: u64) -> io::Result<Vec<u8>> {
        let mut disk = self.0.borrow_mut();
        let bytes = &disk.file(name)?.bytes;
        if bytes.len() as u64 > at_most {
            return Err(ErrorKind::FileTooLarge.into());
        }
        Ok(bytes.clone())
    }

    fn create(&mut self, name: &str) -> io::Result<()> {
        let mut disk = self.0.borrow_mut();
        disk.attempt(Operation::Create)?;
        disk.files.push(Content::default());
        let index = disk.files.len() - 1;
        disk.names.insert(name.to_owned(), index);
        disk.renamed()
    }

    fn append(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut disk = self.0.borrow_mut();
        disk.attempt(Operation::Append)?;
        let room = disk.capacity.map_or(usize::MAX, |capacity| capacity.saturating_sub(disk.size()));
        let burnt = disk.burn(bytes.len() as u64);
        let done = burnt.map_or_else(|left| left as usize, |()| bytes.len()).min(room).min(bytes.len());
        disk.file(name)?.bytes.extend_from_slice(&bytes[..done]);
        match (burnt, done == bytes.len()) {
            (Err(_), _) => Err(io::Error::other("dead")),
            (Ok(()), true) => Ok(()),
            (Ok(()), false) => Err(ErrorKind::StorageFull.into()),
        }
    }

    fn sync(&mut self, name: &str) -> io::Result<()> {
        let mut disk = self.0.borrow_mut();
        disk.attempt(Operation::Sync)?;
        let file = disk.file(name)?;
        file.synced = file.bytes.len();
        disk.burn(1).map_err(|_| io::Error::other("dead"))
    }

    fn rename(&mut self, from: &str, to: &str) -> io::Result<()> {
        let mut disk = self.0.borrow_mut();
        disk.attempt(Operation::Rename)?;
        let index = disk.names.remove(from).ok_or(ErrorKind::NotFound)?;
        disk.names.insert(to.to_owned(), index);
        disk.renamed()
    }

    fn sync_names(&mut self) -> io::Result<()> {
        let mut disk = self.0.borrow_mut();
        disk.attempt(Operation::SyncNames)?;
        disk.names_since = vec![disk.names.clone()];
        disk.burn(1).map_err(|_| io::Error::other("dead"))
    }

    fn remove(&mut self, name: &str) -> io::Result<()> {
        let mut disk = self.0.borrow_mut();
        disk.attempt(Operation::Remove)?;
        disk.names.remove(name).ok_or(ErrorKind::NotFound)?;
        disk.renamed()
    }
}
