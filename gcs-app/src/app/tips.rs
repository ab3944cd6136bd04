//! A tip that is open stays as long as the pointer rests on what it is of, also over a dialog that comes meanwhile by the keyboard. So
//! where a dialog is new, the pointer is away until it moves.

use egui::{Context, Event, Plugin, RawInput};

/// Closes the tips of what a dialog covers.
#[derive(Debug, Default)]
pub(super) struct UnderDialogs {
    had_dialog: bool,
}

impl Plugin for UnderDialogs {
    fn debug_name(&self) -> &'static str {
        "tips under dialogs"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let has_dialog = ctx.memory(|memory| memory.top_modal_layer()).is_some();
        if has_dialog && !self.had_dialog {
            input.events.insert(0, Event::PointerGone);
        }
        self.had_dialog = has_dialog;
    }
}
