//! Several selected legs, stages, fixes, zones, runways and variables as one, or one area, zone or runway: a box around it, and handles
//! that move, turn and scale all of it.

use super::framed::{Does, Moved, framed};
use super::pen::way;
use super::{Canvas, Grip};
use crate::command::{DocumentCommand, Queue, Selection};
use crate::map::text;
use crate::theme::Palette;
use egui::{Align2, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use flight_plan::transform::{self, Motion};
use flight_plan::{Id, Leg, Place};
use geometry::LatLon;

/// The grips' keys begin here; those of the sketch's handles end before.
const FIRST_KEY: usize = 1 << 32;
/// From the places to the box, screen points.
const AROUND: f32 = 22.0;
/// From the box to the handle that turns it, screen points.
const ABOVE: f32 = 26.0;
/// Smaller than this, nothing could be told apart any more.
const LEAST_SCALE: f64 = 0.05;

impl Does {
    fn name(self) -> &'static str {
        match self {
            Self::Move => "Move what is selected",
            Self::Turn => "Turn what is selected",
            Self::Scale => "Scale what is selected",
        }
    }

    fn at(self, around: Rect) -> Pos2 {
        match self {
            Self::Move => around.left_top(),
            Self::Turn => around.center_top() - vec2(0.0, ABOVE),
            Self::Scale => around.right_bottom(),
        }
    }

    fn paint(self, painter: &Painter, around: Rect, p: &Palette) {
        let (at, stroke) = (self.at(around), Stroke::new(2.0, p.accent));
        match self {
            Self::Move => [vec2(7.0, 0.0), vec2(0.0, 7.0)].into_iter().for_each(|axis| {
                painter.line_segment([at - axis, at + axis], Stroke::new(2.4, p.accent));
            }),
            Self::Turn => {
                painter.line_segment([around.center_top(), at], Stroke::new(1.4, p.accent));
                painter.circle(at, 6.0, p.halo, stroke);
            }
            Self::Scale => {
                let square = Rect::from_center_size(at, Vec2::splat(11.0));
                painter.rect(square, 1.0, p.halo, stroke, egui::StrokeKind::Middle);
            }
        }
    }
}

/// A drag on its way. It always begins from the plan as it was, so that it ends exactly where it leads.
#[derive(Debug)]
struct Drag {
    moved: Moved,
    does: Does,
    /// Where the grip was.
    from: Pos2,
    pivot: LatLon,
    motion: Motion,
}

impl Drag {
    fn new(does: Does, from: Pos2, pivot: Pos2, canvas: &Canvas<'_>) -> Self {
        let pivot = canvas.view.geo(pivot);
        Self { moved: Moved::of(canvas), does, from, pivot, motion: Motion::shift(pivot, pivot) }
    }
}

/// The handles around what is selected.
#[derive(Debug, Default)]
pub struct Group {
    drag: Option<Drag>,
}

impl Group {
    /// None around one thing that has no extent.
    pub fn grips(&self, canvas: &Canvas<'_>) -> Vec<Grip> {
        let Some((offered, around)) = boxed(canvas) else { return Vec::new() };
        let grips = (FIRST_KEY..).zip(Does::ALL).filter(|(_, does)| offered.contains(does));
        grips
            .map(|(key, does)| Grip { key, name: does.name().into(), at: does.at(around), first: true })
            .collect()
    }

    /// A grip was clicked, or a drag of it begins; true if it is one of these.
    pub fn press(&mut self, key: usize, clicks: bool, canvas: &Canvas<'_>) -> bool {
        let Some(does) = key.checked_sub(FIRST_KEY).and_then(|index| Does::ALL.get(index)) else {
            return false;
        };
        let begun = boxed(canvas).filter(|_| !clicks);
        self.drag = begun.map(|(_, around)| Drag::new(*does, does.at(around), around.center(), canvas));
        true
    }

    /// A drag of all that is selected begins there.
    pub fn move_from(&mut self, from: Pos2, canvas: &Canvas<'_>) {
        self.drag = Some(Drag::new(Does::Move, from, from, canvas));
    }

    /// The pressed grip is dragged; true if there is one.
    pub fn drag(&mut self, to: Pos2, canvas: &Canvas<'_>, queue: &mut Queue) -> bool {
        let Some(drag) = &mut self.drag else { return false };
        drag.motion = motion(drag, to, canvas);
        if drag.motion.to.is_valid() {
            queue.document(DocumentCommand::DragEdit(drag.moved.edit(&drag.motion)));
        }
        true
    }

