//! Select and move: waypoints, fixes, the middle and the rim of circles, corners of polygons. A drag is
//! one undo step.

use super::{Canvas, Card, Grip, Pointer, Tool, Touch};
use crate::chart::labels::Labels;
use crate::command::{DocumentCommand, Queue, Selection, ViewCommand};
use crate::map::sketch::{Handle, Handled, Sketch, radius_edit};
use crate::map::{path, text};
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Align2, Key, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use flight_plan::{Edit, FlightPlan};
use geometry::LatLon;

/// Most handles that react at once; more could not be told apart.
const MOST: usize = 1000;

/// The tool; the one in use unless another one is chosen.
#[derive(Debug, Default)]
pub struct Select;

impl Tool for Select {
    fn card(&self) -> &'static Card {
        &Card { id: "select", name: "Select and move", symbol: "⬉", key: Key::V }
    }

    fn grips(&self, canvas: &Canvas<'_>) -> Vec<Grip> {
        near(canvas).map(|(key, handle, at)| Grip { key, name: handle.what.name(), at }).collect()
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        let picked = match pointer.grip {
            Some(key) => canvas.sketch.handles.get(key).map(selection),
            None => path::leg_near(pointer.at, canvas.view, canvas.scene)
                .map(|leg| Selection::Leg(canvas.scene.document.written(&leg))),
        };
        queue.view(ViewCommand::Select(picked));
    }

    fn drag(&mut self, grip: usize, to: Pos2, canvas: &Canvas<'_>, queue: &mut Queue) {
        let Some(handle) = canvas.sketch.handles.get(grip) else { return };
        let plan = canvas.scene.document.plan();
        if let Some(edit) = edit(plan, canvas.sketch, &handle.what, canvas.view.geo(to)) {
            queue.document(DocumentCommand::DragEdit(edit));
        }
    }

    fn release(&mut self, queue: &mut Queue) {
        queue.document(DocumentCommand::EndGesture);
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, touch: Touch, p: &Palette) {
        let mut labels = Vec::new();
        for (key, handle, at) in near(canvas) {
            let selected = is_selected(canvas.scene, handle);
            let hot = touch.hovered == Some(key) || touch.dragged == Some(key);
            draw(painter, at, handle, selected, hot, p);
            labels.extend(label(handle, at, selected || touch.hovered == Some(key)));
        }
        draw_labels(painter, labels, p);
    }
}

/// Handles on the screen, with their numbers in the sketch; those of an outline only where it is selected.
fn near<'a>(canvas: &Canvas<'a>) -> impl Iterator<Item = (usize, &'a Handle, Pos2)> {
    let Canvas { view, sketch, scene } = *canvas;
    let of_outline = |h: &Handle| matches!(h.what, Handled::Radius(_) | Handled::Corner { .. });
    sketch
        .handles
        .iter()
        .enumerate()
        .map(move |(key, handle)| (key, handle, view.place(handle.at)))
        .filter(move |(_, _, at)| view.rect.contains(*at))
        .take(MOST)
        .filter(move |(_, handle, _)| !of_outline(handle) || is_selected(scene, handle))
}

fn selection(handle: &Handle) -> Selection {
    match &handle.what {
        Handled::Fix(id) => Selection::Fix(id.clone()),
        Handled::Waypoint(leg)
        | Handled::Centre(leg)
        | Handled::Radius(leg)
        | Handled::Corner { leg, .. } => Selection::Leg(leg.clone()),
    }
}

fn is_selected(scene: &Scene<'_>, handle: &Handle) -> bool {
    scene.is_selected(&selection(handle))
}

/// The edit that moves what a handle stands for.
fn edit(plan: &FlightPlan, sketch: &Sketch, what: &Handled, to: LatLon) -> Option<Edit> {
    if !to.is_valid() {
        return None;
    }
    match what {
        Handled::Fix(fix) => Some(Edit::MoveFix { fix: fix.clone(), to }),
        Handled::Waypoint(leg) | Handled::Centre(leg) => Some(Edit::MoveWaypoint { leg: leg.clone(), to }),
        Handled::Radius(leg) => {
            let centre = sketch.circles.iter().find(|c| c.leg == *leg)?.centre;
            radius_edit(plan, leg, centre.distance_m(to))
        }
        Handled::Corner { leg, hole, corner } => {
            Some(Edit::MoveCorner { leg: leg.clone(), hole: *hole, corner: *corner, to })
        }
    }
}

/// Shapes say what a handle is: triangle a fix, circle a waypoint, cross a centre, square a rim or corner.
fn draw(painter: &Painter, at: Pos2, handle: &Handle, selected: bool, hot: bool, p: &Palette) {
    let size = if selected || hot { 7.0 } else { 5.0 };
    let fill = if selected { p.accent } else { p.halo };
    let stroke = Stroke::new(if hot { 2.4 } else { 1.8 }, if selected { p.text } else { p.accent });
    match &handle.what {
        Handled::Fix(_) => {
            let corners = [vec2(0.0, -1.2), vec2(1.1, 0.8), vec2(-1.1, 0.8)].map(|d| at + d * size);
            painter.add(Shape::convex_polygon(corners.to_vec(), fill, stroke));
        }
        Handled::Waypoint(_) => {
            painter.circle(at, size * 0.8, fill, stroke);
        }
        Handled::Centre(_) => {
            painter.circle(at, size, fill, stroke);
            painter.line_segment([at - vec2(size, 0.0), at + vec2(size, 0.0)], stroke);
            painter.line_segment([at - vec2(0.0, size), at + vec2(0.0, size)], stroke);
        }
        Handled::Radius(_) | Handled::Corner { .. } => {
            let rect = Rect::from_center_size(at, Vec2::splat(size * 1.6));
            painter.rect(rect, 1.0, fill, stroke, egui::StrokeKind::Middle);
        }
    }
}

/// A name beside a handle.
struct Label {
    at: Pos2,
    anchor: Align2,
    text: String,
    /// Drawn whatever is there already.
    first: bool,
}

fn label(handle: &Handle, at: Pos2, first: bool) -> Option<Label> {
    let (id, offset, anchor) = match &handle.what {
        Handled::Fix(id) | Handled::Waypoint(id) => (id, vec2(9.0, -1.0), Align2::LEFT_CENTER),
        Handled::Centre(id) => (id, vec2(0.0, 9.0), Align2::CENTER_TOP),
        Handled::Radius(_) | Handled::Corner { .. } => return None,
    };
    Some(Label { at: at + offset, anchor, text: id.to_string(), first })
}

/// Names that do not overlap; what is selected or under the pointer comes first.
fn draw_labels(painter: &Painter, mut labels: Vec<Label>, p: &Palette) {
    labels.sort_by_key(|l| !l.first);
    let mut placed = Labels::new(painter.clip_rect().into());
    for label in labels {
        let size = vec2(label.text.chars().count() as f32 * 7.0, 13.0);
        let rect = label.anchor.anchor_size(label.at, size);
        if label.first || placed.is_free(&rect.into()) {
            placed.take(text::haloed(painter, label.at, label.anchor, &label.text, 12.0, p.text, p).into());
        }
    }
}
