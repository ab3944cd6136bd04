//! Select and move: waypoints, fixes, the middle and the rim of circles, corners of areas, routes and zones. The small marks
//! between corners, and in the middle of legs, become new ones when they are dragged. A drag is one undo step.

use super::group::{Group, legs_within};
use super::pen::length;
use super::pick::{lines_near, selection};
use super::{Canvas, Card, Grip, Pointer, Tool, Touch};
use crate::chart::labels::Labels;
use crate::command::{DocumentCommand, Queue, Selection, ViewCommand};
use crate::map::sketch::{Handle, Handled, Sketch, numbers, radius_edit};
use crate::map::text;
use crate::theme::Palette;
use aircraft::Profile;
use egui::{Align2, Key, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use flight_plan::create::{self, Drawn, LegChoice};
use flight_plan::{Area, Edit, FlightPlan, Id, LegKind, Pattern, Place, Scan, Spot, Value, ZoneShape};
use geometry::LatLon;

/// Most handles that react at once; more could not be told apart.
const MOST: usize = 1000;
/// A leg that is shorter on the screen shows no middle to be dragged, screen points.
const GAP: f64 = 90.0;

/// The tool; the one in use unless another one is chosen.
#[derive(Debug, Default)]
pub struct Select {
    /// The corner that was grabbed last: Delete removes it.
    corner: Option<Handled>,
    /// The mark that is being dragged, by its name, and what it has become.
    inserting: Option<(String, Handled)>,
    /// What the last click may have meant.
    among: Vec<Selection>,
    /// The handles around several selected legs.
    group: Group,
}

impl Select {
    /// A mark between two corners, or in the middle of a leg, becomes what it stands for.
    fn insert(&mut self, mark: &Handled, at: LatLon, plan: &FlightPlan, queue: &mut Queue) {
        let (edit, becomes) = match mark {
            Handled::Ghost { leg, hole, before } => {
                let edit = Edit::InsertCorner { leg: leg.clone(), hole: *hole, before: *before, at };
                (edit, Handled::Corner { leg: leg.clone(), hole: *hole, corner: *before })
            }
            Handled::Between { leg, .. } => {
                let place = Drawn::Place(Place::Position(Value::Constant(at)));
                let new = create::leg(plan, &Profile::default(), LegChoice::Tf, &place, None, None);
                let Some(new) = new else { return };
                let becomes = Handled::Waypoint(new.id.clone());
                (Edit::InsertLeg { leg: Box::new(new), at: Spot::Before(leg.clone()) }, becomes)
            }
            _ => return,
        };
        queue.document(DocumentCommand::DragEdit(edit));
        if let Handled::Waypoint(new) = &becomes {
            queue.view(ViewCommand::Select(Some(Selection::Leg(new.clone()))));
        }
        self.inserting = Some((mark.name(), becomes));
    }
}

impl Tool for Select {
    fn card(&self) -> &'static Card {
        &Card { id: "select", name: "Select and move", symbol: "⬉", key: Key::V }
    }

    fn grips(&self, canvas: &Canvas<'_>) -> Vec<Grip> {
        // what a mark has become is dragged on under the mark's name
        let name = |handle: &Handle| match &self.inserting {
            Some((name, becomes)) if *becomes == handle.what => name.clone(),
            _ => handle.what.name(),
        };
        let shown = near(canvas).filter(|(_, handle, _)| self.inserting.is_none() || !is_mark(handle));
        let grips = shown.map(|(key, handle, at)| Grip { key, name: name(handle), at });
        grips.chain(self.group.grips(canvas)).collect()
    }

    fn hover(&mut self, _at: Option<Pos2>, canvas: &Canvas<'_>) {
        let plan = canvas.scene.document.plan();
        let selected = |what: &Handled| canvas.scene.is_selected(&selection(plan, what));
        self.corner = self.corner.take().filter(selected);
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        let plan = canvas.scene.document.plan();
        if pointer.grip.is_some_and(|key| self.group.press(key, pointer.clicks, canvas)) {
            return;
        }
        let handle = pointer.grip.and_then(|key| canvas.sketch.handles.get(key));
        self.among = if pointer.grip.is_none() { lines_near(pointer.at, canvas) } else { Vec::new() };
        let chosen = handle.filter(|_| pointer.clicks).and_then(|handle| numbers::choice(plan, &handle.what));
        if let Some(edit) = chosen {
            return queue.edit(edit);
        }
        let picked = match handle {
            Some(handle) => Some(selection(plan, &handle.what)),
            None => self.among.first().cloned(),
        };
        let corner = handle.map(|handle| &handle.what).filter(|what| matches!(what, Handled::Corner { .. }));
        // hover forgets it until its owner is the selected one
        self.corner = corner.filter(|what| canvas.scene.is_selected(&selection(plan, what))).cloned();
        queue.view(match picked {
            Some(Selection::Leg(leg)) if pointer.adds => ViewCommand::Toggle(leg),
            _ if pointer.adds => return,
            picked => ViewCommand::Select(picked),
        });
    }

    fn among(&mut self) -> Vec<Selection> {
        std::mem::take(&mut self.among)
    }

    fn drag(&mut self, grip: usize, to: Pos2, canvas: &Canvas<'_>, queue: &mut Queue) {
        if self.group.drag(to, canvas, queue) {
            return;
        }
        let Some(handle) = canvas.sketch.handles.get(grip) else { return };
        let (plan, to) = (canvas.scene.document.plan(), canvas.view.geo(to));
        if is_mark(handle) {
            return if to.is_valid() {
                self.insert(&handle.what, to, plan, queue)
            };
        }
        if let Some(edit) = edit(plan, canvas.sketch, &handle.what, to) {
            queue.document(DocumentCommand::DragEdit(edit));
        }
    }

    fn sweep(&mut self, area: Rect, canvas: &Canvas<'_>, queue: &mut Queue) {
        for leg in legs_within(area, canvas) {
            if !canvas.scene.is_selected(&Selection::Leg(leg.clone())) {
                queue.view(ViewCommand::Toggle(leg));
            }
        }
    }

    fn release(&mut self, queue: &mut Queue) {
        self.inserting = None;
        self.group.release();
        queue.document(DocumentCommand::EndGesture);
    }

    fn wants(&self, key: Key) -> bool {
        key == Key::Delete && self.corner.is_some()
    }

    fn key(&mut self, _key: Key, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(corner) = self.corner.take() {
            remove_corner(canvas.scene.document.plan(), &corner, queue);
        }
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, touch: Touch, p: &Palette) {
        let plan = canvas.scene.document.plan();
        let mut labels = Vec::new();
        for (key, handle, at) in near(canvas) {
            let selected = canvas.scene.is_selected(&selection(plan, &handle.what));
            let hot = touch.hovered == Some(key) || touch.dragged == Some(key);
            let chosen = self.corner.as_ref() == Some(&handle.what);
            draw(painter, at, handle, selected, hot || chosen, p);
            labels.extend(label(handle, at, selected || touch.hovered == Some(key)));
            labels.extend(value(handle, at, canvas).filter(|_| hot));
        }
        draw_labels(painter, labels, p);
        self.group.paint(painter, canvas, p);
    }
}

