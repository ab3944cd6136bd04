//! Select and move: waypoints, fixes, the middle and the rim of circles, corners of areas, routes and zones. The small marks
//! between corners, and in the middle of legs, become new ones when they are dragged. A drag is one undo step.

use super::bands;
use super::corner::{corner_of, remove_corner};
use super::crossing;
use super::group::{Group, within};
use super::handles::{draw, draw_labels, label, value};
use super::pen::{Mark, way};
use super::pick::{line_under, lines_near, put_meant_last, selection};
use super::snap::{self, snap_but};
use super::{Canvas, Card, Grip, Pointer, Tool, Touch, whole};
use crate::command::{DocumentCommand, Queue, Selection, ViewCommand};
use crate::map::guard;
use crate::map::sketch::{AreaPart, Handle, Handled, Sketch, numbers, radius_edit};
use crate::map::text;
use crate::panels::{Scene, inspector};
use crate::theme::Palette;
use aircraft::Profile;
use egui::{Align2, Key, Painter, Pos2, Rect, Stroke, vec2};
use flight_plan::create::{self, Drawn, LegChoice};
use flight_plan::{Edit, FlightPlan, Id, Place, Problem, Spot, Value, VariableValue};
use geometry::LatLon;
use std::sync::Arc;

/// The grip's key that is the line under the pointer.
const LINE: usize = usize::MAX;
/// Something that can be grabbed is so near to the pointer that the line there is not meant, screen points.
const BESIDE: f32 = 12.0;

/// The tool; the one in use unless another one is chosen.
#[derive(Debug, Default)]
pub struct Select {
    /// The corner that was grabbed last: Delete removes it.
    corner: Option<Handled>,
    /// The mark or line that is being dragged, by its name, and what it has become.
    inserting: Option<(String, Handled)>,
    /// The leg whose line was grabbed.
    line: Option<Id>,
    /// The zone or area that is moved as a whole.
    whole: Option<Selection>,
    /// It was: a press alone moves nothing.
    whole_moves: bool,
    /// What the last click may have meant.
    among: Vec<Selection>,
    /// The handles around several selected legs.
    group: Group,
    /// The handle that is being dragged, and where it was.
    grabbed: Option<Handle>,
    /// What is being dragged, where it is the first point of a selected route: that point alone.
    bent: Option<Handled>,
    /// Where it was dragged to.
    dragged: Option<Mark>,
    /// What letting go does: the leg goes to what it was dragged onto.
    landing: Option<Edit>,
    /// The plan before a runway was dragged: what leads down to it goes along from where it was.
    before: Option<Arc<FlightPlan>>,
    /// What is being dragged can't be moved now.
    refused: bool,
}

impl Select {
    /// The line under the pointer, if it is that what a drag from there would mean.
    fn line_grip(&self, grips: &[Grip], canvas: &Canvas<'_>) -> Option<Grip> {
        let view = canvas.scene.view;
        // where an alarm is raised, a click on the path moves it
        if self.inserting.is_some() || view.locked || view.alarm.is_some() {
            return None;
        }
        let at = canvas.pointer?;
        let is_free = grips.iter().all(|grip| grip.at.distance(at) > BESIDE);
        let (leg, _) = line_under(at, canvas).filter(|_| is_free)?;
        Some(Grip { key: LINE, name: line_name(&leg, canvas), at, first: true })
    }

