//! What is in a folder, for the dialog in the window.

use super::Purpose;
use std::path::Path;

/// So many entries of a folder are listed.
const MOST_ENTRIES: usize = 10_000;

/// Something in a folder: another folder, or a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Its name.
    pub name: String,
    /// It is a folder.
    pub is_folder: bool,
}

/// Folders, then plans, by name; nothing hidden.
pub(super) fn list(folder: &Path, purpose: Purpose) -> std::io::Result<Vec<Entry>> {
    let entry = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.ok()?.path();
        let name = path.file_name()?.to_str()?.to_owned();
        let is_plan = purpose.lists(&path);
        // a link to a folder is one
        let is_folder = !is_plan && path.is_dir();
        ((is_folder || is_plan) && !name.starts_with('.')).then_some(Entry { name, is_folder })
    };
    let mut entries: Vec<Entry> = std::fs::read_dir(folder)?.filter_map(entry).take(MOST_ENTRIES).collect();
    entries.sort_by_key(|e| (!e.is_folder, e.name.to_lowercase()));
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interchange::Format;

    #[test]
    fn folder_lists_folders_then_plans_and_nothing_hidden() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.xml", "A.XML", "notes.txt", ".hidden.xml", "c.kml", "d.csv"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join("z")).unwrap();
        let names = |purpose| -> Vec<String> {
            list(folder.path(), purpose).unwrap().into_iter().map(|e| e.name).collect()
        };
        assert_eq!(names(Purpose::Save), ["z", "A.XML", "b.xml"]);
        assert_eq!(names(Purpose::Open), ["z", "A.XML", "b.xml", "c.kml", "notes.txt"]);
        assert_eq!(names(Purpose::Export(Format::Csv)), ["z", "d.csv"]);
    }
}
