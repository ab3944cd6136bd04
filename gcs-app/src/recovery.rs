//! Work that was not saved survives a crash. While documents have unsaved changes, a copy of them is kept in a folder of
//! the program's own. It is taken away when the changes are saved or discarded; the next window offers one that is left.

use crate::document::Document;
use crate::files::{Stamp, write_whole};
use flight_plan::FlightPlan;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Seconds between two copies, at least.
const PERIOD_S: f64 = 2.0;
/// So many windows at a time have a copy.
const PLACES: usize = 16;

/// A copy of documents as they are kept.
#[derive(Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Kept {
    /// The one that is shown first.
    documents: Vec<LeftDocument>,
}

/// A document with unsaved changes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftDocument {
    /// Its file, if it has one.
    pub path: Option<PathBuf>,
    /// That file as the window knew it.
    #[serde(default)]
    pub stamp: Option<Stamp>,
    /// The plan's name.
    #[serde(default)]
    pub name: String,
    /// When it was last changed, to the [`PERIOD_S`], seconds since 1970-01-01T00:00:00Z; a copy that does not say was written then.
    #[serde(default, alias = "kept_unix_s")]
    pub changed_unix_s: Option<i64>,
    /// The plan as it would be saved.
    pub text: String,
}

/// What a window left behind that ended without being closed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftBehind {
    /// The documents with unsaved changes, at least one; the one that was shown first.
    pub documents: Vec<LeftDocument>,
}

/// A document that is to be kept.
struct Unsaved {
    path: Option<PathBuf>,
    stamp: Option<Stamp>,
    plan: Arc<FlightPlan>,
    changed_unix_s: i64,
}

impl Unsaved {
    fn of(document: &Document, changed_unix_s: i64) -> Self {
        Self {
            path: document.path().map(Path::to_owned),
            stamp: document.stamp(),
            plan: document.plan().clone(),
            changed_unix_s,
        }
    }

    fn written(&self) -> LeftDocument {
        LeftDocument {
            path: self.path.clone(),
            stamp: self.stamp,
            name: self.plan.name.clone(),
            changed_unix_s: Some(self.changed_unix_s),
            text: flight_plan::write(&self.plan),
        }
    }
}

/// All that is to be kept.
struct Job {
    unsaved: Vec<Unsaved>,
    /// What the last window left behind, as long as nothing is decided about it.
    left: Vec<LeftDocument>,
}

/// Keeps the copy of one window's documents, on a thread of its own.
#[derive(Debug)]
pub struct Keeper {
    jobs: Option<Sender<Job>>,
    failures: Receiver<String>,
    worker: Option<JoinHandle<()>>,
    /// The versions of which there are copies, each with when it came to be, seconds since 1970-01-01T00:00:00Z; `None`: what is
    /// there is not of this window.
    kept: Option<Vec<(u64, i64)>>,
    /// The versions that were recovered, each with when it came to be in the window that crashed.
    recovered: Vec<(u64, i64)>,
    last_s: f64,
    left_behind: Option<LeftBehind>,
    /// Held while the window lives: the place is not free.
    _place: File,
}

