//! A moving tape with the present value in a window.

use crate::theme::Palette;
use egui::{Align2, Color32, FontId, Painter, Rect, Stroke, pos2, vec2};

/// Which side of the attitude a tape is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left: its marks are at its right edge.
    Left,
    /// Right: its marks are at its left edge.
    Right,
}

/// Screen points between two marks.
const GAP: f64 = 30.0;

/// Draws a value on a tape with a mark every `step`; without a value, an empty tape.
pub fn draw(painter: &Painter, rect: Rect, side: Side, value: Option<f64>, step: f64, p: &Palette) {
    let painter = painter.with_clip_rect(rect);
    painter.rect_filled(rect, 0.0, p.card);
    let value = value.filter(|v| v.is_finite());
    if let Some(value) = value {
        marks(&painter, rect, side, value, step, p);
    }
    window(&painter, rect, value, p);
}

fn marks(painter: &Painter, rect: Rect, side: Side, value: f64, step: f64, p: &Palette) {
    let reach = (f64::from(rect.height()) / 2.0 / GAP).ceil() as i64 + 1;
    let nearest = (value / step).round() as i64;
    for mark in nearest.saturating_sub(reach)..=nearest.saturating_add(reach) {
        let at = mark as f64 * step;
        if side == Side::Left && at < 0.0 {
            continue;
        }
        let y = rect.center().y - ((at - value) / step * GAP) as f32;
        let (edge, inward) = match side {
            Side::Left => (rect.right(), -1.0),
            Side::Right => (rect.left(), 1.0),
        };
        painter.line_segment([pos2(edge, y), pos2(edge + inward * 7.0, y)], Stroke::new(1.0, p.weak));
        let anchor = if side == Side::Left { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
        painter.text(
            pos2(edge + inward * 11.0, y),
            anchor,
            format!("{at:.0}"),
            FontId::monospace(11.0),
            p.weak,
        );
    }
}

fn window(painter: &Painter, rect: Rect, value: Option<f64>, p: &Palette) {
    let plate = Rect::from_center_size(rect.center(), vec2(rect.width(), 24.0));
    painter.rect(plate, 2.0, Color32::BLACK, Stroke::new(1.2, p.weak), egui::StrokeKind::Inside);
    let text = value.map_or_else(
        || "–––".into(),
        |v| if v.abs() < 100.0 { format!("{v:.1}") } else { format!("{v:.0}") },
    );
    painter.text(plate.center(), Align2::CENTER_CENTER, text, FontId::monospace(15.0), Color32::WHITE);
}
