//! The question after a crash: the work that was not saved, or a clean start.

use super::{field, primary_button};
use crate::command::{DocumentCommand, Queue, ViewCommand};
use crate::recovery::{LeftBehind, LeftDocument};
use crate::{theme, units};
use egui::{Key, Label, Response, RichText, ScrollArea, Ui};

/// Where there is room for it, screen points.
const WIDTH: f32 = 380.0;
/// Of the list of plans, screen points.
const LIST_HEIGHT: f32 = 120.0;

/// Draws it. It hides nothing that a flight is led with: a window may have crashed in the middle of one.
/// `may_close`: Escape is for it. `is_calm`: no vehicle flies, and Return may be for it.
pub fn show(ui: &mut Ui, found: &LeftBehind, (may_close, is_calm): (bool, bool), queue: &mut Queue) {
    ui.set_width(ui.available_width().min(WIDTH));
    let weak = theme::of(ui).weak;
    ui.strong("The last window ended without saving");
    ui.label("It had changes of");
    ScrollArea::vertical().id_salt("left behind").max_height(LIST_HEIGHT).show(ui, |ui| {
        for document in &found.documents {
            ui.add(Label::new(format!("• {}", which(document))).truncate());
            ui.add(Label::new(RichText::new(format!("   {}", when(document))).color(weak)).truncate());
        }
    });
    ui.label(RichText::new("You may go on meanwhile: they are kept until you decide.").color(weak));
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        let recover = ui.add(primary_button("Recover the changes", theme::of(ui)));
        offer_return(ui, &recover, is_calm);
        if recover.clicked() {
            queue.document(DocumentCommand::Recover);
        }
        // no undo brings them back
        if field::hold_button(ui, "Delete them", theme::of(ui).caution, 0.0) {
            queue.document(DocumentCommand::ForgetLeftBehind);
        }
        let later = ui.button("Later").on_hover_text("Asked again from the menu, and by the next window");
        if later.clicked() || (may_close && ui.input(|i| i.key_pressed(Key::Escape))) {
            queue.view(ViewCommand::AskRecovery(false));
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
fn when(left: &LeftDocument) -> String {
    let ago = units::duration(left.age.as_secs_f64());
    let at = left.changed_unix_s.and_then(|s| jiff::Timestamp::from_second(s.try_into().ok()?).ok());
    let at = at.map_or_else(String::new, |at| at.strftime(" %Y-%m-%d %H:%M UTC,").to_string());
    format!("last changed{at} {ago} ago")
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