/// Not there yet: it is when it is dragged.
fn is_mark(handle: &Handle) -> bool {
    matches!(handle.what, Handled::Ghost { .. } | Handled::Between { .. })
}

/// Handles on the screen, with their numbers in the sketch; those of an outline only where it is selected.
fn near<'a>(canvas: &Canvas<'a>) -> impl Iterator<Item = (usize, &'a Handle, Pos2)> {
    let Canvas { view, sketch, scene, .. } = *canvas;
    let plan = scene.document.plan();
    let is_shown = move |handle: &Handle| match &handle.what {
        Handled::Number { .. } | Handled::ArcCentre(_) | Handled::Entry { .. } | Handled::Side(_) => {
            scene.view.also.is_empty() && scene.is_selected(&selection(plan, &handle.what))
        }
        Handled::Radius(_) | Handled::Corner { .. } | Handled::Ghost { .. } => {
            scene.is_selected(&selection(plan, &handle.what))
        }
        Handled::Centre(id) => plan.zone(id).is_none() || scene.is_selected(&Selection::Zone(id.clone())),
        Handled::Between { gap_m, .. } => f64::from(*gap_m) * view.points_per_metre() > GAP,
        Handled::Fix(_) | Handled::Waypoint(_) => true,
    };
    sketch
        .handles
        .iter()
        .enumerate()
        .map(move |(key, handle)| (key, handle, view.place(handle.at)))
        .filter(move |(_, _, at)| view.rect.contains(*at))
        .filter(move |(_, handle, _)| is_shown(handle))
        .take(MOST)
}

