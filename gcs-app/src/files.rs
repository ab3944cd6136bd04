//! Files: dialogs, reading and writing, each on a thread of its own; the window gets the result later.

mod disk;
mod event;
mod listing;
mod reading;
mod saving;
mod watch;

pub use disk::Disk;
pub use event::FileEvent;
pub use listing::Entry;
pub use reading::{Choices, Content, Imported, Lines};
pub use saving::{Over, Stamp, Writing};
pub(crate) use saving::{write_together, write_whole};
pub use watch::Watched;

use crate::desktop;
use crate::export::{self, Exported};
use crate::formats::FileFormat;
use crate::jobs::{Job, Jobs, Progress};
use disk::Machine;
use flight_plan::FlightPlan;
use interchange::Format;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};
use terrain::Terrain;
use watch::Watch;

/// What a file is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To open it.
    Open,
    /// To save the document in it.
    Save,
    /// To write what another program is to read.
    Export(Format),
}

impl Purpose {
    /// What the file ends in where nothing else is typed.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Open | Self::Save => "xml",
            Self::Export(format) => format.name(),
        }
    }

    /// A file of this name is listed.
    fn lists(self, path: &Path) -> bool {
        match (self, FileFormat::by_path(path)) {
            // missions are saved as text, too; what one is is decided by its content
            (Self::Open, None) => path.extension().is_some_and(|e| e.eq_ignore_ascii_case("txt")),
            (Self::Open, Some(format)) => format.is_read(),
            (Self::Save, format) => format == Some(FileFormat::Legwork),
            (Self::Export(format), of_path) => of_path == Some(FileFormat::Other(format)),
        }
    }
}

/// A dialog that is closed sooner than this was never seen.
const UNSEEN: Duration = Duration::from_millis(150);

