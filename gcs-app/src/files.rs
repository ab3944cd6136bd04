//! Files: dialogs, reading and saving, each on a thread of its own; the window gets the result later.

mod watch;

pub use watch::Watched;

use flight_plan::FlightPlan;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant, SystemTime};
use watch::Watch;

/// What came of it.
#[derive(Debug)]
pub enum FileEvent {
    /// A file was read.
    Opened {
        /// Which.
        path: PathBuf,
        /// What is in it.
        bytes: Vec<u8>,
        /// Its state at that time.
        stamp: Option<Stamp>,
    },
    /// The document's own file was read again.
    Reread {
        /// Which.
        path: PathBuf,
        /// What is in it.
        bytes: Vec<u8>,
        /// Its state at that time.
        stamp: Option<Stamp>,
    },
    /// The document was saved; `version` of it.
    Saved {
        /// Where.
        path: PathBuf,
        /// What is in it now.
        text: Arc<str>,
        /// Which document.
        document: u64,
        /// Which version.
        version: u64,
        /// The file's state since then.
        stamp: Option<Stamp>,
    },
    /// Another program has written the file since; it was left as it is.
    ChangedMeanwhile(PathBuf),
    /// The same was found without saving.
    ChangedOutside {
        /// The file.
        path: PathBuf,
        /// Its state as the window knew it.
        known: Stamp,
        /// Its state now; `None`: it is gone.
        stamp: Option<Stamp>,
    },
    /// A map or a folder of elevations was chosen.
    MapChosen(PathBuf),
    /// The desktop has no dialog to ask with.
    NoDialog(Purpose),
    /// What is in a folder, or why that can't be said.
    Listed {
        /// The folder.
        folder: PathBuf,
        /// Folders first, each by name.
        entries: Result<Vec<Entry>, String>,
    },
    /// It didn't work; the sentence says what to do.
    Failed(String),
}

/// A file's state on disk; it differs after another program has written it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    modified: SystemTime,
    bytes: u64,
}

impl Stamp {
    /// Of a file as it is now; `None`: it can't be looked at.
    pub fn of(path: &Path) -> Option<Self> {
        let meta = path.metadata().ok()?;
        Some(Self { modified: meta.modified().ok()?, bytes: meta.len() })
    }
}

/// What a plan may be written over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Whatever is there.
    Anything,
    /// Nothing: there must be no such file.
    Nothing,
    /// A file in this state, or none.
    As(Stamp),
}

/// A plan that is to be written.
#[derive(Debug, Clone)]
pub struct Writing {
    /// What is to be read from it.
    pub plan: Arc<FlightPlan>,
    /// The text that it comes from: what was not edited stays as it is there.
    pub original: Option<Arc<str>>,
    /// Which document it is.
    pub document: u64,
    /// Which version of the document it is.
    pub version: u64,
    /// What may be overwritten.
    pub over: Over,
}

/// What a file is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To open it.
    Open,
    /// To save the document in it.
    Save,
}

/// Something in a folder: another folder, or a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Its name.
    pub name: String,
    /// It is a folder.
    pub is_folder: bool,
}

/// So many entries of a folder are listed.
const MOST_ENTRIES: usize = 10_000;
/// Largest file that is opened, bytes; the reader's own limit is a little lower than this.
const LARGEST: u64 = 80 * 1024 * 1024;
/// A dialog that is closed sooner than this was never seen.
const UNSEEN: Duration = Duration::from_millis(150);

/// Where files come from and go to.
pub struct Files {
    outbox: Sender<FileEvent>,
    inbox: Receiver<FileEvent>,
    wake: Arc<dyn Fn() + Send + Sync>,
    watch: Watch,
    /// The desktop is asked for a dialog; false as soon as it turned out to have none.
    pub desktop: bool,
}

impl std::fmt::Debug for Files {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Files").finish_non_exhaustive()
    }
}

impl Files {
    /// `wake` is called when an event is ready.
    pub fn new(wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let (outbox, inbox) = channel();
        let watch = {
            let (outbox, wake) = (outbox.clone(), wake.clone());
            Watch::spawn(Arc::new(move |event| {
                // the window may be gone: nobody receives it
                let _ = outbox.send(event);
                wake();
            }))
        };
        Self { outbox, inbox, wake, watch, desktop: true }
    }

    /// Looks at a file from now on, and tells once if it is no longer in this state.
    pub fn watch(&mut self, file: Option<Watched>) {
        self.watch.look_at(file);
    }

    /// Reads the document's own file again.
    pub fn reread(&self, path: PathBuf) {
        self.work(move || {
            Some(match open(&path) {
                FileEvent::Opened { path, bytes, stamp } => FileEvent::Reread { path, bytes, stamp },
                other => other,
            })
        });
    }

    /// The next event, if there is one.
    pub fn next_event(&self) -> Option<FileEvent> {
        self.inbox.try_recv().ok()
    }

    /// Asks for a file and reads it.
    pub fn ask_open(&self) {
        let desktop = self.desktop;
        self.work(move || {
            let dialog = rfd::FileDialog::new().add_filter("Flight plan", &["xml"]);
            asked(desktop, Purpose::Open, || dialog.pick_file(), |path| open(&path))
        });
    }

