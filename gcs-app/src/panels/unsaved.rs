//! The question before plans with unsaved changes give way to something else, or are closed with the window; and before a
//! window that watches a flight is closed.

use super::{Scene, dialog, primary_button};
use crate::command::{DocumentCommand, Queue, Replacement, ViewCommand};
use crate::document::Document;
use crate::theme;
use egui::{Label, Rect, ScrollArea, Ui};

/// Draws it, while there is something to be decided.
pub fn show(ui: &mut Ui, room: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(with) = &scene.view.unsaved else { return };
    let quits = *with == Replacement::Quit;
    let documents: Vec<&Document> = match quits {
        true => scene.shelf.unsaved(scene.document).collect(),
        false => vec![scene.document],
    };
    let flying = if quits { flying(scene) } else { None };
    let is_given_up = dialog::show(ui, room, scene, "unsaved", |ui| {
        ui.set_width(400.0);
        if !documents.is_empty() {
            title(ui, &documents, scene.document.id());
            ui.label(consequence(with));
        }
        if let Some(flying) = &flying {
            ui.strong(flying);
            ui.label(match scene.view.is_demo {
                true => "The demo ends with this window.",
                false => "It flies on by its plan, and nobody watches it from this window any more.",
            });
        }
        ui.add_space(8.0);
        ui.horizontal_wrapped(|ui| {
            if documents.is_empty() {
                if ui.button("Close all the same").clicked() {
                    queue.document(DocumentCommand::Discard(with.clone()));
                }
                if ui.add(primary_button("Cancel", theme::of(ui))).clicked() {
                    queue.view(ViewCommand::KeepUnsaved);
                }
                return;
            }
            let save = if quits { "Save and quit" } else { "Save first" };
            if ui.add(primary_button(save, theme::of(ui))).clicked() {
                queue.document(DocumentCommand::SaveThen(with.clone()));
            }
            if ui.button("Discard the changes").clicked() {
                queue.document(DocumentCommand::Discard(with.clone()));
            }
            if ui.button("Cancel").clicked() {
                queue.view(ViewCommand::KeepUnsaved);
            }
        });
    });
    if is_given_up {
        queue.view(ViewCommand::KeepUnsaved);
    }
}

/// Who is in the air.
fn flying(scene: &Scene<'_>) -> Option<String> {
    let names: Vec<&str> = scene.vehicles.flying().map(|name| name.as_str()).collect();
    let verb = if names.len() == 1 { "is" } else { "are" };
    (!names.is_empty()).then(|| format!("{} {verb} in the air", names.join(", ")))
}

/// `shown`: the number of the document that is shown.
fn title(ui: &mut Ui, documents: &[&Document], shown: u64) {
    let name = |document: &Document| document.plan().name.clone();
    if let [document] = documents {
        ui.strong(format!("“{}” ({}) has unsaved changes", name(document), document.file_name()));
        if document.id() != shown {
            ui.label("It is not the plan that is shown: undo leads there.");
        }
        return;
    }
    ui.strong(format!("{} plans have unsaved changes", documents.len()));
    ScrollArea::vertical().max_height(160.0).show(ui, |ui| {
        for document in documents {
            let text = format!("“{}”, {}", name(document), document.file_name());
            ui.add(Label::new(text).truncate());
        }
    });
}

fn consequence(with: &Replacement) -> &'static str {
    match with {
        Replacement::New => "A new plan takes its place. Until the window closes, undo brings this one back.",
        Replacement::AskOpen | Replacement::AskImport | Replacement::Open(_) => {
            "Another plan takes its place. Until the window closes, undo brings this one back."
        }
        Replacement::Quit => "The window is about to close: the changes would be lost.",
    }
}
