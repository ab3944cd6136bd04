//! The handles that are on the screen, and how they look.

use super::Canvas;
use super::pen::{length, way};
use super::pick::selection;
use crate::command::Selection;
use crate::map::names::{self, Ground, Name, Rank, Spot};
use crate::map::sketch::{AreaPart, Handle, Handled, Sketch, numbers};
use crate::map::text;
use crate::map::view::View;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Align2, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};

/// Most handles that react at once; more could not be told apart.
const MOST: usize = 1000;
/// A leg that is shorter on the screen shows no middle to be dragged, screen points.
const GAP: f64 = 90.0;
/// How much is left of a place that can't be grabbed.
const FAINT: f32 = 0.6;

/// A handle on the screen, with its number in the sketch.
pub type Near<'a> = (usize, &'a Handle, Pos2);

/// Handles on the screen; those of an outline only where it is selected.
pub fn near<'a>(view: &View, sketch: &'a Sketch, scene: &Scene<'_>) -> Vec<Near<'a>> {
    let (plan, points_per_metre) = (scene.document.plan(), view.points_per_metre());
    let is_shown = move |handle: &Handle| match &handle.what {
        Handled::Number { .. }
        | Handled::ArcCentre(_)
        | Handled::Entry { .. }
        | Handled::Side { .. }
        | Handled::Runway(..) => {
            scene.view.also.is_empty() && scene.is_selected(&selection(plan, &handle.what))
        }
        Handled::Radius(_) | Handled::Corner { .. } | Handled::Ghost { .. } | Handled::Area(..) => {
            scene.is_selected(&selection(plan, &handle.what))
        }
        Handled::Centre(id) => plan.zone(id).is_none() || scene.is_selected(&Selection::Zone(id.clone())),
        Handled::Between { gap_m, .. } => f64::from(*gap_m) * points_per_metre > GAP,
        Handled::Fix(_) | Handled::Variable(_) | Handled::Waypoint(_) => true,
    };
    let there = sketch.handles_there(scene.view.selection.as_ref());
    there
        .map(|(key, handle, at)| (key, handle, view.screen(at)))
        .filter(move |(_, _, at)| view.rect.contains(*at))
        .filter(move |(_, handle, _)| is_shown(handle))
        .take(MOST)
        .collect()
}

/// The plan's places with their names, faint, where the tool in use offers none of them to be grabbed.
pub fn draw_faint(painter: &Painter, canvas: &Canvas<'_>, p: &Palette) {
    let mut painter = painter.clone();
    painter.multiply_opacity(FAINT);
    let is_place = |handle: &Handle| {
        matches!(
            handle.what,
            Handled::Fix(_) | Handled::Variable(_) | Handled::Waypoint(_) | Handled::Centre(_)
        )
    };
    let mut labels = Vec::new();
    for (_, handle, at) in canvas.near.iter().filter(|(_, handle, _)| is_place(handle)) {
        draw(&painter, *at, handle, false, false, p);
        labels.extend(label(handle, *at, canvas, false));
    }
    draw_labels(&painter, labels, canvas, p);
}

/// What a handle that is hovered or dragged has come to.
pub fn value(handle: &Handle, at: Pos2, canvas: &Canvas<'_>) -> Option<Label> {
    let (plan, units) = (canvas.scene.document.plan(), canvas.scene.units());
    let text = match &handle.what {
        Handled::Number { number, ruler, .. } => numbers::words(number, ruler.read(handle.at), units),
        Handled::Radius(of) => {
            let centre = canvas.sketch.centre_of(of, plan)?;
            format!("Radius {}", length(centre.distance_m(handle.at), units))
        }
        Handled::Runway(id, _) => {
            let runway = plan.runway(id)?;
            way(runway.threshold, runway.from_other_end().threshold, units)
        }
        what if what.is_choice() => what.name(canvas.scene.document),
        _ => return None,
    };
    Some(Label { rank: Rank::Selected, spots: names::corners_above(at, vec2(11.0, 9.0)), text })
}