    /// A mark between two corners, in the middle of a leg or anywhere on its line, becomes what it stands for.
    fn insert(&mut self, mark: &Handled, name: String, at: LatLon, canvas: &Canvas<'_>, queue: &mut Queue) {
        let plan = canvas.scene.document.plan();
        let (edit, becomes) = match mark {
            Handled::Ghost { leg, hole, before } => {
                let edit = Edit::InsertCorner { leg: leg.clone(), hole: *hole, before: *before, at };
                (edit, Handled::Corner { leg: leg.clone(), hole: *hole, corner: *before })
            }
            Handled::Area(variable, part @ AreaPart::Ghost(before)) => {
                let Some(edit) = canvas.sketch.drag_area(variable, *part, at) else { return };
                (edit, Handled::Area(variable.clone(), AreaPart::Corner(*before)))
            }
            Handled::Between { leg, .. } => {
                let place = Drawn::Place(Place::Position(Value::Constant(at)));
                let new = create::leg(plan, &Profile::default(), LegChoice::Tf, &place, None, None);
                let Some(new) = new else { return };
                let becomes = Handled::Waypoint(new.id.clone());
                let at = Spot::Before(leg.clone());
                (create::insert(plan, create::like_beside(plan, new, &at), at), becomes)
            }
            _ => return,
        };
        queue.document(DocumentCommand::DragEdit(edit));
        if let Handled::Waypoint(new) = &becomes {
            queue.view(ViewCommand::Select(Some(Selection::Leg(new.clone()))));
        }
        self.inserting = Some((name, becomes));
    }
}