impl Keeper {
    /// Takes a place in the folder, rather one with something left behind than an empty one. A place belongs to whoever
    /// has its lock, and a lock ends with its process.
    ///
    /// # Errors
    /// The folder can't be made or written, or all places are taken.
    pub fn open(folder: &Path) -> std::io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        let mut places: Vec<usize> = (0..PLACES).collect();
        places.sort_by_key(|place| !copy_in(folder, *place).exists());
        for place in places {
            let lock = File::create(folder.join(format!("{place}.lock")))?;
            match lock.try_lock() {
                Ok(()) => return Self::at(lock, copy_in(folder, place)),
                Err(std::fs::TryLockError::WouldBlock) => {}
                Err(std::fs::TryLockError::Error(error)) => return Err(error),
            }
        }
        Err(std::io::Error::other(format!("{PLACES} windows are open")))
    }

    fn at(place: File, copy: PathBuf) -> std::io::Result<Self> {
        let left_behind = read(&copy);
        let (jobs, inbox) = channel::<Job>();
        let (outbox, failures) = channel();
        let work = move || {
            while let Ok(job) = inbox.recv() {
                // only the last one counts
                let job = inbox.try_iter().last().unwrap_or(job);
                if let Err(error) = carry_out(job, &copy) {
                    // the window may be gone
                    let _ = outbox.send(error.to_string());
                }
            }
        };
        let worker = std::thread::Builder::new().name("recovery".into()).spawn(work)?;
        Ok(Self {
            jobs: Some(jobs),
            failures,
            worker: Some(worker),
            kept: Some(Vec::new()),
            recovered: Vec::new(),
            last_s: f64::NEG_INFINITY,
            left_behind,
            _place: place,
        })
    }

    /// What is to be decided. Until then it is kept beside the changes that are made meanwhile.
    pub fn left_behind(&self) -> Option<&LeftBehind> {
        self.left_behind.as_ref()
    }

    /// It was decided, of all or `only` of one of them: what was left behind is given away, and its copy is no longer needed once the
    /// document that it became is kept or saved.
    pub fn take_left_behind(&mut self, only: Option<usize>) -> Vec<LeftDocument> {
        // what is there now is not of this document; those that are open stay as old as they are
        self.recovered.extend(self.kept.take().into_iter().flatten());
        let Some(mut left) = self.left_behind.take() else { return Vec::new() };
        let Some(number) = only.filter(|number| *number < left.documents.len()) else {
            return left.documents;
        };
        let taken = vec![left.documents.remove(number)];
        self.left_behind = Some(left).filter(|left| !left.documents.is_empty());
        taken
    }

    /// What was left behind has become this version of a document: it is as old as it was.
    pub fn recovered_as(&mut self, version: u64, left: &LeftDocument) {
        self.recovered.extend(left.changed_unix_s.map(|changed| (version, changed)));
    }

    /// Keeps a copy of these documents with unsaved changes if they have changed, or takes it away where there are none. Returns
    /// after how long to look again. `now_s`: by the window's clock; `utc`: the time of day.
    pub fn tend<'d>(
        &mut self,
        unsaved: impl Iterator<Item = &'d Document>,
        now_s: f64,
        utc: Timestamp,
    ) -> Option<Duration> {
        let unsaved: Vec<&Document> = unsaved.collect();
        let versions = unsaved.iter().map(|document| document.version());
        let has_all = |kept: &Vec<(u64, _)>| versions.clone().eq(kept.iter().map(|(version, _)| *version));
        if self.kept.as_ref().is_some_and(has_all) {
            return None;
        }
        let wait_s = self.last_s + PERIOD_S - now_s;
        if !unsaved.is_empty() && wait_s > 0.0 {
            return Some(Duration::from_secs_f64(wait_s));
        }
        self.last_s = now_s;
        let before = self.kept.take().unwrap_or_default();
        let known = || before.iter().chain(&self.recovered);
        let since =
            |version| known().find(|(of, _)| *of == version).map_or(utc.as_second(), |(_, changed)| *changed);
        let kept: Vec<(u64, i64)> = versions.map(|version| (version, since(version))).collect();
        let unsaved =
            unsaved.into_iter().zip(&kept).map(|(document, (_, changed))| Unsaved::of(document, *changed));
        self.order(unsaved.collect());
        self.kept = Some(kept);
        None
    }

    /// The window is closed, and what it had is saved or not wanted.
    pub fn close(&mut self) {
        // what was left behind may be there alone, as it was
        if self.left_behind.is_none() || self.kept.as_ref().is_none_or(|kept| !kept.is_empty()) {
            self.order(Vec::new());
        }
    }

    /// Why the last copy could not be kept.
    pub fn failure(&self) -> Option<String> {
        let why = self.failures.try_iter().last()?;
        Some(format!("No copy of unsaved changes can be kept: {why}. Save the plan often."))
    }

    fn order(&self, unsaved: Vec<Unsaved>) {
        let left = self.left_behind.as_ref().map_or_else(Vec::new, |left| left.documents.clone());
        if let Some(jobs) = &self.jobs {
            // the worker ends after this does
            let _ = jobs.send(Job { unsaved, left });
        }
    }
}

