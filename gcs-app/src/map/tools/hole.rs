//! A hole in an area that is scanned or followed along its edge: what lies in it is left out.

use super::crossing;
use super::pen::{Figure, Mark, Pen};
use super::{Canvas, Card, Pointer, Tool, Touch};
use crate::command::{Queue, Selection, ViewCommand};
use crate::map::guard;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{CursorIcon, Key, Painter, Pos2};
use flight_plan::{Area, Edit, FlightPlan, Id, Leg};
use geometry::LatLon;

/// Said where no area can get a hole.
const NOWHERE: &str = "Begin the hole inside of an area with corners of its own. A circle, a zone and the area of a variable have none.";

/// An outline inside of an area becomes a hole in it.
#[derive(Debug)]
pub struct CutHole {
    pen: Pen,
    /// The leg whose area was begun in.
    leg: Option<Id>,
    /// Why it can't be as it is drawn so far.
    fault: Option<&'static str>,
}

impl Default for CutHole {
    fn default() -> Self {
        Self { pen: Pen::new(Figure::Ring).off_lines(), leg: None, fault: None }
    }
}

impl CutHole {
    fn complete(&mut self, marks: &[Mark], canvas: &Canvas<'_>, queue: &mut Queue) {
        let Some(leg) = self.leg.take() else { return };
        let Some(area) = cut(canvas.scene.document.plan(), &leg, marks) else { return };
        queue.edit(Edit::SetArea { leg: leg.clone(), area });
        queue.view(ViewCommand::Select(Some(Selection::Leg(leg))));
    }

    /// Ends the outline if it can be a hole; else says why not, and what was drawn stays.
    fn close(&mut self, canvas: &Canvas<'_>, queue: &mut Queue) {
        let drawn: Vec<Mark> = self.pen.clicked().cloned().collect();
        match self.leg.as_ref().and_then(|leg| fault(canvas, leg, &drawn)) {
            Some(why) => queue.view(ViewCommand::Notice(format!("{why}. Backspace takes one back."))),
            None => self.pen.finish().into_iter().for_each(|marks| self.complete(&marks, canvas, queue)),
        }
    }
}

/// The leg's area with what was drawn cut out of it.
fn cut(plan: &FlightPlan, leg: &Id, marks: &[Mark]) -> Option<Area> {
    let Area::Polygon { corners, holes } = plan.any_leg(leg)?.area()? else { return None };
    let new = marks.iter().map(|mark| mark.at).collect();
    Some(Area::Polygon { corners: corners.clone(), holes: holes.iter().cloned().chain([new]).collect() })
}

/// The leg whose area is there: the selected one, else the one that was put into the plan last.
fn leg_at(at: LatLon, canvas: &Canvas<'_>) -> Option<Id> {
    let plan = canvas.scene.document.plan();
    let has_corners = |leg: &Id| matches!(plan.any_leg(leg).and_then(Leg::area), Some(Area::Polygon { .. }));
    let around = |(leg, rings): &&(Id, Vec<Vec<LatLon>>)| {
        rings.first().is_some_and(|outer| crossing::is_inside(outer, at)) && has_corners(leg)
    };
    let mut areas = canvas.sketch.polygons.iter().filter(around).map(|(leg, _)| leg).rev().peekable();
    let last = areas.peek().map(|leg| (*leg).clone());
    areas.find(|leg| canvas.scene.is_selected(&Selection::Leg((*leg).clone()))).cloned().or(last)
}

/// Why what was drawn can't be a hole of the leg's area.
fn fault(canvas: &Canvas<'_>, leg: &Id, drawn: &[Mark]) -> Option<&'static str> {
    let area = cut(canvas.scene.document.plan(), leg, drawn)?;
    let Area::Polygon { corners, holes } = area else { return None };
    let rings: Vec<Vec<LatLon>> = std::iter::once(corners).chain(holes).collect();
    crossing::fault(&rings).map(|(why, _)| why)
}

impl Tool for CutHole {
    fn card(&self) -> &'static Card {
        &Card { id: "hole", name: "Cut a hole into an area", symbol: "▣", key: Key::H }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        let plan = scene.document.plan();
        Some(match (&self.leg, self.fault) {
            (None, _) => {
                "Hole: click its corners inside of an area; it is left out there. Esc ends it.".into()
            }
            (Some(leg), None) => format!("Hole in {}: {}.", plan.label(leg), self.pen.hint()),
            (Some(leg), Some(why)) => format!("Hole in {}: {why}.", plan.label(leg)),
        })
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pen.hover(at, canvas);
        let so_far = self.pen.so_far().filter(|marks| marks.len() >= 3);
        self.fault = so_far.zip(self.leg.as_ref()).and_then(|(marks, leg)| fault(canvas, leg, &marks));
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        Some(self.pen.last())
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        self.put(self.pen.snap(pointer.at, canvas), canvas, queue);
    }

    fn put(&mut self, mark: Mark, canvas: &Canvas<'_>, queue: &mut Queue) {
        if self.pen.len() == 0 {
            self.leg = leg_at(mark.at, canvas);
        }
        let Some(leg) = &self.leg else { return queue.view(ViewCommand::Notice(NOWHERE.into())) };
        if let Some(why) = guard::of_legs(canvas.scene, std::slice::from_ref(leg)) {
            self.leg = None;
            return queue.view(ViewCommand::Notice(why));
        }
        match self.pen.closes(&mark, canvas) {
            true => self.close(canvas, queue),
            false => drop(self.pen.put(mark, canvas)),
        }
    }

    fn finish(&mut self, canvas: &Canvas<'_>, queue: &mut Queue) {
        self.close(canvas, queue);
    }

    fn wants(&self, key: Key) -> bool {
        self.pen.wants(key)
    }

    fn key(&mut self, key: Key, canvas: &Canvas<'_>, queue: &mut Queue) {
        match key {
            Key::Enter => self.close(canvas, queue),
            _ => drop(self.pen.key(key)),
        }
        self.leg = self.leg.take().filter(|_| self.pen.len() > 0);
    }

    fn leave(&mut self) {
        *self = Self::default();
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        self.pen.paint(painter, canvas, self.fault.is_some(), p);
    }
}