    /// The drag is over.
    pub fn release(&mut self) {
        self.drag = None;
    }

    /// The box, its handles, and what the drag has come to.
    pub fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, p: &Palette) {
        let Some((offered, around)) = boxed(canvas) else { return };
        let stroke = Stroke::new(1.4, p.accent);
        let corners = [around.left_top(), around.right_top(), around.right_bottom(), around.left_bottom()];
        let ring: Vec<Pos2> = corners.into_iter().chain([around.left_top()]).collect();
        painter.extend(Shape::dashed_line(&ring, stroke, 5.0, 4.0));
        offered.iter().for_each(|does| does.paint(painter, around, p));
        if let Some(drag) = &self.drag {
            let at = drag.does.at(around) + vec2(12.0, -10.0);
            text::haloed(painter, at, Align2::LEFT_BOTTOM, &words(drag, canvas), 13.0, p.text, p);
        }
    }
}

fn motion(drag: &Drag, to: Pos2, canvas: &Canvas<'_>) -> Motion {
    let view = canvas.view;
    let still = Motion::shift(drag.pivot, drag.pivot);
    let middle = view.place(drag.pivot);
    let (before, now) = (drag.from - middle, to - middle);
    match drag.does {
        Does::Move => Motion::shift(drag.pivot, view.geo(middle + (to - drag.from))),
        Does::Turn => {
            let turn_deg = f64::from((now.angle() - before.angle()).to_degrees()).round();
            Motion { turn_deg: geometry::geodesy::normalise_180(turn_deg), ..still }
        }
        Does::Scale => {
            let scale = f64::from(now.length() / before.length().max(1.0));
            Motion { scale: ((scale * 100.0).round() / 100.0).max(LEAST_SCALE), ..still }
        }
    }
}

fn words(drag: &Drag, canvas: &Canvas<'_>) -> String {
    match drag.does {
        Does::Move => way(drag.motion.pivot, drag.motion.to, canvas.scene.units()),
        Does::Turn => format!("Turned {:+.0}°", drag.motion.turn_deg),
        Does::Scale => format!("× {:.2}", drag.motion.scale),
    }
}

/// The box around what is selected on the screen, and what its handles do.
fn boxed(canvas: &Canvas<'_>) -> Option<(&'static [Does], Rect)> {
    framed(canvas).map(|(does, around)| (does, around.expand(AROUND)))
}

/// What is selected in a part of the screen: the legs that have a place there, those of emergency plans too, the fixes there that
/// none of these uses, the variables whose places are there, and the zones, runways and areas of variables that are there as a whole.
pub fn within(area: Rect, canvas: &Canvas<'_>) -> Vec<Selection> {
    let plan = canvas.scene.document.plan();
    let is_there = |at: LatLon| area.contains(canvas.view.place(at));
    let contexts = plan.all_legs();
    let legs: Vec<&Leg> = contexts
        .iter()
        .map(|context| context.leg)
        .filter(|leg| transform::places(plan, leg).into_iter().any(is_there))
        .collect();
    let uses = |fix: &Id| legs.iter().any(|leg| matches!(leg.place(), Some(Place::Fix(id)) if id == fix));
    let fixes = plan.fixes.iter().filter(|fix| is_there(fix.position) && !uses(&fix.id));
    let is_whole = |id: &Id| {
        let places = transform::places_of(plan, std::slice::from_ref(id));
        !places.is_empty() && places.into_iter().all(is_there)
    };
    let zones = plan.zones.iter().filter(|zone| is_whole(&zone.id));
    let runways = plan.runways.iter().filter(|runway| is_whole(&runway.id));
    let placed = canvas.sketch.variables.iter().filter(|variable| is_there(variable.at));
    let areas = canvas.sketch.areas.iter().filter(|(_, corners)| corners.iter().copied().all(is_there));
    let variables = placed.map(|variable| &variable.name).chain(areas.map(|(name, _)| name));
    let ids = legs.iter().map(|leg| Selection::Leg(leg.id.clone()));
    let fixes = fixes.map(|fix| Selection::Fix(fix.id.clone()));
    ids.chain(fixes)
        .chain(zones.map(|zone| Selection::Zone(zone.id.clone())))
        .chain(runways.map(|runway| Selection::Runway(runway.id.clone())))
        .chain(variables.map(|name| Selection::Variable(name.clone())))
        .collect()
}
