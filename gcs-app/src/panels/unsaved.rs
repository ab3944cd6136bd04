//! The question before a plan with unsaved changes gives way to something else.

use super::{Scene, primary_button};
use crate::command::{DocumentCommand, Queue, Replacement, ViewCommand};
use crate::theme;
use egui::{Id, Key, Modal, Ui};

/// Draws it, while there is something to be decided.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(with) = &scene.view.unsaved else { return };
    let modal = Modal::new(Id::unique("unsaved")).show(ui.ctx(), |ui| {
        ui.set_width(360.0);
        ui.strong(format!("“{}” has unsaved changes", scene.document.plan().name));
        ui.label(consequence(with));
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if ui.add(primary_button("Save first", theme::of(ui))).clicked() {
                queue.view(ViewCommand::KeepUnsaved);
                queue.document(DocumentCommand::Save);
            }
            if ui.button("Discard the changes").clicked() {
                queue.document(DocumentCommand::Discard(with.clone()));
            }
            if ui.button("Cancel").clicked() {
                queue.view(ViewCommand::KeepUnsaved);
            }
        });
    });
    if modal.should_close() || ui.input(|i| i.key_pressed(Key::Escape)) {
        queue.view(ViewCommand::KeepUnsaved);
    }
}

fn consequence(with: &Replacement) -> &'static str {
    match with {
        Replacement::New => "A new plan takes its place. Until the window closes, undo brings this one back.",
        Replacement::AskOpen | Replacement::Open(_) => {
            "Another plan takes its place. Until the window closes, undo brings this one back."
        }
        Replacement::Quit => "The window is about to close: the changes would be lost.",
    }
}