/// Where files come from and go to.
pub struct Files {
    outbox: Sender<FileEvent>,
    inbox: Receiver<FileEvent>,
    wake: Arc<dyn Fn() + Send + Sync>,
    watch: Watch,
    jobs: Jobs,
    disk: Arc<dyn Disk>,
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
        Self { outbox, inbox, wake, watch, jobs: Jobs::default(), disk: Arc::new(Machine), desktop: true }
    }

    /// Reads what is opened from this disk, and writes there what is saved.
    pub fn use_disk(&mut self, disk: Arc<dyn Disk>) {
        self.disk = disk;
    }

    /// Looks at a file from now on, and tells once if it is no longer in this state.
    pub fn watch(&mut self, file: Option<Watched>) {
        self.watch.look_at(file);
    }

    /// What is being done with files.
    pub fn jobs(&self) -> &Jobs {
        &self.jobs
    }

    /// Shows work that has begun elsewhere, which can be cancelled like any other.
    pub fn adopt(&mut self, job: Job) {
        self.jobs.add(job);
    }

    /// The result of this work is no longer wanted.
    pub fn cancel(&mut self, job: u64) {
        self.jobs.cancel(job);
    }

    /// Forgets what has ended. True: something is still being done.
    pub fn tend(&mut self, now_s: f64) -> bool {
        self.jobs.tend(now_s)
    }

    /// Reads the document's own file again.
    pub fn reread(&mut self, path: PathBuf) {
        let disk = self.disk.clone();
        self.job(format!("Reading {}", name_of(&path)), move |progress| {
            match reading::read(disk.as_ref(), &path, &Choices::default(), progress) {
                Ok(Content::Plan(theirs)) => FileEvent::Reread { path, theirs },
                Ok(Content::Foreign(_)) => {
                    FileEvent::Failed(format!("{} is no flight plan any more.", path.display()))
                }
                Err(why) => FileEvent::Failed(why),
            }
        });
    }

    /// The next event, if there is one.
    pub fn next_event(&self) -> Option<FileEvent> {
        self.inbox.try_recv().ok()
    }

    /// Asks for a file to be opened; `foreign`: for another program's.
    pub fn ask_open(&self, foreign: bool) {
        let desktop = self.desktop;
        self.work(move || {
            let others: Vec<&str> =
                Format::ALL.iter().filter(|(_, format)| format.is_read()).map(|(name, _)| *name).collect();
            let others: Vec<&str> = others.into_iter().chain(["txt"]).collect();
            let dialog = rfd::FileDialog::new();
            let dialog = match foreign {
                false => dialog.add_filter("Flight plan", &["xml"]).add_filter("Other programs", &others),
                true => dialog.add_filter("Other programs", &others),
            };
            asked(desktop, Purpose::Open, || dialog.pick_file(), FileEvent::Chosen)
        });
    }

    /// Says whether something that was dropped is a map or a plan.
    pub fn sort_dropped(&self, path: PathBuf) {
        let disk = self.disk.clone();
        self.work(move || {
            Some(match reading::is_map(disk.as_ref(), &path) {
                true => FileEvent::MapChosen(path),
                false => FileEvent::PlanDropped(path),
            })
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
    pub fn list(&self, folder: PathBuf, purpose: Purpose) {
        self.work(move || {
            let folder = std::fs::canonicalize(&folder).unwrap_or(folder);
            let entries = listing::list(&folder, purpose)
                .map_err(|why| format!("{} can't be read: {why}", folder.display()));
            Some(FileEvent::Listed { folder, entries })
        });
    }

    /// Reads a file.
    pub fn open(&mut self, path: PathBuf) {
        self.open_with(path, Choices::default());
    }

    /// Reads a file; another program's as what was chosen.
    pub fn open_with(&mut self, path: PathBuf, choices: Choices) {
        let disk = self.disk.clone();
        self.job(format!("Reading {}", name_of(&path)), move |progress| {
            match reading::read(disk.as_ref(), &path, &choices, progress) {
                Ok(content) => FileEvent::Opened(content),
                Err(why) => FileEvent::Failed(why),
            }
        });
    }

    /// Asks where to save, and saves.
    pub fn ask_save(&self, suggestion: String, writing: Writing) {
        let (desktop, disk, document) = (self.desktop, self.disk.clone(), writing.document);
        self.save_by(document, move || {
            let dialog = rfd::FileDialog::new().add_filter("Flight plan", &["xml"]).set_file_name(suggestion);
            let save = |path| {
                let (path, over) = completed(path, "xml", writing.over);
                saving::save(path, &Writing { over, ..writing }, disk.as_ref())
            };
            asked(desktop, Purpose::Save, || dialog.save_file(), save)
                .or(Some(FileEvent::NotSaved { document, why: None }))
        });
    }

    /// Saves.
    pub fn save(&self, path: PathBuf, writing: Writing) {
        let disk = self.disk.clone();
        self.save_by(writing.document, move || Some(saving::save(path, &writing, disk.as_ref())));
    }

    /// Flies a plan ahead of time and puts it into another program's format.
    pub fn export(&mut self, plan: Arc<FlightPlan>, format: Format, terrain: Arc<dyn Terrain>) {
        self.job(format!("Exporting as {}", crate::formats::label(format)), move |progress| {
            match export::export(&plan, format, terrain, progress) {
                Ok(exported) => FileEvent::Exported(Box::new(exported.in_names(&plan))),
                Err(why) => FileEvent::Failed(why),
            }
        });
    }

    /// Asks where to write it, and writes it.
    pub fn ask_export(&self, suggestion: String, exported: Arc<Exported>) {
        let disk = self.disk.clone();
        let desktop = self.desktop;
        self.work(move || {
            let format = exported.format;
            let dialog = rfd::FileDialog::new().add_filter(crate::formats::label(format), &[format.name()]);
            let dialog = dialog.set_file_name(suggestion);
            let write = |path: PathBuf| {
                let (path, over) = completed(path, format.name(), Over::Anything);
                write_export(path, &exported, over, disk.as_ref())
            };
            asked(desktop, Purpose::Export(format), || dialog.save_file(), write)
        });
    }

    /// Writes it.
    pub fn write_export(&self, path: PathBuf, exported: Arc<Exported>, over: Over) {
        let disk = self.disk.clone();
        self.work(move || Some(write_export(path, &exported, over, disk.as_ref())));
    }

    /// Has the desktop open a file.
    pub fn show(&self, path: PathBuf) {
        self.work(move || desktop::open(&path).err().map(FileEvent::Failed));
    }

    /// Work that may take long: it is shown, and can be cancelled.
    fn job(&mut self, label: String, job: impl FnOnce(&Progress) -> FileEvent + Send + 'static) {
        let running = self.jobs.begin(label);
        self.work(move || {
            let event = job(running.progress());
            (!running.progress().is_cancelled()).then_some(event)
        });
    }

    /// Whatever becomes of a document that is being saved, the window hears of it: it could not be saved again before.
    fn save_by(&self, document: u64, job: impl FnOnce() -> Option<FileEvent> + Send + 'static) {
        let failed = move || {
            let why = "Nothing was saved: the program failed at it. Save under another name.".to_owned();
            FileEvent::NotSaved { document, why: Some(why) }
        };
        let job = move || std::panic::catch_unwind(AssertUnwindSafe(job)).unwrap_or_else(|_| Some(failed()));
        if !self.work(job) {
            // this window receives it
            let _ = self.outbox.send(failed());
        }
    }

    /// False: there is no thread for it.
    fn work(&self, job: impl FnOnce() -> Option<FileEvent> + Send + 'static) -> bool {
        let (outbox, wake) = (self.outbox.clone(), self.wake.clone());
        let work = move || {
            if let Some(event) = job() {
                // the window may be gone: nobody receives it
                let _ = outbox.send(event);
                wake();
            }
        };
        let started = std::thread::Builder::new().name("files".into()).spawn(work);
        started.inspect_err(|error| tracing::warn!(%error, "no thread for a file")).is_ok()
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

/// A name that was typed without what it ends in gets that; nobody was asked about a file that is there under the whole name.
fn completed(mut path: PathBuf, extension: &str, over: Over) -> (PathBuf, Over) {
    if path.extension().is_some() {
        return (path, over);
    }
    path.set_extension(extension);
    (path, Over::Nothing)
}

fn write_export(path: PathBuf, exported: &Arc<Exported>, over: Over, disk: &dyn Disk) -> FileEvent {
    match saving::export(&path, &exported.bytes, over, disk) {
        Ok(()) => FileEvent::ExportWritten { path, exported: exported.clone() },
        Err(why) => FileEvent::Failed(why),
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_without_extension_is_completed_and_overwrites_nothing_unseen() {
        let of = |name: &str| completed(name.into(), "xml", Over::Anything);
        assert_eq!(of("a/plan"), ("a/plan.xml".into(), Over::Nothing));
        assert_eq!(of("a/plan.kml"), ("a/plan.kml".into(), Over::Anything));
    }
}