/// Shapes say what a handle is: triangle a fix, circle a waypoint, cross a centre, square a rim or corner.
pub fn draw(painter: &Painter, at: Pos2, handle: &Handle, selected: bool, hot: bool, p: &Palette) {
    let size = if selected || hot { 7.0 } else { 5.0 };
    let fill = if selected { p.accent } else { p.halo };
    let stroke = Stroke::new(if hot { 2.4 } else { 1.8 }, if selected { p.text } else { p.accent });
    match &handle.what {
        Handled::Fix(_) => {
            let corners = [vec2(0.0, -1.2), vec2(1.1, 0.8), vec2(-1.1, 0.8)].map(|d| at + d * size);
            painter.add(Shape::convex_polygon(corners.to_vec(), fill, stroke));
        }
        Handled::Variable(_) => {
            text::disc(painter, at, size * 0.6, fill, stroke);
        }
        Handled::Waypoint(_) => {
            text::disc(painter, at, size * 0.8, fill, stroke);
        }
        Handled::Centre(_) | Handled::Area(_, AreaPart::Middle) => {
            text::disc(painter, at, size, fill, stroke);
            painter.line_segment([at - vec2(size, 0.0), at + vec2(size, 0.0)], stroke);
            painter.line_segment([at - vec2(0.0, size), at + vec2(0.0, size)], stroke);
        }
        Handled::Ghost { .. } | Handled::Between { .. } | Handled::Area(_, AreaPart::Ghost(_)) => {
            let size = if hot { 6.0 } else { 3.5 };
            painter.circle(at, size, p.halo.gamma_multiply(0.8), Stroke::new(1.4, p.accent));
            if hot {
                painter.line_segment([at - vec2(3.5, 0.0), at + vec2(3.5, 0.0)], stroke);
                painter.line_segment([at - vec2(0.0, 3.5), at + vec2(0.0, 3.5)], stroke);
            }
        }
        Handled::Number { .. } | Handled::ArcCentre(_) => {
            let corners = [vec2(0.0, -1.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(-1.0, 0.0)];
            let corners = corners.map(|d| at + d * size).to_vec();
            painter.add(Shape::convex_polygon(corners, p.halo, stroke));
        }
        Handled::Entry { chosen, .. } => {
            painter.circle(at, size * 0.9, if *chosen { p.accent } else { p.halo }, stroke);
            painter.circle_filled(at, 2.0, p.text);
        }
        Handled::Side { .. } => {
            painter.circle(at, size * 0.9, p.halo, stroke);
            text::haloed(painter, at, Align2::CENTER_CENTER, "⇄", 11.0, p.text, p);
        }
        Handled::Radius(_)
        | Handled::Corner { .. }
        | Handled::Area(_, AreaPart::Corner(_))
        | Handled::Runway(..) => {
            let rect = Rect::from_center_size(at, Vec2::splat(size * 1.6));
            painter.rect(rect, 1.0, fill, stroke, egui::StrokeKind::Middle);
        }
    }
}

/// A name beside a handle.
pub struct Label {
    rank: Rank,
    spots: [Spot; 4],
    text: String,
}

/// The name of a fix or a leg; `first`: it is selected or under the pointer. A zone has its own.
pub fn label(handle: &Handle, at: Pos2, canvas: &Canvas<'_>, first: bool) -> Option<Label> {
    let (id, rank, spots) = match &handle.what {
        Handled::Fix(id) => (id, Rank::Place, names::beside(at, 9.0)),
        Handled::Waypoint(id) => (id, Rank::Leg, names::beside(at, 9.0)),
        Handled::Centre(id) if canvas.scene.document.plan().zone(id).is_none() => {
            (id, Rank::Leg, names::below(at, 9.0))
        }
        _ => return None,
    };
    let document = canvas.scene.document;
    let text = match document.called(id) {
        Some(procedure) => format!("{} of {}", document.label(id), document.label(procedure)),
        None => document.label(id).to_owned(),
    };
    Some(Label { rank: rank.or_selected(first), spots, text })
}

/// Asks for them.
pub fn draw_labels(painter: &Painter, labels: Vec<Label>, canvas: &Canvas<'_>, p: &Palette) {
    let mut names = canvas.names.borrow_mut();
    for Label { rank, spots, text } in labels {
        names.ask(painter, Name { rank, spots, text, size: 12.0, colour: p.text, ground: Ground::Halo });
    }
}
