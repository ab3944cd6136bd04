//! The document and its files: opening, saving, asking where, and what was never saved.

use super::App;
use crate::document::Document;
use crate::files::{Entry, FileEvent, Over, Purpose, Stamp, Writing};
use crate::layers::LayerCommand;
use crate::panels::browse::Browsing;
use crate::recovery::{Keeper, LeftBehind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl App {
    /// Keeps a copy of unsaved changes in this folder, and offers what a crashed window left there.
    pub fn keep_copies(&mut self, folder: &Path) {
        match Keeper::open(folder) {
            Ok(keeper) => self.keeper = Some(keeper),
            Err(error) => {
                self.view.notice = Some(format!(
                    "No copy of unsaved changes can be kept in {}: {error}. Save the plan often.",
                    folder.display()
                ));
            }
        }
    }

    /// Asks for files in the window, as on a desktop without dialogs.
    pub fn ask_for_files_here(&mut self) {
        self.files.desktop = false;
    }

    pub(super) fn tend_copy(&mut self, ctx: &egui::Context) {
        let Some(keeper) = &mut self.keeper else { return };
        if let Some(wait) = keeper.tend(&self.document, ctx.input(|i| i.time)) {
            ctx.request_repaint_after(wait);
        }
        self.view.notice = keeper.failure().or_else(|| self.view.notice.take());
    }

    pub(super) fn file_event(&mut self, event: FileEvent) {
        match event {
            FileEvent::Opened { path, bytes, stamp } => {
                self.recent.add(&path);
                let mut opened = Document::read(&bytes, Some(path));
                opened.set_stamp(stamp);
                self.shelf.open(&mut self.document, opened);
                self.show_another();
                self.view.notice = None;
            }
            FileEvent::Reread { path, bytes, stamp } => {
                if self.document.path() == Some(path.as_path()) {
                    self.document.reread(&bytes, stamp);
                }
            }
            FileEvent::Saved { path, text, document, version, stamp } => {
                self.saving = false;
                self.recent.add(&path);
                self.saved(document, version, path, text, stamp);
            }
            FileEvent::ChangedMeanwhile(path) => {
                self.saving = false;
                // who saves again has been told
                self.document.set_stamp(None);
                self.view.notice = Some(format!(
                    "{} was changed by another program and is not overwritten. “Save as…” keeps both; save again to replace it.",
                    path.display()
                ));
            }
            FileEvent::ChangedOutside { path, known, stamp } => self.changed_outside(&path, known, stamp),
            FileEvent::MapChosen(path) => self.change_layers(LayerCommand::Add(path)),
            FileEvent::NoDialog(purpose) => self.ask_here(purpose),
            FileEvent::Listed { folder, entries } => self.show_folder(folder, entries),
            FileEvent::Failed(why) => {
                self.saving = false;
                self.view.notice = Some(why);
            }
        }
    }

    fn saved(&mut self, document: u64, version: u64, path: PathBuf, text: Arc<str>, stamp: Option<Stamp>) {
        let Some(saved) = self.shelf.find(&mut self.document, document) else { return };
        if saved.version() != version {
            let why = format!("{} was saved; edits made meanwhile are not in it yet.", path.display());
            self.view.notice = Some(why);
        }
        saved.saved(version, path, text, stamp);
    }

    /// Another document took the place of the one that was shown.
    pub(super) fn show_another(&mut self) {
        self.view.select(None);
        self.view.cursor_s = None;
        self.view.changed_outside = None;
        self.map.fit();
    }

    /// Has the document's file looked at, as long as nobody is asked about it and it is not being written.
    pub(super) fn watch_file(&mut self) {
        let is_quiet = !self.saving && self.view.changed_outside.is_none();
        let file = self.document.path().zip(self.document.stamp()).filter(|_| is_quiet);
        self.files.watch(file.map(|(path, stamp)| (path.to_owned(), stamp)));
    }

    fn changed_outside(&mut self, path: &Path, known: Stamp, now: Option<Stamp>) {
        let is_news = self.document.path() == Some(path) && self.document.stamp() == Some(known);
        if self.saving || !is_news {
            return;
        }
        self.view.changed_outside = now;
        if now.is_none() {
            // its stamp stays: what comes back in its place is not overwritten unseen
            self.document.differs_from_file();
            let why = "was deleted or moved by another program. Save to write it again.";
            self.view.notice = Some(format!("{} {why}", path.display()));
        }
    }

    pub(super) fn load_theirs(&mut self) {
        self.keep_mine();
        if let Some(path) = self.document.path() {
            self.files.reread(path.to_owned());
        }
    }

    pub(super) fn keep_mine(&mut self) {
        let stamp = self.view.changed_outside.take();
        self.document.set_stamp(stamp);
        self.document.differs_from_file();
    }

    pub(super) fn save(&mut self) {
        match self.document.path() {
            // a held key asks again and again
            Some(_) if self.saving => {}
            Some(path) => {
                let over = self.document.stamp().map_or(Over::Anything, Over::As);
                self.saving = true;
                self.files.save(path.to_owned(), Writing { over, ..self.writing() });
            }
            None => self.ask_save(),
        }
    }

    pub(super) fn recover(&mut self) {
        let Some(found) = self.take_left_behind() else { return };
        let mut recovered = Document::recovered(found.text.as_bytes(), found.path);
        recovered.set_stamp(found.stamp);
        self.shelf.open(&mut self.document, recovered);
        self.show_another();
    }

    pub(super) fn take_left_behind(&mut self) -> Option<LeftBehind> {
        self.keeper.as_mut().and_then(Keeper::take_left_behind)
    }

    /// Saves in a file that was chosen; over another one only if that was chosen, too.
    pub(super) fn save_to(&mut self, path: PathBuf, over: bool) {
        let over = if over { Over::Anything } else { Over::Nothing };
        self.saving = self.document.path() == Some(path.as_path());
        self.files.save(path, Writing { over, ..self.writing() });
    }

    pub(super) fn ask_save(&mut self) {
        self.files.ask_save(self.suggested_name(), self.writing());
    }

    /// The document for any file: who chose that one knows what is in it.
    fn writing(&self) -> Writing {
        Writing {
            plan: self.document.plan().clone(),
            original: self.document.text().cloned(),
            document: self.document.id(),
            version: self.document.version(),
            over: Over::Anything,
        }
    }

    fn suggested_name(&self) -> String {
        let name = self.document.path().and_then(Path::file_name);
        name.map_or_else(|| "plan.xml".into(), |n| n.to_string_lossy().into_owned())
    }

    /// Asks in the window, beginning where the document's file is.
    pub(super) fn ask_here(&mut self, purpose: Purpose) {
        self.files.desktop = false;
        let beside = self.document.path().and_then(Path::parent).map(Path::to_owned);
        let folder = beside.filter(|f| !f.as_os_str().is_empty()).or_else(std::env::home_dir);
        let name = if purpose == Purpose::Save { self.suggested_name() } else { String::new() };
        let folder = folder.unwrap_or_else(|| ".".into());
        self.view.browsing = Some(Browsing::new(purpose, folder.clone(), name));
        self.files.list(folder);
    }

    pub(super) fn browse(&mut self, folder: PathBuf, name: String) {
        let Some(browsing) = &mut self.view.browsing else { return };
        *browsing = Browsing::new(browsing.purpose, folder.clone(), name);
        self.files.list(folder);
    }

    pub(super) fn show_folder(&mut self, folder: PathBuf, entries: Result<Vec<Entry>, String>) {
        if let Some(browsing) = &mut self.view.browsing {
            browsing.folder = folder;
            browsing.entries = Some(entries);
        }
    }
}