impl Tool for Select {
    fn card(&self) -> &'static Card {
        &Card { id: "select", name: "Select and move", symbol: "⬉", key: Key::V }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        scene.view.locked.then(|| guard::LOCKED.into())
    }

    fn grips(&self, canvas: &Canvas<'_>) -> Vec<Grip> {
        // what a mark has become is dragged on under the mark's name
        let name = |handle: &Handle| match &self.inserting {
            Some((name, becomes)) if *becomes == handle.what => name.clone(),
            _ => handle.what.name(canvas.scene.document),
        };
        let shown = canvas.near.iter().filter(|(_, handle, _)| self.inserting.is_none() || !is_mark(handle));
        let plan = canvas.scene.document.plan();
        let first = |handle: &Handle| canvas.scene.is_selected(&selection(plan, &handle.what));
        let grips =
            shown.map(|&(key, handle, at)| Grip { key, name: name(handle), at, first: first(handle) });
        let mut grips: Vec<Grip> = grips.collect();
        grips.extend(self.group.grips(canvas));
        put_meant_last(&mut grips, canvas.pointer);
        // below the others
        let line = self.line_grip(&grips, canvas);
        let is_free = line.is_none() && self.inserting.is_none();
        let whole = whole::grip(self.whole.as_ref(), &grips, canvas).filter(|_| is_free);
        whole.into_iter().chain(line).chain(grips).collect()
    }

    fn hover(&mut self, _at: Option<Pos2>, canvas: &Canvas<'_>) {
        let plan = canvas.scene.document.plan();
        let selected = |what: &Handled| canvas.scene.is_selected(&selection(plan, what));
        self.corner = self.corner.take().filter(selected);
    }

    fn press(&mut self, mut pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        (self.line, self.whole) = (None, None);
        if let Some(below @ (LINE | whole::KEY)) = pointer.grip {
            match (below, pointer.clicks) {
                (LINE, false) => return self.grab_line(canvas, queue),
                (_, false) => return self.grab_whole(canvas),
                _ => pointer.grip = None,
            }
        }
        let plan = canvas.scene.document.plan();
        let handle = pointer.grip.and_then(|key| canvas.sketch.handles.get(key));
        self.refused = false;
        if let Some(why) = why_not(pointer, handle, canvas) {
            self.refused = true;
            queue.view(ViewCommand::Notice(why));
            if handle.is_none() {
                // what is selected stays so
                return;
            }
        } else if pointer.grip.is_some_and(|key| self.group.press(key, pointer.clicks, canvas)) {
            return;
        }
        self.grabbed = handle.filter(|_| !pointer.clicks).cloned();
        let is_selected = |what: &Handled| canvas.scene.is_selected(&selection(plan, what));
        let corner = handle.and_then(|handle| corner_of(plan, &handle.what)).filter(is_selected);
        self.bent = corner.clone().filter(|_| !pointer.clicks);
        self.among = match pointer.grip {
            None => whole::or_zone(lines_near(pointer.at, canvas), pointer.at, canvas),
            Some(_) => Vec::new(),
        };
        let chosen = handle
            .filter(|_| pointer.clicks && !self.refused)
            .and_then(|handle| numbers::choice(plan, &handle.what));
        if let Some(edit) = chosen {
            return queue.edit(edit);
        }
        let picked = match handle {
            Some(handle) => Some(selection(plan, &handle.what)),
            None => self.among.first().cloned(),
        };
        // hover forgets it until its owner is the selected one
        self.corner = corner;
        queue.view(match picked {
            Some(what) if pointer.adds && what.is_in_sets() => ViewCommand::Toggle(what),
            _ if pointer.adds => return,
            picked => ViewCommand::Select(picked),
        });
    }

    fn among(&mut self) -> Vec<Selection> {
        std::mem::take(&mut self.among)
    }

    fn drag(&mut self, grip: usize, to: Pos2, canvas: &Canvas<'_>, queue: &mut Queue) {
        if self.refused {
            return;
        }
        if self.group.drag(to, canvas, queue) {
            self.whole_moves = self.whole.is_some();
            return;
        }
        let plan = canvas.scene.document.plan();
        if let (Some(leg), true) = (self.line.take(), self.inserting.is_none()) {
            let (name, at) = (line_name(&leg, canvas), canvas.view.geo(to));
            return if at.is_valid() {
                self.insert(&Handled::Between { leg, gap_m: 0 }, name, at, canvas, queue)
            };
        }
        let Some(handle) = canvas.sketch.handles.get(grip) else { return };
        let mark = self.snapped(handle, to, canvas);
        let to = mark.at;
        let alone = self.grabbed.as_ref().filter(|_| self.bent.is_none());
        self.landing = landing(plan, alone, &mark);
        self.dragged = Some(mark);
        if is_mark(handle) {
            return if to.is_valid() {
                self.insert(&handle.what, handle.what.name(canvas.scene.document), to, canvas, queue)
            };
        }
        let what = self.bent.as_ref().unwrap_or(&handle.what);
        let plan = match what {
            Handled::Runway(..) => self.before.get_or_insert_with(|| plan.clone()),
            _ => plan,
        };
        if let Some(edit) = edit(plan, canvas.sketch, what, to) {
            queue.document(DocumentCommand::DragEdit(edit));
        }
    }

    /// What was clicked twice is to be seen with all it has: in the inspector, if that is hidden or behind another panel. One click
    /// only selects: who has closed the inspector wants the room.
    fn finish(&mut self, canvas: &Canvas<'_>, queue: &mut Queue) {
        if canvas.scene.view.selection.is_some() {
            queue.view(ViewCommand::ShowPanel(inspector::ID, true));
        }
    }

    fn sweep(&mut self, area: Rect, canvas: &Canvas<'_>, queue: &mut Queue) {
        let new = within(area, canvas).into_iter().filter(|what| !canvas.scene.is_selected(what));
        new.for_each(|what| queue.view(ViewCommand::Toggle(what)));
    }

    fn release(&mut self, queue: &mut Queue) {
        self.inserting = None;
        if let Some(whole) = self.whole.take()
            && std::mem::take(&mut self.whole_moves)
        {
            // who meant the map sees what he did
            let kind = whole::kind(&whole);
            queue.view(ViewCommand::Toast(format!("Moved the selected {kind}. Ctrl+Z takes it back.")));
        }
        self.group.release();
        (self.grabbed, self.dragged, self.bent, self.before) = (None, None, None, None);
        if let Some(edit) = self.landing.take() {
            queue.document(DocumentCommand::DragEdit(edit));
        }
        queue.document(DocumentCommand::EndGesture);
    }

    fn wants(&self, key: Key) -> bool {
        key == Key::Delete && self.corner.is_some()
    }

    fn key(&mut self, _key: Key, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(corner) = self.corner.take() {
            remove_corner(canvas.scene.document.plan(), canvas.sketch, &corner, queue);
        }
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, touch: Touch, p: &Palette) {
        let plan = canvas.scene.document.plan();
        let mut labels = Vec::new();
        for &(key, handle, at) in canvas.near {
            let selected = canvas.scene.is_selected(&selection(plan, &handle.what));
            let hot = touch.hovered == Some(key) || touch.dragged == Some(key);
            let chosen = self.corner.is_some() && self.corner == corner_of(plan, &handle.what);
            draw(painter, at, handle, selected, hot || chosen, p);
            labels.extend(label(handle, at, canvas, selected || touch.hovered == Some(key)));
            labels.extend(value(handle, at, canvas).filter(|_| hot));
        }
        draw_labels(painter, labels, canvas, p);
        crossing::paint(painter, canvas, self.dragged.as_ref().map(|mark| canvas.view.place(mark.at)), p);
        if let Some(handle) = touch.dragged.and_then(|key| canvas.sketch.handles.get(key)) {
            self.paint_drag(painter, handle, canvas, p);
        }
        self.group.paint(painter, canvas, p);
        if let (Some(LINE), Some(at)) = (touch.hovered, canvas.pointer) {
            painter.circle(at, 3.5, p.halo, Stroke::new(1.4, p.accent));
        }
    }
}

