//! Reading a file that somebody wants opened: whether it is text, how long it may be, and what it means.

use super::{Disk, Stamp};
use crate::document::Document;
use crate::formats::{self, FileFormat};
use crate::jobs::Progress;
use crate::layers;
use flight_plan::Runway;
use interchange::{Areas, Assumptions, Feature, Format, Import};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Longest file that is read, bytes: the limit of the readers.
const LONGEST: u64 = if flight_plan::xml::MAX_BYTES < interchange::MAX_BYTES {
    flight_plan::xml::MAX_BYTES as u64
} else {
    interchange::MAX_BYTES as u64
};
/// So much of a file tells what it is, bytes.
const HEAD: u64 = 8 << 10;
/// Bytes that are read at a time.
const CHUNK: u64 = 1 << 20;

/// What a file turned out to be.
#[derive(Debug)]
pub enum Content {
    /// A plan of ours, however broken.
    Plan(Box<Document>),
    /// A plan of another program.
    Foreign(Box<Imported>),
}

/// What the lines of a drawing are in a plan that they are added to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Lines {
    /// Each is a corridor: flown along, in as many tracks as it takes.
    #[default]
    Corridors,
    /// Each of their points is a leg.
    Tracks,
}

/// What only the user can say about another program's file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Choices {
    /// What its areas are.
    pub areas: Areas,
    /// What its lines are where they are added to another plan.
    pub lines: Lines,
    /// The runway to take off from and to land on; `None`: what the file says.
    pub runway: Option<Runway>,
}

/// A plan of another program, before it becomes a document.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// Its file.
    pub path: PathBuf,
    /// The file's format.
    pub format: Format,
    /// As what it was read.
    pub choices: Choices,
    /// What it means.
    pub import: Import,
    /// What it draws, to be added to another plan.
    pub features: Vec<Feature>,
}

/// Reads it as what was chosen; the sentence says why that can't be, and what to do.
pub(super) fn read(
    disk: &dyn Disk,
    path: &Path,
    choices: &Choices,
    progress: &Progress,
) -> Result<Content, String> {
    let path = &with_extension(path);
    let stamp = Stamp::of(path);
    let bytes =
        bytes(disk, path, progress).map_err(|why| format!("{} can't be opened: {why}", path.display()))?;
    match FileFormat::of(path, &bytes) {
        FileFormat::Legwork => {
            let mut document = Document::read(&bytes, Some(path.to_owned()));
            let not_a_plan = document.reading_problems().iter().find(|problem| problem.code == "not-a-plan");
            if let Some(problem) = not_a_plan {
                return Err(format!("{} can't be opened: {}.", path.display(), problem.message));
            }
            document.set_stamp(stamp);
            Ok(Content::Plan(Box::new(document)))
        }
        FileFormat::Other(format) => {
            let Choices { areas, runway, .. } = choices.clone();
            let assumptions = Assumptions { areas, runway, ..formats::assumptions(path) };
            let import = formats::import(format, path, &bytes, &assumptions);
            let import = import.map_err(|error| format!("{error:#}"))?;
            if import.is_empty() {
                return Err(format!("nothing in {} could become part of a plan.", path.display()));
            }
            let features = interchange::features(format, &bytes).unwrap_or_default();
            let (path, choices) = (path.to_owned(), choices.clone());
            Ok(Content::Foreign(Box::new(Imported { path, format, choices, import, features })))
        }
    }
}

/// The plan of that name, where somebody left out what it ends in.
fn with_extension(path: &Path) -> PathBuf {
    let mut whole = path.as_os_str().to_owned();
    whole.push(".xml");
    let whole = PathBuf::from(whole);
    if !path.exists() && whole.is_file() { whole } else { path.to_owned() }
}

/// A dropped file or folder is a map or elevations; else it is taken to be a plan.
pub(super) fn is_map(disk: &dyn Disk, path: &Path) -> bool {
    path.is_dir() || (path.is_file() && head(disk, path).is_ok_and(|head| layers::is_map(path, &head)))
}

fn head(disk: &dyn Disk, path: &Path) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    disk.open(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(head)
}

fn bytes(disk: &dyn Disk, path: &Path, progress: &Progress) -> Result<Vec<u8>, String> {
    let text = |error: std::io::Error| error.to_string();
    let all = disk.length(path).map_err(text)?.ok_or("it is no file")?;
    check_kind(path, &head(disk, path).map_err(text)?)?;
    if all > LONGEST {
        return Err(too_long(all));
    }
    let mut bytes = Vec::new();
    let mut file = disk.open(path).map_err(text)?;
    while file.by_ref().take(CHUNK).read_to_end(&mut bytes).map_err(text)? > 0 {
        progress.set(bytes.len() as u64, all);
        // it may be growing
        if bytes.len() as u64 > LONGEST {
            return Err(too_long(bytes.len() as u64));
        }
        if progress.is_cancelled() {
            return Err("cancelled".into());
        }
    }
    Ok(bytes)
}

