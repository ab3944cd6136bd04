//! The document and its files: opening, saving, asking where, and what was never saved.

use super::App;
use super::file_name::file_name;
use super::settings::Settings;
use crate::command::Replacement;
use crate::document::Document;
use crate::export::Exported;
use crate::files::{Choices, Content, Entry, FileEvent, Over, Purpose, Stamp, Writing};
use crate::jobs::{Taken, Task};
use crate::layers::{LayerCommand, Source};
use crate::map::{clipboard, drawings};
use crate::panels::browse::Browsing;
use crate::recovery::{Keeper, LeftDocument};
use crate::state::Level;
use flight_exec::rehearse::WhatIf;
use interchange::{Format, Note};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// So many notes about an import or an export are put into the log.
const MOST_NOTES: usize = 200;

impl App {
    /// Keeps a copy of unsaved changes in this folder, and offers what a crashed window left there.
    ///
    /// The folder is looked into in the background: the disk that it is on may be slow.
    pub fn keep_copies(&mut self, folder: &Path) {
        let folder = folder.to_owned();
        let open = move || {
            Keeper::open(&folder).map_err(|error| {
                let folder = folder.display();
                format!("No copy of unsaved changes can be kept in {folder}: {error}. Save the plan often.")
            })
        };
        self.opening_copies = Some(Task::begin(self.wake.clone(), open));
    }

    fn take_keeper(&mut self) {
        let Some(opening) = self.opening_copies.take() else { return };
        match opening.take() {
            Taken::NotYet => self.opening_copies = Some(opening),
            Taken::Done(Ok(keeper)) => self.keeper = Some(keeper),
            Taken::Done(Err(why)) => self.view.notice = Some(why),
            Taken::Failed => {
                let why =
                    "No copy of unsaved changes can be kept: the program failed at it. Save the plan often.";
                self.view.notice = Some(why.into());
            }
        }
    }

    /// Asks for files in the window, as on a desktop without dialogs.
    pub fn ask_for_files_here(&mut self) {
        self.files.desktop = false;
    }

    /// Reads files from this disk instead of the machine's, and writes them there.
    pub fn use_disk(&mut self, disk: std::sync::Arc<dyn crate::files::Disk>) {
        self.files.use_disk(disk);
    }

    /// Waits like this for the disk to have taken the settings, on a thread.
    pub fn sync_settings_by(&mut self, sync: Arc<dyn Fn() + Send + Sync>) {
        self.settings = Settings::synced_by(sync);
    }

    pub(super) fn tend_copy(&mut self, ctx: &egui::Context) {
        let now = self.now(ctx);
        self.take_keeper();
        let Some(keeper) = &mut self.keeper else { return };
        let unsaved = self.shelf.unsaved(&self.document);
        if let Some(wait) = keeper.tend(unsaved, now.window_s, now.utc) {
            ctx.request_repaint_after(wait);
        }
        match keeper.failure() {
            // why the plan could not be saved says more
            Some(why) if self.view.notice.as_ref().is_some_and(|notice| *notice != why) => {
                self.toasts.add(now.window_s, Level::Caution, why);
            }
            Some(why) => self.view.notice = Some(why),
            None => {}
        }
    }

    pub(super) fn file_event(&mut self, event: FileEvent, now_s: f64) {
        match event {
            FileEvent::Chosen(path) => self.files.open(path),
            FileEvent::PlanDropped(path) => self.ask_or_replace(Replacement::Open(path)),
            FileEvent::Opened(Content::Plan(opened)) => {
                opened.path().into_iter().for_each(|path| self.recent.add(path));
                self.shelf.open(&mut self.document, *opened);
                self.show_another();
                self.view.browsing = None;
            }
            FileEvent::Opened(Content::Foreign(imported)) => {
                self.view.browsing = None;
                self.view.imported = Some(imported.into());
            }
            FileEvent::Reread { path, theirs } => {
                if self.document.path() == Some(path.as_path()) {
                    self.document.reread(*theirs);
                    self.toasts.add(
                        now_s,
                        Level::Info,
                        format!("Loaded {} again", self.document.file_name()),
                    );
                }
            }
            FileEvent::Saved { path, text, document, version, stamp } => {
                self.saving.remove(&document);
                self.recent.add(&path);
                let name = path.display().to_string();
                self.toasts.withdraw(|said| said.starts_with(&name));
                self.toasts.add(now_s, Level::Info, format!("Saved {name}"));
                // why it could not be saved before
                self.view.notice = None;
                self.saved(document, version, path, text, stamp);
            }
            FileEvent::NotSaved { document, why } => self.not_saved(document, why),
            FileEvent::ChangedMeanwhile { path, document } => self.changed_meanwhile(&path, document),
            FileEvent::ChangedOutside { path, known, stamp } => {
                self.changed_outside(&path, known, stamp, now_s)
            }
            FileEvent::Exported(exported) => {
                self.view.exported = Some((*exported).into());
                self.view.notice = None;
            }
            FileEvent::ExportWritten { path, exported } => self.exported(&path, &exported, now_s),
            FileEvent::MapChosen(path) => self.change_layers(LayerCommand::Add(Source::File(path))),
            FileEvent::NoDialog(purpose) => self.ask_here(purpose),
            FileEvent::Listed { folder, entries } => self.show_folder(folder, entries),
            FileEvent::Failed(why) => self.view.notice = Some(why),
        }
    }

