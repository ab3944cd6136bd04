//! A drag with Shift over empty ground draws around what is to be selected.

use crate::theme::Palette;
use egui::{Painter, Pos2, Rect, Response, Stroke, StrokeKind};

/// What is being drawn around, from corner to corner.
#[derive(Debug, Default)]
pub struct Sweep(Option<(Pos2, Pos2)>);

impl Sweep {
    /// A drag is on its way.
    pub fn is_active(&self) -> bool {
        self.0.is_some()
    }

    /// Follows the pointer; gives what was drawn around when the drag ends.
    pub fn follow(&mut self, map: &Response) -> Option<Rect> {
        let at = map.interact_pointer_pos();
        if map.drag_started() && map.ctx.input(|i| i.modifiers.shift) {
            let from = map.ctx.input(|i| i.pointer.press_origin());
            self.0 = from.zip(at);
        }
        if let (Some((_, to)), Some(at)) = (self.0.as_mut(), at) {
            *to = at;
        }
        if !map.drag_stopped() {
            return None;
        }
        self.0.take().map(|(from, to)| Rect::from_two_pos(from, to))
    }

    /// Draws it.
    pub fn paint(&self, painter: &Painter, p: &Palette) {
        if let Some((from, to)) = self.0 {
            let (fill, stroke) = (p.accent.gamma_multiply(0.12), Stroke::new(1.2, p.accent));
            painter.rect(Rect::from_two_pos(from, to), 0.0, fill, stroke, StrokeKind::Middle);
        }
    }
}
