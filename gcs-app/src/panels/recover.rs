//! The question after a crash: the work that was not saved, or a clean start.

use super::{field, primary_button};
use crate::command::{DocumentCommand, Queue, ViewCommand};
use crate::recovery::{LeftBehind, LeftDocument};
use crate::{theme, units};
use egui::{Key, Label, Response, RichText, ScrollArea, Ui};
use jiff::Timestamp;

/// Where there is room for it, screen points.
const WIDTH: f32 = 380.0;
/// Of the list of plans, at most and at least, screen points.
const LIST_HEIGHT: f32 = 190.0;
const LEAST_LIST: f32 = 60.0;
/// Of all that stands around the list, screen points.
const AROUND: f32 = 230.0;

/// Draws it. It hides nothing that a flight is led with: a window may have crashed in the middle of one.
/// `room`: so high it may be, screen points. `may_close`: Escape is for it. `is_calm`: no vehicle flies, and Return may be for it.
pub fn show(
    ui: &mut Ui,
    found: &LeftBehind,
    (room, utc): (f32, Timestamp),
    (may_close, is_calm): (bool, bool),
    queue: &mut Queue,
) {
    ui.set_width(ui.available_width().min(WIDTH));
    let p = theme::of(ui);
    let several = found.documents.len() > 1;
    ui.strong("The last window ended without saving");
    ui.label("It had changes of");
    let height = (room - AROUND).clamp(LEAST_LIST, LIST_HEIGHT);
    ScrollArea::vertical().id_salt("left behind").max_height(height).show(ui, |ui| {
        for (number, document) in found.documents.iter().enumerate() {
            ui.add(Label::new(format!("• {}", which(document))).truncate());
            ui.add(Label::new(RichText::new(format!("   {}", when(document, utc))).color(p.weak)).truncate());
            if several {
                ui.push_id(number, |ui| decide_on(ui, number, queue));
            }
        }
    });
    let opens = match several {
        true => "Recover all opens the first one; Undo leads to the others. Each is saved in its own file. ",
        false => "",
    };
    let text = format!("{opens}You may go on meanwhile: they are kept until you decide.");
    ui.add(Label::new(RichText::new(text).color(p.weak)).wrap());
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        let (all, none) = match several {
            true => ("Recover all", "Delete all"),
            false => ("Recover the changes", "Delete them"),
        };
        let recover = ui.add(primary_button(all, p));
        offer_return(ui, &recover, is_calm);
        if recover.clicked() {
            queue.document(DocumentCommand::Recover(None));
        }
        // no undo brings them back
        if field::hold_button(ui, none, p.caution, 0.0) {
            queue.document(DocumentCommand::ForgetLeftBehind(None));
        }
        let later = ui.button("Later").on_hover_text("Asked again from the menu, and by the next window");
        if later.clicked() || (may_close && ui.input(|i| i.key_pressed(Key::Escape))) {
            queue.view(ViewCommand::AskRecovery(false));
        }
    });
}

/// One of several, while the others wait.
fn decide_on(ui: &mut Ui, number: usize, queue: &mut Queue) {
    ui.horizontal(|ui| {
        ui.add_space(10.0);
        if ui.button("Recover").clicked() {
            queue.document(DocumentCommand::Recover(Some(number)));
        }
        if field::hold_button(ui, "Delete", theme::of(ui).caution, 0.0) {
            queue.document(DocumentCommand::ForgetLeftBehind(Some(number)));
        }
    });
}

/// By which a plan is known again: its file or else its name.
fn which(left: &LeftDocument) -> String {
    match (&left.path, left.name.as_str()) {
        (Some(path), _) => path.display().to_string(),
        (None, "") => "a plan without a file".into(),
        (None, name) => format!("“{name}”, without a file"),
    }
}

/// When the last change was made, and how long ago that is.
fn when(left: &LeftDocument, utc: Timestamp) -> String {
    let Some(at) = left.changed_unix_s.and_then(|s| Timestamp::from_second(s).ok()) else {
        return "nobody knows when it was last changed".into();
    };
    let ago_s = (utc.as_second() - at.as_second()).max(0);
    format!("last changed {} UTC, {} ago", at.strftime("%Y-%m-%d %H:%M"), units::duration(ago_s as f64))
}

/// Return presses it, until something else is chosen. While something else has the keyboard, or in a flight, Return is not meant for it.
fn offer_return(ui: &Ui, recover: &Response, is_calm: bool) {
    let id = recover.id.with("offered");
    let is_offered: bool = ui.data(|d| d.get_temp(id)).unwrap_or(false);
    if is_calm && !is_offered && ui.memory(|m| m.focused().is_none()) {
        recover.request_focus();
        ui.data_mut(|d| d.insert_temp(id, true));
    } else if !is_calm && is_offered {
        recover.surrender_focus();
        ui.data_mut(|d| d.insert_temp(id, false));
    }
}