    fn saved(&mut self, document: u64, version: u64, path: PathBuf, text: Arc<str>, stamp: Option<Stamp>) {
        let Some(saved) = self.shelf.find(&mut self.document, document) else { return };
        if saved.version() != version {
            let why = format!("{} was saved; edits made meanwhile are not in it yet.", path.display());
            self.view.notice = Some(why);
        }
        saved.saved(version, path, text, stamp);
        self.shelf.saved(&mut self.document, document);
    }

    fn not_saved(&mut self, document: u64, why: Option<String>) {
        self.saving.remove(&document);
        self.after_saving = None;
        self.view.notice = why.or_else(|| self.view.notice.take());
    }

    fn changed_meanwhile(&mut self, path: &Path, document: u64) {
        // who saves again has been told
        if let Some(document) = self.shelf.find(&mut self.document, document) {
            document.set_stamp(None);
        }
        let why = "was changed by another program and is not overwritten. “Save as…” keeps both; save again to replace it.";
        self.not_saved(document, Some(format!("{} {why}", path.display())));
    }

    fn exported(&mut self, path: &Path, exported: &Exported, now_s: f64) {
        self.view.exported = None;
        let text = format!("Exported to {}", path.display());
        self.tell_losses(text, &exported.notes, now_s);
    }

    /// The losses of an import or an export can be read in the log afterwards.
    fn tell_losses(&mut self, text: String, notes: &[Note], now_s: f64) {
        for note in notes.iter().take(MOST_NOTES).rev() {
            self.toasts.note(now_s, Level::Info, &note.to_string());
        }
        match notes.len() {
            0 => self.toasts.add(now_s, Level::Info, text),
            1 => self.toasts.add(now_s, Level::Info, format!("{text}. One note about it is in the log")),
            more => {
                self.toasts.add(now_s, Level::Info, format!("{text}. {more} notes about it are in the log"))
            }
        }
    }

    /// Puts a plan of another program in the document's place.
    pub(super) fn take_import(&mut self, now_s: f64) {
        if let Some(imported) = self.view.imported.take() {
            let name = imported.path.file_name().unwrap_or_default().to_string_lossy();
            self.tell_losses(format!("Imported {name}"), &imported.import.notes, now_s);
            // nobody else holds it: it is not copied within a frame, however large it is
            let plan =
                Arc::try_unwrap(imported).map_or_else(|one| one.import.plan.clone(), |one| one.import.plan);
            self.shelf.open(&mut self.document, Document::imported(plan));
            self.show_another();
        }
    }

    /// Adds what another program has drawn to the document, as one step.
    pub(super) fn add_import(&mut self, now_s: f64) {
        let Some(imported) = self.view.imported.take() else { return };
        let plan = self.document.plan();
        let selected = self.view.selection.as_ref();
        let added = drawings::add(&imported.features, &imported.choices, plan, selected);
        let done =
            added.and_then(|added| self.document.edit(&added.edit).map(|()| clipboard::selections(&added)));
        match done {
            Ok(made) => {
                made.first().into_iter().for_each(|first| self.map.reveal(first));
                let mut made = made.into_iter();
                self.view.select(made.next());
                self.view.also.extend(made);
                let name = imported.path.file_name().unwrap_or_default().to_string_lossy();
                self.toasts.add(now_s, Level::Info, format!("Added what {name} draws"));
            }
            Err(why) => self.tell(Err(why)),
        }
    }

    pub(super) fn import_as(&mut self, choices: Choices) {
        if let Some(imported) = &self.view.imported {
            self.files.open_with(imported.path.clone(), choices);
        }
    }

    pub(super) fn export(&mut self, format: Format) {
        self.files.export(self.document.plan().clone(), format, self.layers.elevations().clone());
    }