impl Drop for Keeper {
    /// Waits for the last copy.
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(worker) = self.worker.take() {
            // a worker that panicked has said so
            let _ = worker.join();
        }
    }
}

fn copy_in(folder: &Path, place: usize) -> PathBuf {
    folder.join(format!("{place}.json"))
}

/// The copy has the changes of this window first; without documents it is taken away.
fn carry_out(job: Job, copy: &Path) -> std::io::Result<()> {
    let documents: Vec<_> = job.unsaved.iter().map(Unsaved::written).chain(job.left).collect();
    if !documents.is_empty() {
        let kept = Kept { documents };
        return write_whole(copy, &serde_json::to_vec(&kept)?).map(drop);
    }
    match std::fs::remove_file(copy) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// `None`: nothing was left there, or nothing that can be read.
fn read(copy: &Path) -> Option<LeftBehind> {
    let written = copy.metadata().and_then(|meta| meta.modified()).ok()?;
    let written = Timestamp::try_from(written).ok()?;
    let mut kept: Kept = serde_json::from_slice(&std::fs::read(copy).ok()?).ok()?;
    for document in &mut kept.documents {
        // once it is written again, the file no longer says so
        document.changed_unix_s = document.changed_unix_s.or(Some(written.as_second()));
    }
    (!kept.documents.is_empty()).then_some(LeftBehind { documents: kept.documents })
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::{Edit, Fix, Thing};
    use geometry::LatLon;

    fn edited() -> Document {
        let mut document = Document::new(FlightPlan::default(), Some("/plans/a.xml".into()), Vec::new());
        let fix = Fix {
            id: "A".into(),
            position: LatLon::new(1.0, 1.0),
            name: String::new(),
            description: String::new(),
        };
        document.edit(&Edit::Add(Box::new(Thing::Fix(fix)))).unwrap();
        document
    }

    /// The time of day in these tests, seconds since 1970-01-01T00:00:00Z.
    const TODAY_S: i64 = 1_790_000_000;

    fn utc(later_s: i64) -> Timestamp {
        Timestamp::from_second(TODAY_S + later_s).unwrap()
    }

    fn tend(keeper: &mut Keeper, document: &Document, now_s: f64) -> Option<Duration> {
        keeper.tend(std::iter::once(document).filter(|document| document.is_dirty()), now_s, utc(0))
    }

    fn ages(keeper: &Keeper) -> Vec<Option<i64>> {
        keeper.left_behind().unwrap().documents.iter().map(|left| left.changed_unix_s).collect()
    }

    #[test]
    fn every_document_with_unsaved_changes_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let (first, second) = (edited(), edited());
        let mut killed = Keeper::open(folder.path()).unwrap();
        assert_eq!(killed.tend([&first, &second].into_iter(), 0.0, utc(0)), None);
        assert_eq!(killed.tend([&second, &first].into_iter(), 9.0, utc(9)), None);
        drop(killed);
        let found = Keeper::open(folder.path()).unwrap().take_left_behind(None);
        assert_eq!(found.len(), 2);
        assert_eq!(flight_plan::read(found[1].text.as_bytes()).plan, **first.plan());
    }

    #[test]
    fn killed_window_leaves_its_work_to_the_next_one() {
        let folder = tempfile::tempdir().unwrap();
        let document = edited();
        let mut killed = Keeper::open(folder.path()).unwrap();
        assert_eq!(killed.left_behind(), None);
        assert_eq!(tend(&mut killed, &document, 0.0), None);
        drop(killed);
        let mut next = Keeper::open(folder.path()).unwrap();
        let found = next.take_left_behind(None).remove(0);
        assert_eq!(found.path.as_deref(), document.path());
        assert_eq!(flight_plan::read(found.text.as_bytes()).plan, **document.plan());
        assert_eq!(tend(&mut next, &Document::default(), 0.0), None);
        drop(next);
        assert_eq!(Keeper::open(folder.path()).unwrap().left_behind(), None, "it was decided");
    }

    #[test]
    fn what_was_left_behind_stays_until_it_is_decided() {
        let folder = tempfile::tempdir().unwrap();
        tend(&mut Keeper::open(folder.path()).unwrap(), &edited(), 0.0);
        for _ in 0..2 {
            let mut window = Keeper::open(folder.path()).unwrap();
            assert!(window.left_behind().is_some());
            tend(&mut window, &Document::default(), 0.0);
            window.close();
        }
    }

    /// The question may wait while somebody flies or plans: a second crash takes nothing.
    #[test]
    fn changes_are_kept_while_the_question_after_a_crash_waits() {
        let folder = tempfile::tempdir().unwrap();
        let (lost, mut new) = (edited(), edited());
        new.edit(&Edit::MoveFix { fix: "A".into(), to: LatLon::new(2.0, 2.0) }).unwrap();
        tend(&mut Keeper::open(folder.path()).unwrap(), &lost, 0.0);
        let mut window = Keeper::open(folder.path()).unwrap();
        tend(&mut window, &new, 0.0);
        assert!(window.left_behind().is_some_and(|left| left.documents.len() == 1), "asked as before");
        drop(window);
        let mut next = Keeper::open(folder.path()).unwrap();
        let plans = |left: &LeftBehind| -> Vec<FlightPlan> {
            left.documents.iter().map(|left| flight_plan::read(left.text.as_bytes()).plan).collect()
        };
        assert_eq!(plans(next.left_behind().unwrap()), [(**new.plan()).clone(), (**lost.plan()).clone()]);
        // what is saved or given up by then is no longer there
        tend(&mut next, &new, 0.0);
        next.close();
        drop(next);
        assert_eq!(plans(Keeper::open(folder.path()).unwrap().left_behind().unwrap()).len(), 2);
    }

    #[test]
    fn windows_at_the_same_time_have_places_of_their_own() {
        let folder = tempfile::tempdir().unwrap();
        let mut first = Keeper::open(folder.path()).unwrap();
        tend(&mut first, &edited(), 0.0);
        let second = Keeper::open(folder.path()).unwrap();
        assert_eq!(second.left_behind(), None);
        drop((first, second));
        assert!(Keeper::open(folder.path()).unwrap().left_behind().is_some());
    }

    #[test]
    fn closed_window_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut window = Keeper::open(folder.path()).unwrap();
        tend(&mut window, &edited(), 0.0);
        window.close();
        drop(window);
        assert_eq!(Keeper::open(folder.path()).unwrap().left_behind(), None);
    }

    #[test]
    fn changes_in_quick_succession_are_kept_every_two_seconds() {
        let folder = tempfile::tempdir().unwrap();
        let mut document = edited();
        let mut keeper = Keeper::open(folder.path()).unwrap();
        assert_eq!(tend(&mut keeper, &document, 10.0), None);
        document.edit(&Edit::MoveFix { fix: "A".into(), to: LatLon::new(2.0, 2.0) }).unwrap();
        assert_eq!(tend(&mut keeper, &document, 10.5), Some(Duration::from_millis(1500)));
        assert_eq!(tend(&mut keeper, &document, 12.0), None);
        document.saved(document.version(), "/plans/a.xml".into(), "".into(), None);
        assert_eq!(tend(&mut keeper, &document, 12.1), None, "taken away at once");
        drop(keeper);
        assert_eq!(Keeper::open(folder.path()).unwrap().left_behind(), None);
    }

    /// Though both are written when one is edited.
    #[test]
    fn of_two_documents_each_is_as_old_as_its_own_last_change() {
        let folder = tempfile::tempdir().unwrap();
        let (still, mut busy) = (edited(), edited());
        let mut window = Keeper::open(folder.path()).unwrap();
        window.tend([&still, &busy].into_iter(), 0.0, utc(0));
        busy.edit(&Edit::MoveFix { fix: "A".into(), to: LatLon::new(2.0, 2.0) }).unwrap();
        window.tend([&busy, &still].into_iter(), 600.0, utc(600));
        drop(window);
        let next = Keeper::open(folder.path()).unwrap();
        assert_eq!(ages(&next), [Some(TODAY_S + 600), Some(TODAY_S)]);
    }

    #[test]
    fn one_of_several_is_decided_and_the_others_wait() {
        let folder = tempfile::tempdir().unwrap();
        let (first, second) = (edited(), edited());
        let mut killed = Keeper::open(folder.path()).unwrap();
        killed.tend([&first, &second].into_iter(), 0.0, utc(0));
        drop(killed);
        let mut next = Keeper::open(folder.path()).unwrap();
        assert_eq!(next.take_left_behind(Some(1)).len(), 1);
        tend(&mut next, &Document::default(), 0.0);
        drop(next);
        let mut again = Keeper::open(folder.path()).unwrap();
        assert_eq!(ages(&again).len(), 1, "the other one waits on");
        again.take_left_behind(Some(0));
        assert_eq!(again.left_behind(), None);
    }

    /// Copies of earlier versions are as old as their file.
    #[test]
    fn plans_are_left_with_their_names_and_ages() {
        let folder = tempfile::tempdir().unwrap();
        let kept = r#"{"documents":[{"path":null,"name":"Ridge","kept_unix_s":1000,"text":""},{"path":null,"text":""}]}"#;
        std::fs::write(folder.path().join("0.json"), kept).unwrap();
        let copy = folder.path().join("0.json");
        let written = Timestamp::try_from(copy.metadata().unwrap().modified().unwrap()).unwrap();
        let found = Keeper::open(folder.path()).unwrap().take_left_behind(None);
        let [ridge, old] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((ridge.name.as_str(), old.name.as_str()), ("Ridge", ""));
        assert_eq!((ridge.changed_unix_s, old.changed_unix_s), (Some(1000), Some(written.as_second())));
    }

    /// However often it is written again, or recovered and lost once more: when it was last changed stays what it was.
    #[test]
    fn a_plan_is_as_old_as_its_last_change_and_not_as_its_copy() {
        let folder = tempfile::tempdir().unwrap();
        let kept = r#"{"documents":[{"path":null,"kept_unix_s":1000,"text":""}]}"#;
        std::fs::write(folder.path().join("0.json"), kept).unwrap();
        // beside another one, it is written again
        let other = edited();
        let mut window = Keeper::open(folder.path()).unwrap();
        tend(&mut window, &other, 0.0);
        drop(window);
        let mut next = Keeper::open(folder.path()).unwrap();
        assert_eq!(ages(&next), [Some(TODAY_S), Some(1000)]);
        // those that are open when it is decided, too
        let own = edited();
        tend(&mut next, &own, 0.0);
        let found = next.take_left_behind(None);
        next.tend(std::iter::once(&own), 1000.0, utc(500));
        assert_eq!(next.kept.as_ref().map(|kept| kept[0].1), Some(TODAY_S));
        let mut recovered = edited();
        next.recovered_as(recovered.version(), &found[1]);
        tend(&mut next, &recovered, 2000.0);
        drop(next);
        let mut again = Keeper::open(folder.path()).unwrap();
        assert_eq!(ages(&again), [Some(1000)]);
        again.take_left_behind(None);
        recovered.edit(&Edit::MoveFix { fix: "A".into(), to: LatLon::new(2.0, 2.0) }).unwrap();
        tend(&mut again, &recovered, 0.0);
        drop(again);
        assert_eq!(ages(&Keeper::open(folder.path()).unwrap()), [Some(TODAY_S)], "it was edited");
    }

    #[test]
    fn torn_copy_is_nothing_and_a_folder_that_cannot_be_made_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("0.json"), "{\"path\":").unwrap();
        assert_eq!(Keeper::open(folder.path()).unwrap().left_behind(), None);
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        assert!(Keeper::open(&file.join("below")).is_err());
    }
}
