//! A file dialog in the window, for desktops that offer none.

use super::{Scene, dialog, primary_button};
use crate::command::{DocumentCommand, Queue, ViewCommand};
use crate::files::{Entry, Purpose};
use crate::formats;
use crate::theme;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Align, Id, Key, Layout, Rect, RichText, ScrollArea, Ui};
use std::path::PathBuf;

/// A folder in which a file is chosen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Browsing {
    /// What the file is for.
    pub purpose: Purpose,
    /// The folder.
    pub folder: PathBuf,
    /// What is in it, or why that is not known; `None`: it is being read.
    pub entries: Option<Result<Vec<Entry>, String>>,
    /// The name as it is typed: of the folder's files, or a path.
    pub name: String,
}

impl Browsing {
    /// A folder whose entries are still to be read.
    pub fn new(purpose: Purpose, folder: PathBuf, name: String) -> Self {
        Self { purpose, folder, entries: None, name }
    }

    /// A file of this name is there.
    fn has(&self, name: &str) -> bool {
        let entries = self.entries.iter().flatten().flatten();
        entries.into_iter().any(|entry| !entry.is_folder && entry.name == name)
    }

    /// What is typed, as a path: `~` is the user's own folder, and what is written ends in what says its format.
    fn target(&self, name: &str) -> PathBuf {
        let mut path = match (name.strip_prefix("~/"), std::env::home_dir()) {
            (Some(rest), Some(home)) => home.join(rest),
            _ => self.folder.join(name),
        };
        if self.purpose != Purpose::Open && path.extension().is_none() && !names_folder(name) {
            path.set_extension(self.purpose.extension());
        }
        path
    }

    /// What a typed name asks for.
    fn wish(&self, name: &str) -> Wish {
        let name = name.trim();
        if name.is_empty() {
            return Wish::Nothing;
        }
        let path = self.target(name);
        match (self.purpose, path.file_name()) {
            _ if names_folder(name) => Wish::Folder(path, String::new()),
            (_, None) => Wish::Folder(path, String::new()),
            (Purpose::Open, Some(_)) => Wish::Open(path),
            (_, Some(file)) if path.parent() == Some(&self.folder) && self.has(&file.to_string_lossy()) => {
                Wish::Overwrite(path)
            }
            // in a folder that is not shown, too: what is there already is not overwritten, and that is said
            (_, Some(_)) => Wish::Save(path),
        }
    }
}

fn names_folder(name: &str) -> bool {
    name.ends_with(std::path::is_separator) || matches!(name, "~" | "." | "..")
}

#[derive(Debug, PartialEq, Eq)]
enum Wish {
    Nothing,
    /// Go there, with this name.
    Folder(PathBuf, String),
    Open(PathBuf),
    Save(PathBuf),
    Overwrite(PathBuf),
}

/// Draws it, while a file is asked for.
pub fn show(ui: &mut Ui, room: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(browsing) = &scene.view.browsing else { return };
    let is_given_up = dialog::show(ui, room, scene, "browse", |ui| {
        ui.set_width(480.0);
        ui.strong(match browsing.purpose {
            Purpose::Open => "Open or import a plan".to_owned(),
            Purpose::Save => "Save the plan as".to_owned(),
            Purpose::Export(format) => format!("Export the plan as {}", formats::label(format)),
        });
        folder_row(ui, browsing, queue);
        entries(ui, browsing, queue);
        let (name, entered) = name_row(ui, browsing, queue);
        // what could not be opened is said here: the dialog covers the window
        if let (Some(why), Purpose::Open) = (&scene.view.notice, browsing.purpose) {
            ui.add(egui::Label::new(RichText::new(why).color(theme::of(ui).caution)).wrap());
        }
        ui.add_space(6.0);
        buttons(ui, browsing.purpose, browsing.wish(&name), entered, queue);
    });
    if is_given_up {
        queue.view(ViewCommand::StopBrowsing);
    }
}

fn folder_row(ui: &mut Ui, browsing: &Browsing, queue: &mut Queue) {
    ui.horizontal(|ui| {
        let above = browsing.folder.parent();
        let up = ui.add_enabled(above.is_some(), egui::Button::new("⬆ Up"));
        if let Some(above) = above.filter(|_| up.clicked()) {
            queue.document(DocumentCommand::Browse(above.to_owned(), browsing.name.clone()));
        }
        if let Some(home) = std::env::home_dir()
            && ui.button("Home").clicked()
        {
            queue.document(DocumentCommand::Browse(home, browsing.name.clone()));
        }
        let path = browsing.folder.display().to_string();
        ui.add(egui::Label::new(RichText::new(&path).color(theme::of(ui).weak)).truncate())
            .on_hover_text(path);
    });
}

fn entries(ui: &mut Ui, browsing: &Browsing, queue: &mut Queue) {
    const ROWS_HEIGHT: f32 = 260.0;
    const ROW: f32 = 20.0;
    ui.separator();
    let area = ScrollArea::vertical().id_salt(&browsing.folder).auto_shrink(false).max_height(ROWS_HEIGHT);
    match &browsing.entries {
        None => drop(area.show(ui, |ui| ui.spinner())),
        Some(Err(why)) => drop(area.show(ui, |ui| ui.colored_label(theme::of(ui).warning, why))),
        Some(Ok(entries)) if entries.is_empty() => {
            area.show(ui, |ui| ui.weak("There is no folder and no such file in here."));
        }
        Some(Ok(entries)) => {
            area.show_rows(ui, ROW, entries.len(), |ui, shown| {
                ui.with_layout(Layout::top_down_justified(Align::LEFT), |ui| {
                    for entry in entries.get(shown).unwrap_or_default() {
                        entry_row(ui, browsing, entry, queue);
                    }
                });
            });
        }
    }
    ui.separator();
}