impl Select {
    /// A drag begins on a line.
    fn grab_line(&mut self, canvas: &Canvas<'_>, queue: &mut Queue) {
        let leg = canvas.pointer.and_then(|at| line_under(at, canvas)).map(|(leg, _)| leg);
        let why = leg.as_ref().and_then(|leg| guard::of_legs(canvas.scene, std::slice::from_ref(leg)));
        self.refused = why.is_some();
        self.line = leg.filter(|_| why.is_none());
        why.into_iter().for_each(|why| queue.view(ViewCommand::Notice(why)));
    }

    /// A drag begins inside of the selected zone or area.
    fn grab_whole(&mut self, canvas: &Canvas<'_>) {
        self.whole = canvas.pointer.and_then(|at| whole::selected(at, canvas));
        self.refused = self.whole.is_none();
        if let (Some(_), Some(at)) = (&self.whole, canvas.pointer) {
            self.group.move_from(at, canvas);
        }
    }

    /// What is near where a handle is dragged; nothing that moves with it. Numbers and marks don't snap.
    fn snapped(&self, handle: &Handle, to: Pos2, canvas: &Canvas<'_>) -> Mark {
        let snaps = matches!(
            handle.what,
            Handled::Fix(_)
                | Handled::Variable(_)
                | Handled::Waypoint(_)
                | Handled::Centre(_)
                | Handled::Corner { .. }
                | Handled::Area(_, AreaPart::Corner(_))
                | Handled::Runway(..)
        );
        if !snaps {
            return Mark::at(canvas.view.geo(to));
        }
        let plan = canvas.scene.document.plan();
        let bound = handle.what.leg().and_then(|leg| create::bound_to(plan.any_leg(leg)?));
        let own_variable = match &handle.what {
            Handled::Variable(name) => Some(name.clone()),
            _ => None,
        };
        let bound = bound.or(own_variable);
        let own = [
            handle.what.name(canvas.scene.document),
            bound.map_or_else(String::new, |name| format!("variable {name}")),
        ];
        let own = own.map(|name| name.to_lowercase());
        let runways = match &handle.what {
            Handled::Runway(id, _) => snap::of_runway(plan, id),
            _ => Vec::new(),
        };
        let is_own = |on: &str| own.contains(&on.to_lowercase()) || runways.iter().any(|of| on.ends_with(of));
        let (now, was) = (handle.at, self.grabbed.as_ref().map(|grabbed| grabbed.at));
        let lands = self.dragged.as_ref().and_then(|mark| mark.on.clone());
        snap_but(to, canvas, &|on, at| {
            // what is at the same place moves along, unless it was dragged onto it
            is_own(on) || (at.distance_m(now) < 0.5 && lands.as_deref() != Some(on)) || was == Some(at)
        })
    }

