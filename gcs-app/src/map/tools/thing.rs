//! Fixes, runways and zones.

use super::pen::{Figure, Mark, Pen};
use super::snap::{self, snap};
use super::{Canvas, Card, Pointer, Tool, Touch};
use crate::command::{DocumentCommand, Queue, Selection, ViewCommand};
use crate::panels::Scene;
use crate::panels::field::{self, Change};
use crate::theme::Palette;
use egui::{Button, CursorIcon, Key, Painter, Pos2, Ui};
use flight_plan::{Altitude, AltitudeReference, Edit, Thing, Value, Zone, ZoneKind, ZoneShape, create};
use geometry::LatLon;

/// Each click makes a fix.
#[derive(Debug, Default)]
pub struct PlaceFix {
    /// Where a click would make one.
    pointer: Option<Mark>,
}

impl Tool for PlaceFix {
    fn card(&self) -> &'static Card {
        &Card { id: "fix", name: "Place a fix", symbol: "△", key: Key::X }
    }

    fn status(&self, _scene: &Scene<'_>) -> Option<String> {
        Some("Fix: click where it is; legs that are drawn near it go there. Esc ends it.".into())
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pointer = at.map(|at| snap(at, canvas));
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        Some(None)
    }

    fn put(&mut self, mark: Mark, canvas: &Canvas<'_>, queue: &mut Queue) {
        let at = mark.at;
        if !at.is_valid() {
            return;
        }
        let fix = create::fix(canvas.scene.document.plan(), at);
        let id = fix.id.clone();
        queue.edit(Edit::Add(Box::new(Thing::Fix(fix))));
        queue.view(ViewCommand::Select(Some(Selection::Fix(id))));
    }

    fn leave(&mut self) {
        self.pointer = None;
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        if let Some(mark) = &self.pointer {
            snap::paint(painter, mark, canvas, p);
        }
    }
}

/// Two clicks along a runway.
#[derive(Debug)]
pub struct DrawRunway {
    pen: Pen,
    /// It is used in both directions.
    both: bool,
}

impl Default for DrawRunway {
    fn default() -> Self {
        Self { pen: Pen::new(Figure::Segment), both: true }
    }
}

impl DrawRunway {
    fn complete(&self, marks: &[Mark], queue: &mut Queue) {
        if let [threshold, end, ..] = marks {
            let (threshold, end, both) = (threshold.at, end.at, self.both);
            queue.document(DocumentCommand::AddRunway { threshold, end, both });
        }
    }
}

impl Tool for DrawRunway {
    fn card(&self) -> &'static Card {
        &Card { id: "runway", name: "Draw a runway", symbol: "═", key: Key::R }
    }

    fn status(&self, _scene: &Scene<'_>) -> Option<String> {
        let next = if self.pen.len() == 0 { "click the landing threshold" } else { "click its other end" };
        Some(format!("Runway: {next}. Esc ends it."))
    }

    fn options(&mut self, ui: &mut Ui, _scene: &Scene<'_>, _queue: &mut Queue) {
        ui.checkbox(&mut self.both, "Both directions")
            .on_hover_text("Make two runways of it, one for each landing direction");
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pen.hover(at, canvas);
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        Some(self.pen.last())
    }

    fn put(&mut self, mark: Mark, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(marks) = self.pen.put(mark, canvas) {
            self.complete(&marks, queue);
        }
    }

    fn wants(&self, key: Key) -> bool {
        self.pen.wants(key)
    }

    fn key(&mut self, key: Key, _canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(marks) = self.pen.key(key) {
            self.complete(&marks, queue);
        }
    }

    fn leave(&mut self) {
        self.pen.clear();
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        self.pen.paint(painter, canvas, false, p);
    }
}

/// Where the flight must not be, or must stay.
#[derive(Debug)]
pub struct DrawZone {
    pen: Pen,
    kind: ZoneKind,
    /// Its lower limit; `None`: the ground.
    floor: Option<Altitude>,
    /// Its upper limit; `None`: none.
    ceiling: Option<Altitude>,
}

impl Default for DrawZone {
    fn default() -> Self {
        Self { pen: outline(), kind: ZoneKind::KeepOut, floor: None, ceiling: None }
    }
}

fn outline() -> Pen {
    Pen::new(Figure::Ring).off_lines()
}

