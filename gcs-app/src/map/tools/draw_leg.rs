//! Areas, lines and circles that become patterns.

use super::bands::{self, Band};
use super::new_leg::{self, Aim, NO_STAGE, Side, choose_kind, choose_side, words};
use super::pen::{Figure, Mark, Pen};
use super::trial::Trials;
use super::{Canvas, Card, Tool, Touch};
use crate::command::Queue;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{CursorIcon, Key, Painter, Pos2, Ui};
use flight_plan::create::{Drawn, LegChoice, Shape};
use geometry::LatLon;

/// What a tool of this sort is.
#[derive(Debug, PartialEq, Eq)]
pub struct Form {
    card: Card,
    shape: Shape,
    first: LegChoice,
    /// How it can be drawn.
    figures: &'static [(Figure, &'static str)],
}

/// Areas that are scanned or flown around.
pub const AREA: Form = Form {
    card: Card { id: "area", name: "Draw an area to scan", symbol: "⬟", key: Key::A },
    shape: Shape::Area,
    first: LegChoice::Scan,
    figures: &[(Figure::Ring, "outline"), (Figure::Circle, "circle")],
};

/// Lines with something along them.
pub const LINE: Form = Form {
    card: Card { id: "line", name: "Draw a line to follow", symbol: "〰", key: Key::L },
    shape: Shape::Line,
    first: LegChoice::Corridor,
    figures: &[(Figure::Line, "line")],
};

/// Circles and searches around a point.
pub const CIRCLE: Form = Form {
    card: Card { id: "circle", name: "Draw a circle or search", symbol: "◎", key: Key::O },
    shape: Shape::Circle,
    first: LegChoice::Orbit,
    figures: &[(Figure::Circle, "circle")],
};

/// The tool: when its figure is whole, it becomes a leg.
#[derive(Debug)]
pub struct DrawLeg {
    form: &'static Form,
    choice: LegChoice,
    side: Side,
    pen: Pen,
    /// What it would become, as it would be flown.
    trials: Trials,
    /// Where the path may go on behind it.
    bands: Vec<Band>,
}

impl DrawLeg {
    /// With nothing drawn yet.
    pub fn new(form: &'static Form) -> Self {
        let figure = form.figures.first().map_or(Figure::Ring, |(figure, _)| *figure);
        Self {
            form,
            choice: form.first,
            side: Side::default(),
            pen: Pen::new(figure),
            trials: Trials::default(),
            bands: Vec::new(),
        }
    }

    /// Where the leg goes.
    fn aim(&self, scene: &Scene<'_>) -> Option<Aim> {
        new_leg::mission_aim_of(scene, &self.side)
    }

    fn complete(&mut self, marks: Vec<Mark>, canvas: &Canvas<'_>, queue: &mut Queue) {
        let Some(aim) = self.aim(canvas.scene) else { return };
        let (plan, approach) = (canvas.scene.document.plan(), new_leg::approach(canvas, &aim));
        new_leg::add(self.choice, &drawn(self.pen.figure(), marks), aim, approach, plan, queue);
        self.side = Side::default();
    }
}

/// What a whole figure is.
fn drawn(figure: Figure, marks: Vec<Mark>) -> Drawn {
    match (figure, marks.as_slice()) {
        (Figure::Circle, [centre, rim, ..]) => {
            Drawn::Circle { centre: centre.place.clone(), radius_m: centre.at.distance_m(rim.at) }
        }
        (Figure::Ring, _) => Drawn::Area(marks.into_iter().map(|mark| mark.at).collect()),
        _ => Drawn::Line(marks.into_iter().map(|mark| mark.place).collect()),
    }
}

impl Tool for DrawLeg {
    fn card(&self) -> &'static Card {
        &self.form.card
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        Some(match (self.pen.len(), self.aim(scene)) {
            (_, None) => format!("{}: {NO_STAGE}", self.choice.name()),
            (0, Some(at)) => {
                format!(
                    "{} {}: {}. Esc ends it.",
                    self.choice.name(),
                    words(&at, scene.document.plan()),
                    self.pen.hint()
                )
            }
            _ => {
                let trial = self.trials.get().map_or(String::new(), |trial| match &trial.fault {
                    Some(fault) => format!(" It can't be flown so: {fault}."),
                    None => trial.cost_words(scene.units()).map_or(String::new(), |cost| format!(" {cost}.")),
                });
                format!("{}: {}.{trial}", self.choice.name(), self.pen.hint())
            }
        })
    }

    fn options(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        if self.pen.len() > 0 {
            return;
        }
        choose_kind(ui, LegChoice::drawn_as(self.form.shape), &mut self.choice);
        if self.form.figures.len() > 1 {
            for (figure, name) in self.form.figures {
                if ui.selectable_label(self.pen.figure() == *figure, *name).clicked() {
                    self.pen.set_figure(*figure);
                }
            }
        }
        choose_side(ui, scene, &mut self.side, new_leg::mission_aim_of);
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pen.hover(at, canvas);
        self.bands = self.aim(canvas.scene).map_or(Vec::new(), |aim| bands::behind(canvas, &aim));
        let Some((marks, aim)) = self.pen.so_far().zip(self.aim(canvas.scene)) else {
            return self.trials.clear();
        };
        let (plan, approach) = (canvas.scene.document.plan(), new_leg::approach(canvas, &aim));
        let leg = new_leg::leg(self.choice, &drawn(self.pen.figure(), marks), &aim, approach, plan);
        self.trials.fly(leg, &aim, approach, canvas);
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        Some(self.pen.last())
    }

    fn put(&mut self, mark: Mark, canvas: &Canvas<'_>, queue: &mut Queue) {
        if self.aim(canvas.scene).is_none() {
            return;
        }
        if let Some(marks) = self.pen.put(mark, canvas) {
            self.complete(marks, canvas, queue);
        }
    }

    fn finish(&mut self, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(marks) = self.pen.finish() {
            self.complete(marks, canvas, queue);
        }
    }

    fn wants(&self, key: Key) -> bool {
        self.pen.wants(key)
    }

    fn key(&mut self, key: Key, canvas: &Canvas<'_>, queue: &mut Queue) {
        if let Some(marks) = self.pen.key(key) {
            self.complete(marks, canvas, queue);
        }
    }

    fn leave(&mut self) {
        self.pen.clear();
    }

    fn is_busy(&self) -> bool {
        self.trials.is_flying()
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        if let Some(trial) = self.trials.get() {
            trial.paint(painter, canvas, p);
        }
        if let Some(from) = self.pen.pointer() {
            bands::paint(painter, canvas, from.at, &self.bands, p);
        }
        let is_bad = self.trials.get().is_some_and(|trial| trial.fault.is_some());
        self.pen.paint(painter, canvas, is_bad, p);
    }
}
