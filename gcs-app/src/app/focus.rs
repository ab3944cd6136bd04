//! What has the keyboard is to be seen, whatever it looks like itself.

use crate::theme;
use egui::{Context, StrokeKind};

/// Draws a ring around it. Fields that are typed into have a cursor and a frame of their own.
pub fn ring(ctx: &Context) {
    // to read a response takes the keyboard from it if the pointer is just pressed or released beside it
    if ctx.input(|i| i.pointer.any_pressed() || i.pointer.any_released()) {
        return;
    }
    let focused = ctx.memory(|m| m.focused()).filter(|_| !ctx.text_edit_focused());
    let Some(response) = focused.and_then(|id| ctx.read_response(id)) else { return };
    let p = theme::palette(ctx.global_style().visuals.dark_mode);
    // what is scrolled away has none
    let seen = response.interact_rect.expand(4.0);
    let painter = ctx.layer_painter(response.layer_id).with_clip_rect(seen);
    for (width, colour) in [(4.0, p.halo), (2.0, p.accent)] {
        painter.rect_stroke(response.rect.expand(1.0), 5.0, (width, colour), StrokeKind::Outside);
    }
}
