//! The question after a crash: the work that was not saved, or a clean start.

use super::{Scene, primary_button};
use crate::command::{DocumentCommand, Queue};
use crate::{theme, units};
use egui::{Id, Modal, Ui};

/// Draws it, while there is something to be decided.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(found) = scene.left_behind else { return };
    Modal::new(Id::unique("recover")).show(ui.ctx(), |ui| {
        ui.set_width(380.0);
        ui.strong("The last window ended without saving");
        let file =
            found.path.as_ref().map_or_else(|| "a plan without a file".into(), |p| p.display().to_string());
        let age = units::duration(found.age.as_secs_f64());
        ui.label(format!("It had changes of {file}. They were kept {age} ago."));
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if ui.add(primary_button("Recover the changes", theme::of(ui))).clicked() {
                queue.document(DocumentCommand::Recover);
            }
            if ui.button("Delete them").clicked() {
                queue.document(DocumentCommand::ForgetLeftBehind);
            }
        });
    });
}
