//! An emergency plan, drawn from the runway outwards; it is flown the other way.

use super::bands::{self, Band};
use super::pen::{Figure, Mark, Pen};
use super::pick::runway_near;
use super::snap::snap;
use super::{Canvas, Card, Pointer, Tool, Touch};
use crate::command::{DocumentCommand, Queue, ViewCommand};
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{CursorIcon, Key, Painter, Pos2};
use flight_plan::{Id, Place};
use geometry::LatLon;

/// The tool.
#[derive(Debug)]
pub struct DrawEmergency {
    pen: Pen,
    runway: Option<Id>,
    /// From where the flight may come into it.
    bands: Vec<Band>,
}

impl Default for DrawEmergency {
    fn default() -> Self {
        Self { pen: Pen::new(Figure::Line), runway: None, bands: Vec::new() }
    }
}

impl DrawEmergency {
    /// With the runway alone, it is the way home from anywhere.
    fn complete(&mut self, queue: &mut Queue) {
        let marks = self.pen.drawn();
        if let Some(runway) = self.runway.take() {
            let outwards: Vec<Place> = marks.into_iter().skip(1).map(|mark| mark.place).collect();
            queue.document(DocumentCommand::BringHome { runway, outwards });
        }
        self.pen.clear();
    }
}

impl Tool for DrawEmergency {
    fn card(&self) -> &'static Card {
        &Card { id: "emergency", name: "Draw an emergency plan", symbol: "⚑", key: Key::E }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        Some(match &self.runway {
            _ if scene.document.plan().runways.is_empty() => {
                "Emergency plan: draw a runway first, it lands on one.".into()
            }
            None => "Emergency plan: click the runway it leads to. Esc ends it.".into(),
            Some(runway) => format!(
                "Emergency plan to {runway}: click its places from there outwards, it is flown inwards. Enter or a double click ends it; without places it comes straight home."
            ),
        })
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pen.hover(at, canvas);
        let gone = |id: &Id| canvas.scene.document.plan().runway(id).is_none();
        if self.pen.len() == 0 || self.runway.as_ref().is_some_and(gone) {
            self.leave();
        }
        let from = self.pen.pointer().filter(|_| self.runway.is_some());
        self.bands = from.map_or(Vec::new(), |from| bands::entries(canvas, from.at));
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        if self.runway.is_some() {
            return self.put(snap(pointer.at, canvas), canvas, queue);
        }
        match runway_near(pointer.at, canvas) {
            Some(runway) => {
                self.runway = Some(runway.id.clone());
                self.pen.put(Mark::at(runway.threshold), canvas);
            }
            None => queue.view(ViewCommand::Notice("Click a runway: the emergency plan leads there.".into())),
        }
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        self.runway.as_ref().map(|_| self.pen.last())
    }

    fn put(&mut self, mark: Mark, canvas: &Canvas<'_>, _queue: &mut Queue) {
        // a line is not whole before it is ended
        let _ = self.pen.put(mark, canvas);
    }

    fn finish(&mut self, _canvas: &Canvas<'_>, queue: &mut Queue) {
        self.complete(queue);
    }

    fn wants(&self, key: Key) -> bool {
        self.pen.wants(key)
    }

    fn key(&mut self, key: Key, _canvas: &Canvas<'_>, queue: &mut Queue) {
        match key {
            Key::Enter => self.complete(queue),
            _ => drop(self.pen.key(key)),
        }
    }

    fn leave(&mut self) {
        self.pen.clear();
        self.runway = None;
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        if let Some(from) = self.pen.pointer() {
            bands::paint(painter, canvas, from.at, &self.bands, p);
        }
        self.pen.paint(painter, canvas, false, p);
    }
}