    /// Asks for a map, or for a folder of elevations.
    pub fn ask_map(&self, folder: bool) {
        let desktop = self.desktop;
        self.work(move || {
            let begin = Instant::now();
            let dialog = rfd::FileDialog::new();
            let chosen = desktop.then(|| if folder { dialog.pick_folder() } else { dialog.pick_file() });
            match chosen.flatten() {
                Some(path) => Some(FileEvent::MapChosen(path)),
                None if desktop && begin.elapsed() >= UNSEEN => None,
                None => Some(FileEvent::Failed(
                    "This desktop has no file dialog: type the path, or drop the file onto the window."
                        .into(),
                )),
            }
        });
    }

    /// Reads what is in a folder.
    pub fn list(&self, folder: PathBuf) {
        self.work(move || {
            let folder = std::fs::canonicalize(&folder).unwrap_or(folder);
            let entries = list(&folder).map_err(|why| format!("{} can't be read: {why}", folder.display()));
            Some(FileEvent::Listed { folder, entries })
        });
    }

    /// Reads a file.
    pub fn open(&self, path: PathBuf) {
        self.work(move || Some(open(&path)));
    }

    /// Asks where to save, and saves.
    pub fn ask_save(&self, suggestion: String, writing: Writing) {
        let desktop = self.desktop;
        self.work(move || {
            let dialog = rfd::FileDialog::new().add_filter("Flight plan", &["xml"]).set_file_name(suggestion);
            asked(desktop, Purpose::Save, || dialog.save_file(), |path| save(path, &writing))
        });
    }

    /// Saves.
    pub fn save(&self, path: PathBuf, writing: Writing) {
        self.work(move || Some(save(path, &writing)));
    }

    fn work(&self, job: impl FnOnce() -> Option<FileEvent> + Send + 'static) {
        let (outbox, wake) = (self.outbox.clone(), self.wake.clone());
        let work = move || {
            if let Some(event) = job() {
                // the window may be gone: nobody receives it
                let _ = outbox.send(event);
                wake();
            }
        };
        if let Err(error) = std::thread::Builder::new().name("files".into()).spawn(work) {
            tracing::warn!(%error, "no thread for a file");
        }
    }
}

/// What came of a dialog of the desktop. Without a desktop portal it "cancels" at once, before anybody saw it.
fn asked(
    desktop: bool,
    purpose: Purpose,
    dialog: impl FnOnce() -> Option<PathBuf>,
    chosen: impl FnOnce(PathBuf) -> FileEvent,
) -> Option<FileEvent> {
    let begin = Instant::now();
    match desktop.then(dialog) {
        None => Some(FileEvent::NoDialog(purpose)),
        Some(None) if begin.elapsed() < UNSEEN => Some(FileEvent::NoDialog(purpose)),
        Some(path) => path.map(chosen),
    }
}

/// Folders, then plans, by name; nothing hidden.
fn list(folder: &Path) -> std::io::Result<Vec<Entry>> {
    let entry = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.ok()?.path();
        let name = path.file_name()?.to_str()?.to_owned();
        let is_plan = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("xml"));
        // a link to a folder is one
        let is_folder = !is_plan && path.is_dir();
        ((is_folder || is_plan) && !name.starts_with('.')).then_some(Entry { name, is_folder })
    };
    let mut entries: Vec<Entry> = std::fs::read_dir(folder)?.filter_map(entry).take(MOST_ENTRIES).collect();
    entries.sort_by_key(|e| (!e.is_folder, e.name.to_lowercase()));
    Ok(entries)
}

fn open(path: &Path) -> FileEvent {
    let stamp = Stamp::of(path);
    let read = std::fs::metadata(path).and_then(|meta| {
        if meta.len() > LARGEST {
            Err(std::io::Error::other("it is larger than 80 MiB"))
        } else {
            std::fs::read(path)
        }
    });
    match read {
        Ok(bytes) => FileEvent::Opened { path: path.to_owned(), bytes, stamp },
        Err(error) => FileEvent::Failed(format!("{} can't be opened: {error}", path.display())),
    }
}

fn save(path: PathBuf, writing: &Writing) -> FileEvent {
    match writing.over {
        Over::As(expected) if Stamp::of(&path).is_some_and(|now| now != expected) => {
            return FileEvent::ChangedMeanwhile(path);
        }
        Over::Nothing if path.exists() => {
            let why = "is there already and was not overwritten. Save under another name.";
            return FileEvent::Failed(format!("{} {why}", path.display()));
        }
        _ => {}
    }
    let text = text_of(&path, writing);
    match write_whole(&path, text.as_bytes()) {
        Ok(()) => {
            let stamp = Stamp::of(&path);
            let (document, version) = (writing.document, writing.version);
            FileEvent::Saved { path, text: text.into(), document, version, stamp }
        }
        Err(error) => {
            FileEvent::Failed(format!("{} was not saved: {error}. Save it elsewhere.", path.display()))
        }
    }
}

