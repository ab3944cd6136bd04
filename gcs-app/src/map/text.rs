//! Text and small marks on the map.

use crate::chart::Room;
use crate::theme::Palette;
use egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Stroke, Vec2, vec2};
use std::sync::Arc;

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
    with_halo(painter, rect.min, galley, colour, p);
    rect
}

/// Letters with a halo.
pub fn with_halo(painter: &Painter, at: Pos2, letters: Arc<Galley>, colour: Color32, p: &Palette) {
    let halo = p.halo.gamma_multiply(0.8);
    for offset in [vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(-1.0, 1.0), vec2(1.0, 1.0)] {
        painter.galley_with_override_text_color(at + offset, letters.clone(), halo);
    }
    painter.galley_with_override_text_color(at, letters, colour);
}

/// A small disc with an edge. egui keeps pictures of discs: two of them are a tenth of the vertices of a circle with a stroke.
pub fn disc(painter: &Painter, at: Pos2, radius: f32, fill: Color32, edge: Stroke) {
    // what is below shows through what is faint
    if painter.opacity() < 1.0 || !fill.is_opaque() || !edge.color.is_opaque() {
        painter.circle(at, radius, fill, edge);
        return;
    }
    painter.circle_filled(at, radius + edge.width / 2.0, edge.color);
    painter.circle_filled(at, radius - edge.width / 2.0, fill);
}

/// Letters on a plate, so far from the plate's edge, readable over other names too.
pub fn on_plate(painter: &Painter, plate: Rect, edge: Vec2, letters: Arc<Galley>, p: &Palette) {
    painter.rect_filled(plate, 3.0, p.panel.gamma_multiply(0.8));
    painter.galley(plate.min + edge, letters, p.text);
}

/// Moved so far that nothing of it is outside.
pub fn within(rect: Rect, map: Rect) -> Rect {
    let left = rect.left().min(map.right() - rect.width()).max(map.left());
    let top = rect.top().min(map.bottom() - rect.height()).max(map.top());
    Rect::from_min_size(Pos2::new(left, top), rect.size())
}

impl From<Rect> for Room {
    fn from(rect: Rect) -> Self {
        Self { left: rect.left(), top: rect.top(), right: rect.right(), bottom: rect.bottom() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn a_text_at_the_edge_is_moved_inside() {
        let map = Rect::from_min_size(pos2(100.0, 50.0), vec2(300.0, 200.0));
        let size = vec2(120.0, 16.0);
        for (at, expected) in [
            (pos2(150.0, 90.0), pos2(150.0, 90.0)),
            (pos2(390.0, 90.0), pos2(280.0, 90.0)),
            (pos2(20.0, 300.0), pos2(100.0, 234.0)),
        ] {
            assert_eq!(within(Rect::from_min_size(at, size), map).min, expected, "{at}");
        }
        let large = Rect::from_min_size(pos2(390.0, 90.0), vec2(500.0, 16.0));
        assert_eq!(within(large, map).left(), 100.0, "its beginning is in view");
    }
}
