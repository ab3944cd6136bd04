//! Writing files: whole or not at all, and over nothing that nobody knows of.

use super::{Disk, FileEvent};
use flight_plan::FlightPlan;
use serde::{Deserialize, Serialize};
use std::fs::{File, Metadata};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

/// A file's state on disk; it differs after another program has written it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    modified: SystemTime,
    bytes: u64,
}

impl Stamp {
    /// Of a file as it is now; `None`: it can't be looked at.
    pub fn of(path: &Path) -> Option<Self> {
        Self::from_meta(&path.metadata().ok()?)
    }

    fn from_meta(meta: &Metadata) -> Option<Self> {
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

pub(super) fn save(path: PathBuf, writing: &Writing, disk: &dyn Disk) -> FileEvent {
    save_by(path, writing, |path, bytes| disk.write(path, bytes))
}

fn save_by(
    path: PathBuf,
    writing: &Writing,
    write: impl FnOnce(&Path, &[u8]) -> std::io::Result<Option<Stamp>>,
) -> FileEvent {
    let document = writing.document;
    match writing.over {
        Over::As(expected) if Stamp::of(&path).is_some_and(|now| now != expected) => {
            return FileEvent::ChangedMeanwhile { path, document };
        }
        Over::Nothing if path.exists() => {
            return FileEvent::NotSaved { document, why: Some(is_there(&path)) };
        }
        _ => {}
    }
    let text = text_of(&path, writing);
    match write(&path, text.as_bytes()) {
        Ok(stamp) => FileEvent::Saved { path, text: text.into(), document, version: writing.version, stamp },
        Err(error) => FileEvent::NotSaved { document, why: Some(not_saved(&path, &error)) },
    }
}

/// Writes what another program is to read; the sentence says why that can't be.
pub(super) fn export(path: &Path, bytes: &[u8], over: Over, disk: &dyn Disk) -> Result<(), String> {
    if over == Over::Nothing && path.exists() {
        return Err(is_there(path));
    }
    disk.write(path, bytes).map(drop).map_err(|error| not_saved(path, &error))
}

fn is_there(path: &Path) -> String {
    format!("{} is there already and was not overwritten. Save under another name.", path.display())
}

fn not_saved(path: &Path, error: &std::io::Error) -> String {
    let what_to_do = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "the disk is full. Make room there and save again, or save it elsewhere."
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "nothing may be written in this folder. Save it elsewhere."
        }
        _ => return format!("{} was not saved: {error}. Save it elsewhere.", path.display()),
    };
    format!("{} was not saved: {what_to_do}", path.display())
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
/// to is written. What is no file (a device, a pipe) is written into. Gives the file's state as it was written, whatever
/// another program does to it afterwards.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<Option<Stamp>> {
    replace(path, |file| file.write_all(bytes))
}

fn replace(
    path: &Path,
    fill: impl FnOnce(&mut File) -> std::io::Result<()>,
) -> std::io::Result<Option<Stamp>> {
    let path = &std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if path.metadata().is_ok_and(|is| !is.is_file() && !is.is_dir()) {
        return fill(&mut File::create(path)?).map(|()| None);
    }
    let temporary = Temporary::beside(path, fill)?;
    let stamp = temporary.stamp;
    temporary.take_place()?;
    Ok(stamp)
}

/// Several files that belong together: while one of them can't be written, none takes its place.
pub(crate) fn write_together(files: &[(PathBuf, Vec<u8>)]) -> std::io::Result<()> {
    let of = |path: &Path, error: std::io::Error| {
        std::io::Error::new(error.kind(), format!("{}: {error}", path.display()))
    };
    let mut written = Vec::new();
    for (path, bytes) in files {
        if path.metadata().is_ok_and(|is| !is.is_file()) {
            return Err(of(
                path,
                std::io::Error::new(ErrorKind::AlreadyExists, "there is something that is no file"),
            ));
        }
        let place = std::fs::canonicalize(path).unwrap_or_else(|_| path.clone());
        written
            .push(Temporary::beside(&place, |file| file.write_all(bytes)).map_err(|error| of(path, error))?);
    }
    files
        .iter()
        .zip(written)
        .try_for_each(|((path, _), file)| file.take_place().map_err(|error| of(path, error)))
}

/// A whole file on disk beside its place; it is removed again unless it takes it.
struct Temporary {
    path: PathBuf,
    place: PathBuf,
    stamp: Option<Stamp>,
}

impl Temporary {
    fn beside(place: &Path, fill: impl FnOnce(&mut File) -> std::io::Result<()>) -> std::io::Result<Self> {
        let (path, mut file) = new_file_in(folder_of(place))?;
        let mut temporary = Self { path, place: place.to_owned(), stamp: None };
        fill(&mut file)?;
        file.sync_all()?;
        temporary.stamp = Stamp::from_meta(&file.metadata()?);
        Ok(temporary)
    }

