//! What the window hears of its files.

use super::{Content, Entry, Purpose, Stamp};
use crate::document::Document;
use crate::export::Exported;
use std::path::PathBuf;
use std::sync::Arc;

/// What came of it.
#[derive(Debug)]
pub enum FileEvent {
    /// A file was chosen to be opened.
    Chosen(PathBuf),
    /// A file was dropped onto the window that is no map.
    PlanDropped(PathBuf),
    /// A file was read.
    Opened(Content),
    /// The document's own file was read again.
    Reread {
        /// Which.
        path: PathBuf,
        /// What is in it.
        theirs: Box<Document>,
    },
    /// A document was saved.
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
    /// A document was not saved.
    NotSaved {
        /// Which.
        document: u64,
        /// Why, and what to do; `None`: it is not wanted any more.
        why: Option<String>,
    },
    /// Another program has written the file since; it was left as it is.
    ChangedMeanwhile {
        /// The file.
        path: PathBuf,
        /// Of which document.
        document: u64,
    },
    /// The same was found without saving.
    ChangedOutside {
        /// The file.
        path: PathBuf,
        /// Its state as the window knew it.
        known: Stamp,
        /// Its state now; `None`: it is gone.
        stamp: Option<Stamp>,
    },
    /// A plan is ready to be written for another program.
    Exported(Box<Exported>),
    /// It was written.
    ExportWritten {
        /// Where.
        path: PathBuf,
        /// What.
        exported: Arc<Exported>,
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
