//! Segments on a storage: begun with a state, appended to, replaced. After any error nothing more is appended:
//! only a new segment, which begins with a whole state, can be trusted again.

use super::storage::Storage;
use super::{Chapter, Saved};
use ::journal::frame::{self, PAYLOAD_MAX};
use flight_plan::Program;
use std::collections::BTreeSet;
use std::io;
use std::sync::Arc;

const SEGMENT: &str = "segment-";
/// Of a segment that is, or was to be, appended to.
const JOURNAL: &str = ".journal";
/// Of a segment that could not be gone on with while the flight went on.
const STOPPED: &str = ".stopped";
/// Of a segment that could not be used.
const UNUSABLE: &str = ".unusable";
const SEGMENT_TEMPORARY: &str = "segment.tmp";
const PLAN: &str = "plan-";
const XML: &str = ".xml";
const PLAN_TEMPORARY: &str = "plan.tmp";
const DOCUMENT_TEMPORARY: &str = "document.tmp";
/// A document is written in pieces of so many bytes: each is on a slow card within the time that a turn may take.
const PIECE: usize = 256 << 10;
/// Segments that could not be used and are kept for inspection.
const UNUSABLE_KEPT: usize = 3;
/// Longest plan, bytes: no more can be proposed.
const PLAN_MAX: u64 = 64 << 20;

/// When a segment is long enough.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// A new state is asked for after so many turns: they take well below a second to replay.
    pub turns: u32,
    /// The same, after so many bytes behind the state.
    pub bytes: u64,
    /// Nothing more is appended after so many bytes behind the state.
    pub bytes_max: u64,
    /// A new state is asked for after so many plans.
    pub plans: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { turns: 2000, bytes: 2 << 20, bytes_max: 16 << 20, plans: 8 }
    }
}

/// The journal, as it is written.
pub struct Log<S> {
    storage: S,
    limits: Limits,
    /// The segment that is appended to; `None`: what happens is not recorded.
    open: Option<Open>,
    next_number: u64,
    /// The segment before, kept in case the state of the present one cannot be read.
    previous: Option<String>,
    /// Hashes of the plans on the storage.
    plans: BTreeSet<String>,
    /// Of them, those that the segment before may need.
    previous_plans: BTreeSet<String>,
    buffer: Vec<u8>,
    /// What is on the storage is known.
    stock_taken: bool,
    /// A document that is being written piece by piece.
    document: Option<Document>,
}

/// A plan's document of which so many bytes are written.
struct Document {
    hash: String,
    xml: Vec<u8>,
    written: usize,
}

struct Open {
    number: u64,
    name: String,
    frames: u32,
    /// Behind the state.
    bytes: u64,
    /// Hashes of the plans it needs.
    plans: BTreeSet<String>,
    dirty: bool,
}

/// A segment found by a restart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    name: String,
    number: u64,
}

impl<S: Storage> Log<S> {
    /// On a storage, and the segments there, newest first. Nothing is appended to them: the first state begins a new one.
    ///
    /// # Errors
    /// The storage can't be read; the log can be used all the same.
    pub fn open(storage: S, limits: Limits) -> (Self, Result<Vec<Found>, io::Error>) {
        let mut log = Self {
            storage,
            limits,
            open: None,
            next_number: 1,
            previous: None,
            plans: BTreeSet::new(),
            previous_plans: BTreeSet::new(),
            buffer: Vec::new(),
            stock_taken: false,
            document: None,
        };
        let found = log.storage.names().map(|names| log.take_stock(&names));
        (log, found)
    }

    fn take_stock(&mut self, names: &[String]) -> Vec<Found> {
        let plans = names.iter().filter_map(|n| n.strip_prefix(PLAN)?.strip_suffix(XML));
        self.plans = plans.map(str::to_owned).collect();
        self.previous_plans = self.plans.clone();
        let numbered = |name: &String| Some((number_of(name)?, name.clone()));
        let mut segments: Vec<_> = names.iter().filter_map(numbered).collect();
        segments.sort_by_key(|(number, _)| std::cmp::Reverse(*number));
        self.stock_taken = true;
        self.next_number = segments.first().map_or(1, |(number, _)| number + 1);
        let usable = segments.into_iter().filter(|(_, name)| !name.ends_with(UNUSABLE));
        usable.map(|(number, name)| Found { name, number }).collect()
    }

    /// Reads a segment that was found.
    ///
    /// # Errors
    /// Why it can't be used.
    pub fn chapter(&mut self, found: &Found) -> Result<Chapter, String> {
        let at_most = PAYLOAD_MAX as u64 + 2 * self.limits.bytes_max;
        let bytes = self.storage.read(&found.name, at_most).map_err(|e| e.to_string())?;
        let mut chapter = ::journal::read(&bytes).map_err(|e| e.to_string())?;
        if chapter.number != found.number {
            return Err(format!("it is segment {} under the name of {}", chapter.number, found.number));
        }
        if found.name.ends_with(STOPPED) {
            chapter.incomplete = true;
            chapter.dropped.get_or_insert_with(|| "the disk failed while the flight went on".into());
        }
        Ok(chapter)
    }

