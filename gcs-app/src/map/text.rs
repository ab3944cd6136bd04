//! Text on the map.

use crate::chart::Room;
use crate::theme::Palette;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, vec2};

/// Text with a halo, readable on any ground. Returns where it is.
pub fn haloed(
    painter: &Painter,
    at: Pos2,
    anchor: Align2,
    text: &str,
    size: f32,
    colour: Color32,
    p: &Palette,
) -> Rect {
    let galley = painter.layout_no_wrap(text.into(), FontId::proportional(size), Color32::PLACEHOLDER);
    let rect = anchor.anchor_size(at, galley.size());
    let halo = p.halo.gamma_multiply(0.8);
    for offset in [vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(-1.0, 1.0), vec2(1.0, 1.0)] {
        painter.galley_with_override_text_color(rect.min + offset, galley.clone(), halo);
    }
    painter.galley_with_override_text_color(rect.min, galley, colour);
    rect
}

impl From<Rect> for Room {
    fn from(rect: Rect) -> Self {
        Self { left: rect.left(), top: rect.top(), right: rect.right(), bottom: rect.bottom() }
    }
}