    fn take_place(self) -> std::io::Result<()> {
        std::fs::rename(&self.path, &self.place)?;
        File::open(folder_of(&self.place))?.sync_all()
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // nothing of use is in it; when it has taken its place it is not here any more
        let _ = std::fs::remove_file(&self.path);
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file under a name that nothing else has, not even another save of the same file at the same time.
fn new_file_in(folder: &Path) -> std::io::Result<(PathBuf, File)> {
    static LAST: AtomicU64 = AtomicU64::new(0);
    loop {
        let number = LAST.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!(".legwork-{}-{number}.tmp", std::process::id()));
        match File::create_new(&path) {
            Ok(file) => return Ok((path, file)),
            // a process of the same number has left it behind
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::disk::Machine;

    fn writing(name: &str, version: u64) -> Writing {
        let plan = FlightPlan { name: name.into(), ..FlightPlan::default() };
        Writing { plan: Arc::new(plan), original: None, document: 1, version, over: Over::Anything }
    }

    fn name_in(path: &Path) -> String {
        flight_plan::read(std::fs::read(path).unwrap()).plan.name
    }

    fn why(event: FileEvent) -> String {
        let FileEvent::NotSaved { document: 1, why: Some(why) } = event else { panic!("{event:?}") };
        why
    }

    #[test]
    fn saving_is_all_or_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        assert!(matches!(
            save(path.clone(), &writing("one", 1), &Machine),
            FileEvent::Saved { version: 1, .. }
        ));
        assert!(matches!(save(path.clone(), &writing("two", 2), &Machine), FileEvent::Saved { .. }));
        assert_eq!(name_in(&path), "two");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[test]
    fn folder_that_vanished_is_named_and_not_made() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("plan.xml");
        let why = why(save(path.clone(), &writing("x", 3), &Machine));
        assert!(why.contains("missing") && why.contains("Save it elsewhere"), "{why}");
        assert!(!path.parent().unwrap().exists());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn full_disk_is_told() {
        let why = why(save("/dev/full".into(), &writing("x", 1), &Machine));
        assert!(why.contains("/dev/full was not saved: the disk is full"), "{why}");
    }

    #[test]
    fn a_disk_that_fills_up_while_saving_leaves_the_old_file_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        assert!(matches!(save(path.clone(), &writing("old", 1), &Machine), FileEvent::Saved { .. }));
        let half = |file: &mut File| -> std::io::Result<()> {
            file.write_all(b"<flightPlan name='new")?;
            Err(ErrorKind::StorageFull.into())
        };
        let why = why(save_by(path.clone(), &writing("new", 2), |path, _| replace(path, half)));
        assert!(why.contains("plan.xml was not saved") && why.contains("save it elsewhere"), "{why}");
        assert_eq!(name_in(&path), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[test]
    fn file_stays_whole_and_nothing_is_left_beside_it_when_it_cannot_be_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        std::fs::create_dir(&path).unwrap();
        std::fs::write(path.join("inside"), "old").unwrap();
        let why = why(save(path.clone(), &writing("new", 2), &Machine));
        assert!(why.contains("plan.xml was not saved"), "{why}");
        assert_eq!(std::fs::read_to_string(path.join("inside")).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[test]
    fn files_that_belong_together_are_written_all_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let (first, second) = (folder.path().join("a"), folder.path().join("b"));
        let files = |text: &str| [(first.clone(), text.into()), (second.clone(), text.into())];
        write_together(&files("old")).unwrap();
        std::fs::remove_file(&second).unwrap();
        std::fs::create_dir(&second).unwrap();
        let error = write_together(&files("new")).unwrap_err().to_string();
        assert!(error.contains(&second.display().to_string()), "{error}");
        assert_eq!(std::fs::read_to_string(&first).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "no temporary file is left");
    }

    #[test]
    fn many_saves_of_one_file_at_a_time_leave_one_whole_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        std::thread::scope(|scope| {
            for version in 0..8 {
                let path = path.clone();
                scope.spawn(move || {
                    let saved = save(path, &writing(&"x".repeat(100_000), version), &Machine);
                    assert!(matches!(saved, FileEvent::Saved { .. }), "{saved:?}");
                });
            }
        });
        assert_eq!(name_in(&path).len(), 100_000);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[test]
    fn stamp_is_that_of_what_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        let FileEvent::Saved { stamp, .. } = save(path.clone(), &writing("ours", 1), &Machine) else {
            panic!()
        };
        assert!(stamp.is_some() && stamp == Stamp::of(&path));
    }

    #[test]
    fn comments_of_the_text_and_of_the_file_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        let text = "<flightPlan xmlns='urn:legwork:flight-plan:1' aircraft='t'><!-- mine --></flightPlan>";
        let from_text = Writing { original: Some(text.into()), ..writing("new", 1) };
        let FileEvent::Saved { text: written, stamp, .. } = save(path.clone(), &from_text, &Machine) else {
            panic!()
        };
        assert!(written.contains("<!-- mine -->") && name_in(&path) == "new", "{written}");
        // a recovered plan has no text
        let recovered = Writing { over: Over::As(stamp.unwrap()), ..writing("newer", 2) };
        let FileEvent::Saved { text: written, .. } = save(path.clone(), &recovered, &Machine) else {
            panic!()
        };
        assert!(written.contains("<!-- mine -->") && name_in(&path) == "newer", "{written}");
    }

    #[test]
    fn what_another_program_wrote_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.xml");
        let FileEvent::Saved { stamp, .. } = save(path.clone(), &writing("ours", 1), &Machine) else {
            panic!()
        };
        let next = Writing { over: Over::As(stamp.unwrap()), ..writing("ours again", 2) };
        std::fs::write(&path, "their words").unwrap();
        assert!(matches!(
            save(path.clone(), &next, &Machine),
            FileEvent::ChangedMeanwhile { document: 1, .. }
        ));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "their words");
        let new = Writing { over: Over::Nothing, ..next.clone() };
        assert!(why(save(path.clone(), &new, &Machine)).contains("is there already"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "their words");
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(save(path.clone(), &new, &Machine), FileEvent::Saved { .. }));
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(save(path, &next, &Machine), FileEvent::Saved { .. }), "nothing is lost");
    }
}