/// Removes a corner, unless too few would be left.
pub fn remove_corner(plan: &FlightPlan, corner: &Handled, queue: &mut Queue) {
    let Handled::Corner { leg, hole, corner } = corner else { return };
    let (have, least, what) = points_of(plan, leg, *hole);
    if have <= least {
        let why = format!("{what} has at least {least} points: delete the whole of it instead.");
        return queue.view(ViewCommand::Notice(why));
    }
    queue.edit(Edit::RemoveCorner { leg: leg.clone(), hole: *hole, corner: *corner });
}

/// How many points a ring or route has, how many it must have, and what it is.
fn points_of(plan: &FlightPlan, of: &Id, hole: Option<usize>) -> (usize, usize, &'static str) {
    if let Some(ZoneShape::Polygon(corners)) = plan.zone(of).map(|zone| &zone.shape) {
        return (corners.len(), 3, "A zone");
    }
    match plan.leg(of).map(|context| &context.leg.kind) {
        Some(LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. })) => {
            (route.len(), 2, "A line")
        }
        Some(
            LegKind::Scan(Scan { area: Area::Polygon { corners, holes }, .. })
            | LegKind::Pattern(Pattern::Contour { area: Area::Polygon { corners, holes }, .. }),
        ) => {
            let ring = hole.map_or(Some(corners), |hole| holes.get(hole));
            (ring.map_or(0, Vec::len), 3, "An area")
        }
        // of a variable: the edit counts them
        _ => (usize::MAX, 3, "An area"),
    }
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
            let centre = sketch.centre_of(leg, plan)?;
            radius_edit(plan, leg, centre.distance_m(to))
        }
        Handled::Corner { leg, hole, corner } => {
            Some(Edit::MoveCorner { leg: leg.clone(), hole: *hole, corner: *corner, to })
        }
        Handled::Number { leg, number, ruler } => numbers::edit(plan, leg, number, ruler.read(to)),
        Handled::ArcCentre(leg) => numbers::move_arc_centre(plan, leg, to),
        Handled::Ghost { .. } | Handled::Between { .. } | Handled::Entry { .. } | Handled::Side(_) => None,
    }
}

/// What a handle that is hovered or dragged has come to.
fn value(handle: &Handle, at: Pos2, canvas: &Canvas<'_>) -> Option<Label> {
    let (plan, units) = (canvas.scene.document.plan(), canvas.scene.units());
    let text = match &handle.what {
        Handled::Number { number, ruler, .. } => numbers::words(number, ruler.read(handle.at), units),
        Handled::Radius(of) => {
            let centre = canvas.sketch.centre_of(of, plan)?;
            format!("Radius {}", length(centre.distance_m(handle.at), units))
        }
        what if what.is_choice() => what.name(),
        _ => return None,
    };
    Some(Label { at: at + vec2(11.0, -9.0), anchor: Align2::LEFT_BOTTOM, text, first: true })
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
        Handled::Ghost { .. } | Handled::Between { .. } => {
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
        Handled::Side(_) => {
            painter.circle(at, size * 0.9, p.halo, stroke);
            text::haloed(painter, at, Align2::CENTER_CENTER, "⇄", 11.0, p.text, p);
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
        _ => return None,
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
