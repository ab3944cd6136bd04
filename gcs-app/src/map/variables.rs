//! Variables of the plan that are a place: where they are now, with their radius where they have one.

use super::sketch::{PlacedVariable, Sketch};
use super::text;
use super::view::View;
use crate::command::Selection;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Align2, Painter, Pos2, Shape, Stroke, vec2};
use flight_plan::Id;

/// From the middle of a mark to its corners, screen points.
const MARK: f32 = 6.0;
/// Greatest circle that is drawn, screen points.
const WIDEST: f32 = 20_000.0;

/// Every variable that is a place.
pub fn draw(painter: &Painter, view: &View, sketch: &Sketch, scene: &Scene<'_>, p: &Palette) {
    for variable in &sketch.variables {
        let selected = scene.is_selected(&Selection::Variable(variable.name.clone()));
        draw_one(painter, view, variable, selected, p);
    }
}

fn draw_one(painter: &Painter, view: &View, variable: &PlacedVariable, selected: bool, p: &Palette) {
    let at = view.place(variable.at);
    let width = if selected { 2.4 } else { 1.6 };
    let radius = variable.radius_m.map_or(0.0, |radius_m| (radius_m * view.points_per_metre()) as f32);
    let is_in_view = view.rect.expand(radius + 40.0).contains(at);
    if !is_in_view || radius > WIDEST {
        return;
    }
    if radius > MARK {
        painter.circle(at, radius, p.caution.gamma_multiply(0.12), Stroke::new(width, p.caution));
    }
    let corner = |x: f32, y: f32| -> Pos2 { at + vec2(x, y) * MARK };
    let corners = vec![corner(0.0, -1.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(-1.0, 0.0)];
    painter.add(Shape::convex_polygon(corners, p.caution, Stroke::new(width, p.halo)));
    // clear of what is flown around it
    let above = at - vec2(0.0, radius.max(MARK) + 3.0);
    text::haloed(painter, above, Align2::CENTER_BOTTOM, &name(&variable.name), 11.5, p.text, p);
}

/// As people write it.
pub fn name(variable: &Id) -> String {
    variable.as_str().replace('_', " ")
}
