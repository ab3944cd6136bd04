//! The menu of a row, in the plan's tree and in the table: where a right click was, or by the keyboard below the row.

use egui::{Context, Id, Popup, Response, SetOpenCommand, Ui, vec2};

/// Shows it while it is open; `opens`: the keyboard asks for it.
pub fn show(row: &Response, opens: bool, add: impl FnOnce(&mut Ui)) {
    let mut popup = Popup::context_menu(row);
    if opens {
        popup = popup.open_memory(Some(SetOpenCommand::Bool(true)));
    }
    let by_key = row.id.with("by key");
    if opens || row.secondary_clicked() {
        row.ctx.data_mut(|d| d.insert_temp(by_key, opens));
    }
    if row.ctx.data(|d| d.get_temp(by_key)).unwrap_or(false) {
        popup = popup.at_position(row.rect.left_bottom() + vec2(24.0, 0.0));
    }
    popup.show(add);
}

fn asked_for() -> Id {
    Id::unique("menu of the selected row")
}

/// Asks for the menu of what is selected, in the tree.
pub fn ask(ctx: &Context) {
    ctx.data_mut(|d| d.insert_temp(asked_for(), true));
}

/// It was asked for.
pub fn is_asked(ui: &Ui) -> bool {
    ui.data_mut(|d| d.remove_temp(asked_for())).unwrap_or(false)
}
