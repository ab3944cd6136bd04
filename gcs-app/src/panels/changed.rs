//! The question when another program has changed the plan's file.

use super::{Scene, dialog, primary_button};
use crate::command::{DocumentCommand, Queue};
use crate::theme;
use egui::{Rect, Ui};

/// Draws it, while there is something to be decided.
pub fn show(ui: &mut Ui, room: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    if scene.view.changed_outside.is_none() {
        return;
    }
    let is_given_up = dialog::show(ui, room, scene, "changed", |ui| {
        ui.set_width(400.0);
        ui.strong(format!("Another program has changed {}", scene.document.file_name()));
        ui.label("Load what is in the file now (undo brings yours back), or keep yours: saving then replaces the file.");
        ui.add_space(8.0);
        ui.horizontal_wrapped(|ui| {
            if ui.add(primary_button("Load theirs", theme::of(ui))).clicked() {
                queue.document(DocumentCommand::LoadTheirs);
            }
            if ui.button("Keep mine").clicked() {
                queue.document(DocumentCommand::KeepMine);
            }
        });
    });
    if is_given_up {
        queue.document(DocumentCommand::KeepMine);
    }
}
