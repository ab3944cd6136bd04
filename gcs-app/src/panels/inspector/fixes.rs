//! Fixes of a procedure: a call moves the procedure's own places, while a fix stays where it is.

use crate::command::Queue;
use crate::panels::Scene;
use crate::panels::tree::menu::MOVE_FIXES;
use crate::theme;
use egui::{Label, RichText, Ui};
use flight_plan::{Id, create};

/// Says so of a procedure, or a leg of one, that goes to fixes, and offers to move them along.
pub fn of_procedure(ui: &mut Ui, scene: &Scene<'_>, id: &Id, queue: &mut Queue) {
    let Some(edit) = create::own_places(scene.document.plan(), id) else { return };
    let text = "It goes to a fix, which stays where it is wherever the procedure is called.";
    ui.add(Label::new(RichText::new(text).size(12.0).color(theme::of(ui).weak)).wrap());
    if ui.button(MOVE_FIXES).on_hover_text("The fix's place becomes the leg's own").clicked() {
        queue.edit(edit);
    }
}