impl DrawZone {
    fn complete(&self, marks: &[Mark], canvas: &Canvas<'_>, queue: &mut Queue) {
        let shape = match (self.pen.figure(), marks) {
            (Figure::Circle, [centre, rim, ..]) => {
                ZoneShape::Circle { centre: centre.at, radius_m: centre.at.distance_m(rim.at).round() }
            }
            _ => ZoneShape::Polygon(marks.iter().map(|mark| mark.at).collect()),
        };
        let (floor, ceiling) = (self.floor.clone(), self.ceiling.clone());
        let zone = create::zone(canvas.scene.document.plan(), self.kind, shape);
        let zone = Zone { floor, ceiling, ..zone };
        let id = zone.id.clone();
        queue.edit(Edit::Add(Box::new(Thing::Zone(zone))));
        queue.view(ViewCommand::Select(Some(Selection::Zone(id))));
    }
}

/// A limit of a zone: none, or an altitude; a floor without one is the ground.
fn limit(ui: &mut Ui, name: &str, limit: &mut Option<Altitude>, first: Altitude, scene: &Scene<'_>) {
    let mut given = limit.is_some();
    if ui.checkbox(&mut given, name).changed() {
        *limit = given.then_some(first);
    }
    let Some(Altitude { metres: Value::Constant(metres), reference }) = limit else { return };
    let unit = scene.units().altitude();
    let change = field::number_between(ui, &format!("{name} of the zone"), *metres, unit, -1000.0..=20_000.0);
    if let Change::Moving(new) | Change::Set(new) = change {
        *metres = new;
    }
    let names = AltitudeReference::NAMES;
    let now = names.iter().position(|(_, other)| other == reference);
    let labels = ["AMSL", "AGL", "above home"];
    ui.scope(|ui| {
        ui.set_max_width(110.0);
        let chosen = field::choice(ui, &format!("{name}: above what"), &labels, now);
        if let Some((_, chosen)) = chosen.and_then(|chosen| names.get(chosen)) {
            *reference = *chosen;
        }
    });
}

/// What a kind of zone is called.
fn zone_name(kind: ZoneKind) -> &'static str {
    match kind {
        ZoneKind::KeepOut => "Keep-out zone",
        ZoneKind::KeepIn => "Keep-in zone",
    }
}

impl Tool for DrawZone {
    fn card(&self) -> &'static Card {
        &Card { id: "zone", name: "Draw a zone", symbol: "⛔", key: Key::Z }
    }

    fn status(&self, _scene: &Scene<'_>) -> Option<String> {
        let other = if self.pen.figure() == Figure::Circle { "outline" } else { "circle" };
        let (zone, hint) = (zone_name(self.kind), self.pen.hint());
        let other = if self.pen.may_change() { format!(" (Z: {other})") } else { String::new() };
        Some(format!("{zone}{other}: {hint}. Esc ends it."))
    }

    fn again(&mut self) {
        self.pen.set_figure(match self.pen.figure() {
            Figure::Circle => Figure::Ring,
            _ => Figure::Circle,
        });
    }

    fn options(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        let above_ground =
            |metres| Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Agl };
        for (figure, name) in [(Figure::Ring, "outline"), (Figure::Circle, "circle")] {
            let choice = Button::selectable(self.pen.figure() == figure, name);
            if ui.add_enabled(self.pen.may_change(), choice).clicked() {
                self.pen.set_figure(figure);
            }
        }
        ui.separator();
        ui.selectable_value(&mut self.kind, ZoneKind::KeepOut, "keep out");
        ui.selectable_value(&mut self.kind, ZoneKind::KeepIn, "keep in");
        ui.separator();
        limit(ui, "Floor", &mut self.floor, above_ground(0.0), scene);
        limit(ui, "Ceiling", &mut self.ceiling, above_ground(120.0), scene);
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pen.hover(at, canvas);
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        Some(self.pen.last())
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        self.put(self.pen.snap(pointer.at, canvas), canvas, queue);
    }

    fn put(&mut self, mark: Mark, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(marks) = self.pen.put(mark, canvas) {
            self.complete(&marks, canvas, queue);
        }
    }

    fn finish(&mut self, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(marks) = self.pen.finish() {
            self.complete(&marks, canvas, queue);
        }
    }

    fn wants(&self, key: Key) -> bool {
        self.pen.wants(key)
    }

    fn key(&mut self, key: Key, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(marks) = self.pen.key(key) {
            self.complete(&marks, canvas, queue);
        }
    }

    /// The next one begins as an outline, as areas do.
    fn leave(&mut self) {
        self.pen = outline();
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        self.pen.paint(painter, canvas, false, p);
    }
}