    /// Bands from what is dragged to what is before and behind it, what it is dragged onto, and what is wrong with it so.
    fn paint_drag(&self, painter: &Painter, handle: &Handle, canvas: &Canvas<'_>, p: &Palette) {
        if let Some(mark) = &self.dragged {
            snap::paint(painter, mark, canvas, p);
        }
        let legs = bands::legs_to(canvas.scene.document.plan(), &handle.what);
        let Some(leg) = legs.first() else { return };
        bands::paint(painter, canvas, handle.at, &bands::around(canvas, &legs), p);
        let at = canvas.view.place(handle.at) + vec2(12.0, 26.0);
        let is_fault = |q: &&Problem| q.is_error() && q.subject.as_ref().is_some_and(|of| legs.contains(of));
        let fault = canvas.scene.problems().find(is_fault);
        let (words, colour) = match (fault, bands::before(canvas, leg)) {
            (Some(problem), _) => (canvas.scene.document.plan().in_names(&problem.message), p.warning),
            (None, Some(from)) => (way(from, handle.at, canvas.scene.units()), p.text),
            (None, None) => return,
        };
        text::haloed(painter, at, Align2::LEFT_TOP, &words, 12.0, colour, p);
    }
}

/// Why what is grabbed, or a mark that is clicked, can't be changed now. Whatever it is, it can be selected.
fn why_not(pointer: Pointer, handle: Option<&Handle>, canvas: &Canvas<'_>) -> Option<String> {
    let Some(handle) = handle else {
        let grabs = pointer.grip.is_some() && !pointer.clicks;
        return grabs.then(|| guard::of_selected(canvas.scene)).flatten();
    };
    let changes = !pointer.clicks || handle.what.is_choice();
    changes.then(|| guard::of_handle(canvas.scene, &handle.what)).flatten()
}

/// What letting a leg's place go there does, if there is a fix or variable. A variable that was dragged along goes back.
fn landing(plan: &FlightPlan, grabbed: Option<&Handle>, mark: &Mark) -> Option<Edit> {
    let Handle { what: Handled::Waypoint(leg) | Handled::Centre(leg), at: was } = grabbed? else {
        return None;
    };
    if matches!(mark.place, Place::Position(Value::Constant(_))) {
        return None;
    }
    let lands = create::put_at(plan, leg, &mark.place)?;
    let back = create::bound_to(plan.any_leg(leg)?)
        .map(|name| Edit::SetVariable { name, value: VariableValue::Position(*was) });
    Some(Edit::All(back.into_iter().chain([lands]).collect()))
}

fn line_name(leg: &Id, canvas: &Canvas<'_>) -> String {
    format!("Line to {}", canvas.scene.document.label(leg))
}

/// Not there yet: it is when it is dragged.
fn is_mark(handle: &Handle) -> bool {
    matches!(
        handle.what,
        Handled::Ghost { .. } | Handled::Between { .. } | Handled::Area(_, AreaPart::Ghost(_))
    )
}

/// The edit that moves what a handle stands for.
fn edit(plan: &FlightPlan, sketch: &Sketch, what: &Handled, to: LatLon) -> Option<Edit> {
    if !to.is_valid() {
        return None;
    }
    match what {
        Handled::Variable(name) => {
            Some(Edit::SetVariable { name: name.clone(), value: VariableValue::Position(to) })
        }
        // a mark has become a corner before it gets here
        Handled::Area(_, AreaPart::Ghost(_)) => None,
        Handled::Area(variable, part) => sketch.drag_area(variable, *part, to),
        Handled::Runway(id, end) => create::lay_runway(plan, &end.dragged(plan.runway(id)?, to)?),
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
        Handled::Ghost { .. } | Handled::Between { .. } | Handled::Entry { .. } | Handled::Side { .. } => {
            None
        }
    }
}
