//! The question after a crash: the work that was not saved, or a clean start.

use super::primary_button;
use crate::command::{DocumentCommand, Queue};
use crate::recovery::LeftBehind;
use crate::{theme, units};
use egui::Ui;

/// Draws it. It hides nothing that a flight is led with: a window may have crashed in the middle of one.
pub fn show(ui: &mut Ui, found: &LeftBehind, queue: &mut Queue) {
    ui.set_width(380.0);
    ui.strong("The last window ended without saving");
    let age = units::duration(found.age.as_secs_f64());
    ui.label(format!("It had changes of {}. They were kept {age} ago.", files(found)));
    ui.add_space(8.0);
    ui.horizontal(|ui| {
        let recover = ui.add(primary_button("Recover the changes", theme::of(ui)));
        // Return presses it, until something else is chosen
        let asked = recover.id.with("asked");
        if !ui.data(|d| d.get_temp(asked)).unwrap_or(false) {
            ui.data_mut(|d| d.insert_temp(asked, true));
            recover.request_focus();
        }
        if recover.clicked() {
            queue.document(DocumentCommand::Recover);
        }
        if ui.button("Delete them").clicked() {
            queue.document(DocumentCommand::ForgetLeftBehind);
        }
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