fn entry_row(ui: &mut Ui, browsing: &Browsing, entry: &Entry, queue: &mut Queue) {
    let text = if entry.is_folder { format!("🗀 {}", entry.name) } else { entry.name.clone() };
    let is_chosen = !entry.is_folder && entry.name == browsing.name;
    let row = ui.selectable_label(is_chosen, text);
    if entry.is_folder && row.clicked() {
        queue.document(DocumentCommand::Browse(browsing.folder.join(&entry.name), browsing.name.clone()));
    } else if row.double_clicked() && browsing.purpose == Purpose::Open {
        open(browsing.folder.join(&entry.name), queue);
    } else if row.clicked() {
        queue.view(ViewCommand::NameFile(entry.name.clone()));
    }
}

/// The name as it is now, and whether Enter was pressed in it: on a slow machine the last letters and Enter come in one frame.
fn name_row(ui: &mut Ui, browsing: &Browsing, queue: &mut Queue) -> (String, bool) {
    let mut name = browsing.name.clone();
    let label = ui.label("File name");
    let field = egui::TextEdit::singleline(&mut name)
        .id(Id::unique("browse name"))
        .hint_text("name, or a whole path")
        .desired_width(f32::INFINITY);
    let response = ui.add(field).labelled_by(label.id);
    if ui.memory(|m| m.focused().is_none()) && !response.lost_focus() {
        response.request_focus();
        select_stem(ui, response.id, &browsing.name);
    }
    if response.changed() {
        queue.view(ViewCommand::NameFile(name.clone()));
    }
    (name, response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter)))
}

/// The name without what says its format: that is what is typed anew.
fn select_stem(ui: &Ui, id: Id, name: &str) {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let range = CCursorRange::two(CCursor::new(0), CCursor::new(stem.chars().count()));
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(range));
    state.store(ui.ctx(), id);
}

fn buttons(ui: &mut Ui, purpose: Purpose, wish: Wish, entered: bool, queue: &mut Queue) {
    let p = theme::of(ui);
    let (text, needs_click) = match (&wish, purpose) {
        (Wish::Folder(..), _) => ("Go there", false),
        (Wish::Overwrite(_), _) => ("Replace the file", true),
        (_, Purpose::Open) => ("Open", false),
        (_, Purpose::Save | Purpose::Export(_)) => ("Save here", false),
    };
    if let Wish::Overwrite(path) = &wish {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let text = format!(
            "{name} is there already. What is in it would be lost: Enter does not do that, the button does."
        );
        ui.colored_label(p.caution, text);
    }
    ui.horizontal(|ui| {
        let button = ui.add_enabled(wish != Wish::Nothing, primary_button(text, p));
        if button.clicked() || (entered && !needs_click) {
            carry_out(wish, purpose, queue);
        }
        if ui.button("Cancel").clicked() {
            queue.view(ViewCommand::StopBrowsing);
        }
    });
}

fn carry_out(wish: Wish, purpose: Purpose, queue: &mut Queue) {
    match wish {
        Wish::Nothing => {}
        Wish::Folder(folder, name) => queue.document(DocumentCommand::Browse(folder, name)),
        Wish::Open(path) => open(path, queue),
        Wish::Save(path) => save(path, false, purpose, queue),
        Wish::Overwrite(path) => save(path, true, purpose, queue),
    }
}

fn save(path: PathBuf, over: bool, purpose: Purpose, queue: &mut Queue) {
    queue.document(match purpose {
        Purpose::Export(_) => DocumentCommand::ExportTo { path, over },
        Purpose::Open | Purpose::Save => DocumentCommand::SaveTo { path, over },
    });
}

fn open(path: PathBuf, queue: &mut Queue) {
    queue.document(DocumentCommand::Open(path));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(purpose: Purpose, name: &str) -> Wish {
        let here = |name: &str, is_folder| Entry { name: name.into(), is_folder };
        Browsing {
            entries: Some(Ok(vec![here("below", true), here("old.xml", false)])),
            ..Browsing::new(purpose, "/plans".into(), String::new())
        }
        .wish(name)
    }

    #[test]
    fn typed_names_are_understood_and_nothing_is_overwritten_unseen() {
        use Purpose::{Open, Save};
        let folder = |path: &str, name: &str| Wish::Folder(path.into(), name.into());
        for (purpose, name, expected) in [
            (Open, " ", Wish::Nothing),
            (Open, "old.xml", Wish::Open("/plans/old.xml".into())),
            (Open, "/else/a.xml", Wish::Open("/else/a.xml".into())),
            (Open, "below/", folder("/plans/below/", "")),
            (Save, "new", Wish::Save("/plans/new.xml".into())),
            (Save, "new.v2.xml", Wish::Save("/plans/new.v2.xml".into())),
            (Save, "old", Wish::Overwrite("/plans/old.xml".into())),
            (Save, "below/new", Wish::Save("/plans/below/new.xml".into())),
            (Save, "/else/old.xml", Wish::Save("/else/old.xml".into())),
            (Save, "..", folder("/plans/..", "")),
        ] {
            assert_eq!(wish(purpose, name), expected, "{purpose:?} {name}");
        }
    }
}
