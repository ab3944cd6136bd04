//! Buttons of rows that may move: after one was pressed another row may lie under the pointer, and a second press is not meant for
//! that one.

use crate::panels::field;
use egui::{Id, PointerButton, Pos2, Ui};

/// Until a press at the same place is meant again, seconds.
const READ_S: f64 = 1.5;
/// A pointer that is moved less is at rest, screen points.
const REST: f32 = 4.0;

/// A small button of a row. It takes no press from a pointer that rests where it has just pressed another one.
pub fn row_button(ui: &mut Ui, symbol: &str, name: &str) -> bool {
    let response = field::small_button_response(ui, symbol, name);
    let by_pointer = response.clicked_by(PointerButton::Primary);
    let place = response.interact_pointer_pos().filter(|_| by_pointer);
    let is_meant = place.is_none_or(|at| is_read(ui, at));
    if let Some(at) = place.filter(|_| is_meant) {
        let now_s = ui.input(|i| i.time);
        ui.data_mut(|data| data.insert_temp(pressed_id(), (at, now_s)));
    }
    response.clicked() && is_meant
}

fn pressed_id() -> Id {
    Id::unique("where a button of a row was pressed")
}

/// Nothing has just been pressed there.
fn is_read(ui: &Ui, at: Pos2) -> bool {
    let now_s = ui.input(|i| i.time);
    let last = ui.data(|data| data.get_temp::<(Pos2, f64)>(pressed_id()));
    last.is_none_or(|(there, then_s)| there.distance(at) > REST || now_s - then_s > READ_S)
}