fn too_long(bytes: u64) -> String {
    format!("it has {} MB, and at most {} MB are read. Split it.", bytes >> 20, LONGEST >> 20)
}

/// What can't be a plan is not read at all.
fn check_kind(path: &Path, head: &[u8]) -> Result<(), String> {
    if layers::is_map(path, head) {
        return Err("it is a map or elevations, not a plan. Add it under Maps and elevations….".into());
    }
    if head.starts_with(b"PK\x03\x04") {
        return Ok(());
    }
    // older programs write Latin-1, where any byte is a character
    let is_text = !head.contains(&0);
    match is_text {
        true => Ok(()),
        false => Err(format!("it is no text. Legwork opens its own plans (xml) and {}.", formats::names())),
    }
}

#[cfg(test)]
mod tests {
    use super::super::disk::Machine;
    use super::*;
    use std::fs::File;

    fn why(path: &Path) -> String {
        read(&Machine, path, &Choices::default(), &Progress::default()).unwrap_err()
    }

    #[test]
    fn what_is_no_plan_is_refused_with_its_reason() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content, reason) in [
            ("a.xml", &b"\xff\xfe<\0f\0"[..], "no text"),
            ("photo.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF", "no text"),
            ("late.xml", b"<flightPlan>\0</flightPlan>", "no text"),
            ("a.mbtiles", b"SQLite format 3\0\x10", "a map"),
            ("N36W085.hgt", &[1, 2, 3, 4], "a map"),
            ("a.kml", b"<kml", "(kml)"),
            ("a.plan", b"{\"fileType\": \"Plan\"", "(plan)"),
            ("notes.txt", b"to be done", "not a flight plan"),
            ("page.html", b"<html></html>", "not a flight plan"),
            ("empty.xml", b"", "not a flight plan"),
            ("a.csv", b"lat,lon\n", "CSV is only written"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            let why = why(&path);
            assert!(why.contains(reason) && why.contains(name), "{why}");
        }
        assert!(why(folder.path()).contains("it is no file"));
        assert!(why(&folder.path().join("none.xml")).contains("can't be opened"));
    }

    #[test]
    fn a_plan_is_found_without_its_extension() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("survey.v2.xml"), "<flightPlan/>").unwrap();
        let Ok(Content::Plan(document)) =
            read(&Machine, &folder.path().join("survey.v2"), &Choices::default(), &Progress::default())
        else {
            panic!()
        };
        assert_eq!(document.path(), Some(folder.path().join("survey.v2.xml").as_path()));
    }

    #[test]
    fn a_file_that_is_too_long_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.xml");
        // no such space is used
        File::create(&path).unwrap().set_len(10 << 30).unwrap();
        std::fs::OpenOptions::new().write(true).open(&path).unwrap();
        let why = why(&path);
        assert!(why.contains("no text") || why.contains("10240 MB"), "{why}");
        let text = folder.path().join("long.kml");
        let mut file = File::create(&text).unwrap();
        std::io::Write::write_all(&mut file, &vec![b' '; HEAD as usize]).unwrap();
        file.set_len(100 << 20).unwrap();
        assert!(self::why(&text).contains("it has 100 MB, and at most 64 MB are read"));
    }

    #[test]
    fn another_programs_file_is_known_by_its_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mission.xml");
        let wpl = b"QGC WPL 110\n1 0 3 16 0 0 0 0 36.3 -84.1 100 1\n2 0 3 211 0 0 0 0 0 0 0 1\n";
        std::fs::write(&path, wpl).unwrap();
        let Ok(Content::Foreign(imported)) = read(&Machine, &path, &Choices::default(), &Progress::default())
        else {
            panic!()
        };
        assert_eq!((imported.format, imported.import.plan.name.as_str()), (Format::Waypoints, "mission"));
        assert!(imported.import.notes.iter().any(|note| note.code == "command-not-carried"));
        std::fs::write(&path, "<flightPlan/>").unwrap();
        assert!(matches!(
            read(&Machine, &path, &Choices::default(), &Progress::default()),
            Ok(Content::Plan(_))
        ));
    }

    #[test]
    fn a_map_is_known_by_its_content() {
        let folder = tempfile::tempdir().unwrap();
        assert!(is_map(&Machine, folder.path()), "of elevations");
        for (name, content, expected) in [
            ("world", &b"PMTiles\x03"[..], true),
            ("plan", b"<flightPlan/>", false),
            ("ground.tif", b"II*\0", true),
            ("plan.tif", b"<flightPlan/>", false),
            ("N36W085.HGT", b"", true),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            assert_eq!(is_map(&Machine, &path), expected, "{name}");
        }
        assert!(!is_map(&Machine, &folder.path().join("missing")));
    }
}
