//! Track: legs from place to place, one for each click.

use super::new_leg::{self, Side, choose_kind, choose_side, spot, words};
use super::pen::{Mark, way};
use super::{Canvas, Card, Pointer, Tool, Touch, snap};
use crate::command::{Queue, Selection, ViewCommand};
use crate::map::polyline::{self, Style};
use crate::map::text;
use crate::map::view::Mercator;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Align2, CursorIcon, Key, Painter, Pos2, Stroke, Ui, vec2};
use flight_plan::create::{Approach, Drawn, LegChoice, Shape, arc_centre};
use flight_plan::{Edit, Id, Place, Spot, TurnDirection};
use geometry::LatLon;

/// Pieces of an arc on the screen.
const PIECES: u32 = 24;

/// The tool: each click adds a leg behind the one before, the first beside what is selected.
#[derive(Debug)]
pub struct Track {
    choice: LegChoice,
    side: Side,
    /// The legs that were drawn.
    drawn: Vec<Id>,
    pointer: Option<Mark>,
    /// How the path arrives where the next leg begins.
    approach: Option<Approach>,
    /// Where the path goes on behind it.
    onward: Option<LatLon>,
}

impl Default for Track {
    fn default() -> Self {
        Self {
            choice: LegChoice::Tf,
            side: Side::default(),
            drawn: Vec::new(),
            pointer: None,
            approach: None,
            onward: None,
        }
    }
}

impl Track {
    /// Where the next leg goes.
    fn next_spot(&self, scene: &Scene<'_>) -> Option<Spot> {
        let behind = self.drawn.last().map(|id| Spot::After(id.clone()));
        behind.or_else(|| spot(scene.document.plan(), scene.view.selection.as_ref(), self.side))
    }
}

impl Tool for Track {
    fn card(&self) -> &'static Card {
        &Card { id: "track", name: "Draw legs", symbol: "✏", key: Key::T }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        Some(match (self.drawn.is_empty(), self.next_spot(scene)) {
            (_, None) => "Draw legs: make a new mission first, it has a stage to draw into.".into(),
            (true, Some(spot)) => format!("Draw legs {}: click where to fly. Esc ends it.", words(&spot)),
            (false, _) => match (&self.pointer, self.approach) {
                (Some(to), Some(at)) => {
                    let result = way(at.from, to.at, scene.units());
                    format!("Next leg: {result}. Backspace takes the last back.")
                }
                _ => "Draw legs: Backspace takes the last back, Enter ends it.".into(),
            },
        })
    }

    fn options(&mut self, ui: &mut Ui, scene: &Scene<'_>) {
        choose_kind(ui, LegChoice::drawn_as(Shape::Place), &mut self.choice);
        if self.drawn.is_empty() {
            choose_side(ui, scene, &mut self.side);
        }
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pointer = at.map(|at| snap(at, canvas)).filter(|mark| mark.at.is_valid());
        // what was undone or removed meanwhile is not gone on from
        let plan = canvas.scene.document.plan();
        while self.drawn.last().is_some_and(|id| plan.leg(id).is_none()) {
            self.drawn.pop();
        }
        let spot = self.next_spot(canvas.scene);
        self.approach = spot.as_ref().and_then(|spot| new_leg::approach(canvas, spot));
        self.onward = spot.and_then(|spot| onward(canvas, &spot));
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        let mark = snap(pointer.at, canvas);
        let Some(at) = self.next_spot(canvas.scene).filter(|_| mark.at.is_valid()) else { return };
        let (approach, plan) = (new_leg::approach(canvas, &at), canvas.scene.document.plan());
        let drawn = Drawn::Place(mark.place);
        if let Some(id) = new_leg::add(self.choice, &drawn, at, approach, plan, queue) {
            self.drawn.push(id);
        }
    }

    fn finish(&mut self, _canvas: &Canvas<'_>, _queue: &mut Queue) {
        self.drawn.clear();
    }

    fn drag(&mut self, _grip: usize, _to: Pos2, _canvas: &Canvas<'_>, _queue: &mut Queue) {}

    fn wants(&self, key: Key) -> bool {
        !self.drawn.is_empty() && matches!(key, Key::Escape | Key::Enter | Key::Backspace)
    }

    fn key(&mut self, key: Key, _canvas: &Canvas<'_>, queue: &mut Queue) {
        if key != Key::Backspace {
            return self.drawn.clear();
        }
        let Some(id) = self.drawn.pop() else { return };
        queue.edit(Edit::DeleteLeg { leg: id });
        let before = self.drawn.last().map(|id| Selection::Leg(id.clone()));
        queue.view(ViewCommand::Select(before));
    }

    fn leave(&mut self) {
        *self = Self { choice: self.choice, ..Self::default() };
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        let Some(to) = &self.pointer else { return };
        if matches!(to.place, Place::Fix(_)) {
            painter.circle_stroke(canvas.view.place(to.at), 10.0, Stroke::new(2.0, p.accent));
        }
        if let Some(onward) = self.onward {
            let line = [to.at.into(), onward.into()];
            let parts = polyline::visible_parts(&line, canvas.view);
            polyline::draw(painter, &parts, Stroke::new(1.2, p.weak), Style::Dotted, p.halo);
        }
        let Some(at) = self.approach else { return };
        let ghost = ghost(self.choice, &at, to.at);
        let colour = if ghost.is_some() { p.accent } else { p.warning };
        let line = ghost.unwrap_or_else(|| vec![at.from, to.at]);
        let line: Vec<Mercator> = line.into_iter().map(Mercator::from).collect();
        let parts = polyline::visible_parts(&line, canvas.view);
        polyline::draw(painter, &parts, Stroke::new(2.0, colour), Style::Dashed, p.halo);
        let beside = canvas.view.place(to.at) + vec2(10.0, -10.0);
        let result = way(at.from, to.at, canvas.scene.units());
        text::haloed(painter, beside, Align2::LEFT_BOTTOM, &result, 13.0, p.text, p);
    }
}

/// The line of a leg of a kind to a place; `None`: it can't lead there.
fn ghost(choice: LegChoice, at: &Approach, to: LatLon) -> Option<Vec<LatLon>> {
    if choice != LegChoice::Rf {
        return Some(vec![at.from, to]);
    }
    let (centre, turn) = arc_centre(at, to)?;
    let (start, end) = (centre.inverse(at.from), centre.bearing_deg(to));
    let swept = match turn {
        TurnDirection::Right => (end - start.bearing_start_deg).rem_euclid(360.0),
        TurnDirection::Left => -(start.bearing_start_deg - end).rem_euclid(360.0),
    };
    let on = |i: u32| {
        let share = f64::from(i) / f64::from(PIECES);
        centre.destination(start.bearing_start_deg + swept * share, start.distance_m)
    };
    Some((0..=PIECES).map(on).collect())
}

/// The place that the leg behind a new one leads to.
fn onward(canvas: &Canvas<'_>, spot: &Spot) -> Option<LatLon> {
    let plan = canvas.scene.document.plan();
    let next = match spot {
        Spot::Before(id) => plan.leg(id)?.leg,
        Spot::After(id) => plan.leg(id)?.successor()?,
        Spot::EndOf(_) => return None,
    };
    new_leg::place_of(canvas, next)
}
