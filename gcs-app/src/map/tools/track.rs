//! Track: legs from place to place, one for each click.

use super::bands::{self, Band};
use super::new_leg::{self, Aim, NO_STAGE, Side, choose_kind, choose_side, words};
use super::pen::{Mark, way};
use super::snap::{self, snap};
use super::trial::{self, Trial, Trials};
use super::{Canvas, Card, Tool, Touch};
use crate::command::{Queue, Selection, ViewCommand};
use crate::map::polyline::{self, Style};
use crate::map::text;
use crate::map::view::Mercator;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Align2, CursorIcon, Key, Painter, Pos2, Stroke, Ui, vec2};
use flight_plan::create::{self, Approach, Drawn, LegChoice, Shape, arc_centre};
use flight_plan::{Id, Spot, TurnDirection};
use geometry::LatLon;

/// The tool's identifier.
pub const ID: &str = "track";
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
    /// Where the path may go on behind it.
    bands: Vec<Band>,
    /// The next leg as it would be flown.
    trials: Trials,
}

impl Default for Track {
    fn default() -> Self {
        Self {
            choice: LegChoice::Tf,
            side: Side::default(),
            drawn: Vec::new(),
            pointer: None,
            approach: None,
            bands: Vec::new(),
            trials: Trials::default(),
        }
    }
}

impl Track {
    /// Where the next leg goes.
    fn aim(&self, scene: &Scene<'_>) -> Option<Aim> {
        let behind = self.drawn.last().map(|id| Aim::Spot(Spot::After(id.clone())));
        behind.or_else(|| new_leg::aim_of(scene, &self.side))
    }

    /// What a click would add, or why it could not be flown.
    fn next_in_words(&self, from: LatLon, to: LatLon, scene: &Scene<'_>) -> String {
        match self.trials.get() {
            Some(Trial { fault: Some(fault), .. }) => format!("The next leg can't be flown: {fault}."),
            trial => {
                let words = trial.map_or_else(
                    || way(from, to, scene.units()),
                    |trial| trial.words(from, to, scene.units()),
                );
                format!("Next leg: {words}. Enter or a double click ends, Backspace takes one back.")
            }
        }
    }
}

impl Tool for Track {
    fn card(&self) -> &'static Card {
        &Card { id: ID, name: "Draw legs", symbol: "✏", key: Key::T }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        Some(match (self.drawn.is_empty(), self.aim(scene)) {
            (_, None) => format!("Draw legs: {NO_STAGE}"),
            (true, Some(aim)) => {
                let place = words(&aim, scene.document.plan());
                format!("Draw legs {place}: click where to fly. Esc ends it.")
            }
            (false, _) => match (&self.pointer, self.approach) {
                (Some(to), Some(at)) => self.next_in_words(at.from, to.at, scene),
                _ => "Draw legs: click where to fly next; Enter or a double click ends.".into(),
            },
        })
    }

    fn options(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        choose_kind(ui, LegChoice::drawn_as(Shape::Place), &mut self.choice);
        if self.drawn.is_empty() {
            choose_side(ui, scene, &mut self.side, new_leg::aim_of);
        }
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.pointer = at.map(|at| snap(at, canvas)).filter(|mark| mark.at.is_valid());
        // what was undone or removed meanwhile is not gone on from
        let plan = canvas.scene.document.plan();
        while self.drawn.last().is_some_and(|id| plan.leg(id).is_none()) {
            self.drawn.pop();
        }
        let aim = self.aim(canvas.scene);
        self.approach = aim.as_ref().and_then(|aim| new_leg::approach(canvas, aim));
        if let Some((to, at)) = self.pointer.as_ref().zip(self.approach)
            && leads_there(self.choice)
            && trial::is_at_rest(at.from, to.at, canvas)
        {
            self.pointer = None;
        }
        self.bands = aim.as_ref().map_or(Vec::new(), |aim| bands::behind(canvas, aim));
        let Some((aim, to)) = aim.zip(self.pointer.as_ref()) else { return self.trials.clear() };
        let drawn = Drawn::Place(to.place.clone());
        let leg = new_leg::leg(self.choice, &drawn, &aim, self.approach, plan);
        self.trials.fly(leg, &aim, self.approach, canvas);
    }

    fn typed_from(&self) -> Option<Option<LatLon>> {
        Some(self.approach.map(|approach| approach.from))
    }

    fn put(&mut self, mark: Mark, canvas: &Canvas<'_>, queue: &mut Queue) {
        let Some(at) = self.aim(canvas.scene).filter(|_| mark.at.is_valid()) else { return };
        let (approach, plan) = (new_leg::approach(canvas, &at), canvas.scene.document.plan());
        let drawn = Drawn::Place(mark.place);
        if let Some(id) = new_leg::add(self.choice, &drawn, at, approach, plan, queue) {
            self.drawn.push(id);
            self.side = Side::default();
        }
    }

    fn finish(&mut self, _canvas: &Canvas<'_>, _queue: &mut Queue) {
        self.drawn.clear();
    }

    fn wants(&self, key: Key) -> bool {
        !self.drawn.is_empty() && matches!(key, Key::Escape | Key::Enter | Key::Backspace)
    }

    fn key(&mut self, key: Key, canvas: &Canvas<'_>, queue: &mut Queue) {
        if key != Key::Backspace {
            return self.drawn.clear();
        }
        let Some(id) = self.drawn.pop() else { return };
        queue.edit(create::delete_leg(canvas.scene.document.plan(), &id));
        let before = self.drawn.last().map(|id| Selection::Leg(id.clone()));
        queue.view(ViewCommand::Select(before));
    }

    fn aim_at(&mut self, side: Side) {
        self.drawn.clear();
        self.side = side;
    }

    fn leave(&mut self) {
        *self = Self { choice: self.choice, ..Self::default() };
    }

    fn is_busy(&self) -> bool {
        self.trials.is_flying()
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        let Some(to) = &self.pointer else { return };
        snap::paint(painter, to, canvas, p);
        bands::paint(painter, canvas, to.at, &self.bands, p);
        let Some(at) = self.approach else { return };
        let ghost = ghost(self.choice, &at, to.at);
        let trial = self.trials.get();
        let is_bad = ghost.is_none() || trial.is_some_and(|trial| trial.fault.is_some());
        let colour = if is_bad { p.warning } else { p.accent };
        let line = ghost.unwrap_or_else(|| vec![at.from, to.at]);
        let line: Vec<Mercator> = line.into_iter().map(Mercator::from).collect();
        let parts = polyline::visible_parts(&line, canvas.view);
        polyline::draw(painter, &parts, Stroke::new(2.0, colour), Style::Dashed, p.halo);
        trial.into_iter().for_each(|trial| trial.paint(painter, canvas, p));
        let beside = canvas.view.place(to.at) + vec2(10.0, -10.0);
        let units = canvas.scene.units();
        let words =
            trial.map_or_else(|| way(at.from, to.at, units), |trial| trial.words(at.from, to.at, units));
        text::haloed(
            painter,
            beside,
            Align2::LEFT_BOTTOM,
            &words,
            13.0,
            if is_bad { p.warning } else { p.text },
            p,
        );
    }
}

/// A leg of this kind leads from place to place; others stay at one.
fn leads_there(choice: LegChoice) -> bool {
    matches!(choice, LegChoice::If | LegChoice::Tf | LegChoice::Df | LegChoice::Rf | LegChoice::Cf)
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
