//! A procedure, put where it is wanted: a click is its anchor, a second one says its bearing.

use super::bands::{self, Band};
use super::new_leg::{self, Aim, Side, choose_side, whose, words};
use super::pen::{Figure, Mark, Pen};
use super::trial::{Trial, Trials};
use super::{Canvas, Card, Tool, Touch};
use crate::command::{Queue, Selection};
use crate::panels::{Scene, field};
use crate::theme::Palette;
use crate::units;
use egui::{CursorIcon, Key, Painter, Pos2, Ui};
use flight_plan::create::{self, Approach};
use flight_plan::{Id, Leg, LegKind, Procedure};
use geometry::LatLon;
use geometry::geodesy::normalise_360;

/// Without a leg before it, the path comes from so far, metres.
const FROM_M: f64 = 1000.0;

/// It needs no bearing.
const AS_WRITTEN: &str = "Enter leaves it as it was written";

/// The tool.
#[derive(Debug)]
pub struct PlaceProcedure {
    pen: Pen,
    /// The procedure that was chosen; else the selected or called or the first one.
    chosen: Option<Id>,
    side: Side,
    trials: Trials,
    /// Where the path may go on behind it.
    bands: Vec<Band>,
}

impl Default for PlaceProcedure {
    fn default() -> Self {
        Self {
            pen: Pen::new(Figure::Segment),
            chosen: None,
            side: Side::default(),
            trials: Trials::default(),
            bands: Vec::new(),
        }
    }
}

impl PlaceProcedure {
    fn procedure<'a>(&self, scene: &Scene<'a>) -> Option<&'a Procedure> {
        let plan = scene.document.plan();
        let selected = match &scene.view.selection {
            Some(Selection::Procedure(id)) => plan.procedure(id),
            Some(Selection::Leg(id)) => match plan.leg(id).map(|context| &context.leg.kind) {
                Some(LegKind::Call(call)) => plan.procedure(&call.procedure),
                _ => None,
            },
            _ => None,
        };
        let chosen = || self.chosen.as_ref().and_then(|id| plan.procedure(id));
        selected.or_else(chosen).or(plan.procedures.first())
    }

    /// Beside the selected leg; a procedure that is selected is meant to be placed, not to be drawn into.
    fn aim(&self, scene: &Scene<'_>) -> Option<Aim> {
        let selected = scene.view.selection.as_ref().filter(|s| !matches!(s, Selection::Procedure(_)));
        new_leg::aim(scene.document.plan(), selected, &new_leg::meant(scene, &self.side))
    }

    /// The call with its anchor and, if there are two places, its bearing.
    fn call(&self, marks: &[Mark], scene: &Scene<'_>) -> Option<Leg> {
        let (procedure, anchor) = (self.procedure(scene)?, marks.first()?);
        let towards = marks.get(1).filter(|to| to.at.distance_m(anchor.at) > 1.0);
        let bearing_deg = towards.map(|to| normalise_360(anchor.at.bearing_deg(to.at).round()));
        create::call(scene.document.plan(), &procedure.id, anchor.place.clone(), bearing_deg)
    }

    fn complete(&mut self, marks: &[Mark], canvas: &Canvas<'_>, queue: &mut Queue) {
        let Some((leg, aim)) = self.call(marks, canvas.scene).zip(self.aim(canvas.scene)) else { return };
        new_leg::put(leg, aim, canvas.scene.document.plan(), queue);
        self.pen.clear();
        self.side = Side::default();
    }
}

fn name(procedure: &Procedure) -> &str {
    if procedure.name.is_empty() { procedure.id.as_str() } else { &procedure.name }
}

impl Tool for PlaceProcedure {
    fn card(&self) -> &'static Card {
        &Card { id: "procedure", name: "Place a procedure", symbol: "§", key: Key::P }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        let (Some(procedure), Some(aim)) = (self.procedure(scene), self.aim(scene)) else {
            return Some(
                "Procedure: there is none. Right-click legs and make a procedure of them first.".into(),
            );
        };
        let name = name(procedure);
        // on a small map there is room for two lines
        let trial = match self.trials.get() {
            Some(Trial { fault: Some(fault), .. }) => {
                return Some(format!("Procedure {name} can't be flown there: {fault}."));
            }
            trial => trial.and_then(|trial| trial.cost_words(scene.units())),
        };
        let cost = trial.map_or(String::new(), |cost| format!(" {cost}."));
        Some(match (self.pen.last(), self.pen.pointer()) {
            (None, _) => {
                let plan = scene.document.plan();
                let whose = whose(&aim, plan).map_or(String::new(), |whose| format!(", in {whose}"));
                format!("Procedure {name} {}{whose}: click its anchor.{cost}", words(&aim, plan))
            }
            (Some(_), None) => format!("Procedure {name}: click where it points; {AS_WRITTEN}.{cost}"),
            (Some(anchor), Some(to)) => {
                let bearing = units::bearing(anchor.bearing_deg(to.at));
                format!("Procedure {name}: bearing {bearing}; {AS_WRITTEN}.{cost}")
            }
        })
    }

    fn options(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        if self.pen.len() > 0 {
            return;
        }
        let procedures = &scene.document.plan().procedures;
        let now = self.procedure(scene).and_then(|now| procedures.iter().position(|p| p.id == now.id));
        let names: Vec<&str> = procedures.iter().map(name).collect();
        if names.len() > 1
            && let Some(chosen) = field::choice(ui, "Procedure", &names, now)
        {
            self.chosen = procedures.get(chosen).map(|procedure| procedure.id.clone());
        }
        choose_side(ui, scene, &mut self.side, new_leg::aim_of);
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pen.hover(at, canvas);
        self.bands = self.aim(canvas.scene).map_or(Vec::new(), |aim| bands::behind(canvas, &aim));
        let marks = self.pen.begun();
        let Some((leg, aim)) = self.call(&marks, canvas.scene).zip(self.aim(canvas.scene)) else {
            return self.trials.clear();
        };
        let from = marks
            .first()
            .map(|anchor| Approach { from: anchor.at.destination(180.0, FROM_M), course_deg: None });
        let approach = new_leg::approach(canvas, &aim).or(from);
        self.trials.fly(Some(leg), &aim, approach, canvas);
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        Some(self.pen.last())
    }

    fn put(&mut self, mark: Mark, canvas: &Canvas<'_>, queue: &mut Queue) {
        let can = self.procedure(canvas.scene).is_some() && self.aim(canvas.scene).is_some();
        if let Some(marks) = self.pen.put(mark, canvas).filter(|_| can) {
            self.complete(&marks, canvas, queue);
        }
    }

    fn wants(&self, key: Key) -> bool {
        self.pen.wants(key)
    }

    fn key(&mut self, key: Key, canvas: &Canvas<'_>, queue: &mut Queue) {
        match key {
            Key::Enter => {
                let anchor: Vec<Mark> = self.pen.begun().into_iter().take(1).collect();
                self.complete(&anchor, canvas, queue);
            }
            _ => drop(self.pen.key(key)),
        }
    }

    fn leave(&mut self) {
        self.pen.clear();
        self.trials.clear();
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
        // it begins and ends about its anchor
        let anchor = self.pen.last().or(self.pen.pointer().map(|mark| mark.at));
        anchor.into_iter().for_each(|from| bands::paint(painter, canvas, from, &self.bands, p));
        self.pen.paint(painter, canvas, false, p);
    }
}
