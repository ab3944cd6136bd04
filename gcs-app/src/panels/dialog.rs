//! A question that waits for its answer.

use super::Scene;
use egui::{Align2, Area, Frame, Id, Key, Modal, Order, Rect, Ui};

/// Draws it in the middle. True: it was given up, by Escape or by a click beside it.
///
/// Nothing else takes a click meanwhile, but where there is a vehicle: nobody answers a question before he may hold that. It stays in
/// `room` then, which leaves the commands of the flight alone.
pub fn show(ui: &Ui, room: Rect, scene: &Scene<'_>, id: &str, add: impl FnOnce(&mut Ui)) -> bool {
    let (ctx, id) = (ui.ctx(), Id::unique(id));
    let is_beside = if scene.vehicle.status.is_none() {
        Modal::new(id).show(ctx, add).should_close()
    } else {
        let offset = room.center() - ctx.content_rect().center();
        let area = Area::new(id).order(Order::Foreground).anchor(Align2::CENTER_CENTER, offset);
        area.constrain_to(room).show(ctx, |ui| Frame::popup(ui.style()).show(ui, add));
        false
    };
    is_beside || ui.input(|i| i.key_pressed(Key::Escape))
}
