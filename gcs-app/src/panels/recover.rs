//! The question after a crash: the work that was not saved, or a clean start.

use super::{Scene, primary_button};
use crate::command::{DocumentCommand, Queue};
use crate::recovery::LeftBehind;
use crate::{theme, units};
use egui::{Id, Modal, Ui};

/// Draws it, while there is something to be decided.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(found) = scene.left_behind else { return };
    Modal::new(Id::unique("recover")).show(ui.ctx(), |ui| {
        ui.set_width(380.0);
        ui.strong("The last window ended without saving");
        let age = units::duration(found.age.as_secs_f64());
        ui.label(format!("It had changes of {}. They were kept {age} ago.", files(found)));
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

fn files(found: &LeftBehind) -> String {
    let path = found.documents.first().and_then(|document| document.path.as_ref());
    let first = path.map_or_else(|| "a plan without a file".into(), |path| path.display().to_string());
    match found.documents.len() {
        0 | 1 => first,
        2 => format!("{first} and of another plan"),
        number => format!("{first} and of {} other plans", number - 1),
    }
}