    pub(super) fn ask_export(&mut self) {
        if let Some(exported) = &self.view.exported {
            self.files.ask_export(self.export_name(exported), exported.clone());
        }
    }

    pub(super) fn export_to(&mut self, path: PathBuf, over: bool) {
        if let Some(exported) = self.view.exported.take() {
            self.files.write_export(path, exported, over_if(over));
        }
        self.view.browsing = None;
    }

    /// Another document took the place of the one that was shown.
    pub(super) fn show_another(&mut self) {
        self.forget_the_last();
        self.map.fit();
    }

    /// What was selected in the document that was shown, said of it, drawn and tried with it.
    pub(super) fn forget_the_last(&mut self) {
        self.view.select(None);
        (self.view.notice, self.view.changed_outside) = (None, None);
        (self.view.cursor_s, self.view.playing, self.view.alarm) = (None, false, None);
        self.view.what_if = WhatIf::default();
        self.map.close_menu();
        // nothing is drawn until it is asked for
        self.map.choose_tool("");
    }

    /// Has the document's file looked at, as long as nobody is asked about it and it is not being written.
    pub(super) fn watch_file(&mut self) {
        let is_quiet = !self.is_saving() && self.view.changed_outside.is_none();
        let file = self.document.path().zip(self.document.stamp()).filter(|_| is_quiet);
        self.files.watch(file.map(|(path, stamp)| (path.to_owned(), stamp)));
    }

    fn changed_outside(&mut self, path: &Path, known: Stamp, now: Option<Stamp>, now_s: f64) {
        let is_news = self.document.path() == Some(path) && self.document.stamp() == Some(known);
        if self.is_saving() || !is_news {
            return;
        }
        self.view.changed_outside = now;
        if now.is_none() {
            // its stamp stays: what comes back in its place is not overwritten unseen
            self.document.differs_from_file();
            let why = "was deleted or moved by another program. Save to write it again.";
            let text = format!("{} {why}", path.display());
            match self.view.notice {
                // why it could not be saved says more
                Some(_) => self.toasts.add(now_s, Level::Caution, text),
                None => self.view.notice = Some(text),
            }
        }
    }

    pub(super) fn load_theirs(&mut self) {
        self.keep_mine();
        if let Some(path) = self.document.path() {
            self.files.reread(path.to_owned());
        }
    }

    pub(super) fn keep_mine(&mut self) {
        self.view.notice = None;
        let stamp = self.view.changed_outside.take();
        self.document.set_stamp(stamp);
        self.document.differs_from_file();
    }

    /// The document that is shown is being written, or asked where to.
    fn is_saving(&self) -> bool {
        self.saving.contains(&self.document.id())
    }

    pub(super) fn save(&mut self) {
        match self.document.path() {
            // a held key asks again and again
            _ if self.is_saving() => {}
            Some(path) if let Some(why) = would_be_lost(&self.document) => {
                let what_to_do = "Save under another name, or replace it all the same.";
                self.view.notice = Some(format!("{} {why}. {what_to_do}", path.display()));
                self.ask_save();
            }
            Some(path) => {
                let writing = known(&self.document);
                self.files.save(path.to_owned(), writing);
                self.saving.insert(self.document.id());
            }
            None => self.ask_save(),
        }
    }

    /// What was to happen once the plan is saved; nothing, when it could not be.
    pub(super) fn go_on_after_saving(&mut self) {
        if !self.saving.is_empty() || self.view.browsing.is_some() {
            return;
        }
        match self.after_saving.take() {
            None => {}
            Some(Replacement::Quit) => self.go_on_quitting(),
            Some(with) if self.document.is_dirty() => self.ask_or_replace(with),
            Some(with) => self.replace(with),
        }
    }

    /// Saves what has unsaved changes, one document after the other, then closes the window. Stops when one can't be saved.
    fn go_on_quitting(&mut self) {
        self.after_saving = Some(Replacement::Quit);
        let next = self.shelf.unsaved(&self.document).next().map(Document::id);
        match next {
            None => self.leaving = true,
            Some(next) => {
                if self.shelf.turn_to(&mut self.document, next) {
                    self.show_another();
                }
                self.save();
            }
        }
    }

    pub(super) fn recover(&mut self, only: Option<usize>) {
        let found = self.take_left_behind(only);
        if found.is_empty() {
            return;
        }
        self.document.set_discarded(false);
        let several = found.len() > 1;
        // the one that was shown is shown again
        for left in found.into_iter().rev() {
            let mut recovered = Document::recovered(left.text.as_bytes(), left.path.clone());
            recovered.set_stamp(left.stamp);
            self.keeper.iter_mut().for_each(|keeper| keeper.recovered_as(recovered.version(), &left));
            self.shelf.open(&mut self.document, recovered);
        }
        self.show_another();
        self.view.notice = several.then(|| self.also_recovered());
    }