    /// A plan's document by its hash, if it is there. Whether it is the right one shows when it is compiled.
    pub fn plan(&mut self, hash: &str) -> Option<Vec<u8>> {
        if !hash.bytes().all(|b| b.is_ascii_hexdigit()) {
            return None;
        }
        self.storage.read(&plan_name(hash), PLAN_MAX).ok()
    }

    /// The segment a restart goes on from: it stays until the next but one begins.
    pub fn went_on_from(&mut self, found: &Found) {
        self.previous = Some(found.name.clone());
    }

    /// Keeps an unusable segment for inspection, out of the way; its new name.
    pub fn set_aside(&mut self, found: &Found) -> String {
        let aside = format!("{SEGMENT}{:08}{UNUSABLE}", found.number);
        match self.storage.rename(&found.name, &aside) {
            Ok(()) => aside,
            Err(_) => found.name.clone(),
        }
    }

    /// What happens is recorded.
    pub fn is_recording(&self) -> bool {
        self.open.is_some()
    }

    /// A new state is wanted: the segment is long, or there is none.
    pub fn wants_state(&self) -> bool {
        let Limits { turns, bytes, plans, .. } = self.limits;
        self.open.as_ref().is_none_or(|o| o.frames > turns || o.bytes > bytes || o.plans.len() > plans)
    }

    /// Something is written and not synced.
    pub fn is_dirty(&self) -> bool {
        self.open.as_ref().is_some_and(|o| o.dirty)
    }

    /// Has a plan on the disk.
    ///
    /// # Errors
    /// It could not be written: recording has stopped.
    pub fn keep_plan(&mut self, program: &Program) -> io::Result<()> {
        let outcome = self.write_plan(program);
        if let Some(open) = &mut self.open {
            open.plans.insert(program.hash().to_string());
        }
        outcome.inspect_err(|_| self.stop())
    }

    fn write_plan(&mut self, program: &Program) -> io::Result<()> {
        if self.plans.contains(&**program.hash()) {
            return Ok(());
        }
        let xml = flight_plan::write(&program.plan);
        self.replace(&plan_name(program.hash()), PLAN_TEMPORARY, xml.as_bytes())?;
        self.plans.insert(program.hash().to_string());
        Ok(())
    }

    /// Has a plan's document on the disk by and by, by [`Self::write_piece`]; one that is being written is given up.
    pub fn keep_document(&mut self, hash: &str, xml: Vec<u8>) {
        let known = self.plans.contains(hash);
        self.document = (!known).then(|| Document { hash: hash.to_owned(), xml, written: 0 });
    }

    /// A document is being written.
    pub fn is_writing(&self) -> bool {
        self.document.is_some()
    }

    /// Writes and syncs the next piece of a document, if there is one.
    ///
    /// # Errors
    /// It could not be written, and is given up: it is written at once when a turn names it.
    pub fn write_piece(&mut self) -> io::Result<()> {
        let Some(mut document) = self.document.take() else { return Ok(()) };
        if document.written == 0 {
            self.storage.create(DOCUMENT_TEMPORARY)?;
        }
        let piece = document.xml.get(document.written..).unwrap_or_default();
        let piece = piece.get(..PIECE).unwrap_or(piece);
        self.storage.append(DOCUMENT_TEMPORARY, piece)?;
        self.storage.sync(DOCUMENT_TEMPORARY)?;
        document.written += piece.len();
        if document.written < document.xml.len() {
            self.document = Some(document);
            return Ok(());
        }
        self.storage.rename(DOCUMENT_TEMPORARY, &plan_name(&document.hash))?;
        self.storage.sync_names()?;
        if let Some(open) = &mut self.open {
            // no new state removes it before the turn that names it
            open.plans.insert(document.hash.clone());
        }
        self.plans.insert(document.hash);
        Ok(())
    }

    /// Temporary file, sync, rename, sync of the names.
    fn replace(&mut self, name: &str, temporary: &str, bytes: &[u8]) -> io::Result<()> {
        self.storage.create(temporary)?;
        self.storage.append(temporary, bytes)?;
        self.storage.sync(temporary)?;
        self.storage.rename(temporary, name)?;
        self.storage.sync_names()
    }

