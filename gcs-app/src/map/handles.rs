//! Dragging: waypoints, fixes, the middle and the rim of circles, corners of polygons. A drag is
//! one undo step.

use super::sketch::{Handle, Handled, Sketch, radius_edit};
use super::text;
use super::view::View;
use crate::command::{DocumentCommand, Queue, Selection, ViewCommand};
use crate::panels::Scene;
use crate::theme::{self, Palette};
use egui::{Align2, CursorIcon, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2, vec2};
use flight_plan::{Edit, FlightPlan};
use geometry::LatLon;

/// Most handles that react at once; more could not be told apart.
const MOST: usize = 1000;
/// Reach of a handle, screen points.
const REACH: f32 = 18.0;

/// The tool.
#[derive(Debug, Default)]
pub struct Tool {
    /// From the pointer to the handle when the drag began, so that nothing jumps.
    offset: Option<Vec2>,
}

impl Tool {
    /// Draws the handles and turns drags into edits. True if the pointer clicked on one.
    pub fn run(
        &mut self,
        ui: &mut Ui,
        view: &View,
        sketch: &Sketch,
        scene: &Scene<'_>,
        queue: &mut Queue,
    ) -> bool {
        let mut clicked = false;
        let mut labels = Vec::new();
        let p = theme::of(ui);
        let near =
            sketch.handles.iter().map(|h| (h, view.place(h.at))).filter(|(_, at)| view.rect.contains(*at));
        for (handle, at) in near.take(MOST) {
            let selected = is_selected(scene, handle);
            if matches!(handle.what, Handled::Radius(_) | Handled::Corner { .. }) && !selected {
                continue;
            }
            let name = handle.what.name();
            let rect = Rect::from_center_size(at, Vec2::splat(REACH));
            let response = ui.interact(rect, ui.scope_id().with(&name), Sense::click_and_drag());
            response.widget_info(|| egui::WidgetInfo::labeled(Role::Button, true, &name));
            draw(ui.painter(), at, handle, selected, &response, p);
            labels.extend(label(handle, at, selected || response.hovered()));
            clicked |= response.clicked();
            self.react(&response, at, view, handle, sketch, scene, queue);
        }
        draw_labels(ui.painter(), labels, p);
        clicked
    }

    #[expect(clippy::too_many_arguments, reason = "a gesture meets everything that is on the map")]
    fn react(
        &mut self,
        response: &Response,
        at: Pos2,
        view: &View,
        handle: &Handle,
        sketch: &Sketch,
        scene: &Scene<'_>,
        queue: &mut Queue,
    ) {
        if response.clicked() || response.drag_started() {
            queue.view(ViewCommand::Select(Some(selection(handle))));
        }
        if response.hovered() {
            response.ctx.set_cursor_icon(CursorIcon::Grab);
        }
        let Some(pointer) = response.interact_pointer_pos() else { return };
        if response.drag_started() {
            let pressed = response.ctx.input(|i| i.pointer.press_origin()).unwrap_or(pointer);
            self.offset = Some(at - pressed);
        }
        if response.dragged() && response.drag_delta() != Vec2::ZERO {
            let to = view.geo(pointer + self.offset.unwrap_or_default());
            if let Some(edit) = edit(scene.document.plan(), sketch, &handle.what, to) {
                queue.document(DocumentCommand::DragEdit(edit));
            }
        }
        if response.drag_stopped() {
            self.offset = None;
            queue.document(DocumentCommand::EndGesture);
        }
    }
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
fn draw(painter: &Painter, at: Pos2, handle: &Handle, selected: bool, response: &Response, p: &Palette) {
    let hot = response.hovered() || response.dragged();
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
    let mut taken: Vec<Rect> = Vec::new();
    for label in labels {
        let size = vec2(label.text.chars().count() as f32 * 7.0, 13.0);
        let rect = label.anchor.anchor_size(label.at, size);
        if label.first || !taken.iter().any(|t| t.intersects(rect)) {
            taken.push(text::haloed(painter, label.at, label.anchor, &label.text, 12.0, p.text, p));
        }
    }
}