/// The plan in the words of the text that it comes from; without one, in those of its file that it takes the place of.
fn text_of(path: &Path, writing: &Writing) -> String {
    let in_file = || match writing.over {
        Over::As(_) => std::fs::read_to_string(path).ok().map(Arc::from),
        Over::Anything | Over::Nothing => None,
    };
    match writing.original.clone().or_else(in_file) {
        Some(original) => flight_plan::xml::patch(&original, &writing.plan),
        None => flight_plan::write(&writing.plan),
    }
}

/// Temporary file, fsync, rename, fsync of the folder: the old file or the new one, never half of it. A link stays one: what it leads
/// to is written. What is no file (a device, a pipe) is written into.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let path = &std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if path.metadata().is_ok_and(|is| !is.is_file() && !is.is_dir()) {
        return std::fs::write(path, bytes);
    }
    let name = path.file_name().ok_or_else(|| std::io::Error::other("that is no file name"))?;
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let temporary = folder.join(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id()));
    let written = (|| {
        let mut file = std::fs::File::create(&temporary)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        std::fs::rename(&temporary, path)?;
        std::fs::File::open(folder)?.sync_all()
    })();
    if written.is_err() {
        // nothing of use is in it
        let _ = std::fs::remove_file(&temporary);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    fn writing(name: &str, version: u64) -> Writing {
        let plan = FlightPlan { name: name.into(), ..FlightPlan::default() };
        Writing { plan: Arc::new(plan), original: None, document: 1, version, over: Over::Anything }
    }

    fn name_in(path: &Path) -> String {
        flight_plan::read(std::fs::read(path).unwrap()).plan.name
    }

    fn why(event: FileEvent) -> String {
        let FileEvent::Failed(why) = event else { panic!("{event:?}") };
        why
    }

    #[test]
    fn saving_is_all_or_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        assert!(matches!(save(path.clone(), &writing("one", 1)), FileEvent::Saved { version: 1, .. }));
        assert!(matches!(save(path.clone(), &writing("two", 2)), FileEvent::Saved { .. }));
        assert_eq!(name_in(&path), "two");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
        assert!(matches!(open(&folder.path().join("none.xml")), FileEvent::Failed(_)));
    }

    #[test]
    fn folder_that_vanished_is_named_and_not_made() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("plan.xml");
        let why = why(save(path.clone(), &writing("x", 3)));
        assert!(why.contains("missing") && why.contains("Save it elsewhere"), "{why}");
        assert!(!path.parent().unwrap().exists());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn full_disk_is_told() {
        let why = why(save("/dev/full".into(), &writing("x", 1)));
        assert!(why.contains("/dev/full was not saved") && why.contains("space"), "{why}");
    }

    #[test]
    fn file_stays_whole_where_no_new_one_can_be_written_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        save(path.clone(), &writing("old", 1));
        // as in a folder that may not be written: the temporary file can't be made
        let blocked = folder.path().join(format!(".plan.xml.{}.tmp", std::process::id()));
        std::fs::create_dir(&blocked).unwrap();
        let why = why(save(path.clone(), &writing("new", 2)));
        assert!(why.contains("plan.xml was not saved"), "{why}");
        assert_eq!(name_in(&path), "old");
    }

    #[test]
    fn comments_of_the_text_and_of_the_file_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        let text = "<flightPlan xmlns='urn:legwork:flight-plan:1' aircraft='t'><!-- mine --></flightPlan>";
        let from_text = Writing { original: Some(text.into()), ..writing("new", 1) };
        let FileEvent::Saved { text: written, stamp, .. } = save(path.clone(), &from_text) else { panic!() };
        assert!(written.contains("<!-- mine -->") && name_in(&path) == "new", "{written}");
        // a recovered plan has no text
        let recovered = Writing { over: Over::As(stamp.unwrap()), ..writing("newer", 2) };
        let FileEvent::Saved { text: written, .. } = save(path.clone(), &recovered) else { panic!() };
        assert!(written.contains("<!-- mine -->") && name_in(&path) == "newer", "{written}");
    }

    #[test]
    fn what_another_program_wrote_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        let FileEvent::Saved { stamp, .. } = save(path.clone(), &writing("ours", 1)) else { panic!() };
        let next = Writing { over: Over::As(stamp.unwrap()), ..writing("ours again", 2) };
        std::fs::write(&path, "their words").unwrap();
        assert!(matches!(save(path.clone(), &next), FileEvent::ChangedMeanwhile(_)));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "their words");
        let new = Writing { over: Over::Nothing, ..next.clone() };
        assert!(matches!(save(path.clone(), &new), FileEvent::Failed(_)));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "their words");
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(save(path.clone(), &new), FileEvent::Saved { .. }));
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(save(path, &next), FileEvent::Saved { .. }), "nothing is lost");
    }

    #[test]
    fn folder_lists_folders_then_plans_and_nothing_hidden() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.xml", "A.XML", "notes.txt", ".hidden.xml"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join("z")).unwrap();
        let names: Vec<String> = list(folder.path()).unwrap().into_iter().map(|e| e.name).collect();
        assert_eq!(names, ["z", "A.XML", "b.xml"]);
    }
}