    /// Begins a segment with a state and, once it is safely on the disk, removes what is no longer needed.
    ///
    /// # Errors
    /// It could not be begun. The old one goes on, unless it is unclear which of the two a restart would find.
    pub fn begin(&mut self, saved: &Saved, programs: &[Arc<Program>]) -> io::Result<()> {
        if !self.stock_taken {
            let names = self.storage.names()?;
            self.take_stock(&names);
        }
        programs.iter().try_for_each(|program| self.write_plan(program))?;
        let payload = ::journal::encode(saved).map_err(io::Error::other)?;
        let number = self.next_number;
        let mut bytes = frame::header(number).to_vec();
        frame::append(number, 0, &payload, &mut bytes).map_err(io::Error::other)?;
        self.sync()?;
        let name = format!("{SEGMENT}{number:08}{JOURNAL}");
        self.storage.create(SEGMENT_TEMPORARY)?;
        self.storage.append(SEGMENT_TEMPORARY, &bytes)?;
        self.storage.sync(SEGMENT_TEMPORARY)?;
        self.next_number += 1;
        self.storage.rename(SEGMENT_TEMPORARY, &name).inspect_err(|_| self.stop())?;
        let plans = saved.plans().map(|hash| hash.to_string()).collect();
        let open = Open { number, name, frames: 1, bytes: 0, plans, dirty: false };
        if let Err(error) = self.storage.sync_names() {
            self.stop();
            // a restart may find the new one, too, and has to see that nothing was added to it
            self.open = Some(open);
            self.stop();
            return Err(error);
        }
        let before = self.open.replace(open);
        if let Some(before) = before {
            self.previous = Some(before.name);
            self.previous_plans = before.plans;
        }
        self.clear_up();
        Ok(())
    }

    /// Removes what neither this segment nor the one before needs. What cannot be removed now is next time.
    fn clear_up(&mut self) {
        let Ok(mut names) = self.storage.names() else { return };
        names.sort();
        names.reverse();
        let mut unusable = 0;
        for name in names {
            unusable += usize::from(name.ends_with(UNUSABLE));
            if self.is_needless(&name, unusable) && self.storage.remove(&name).is_ok() {
                let hash = name.strip_prefix(PLAN).and_then(|n| n.strip_suffix(XML));
                hash.map(|hash| self.plans.remove(hash));
            }
        }
    }

    fn is_needless(&self, name: &str, unusable: usize) -> bool {
        if name.ends_with(UNUSABLE) {
            return unusable > UNUSABLE_KEPT;
        }
        if let Some(hash) = name.strip_prefix(PLAN).and_then(|n| n.strip_suffix(XML)) {
            let needed = self.open.as_ref().is_some_and(|o| o.plans.contains(hash));
            return !needed && !self.previous_plans.contains(hash);
        }
        let open = self.open.as_ref().map(|o| o.name.as_str());
        number_of(name).is_some() && Some(name) != open && Some(name) != self.previous.as_deref()
    }

    /// Appends a turn.
    ///
    /// # Errors
    /// It could not be written whole: recording has stopped.
    pub fn append(&mut self, payload: &[u8]) -> io::Result<()> {
        let Some(open) = &mut self.open else { return Ok(()) };
        self.buffer.clear();
        let framed = frame::append(open.number, open.frames, payload, &mut self.buffer);
        let bytes = open.bytes + self.buffer.len() as u64;
        let outcome = match framed {
            Err(error) => Err(io::Error::other(error)),
            Ok(()) if bytes > self.limits.bytes_max => {
                Err(io::Error::new(io::ErrorKind::FileTooLarge, "no new segment could be begun for too long"))
            }
            Ok(()) => self.storage.append(&open.name, &self.buffer),
        };
        (open.frames, open.bytes, open.dirty) = (open.frames + 1, bytes, true);
        outcome.inspect_err(|_| self.stop())
    }

    /// Has everything appended on the disk.
    ///
    /// # Errors
    /// It may not be there: recording has stopped.
    pub fn sync(&mut self) -> io::Result<()> {
        let Some(open) = self.open.as_mut().filter(|o| o.dirty) else { return Ok(()) };
        open.dirty = false;
        self.storage.sync(&open.name).inspect_err(|_| self.stop())
    }

    /// Nothing more is recorded until the next state. The segment's name says so, if names can be written.
    pub fn stop(&mut self) {
        let Some(open) = self.open.take() else { return };
        let stopped = format!("{SEGMENT}{:08}{STOPPED}", open.number);
        let renamed = self.storage.rename(&open.name, &stopped);
        self.previous = Some(if renamed.is_ok() { stopped } else { open.name });
        self.previous_plans = open.plans;
    }

    /// The storage, for tests.
    #[cfg(test)]
    pub fn storage(&mut self) -> &mut S {
        &mut self.storage
    }
}

fn plan_name(hash: &str) -> String {
    format!("{PLAN}{hash}{XML}")
}

/// The number of a segment, whatever became of it.
fn number_of(name: &str) -> Option<u64> {
    let rest = name.strip_prefix(SEGMENT)?;
    let digits = [JOURNAL, STOPPED, UNUSABLE].iter().find_map(|suffix| rest.strip_suffix(suffix))?;
    digits.parse().ok()
}
