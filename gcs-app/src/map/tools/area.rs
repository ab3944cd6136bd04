//! Area: a polygon to be scanned, corner by corner.

use super::new_leg::{self, spot, words};
use super::{Canvas, Card, Pointer, Tool, Touch};
use crate::command::{Queue, Selection, ViewCommand};
use crate::map::polyline::{self, Style};
use crate::map::view::Mercator;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{CursorIcon, Key, Painter, Pos2, Stroke};
use flight_plan::{Area, Edit, FlightPlan, LegKind, Scan, ScanEntry, ScanStyle, Spacing, Spot, Value};
use geometry::LatLon;
use std::sync::Arc;

/// A click so near to the first corner closes the area, screen points.
const NEAR: f32 = 12.0;
/// Between the tracks of a new scan, metres.
const SPACING_M: f64 = 300.0;
/// How far its tracks go on beyond the edge, metres.
const OVERSHOOT_M: f64 = 50.0;

/// The tool: clicks set the corners; Enter, or a click on the first one, makes a scan of them.
#[derive(Debug, Default)]
pub struct DrawArea {
    corners: Vec<LatLon>,
    pointer: Option<LatLon>,
    /// The plan and where in it the scan goes, as they were at the last click: a key sees neither.
    into: Option<(Arc<FlightPlan>, Spot)>,
}

impl DrawArea {
    fn close(&mut self, queue: &mut Queue) {
        let corners = std::mem::take(&mut self.corners);
        let Some((plan, at)) = self.into.take().filter(|_| corners.len() >= 3) else { return };
        let scan = Scan {
            area: Area::Polygon { corners, holes: Vec::new() },
            style: ScanStyle::Parallel,
            spacing: Spacing::Metres(Value::Constant(SPACING_M)),
            heading_deg: None,
            overshoot_m: Value::Constant(OVERSHOOT_M),
            entry: ScanEntry::Nearest,
        };
        let leg = new_leg::make(&plan, "scan", LegKind::Scan(scan));
        let drawn = Selection::Leg(leg.id.clone());
        queue.edit(Edit::InsertLeg { leg: Box::new(leg), at });
        queue.view(ViewCommand::Select(Some(drawn)));
    }
}

impl Tool for DrawArea {
    fn card(&self) -> &'static Card {
        &Card { id: "area", name: "Draw an area to scan", symbol: "⬟", key: Key::A }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        let at = spot(scene.document.plan(), scene.view.selection.as_ref());
        Some(match (self.corners.len(), at) {
            (_, None) => "Scan: make a new mission first, it has a stage to draw into.".into(),
            (0, Some(at)) => format!("Scan {}: click the corners of the area. Esc ends it.", words(&at)),
            (1 | 2, _) => "Scan: click the next corner. Backspace takes the last back.".into(),
            (_, _) => "Scan: Enter, or a click on the first corner, closes the area.".into(),
        })
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pointer = at.map(|at| canvas.view.geo(at)).filter(|at| at.is_valid());
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        let (plan, at) = (canvas.scene.document.plan(), canvas.view.geo(pointer.at));
        let Some(spot) = spot(plan, canvas.scene.view.selection.as_ref()).filter(|_| at.is_valid()) else {
            return;
        };
        self.into = Some((plan.clone(), spot));
        let first = self.corners.first().map(|first| canvas.view.place(*first));
        if self.corners.len() >= 3 && first.is_some_and(|first| first.distance(pointer.at) < NEAR) {
            return self.close(queue);
        }
        self.corners.push(at);
    }

    fn drag(&mut self, _grip: usize, _to: Pos2, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    fn key(&mut self, key: Key, queue: &mut Queue) -> bool {
        if self.corners.is_empty() {
            return false;
        }
        match key {
            Key::Backspace => drop(self.corners.pop()),
            Key::Enter if self.corners.len() >= 3 => self.close(queue),
            Key::Enter => {}
            _ => self.leave(),
        }
        true
    }

    fn leave(&mut self) {
        self.corners.clear();
        self.into = None;
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        let Some(first) = self.corners.first() else { return };
        let ring = self.corners.iter().chain(&self.pointer).chain([first]);
        let line: Vec<Mercator> = ring.map(|at| Mercator::from(*at)).collect();
        let parts = polyline::visible_parts(&line, canvas.view);
        polyline::draw(painter, &parts, Stroke::new(2.0, p.accent), Style::Dashed, p.halo);
        for corner in &self.corners {
            painter.circle(canvas.view.place(*corner), 4.5, p.halo, Stroke::new(2.0, p.accent));
        }
    }
}
