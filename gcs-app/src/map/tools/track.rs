//! Track: legs from place to place, one for each click.

use super::new_leg::{self, spot, words};
use super::{Canvas, Card, Pointer, Tool, Touch};
use crate::command::{Queue, Selection, ViewCommand};
use crate::map::polyline::{self, Style};
use crate::map::sketch::Handled;
use crate::map::text;
use crate::map::view::Mercator;
use crate::panels::Scene;
use crate::theme::Palette;
use crate::units;
use egui::{Align2, CursorIcon, Key, Painter, Pos2, Stroke, vec2};
use flight_plan::{Edit, Id, LegKind, Place, PlanWaypoint, Spot, Value};
use geometry::LatLon;

/// A click so near to a fix means the fix, screen points.
const SNAP: f32 = 12.0;

/// The tool: each click adds a TF leg behind the one before, the first behind what is selected.
#[derive(Debug, Default)]
pub struct Track {
    /// The legs that were drawn, and where they lead.
    drawn: Vec<(Id, LatLon)>,
    pointer: Option<LatLon>,
}

impl Tool for Track {
    fn card(&self) -> &'static Card {
        &Card { id: "track", name: "Draw legs", symbol: "✏", key: Key::T }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        let plan = scene.document.plan();
        Some(match (self.drawn.last(), spot(plan, scene.view.selection.as_ref())) {
            (None, None) => "Draw legs: make a new mission first, it has a stage to draw into.".into(),
            (None, Some(spot)) => format!("Draw legs {}: click where to fly. Esc ends it.", words(&spot)),
            (Some((_, last)), _) => match self.pointer {
                Some(to) => format!("Next leg: {}. Backspace takes the last back.", result(*last, to, scene)),
                None => "Draw legs: Backspace takes the last back, Enter ends it.".into(),
            },
        })
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pointer = at.map(|at| canvas.view.geo(at)).filter(|at| at.is_valid());
        // what was undone or removed meanwhile is not gone on from
        let plan = canvas.scene.document.plan();
        while self.drawn.last().is_some_and(|(id, _)| plan.leg(id).is_none()) {
            self.drawn.pop();
        }
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        let plan = canvas.scene.document.plan();
        let (place, to) = place_at(pointer.at, canvas);
        let selected = canvas.scene.view.selection.as_ref();
        let behind = self.drawn.last().map(|(id, _)| Spot::After(id.clone()));
        let Some(at) = behind.or_else(|| spot(plan, selected)).filter(|_| to.is_valid()) else { return };
        let waypoint = PlanWaypoint { place, fly_over: false };
        let leg = new_leg::make(plan, "leg", LegKind::Tf(waypoint));
        self.drawn.push((leg.id.clone(), to));
        let drawn = Selection::Leg(leg.id.clone());
        queue.edit(Edit::InsertLeg { leg: Box::new(leg), at });
        queue.view(ViewCommand::Select(Some(drawn)));
    }

    fn drag(&mut self, _grip: usize, _to: Pos2, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    fn key(&mut self, key: Key, queue: &mut Queue) -> bool {
        let Some((id, _)) = self.drawn.last().cloned() else { return false };
        if key == Key::Backspace {
            self.drawn.pop();
            queue.edit(Edit::DeleteLeg { leg: id });
            let before = self.drawn.last().map(|(id, _)| Selection::Leg(id.clone()));
            queue.view(ViewCommand::Select(before));
        } else {
            self.leave();
        }
        true
    }

    fn leave(&mut self) {
        self.drawn.clear();
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        let (Some((_, from)), Some(to)) = (self.drawn.last(), self.pointer) else { return };
        let line = [Mercator::from(*from), Mercator::from(to)];
        let parts = polyline::visible_parts(&line, canvas.view);
        polyline::draw(painter, &parts, Stroke::new(2.0, p.accent), Style::Dashed, p.halo);
        let at = canvas.view.place(to) + vec2(10.0, -10.0);
        let result = result(*from, to, canvas.scene);
        text::haloed(painter, at, Align2::LEFT_BOTTOM, &result, 13.0, p.text, p);
    }
}

/// `1.2 km · 045°`: the length and the track at its beginning.
fn result(from: LatLon, to: LatLon, scene: &Scene<'_>) -> String {
    let way = from.inverse(to);
    let distance = scene.units().distance().show(way.distance_m);
    format!("{distance} · {}", units::bearing(way.bearing_start_deg))
}

/// The fix under the pointer, or the place there.
fn place_at(at: Pos2, canvas: &Canvas<'_>) -> (Place, LatLon) {
    let fix = canvas.sketch.handles.iter().find_map(|handle| match &handle.what {
        Handled::Fix(id) if canvas.view.place(handle.at).distance(at) < SNAP => Some((id, handle.at)),
        _ => None,
    });
    match fix {
        Some((id, at)) => (Place::Fix(id.clone()), at),
        None => {
            let at = canvas.view.geo(at);
            (Place::Position(Value::Constant(at)), at)
        }
    }
}