    pub(super) fn take_left_behind(&mut self, only: Option<usize>) -> Vec<LeftDocument> {
        self.keeper.as_mut().map_or_else(Vec::new, |keeper| keeper.take_left_behind(only))
    }

    /// Saves in a file that was chosen; over another one only if that was chosen, too.
    pub(super) fn save_to(&mut self, path: PathBuf, over: bool) {
        self.view.browsing = None;
        self.saving.insert(self.document.id());
        self.files.save(path, Writing { over: over_if(over), ..known(&self.document) });
    }

    /// Of several plans one is shown, and nobody looks for the others where nothing tells of them.
    fn also_recovered(&self) -> String {
        let others = self.shelf.unsaved(&self.document).skip(1);
        let names = others.map(|other| format!("“{}” ({})", other.plan().name, other.file_name()));
        format!("Recovered, too: {}. Undo (Ctrl+Z) leads there.", names.collect::<Vec<_>>().join(", "))
    }

    pub(super) fn ask_save(&mut self) {
        if self.is_saving() {
            return;
        }
        self.saving.insert(self.document.id());
        let writing = Writing { over: Over::Anything, ..known(&self.document) };
        self.files.ask_save(self.suggested_name(), writing);
    }

    fn suggested_name(&self) -> String {
        let name = self.document.path().and_then(Path::file_name);
        name.map_or_else(
            || file_name(&self.document.plan().name, "xml"),
            |name| name.to_string_lossy().into_owned(),
        )
    }

    /// As the document's file is called, else as the plan is.
    fn export_name(&self, exported: &Exported) -> String {
        let stem = self.document.path().and_then(Path::file_stem).map(|stem| stem.to_string_lossy());
        file_name(stem.as_deref().unwrap_or(&exported.name), exported.format.name())
    }

    /// Asks in the window, beginning where the document's file is.
    pub(super) fn ask_here(&mut self, purpose: Purpose) {
        self.files.desktop = false;
        self.saving.remove(&self.document.id());
        let beside = self.document.path().and_then(Path::parent).map(Path::to_owned);
        let folder = beside.filter(|f| !f.as_os_str().is_empty()).or_else(std::env::home_dir);
        if purpose == Purpose::Open {
            // what was said before is of something else
            self.view.notice = None;
        }
        let name = match (purpose, &self.view.exported) {
            (Purpose::Open, _) => String::new(),
            (Purpose::Export(_), Some(exported)) => self.export_name(exported),
            (Purpose::Save | Purpose::Export(_), _) => self.suggested_name(),
        };
        let folder = folder.unwrap_or_else(|| ".".into());
        self.view.browsing = Some(Browsing::new(purpose, folder.clone(), name));
        self.files.list(folder, purpose);
    }

    /// Nothing is chosen.
    pub(super) fn stop_browsing(&mut self) {
        self.view.browsing = None;
        self.after_saving = None;
    }

    pub(super) fn browse(&mut self, folder: PathBuf, name: String) {
        let Some(browsing) = &mut self.view.browsing else { return };
        let purpose = browsing.purpose;
        *browsing = Browsing::new(purpose, folder.clone(), name);
        self.files.list(folder, purpose);
    }

    pub(super) fn show_folder(&mut self, folder: PathBuf, entries: Result<Vec<Entry>, String>) {
        if let Some(browsing) = &mut self.view.browsing {
            browsing.folder = folder;
            browsing.entries = Some(entries);
        }
    }
}

/// What would be lost if the document were written to its file.
fn would_be_lost(document: &Document) -> Option<&'static str> {
    match (document.is_partial(), document.is_superseded()) {
        _ if !document.is_dirty() => None,
        (true, _) => Some("could not be read whole, and what is missing here would be lost in it"),
        (_, true) => Some("has another plan that was saved from this window since, and that would be lost"),
        (false, false) => None,
    }
}

/// The document for its own file, as the window knows that.
fn known(document: &Document) -> Writing {
    Writing {
        plan: document.plan().clone(),
        original: document.text().cloned(),
        document: document.id(),
        version: document.version(),
        over: document.stamp().map_or(Over::Anything, Over::As),
    }
}

fn over_if(over: bool) -> Over {
    if over { Over::Anything } else { Over::Nothing }
}
