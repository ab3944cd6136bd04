//! An emergency plan, drawn from the runway outwards; it is flown the other way. Where an alarm would be raised is known from the
//! cursor or the selected leg: the way from there into the plan is flown ahead while it is drawn.

use super::bands::{self, Band};
use super::besides::Besides;
use super::new_leg::{self, Aim};
use super::pen::{Figure, Mark, Pen};
use super::pick::{is_nearer_to_end, runway_near};
use super::snap::snap;
use super::trial::Trials;
use super::{Canvas, Card, Pointer, Tool, Touch};
use crate::command::{DocumentCommand, Queue, ViewCommand};
use crate::panels::Scene;
use crate::runways::{self, ADD_OTHER};
use crate::theme::Palette;
use egui::{CursorIcon, Key, Painter, Pos2, Ui};
use flight_plan::create::{Approach, Drawn, LegChoice};
use flight_plan::{Edit, Id, Place, Runway, Spot, Thing};
use geometry::LatLon;

/// The tool.
#[derive(Debug)]
pub struct DrawEmergency {
    pen: Pen,
    runway: Option<Id>,
    /// The runway was clicked where it ends, and begins there in no direction of the plan.
    is_at_end: bool,
    /// The other direction of the runway, as soon as the plan has it.
    other: Option<Id>,
    /// From where it would be flown.
    raised: Option<Raised>,
    /// The way from there to where it begins.
    trials: Trials,
    /// What is made besides the places that were clicked.
    besides: Besides,
}

/// Where an alarm would be raised.
#[derive(Debug, Clone, PartialEq)]
struct Raised {
    /// On which leg.
    leg: Id,
    /// Where the aircraft is then, and which way it flies.
    at: Approach,
    /// And how high, metres AMSL.
    altitude_amsl_m: f64,
}

/// At the cursor, unless something else is selected that is flown: then in the middle of that. `None`: there is neither.
fn raised(scene: &Scene<'_>) -> Option<Raised> {
    let forecast = scene.forecast();
    let passage_at = |time_s: f64| forecast.passages.get(forecast.at(time_s)?.passage);
    let selected = scene.view.selection.as_ref().map(|what| match scene.document.plan().leg(what.id()) {
        Some(context) => &context.leg.first_flown().id,
        None => what.id(),
    });
    let middle = selected.and_then(|what| Some((what, forecast.middle_of_s(what)?)));
    let is_meant = |time_s: &f64| {
        let passage = passage_at(*time_s);
        middle.is_none_or(|(what, _)| passage.is_some_and(|p| p.leg == *what || p.stage == *what))
    };
    let time_s = scene.view.cursor_s.filter(is_meant).or(middle.map(|(_, time_s)| time_s))?;
    let altitude_amsl_m = forecast.at(time_s)?.altitude_amsl_m;
    Some(Raised { leg: passage_at(time_s)?.leg.clone(), at: forecast.approach_at(time_s)?, altitude_amsl_m })
}

impl Default for DrawEmergency {
    fn default() -> Self {
        Self {
            pen: Pen::new(Figure::Line),
            runway: None,
            is_at_end: false,
            other: None,
            raised: None,
            trials: Trials::default(),
            besides: Besides::default(),
        }
    }
}

impl DrawEmergency {
    /// With the runway alone, it is the way home from anywhere.
    fn complete(&mut self, queue: &mut Queue) {
        let marks = self.pen.drawn();
        if let Some(runway) = self.runway.take() {
            let outwards: Vec<Place> = marks.into_iter().skip(1).map(|mark| mark.place).collect();
            let from = self.raised.as_ref().map(|raised| (raised.at.from, raised.altitude_amsl_m));
            queue.document(DocumentCommand::BringHome { runway, outwards, from });
        }
        self.pen.clear();
    }

    fn begin(&mut self, runway: &Runway, canvas: &Canvas<'_>) {
        self.pen.clear();
        self.runway = Some(runway.id.clone());
        let _ = self.pen.put(Mark::at(runway.threshold), canvas);
    }

    /// Goes over to the other direction once the plan has it.
    fn turn(&mut self, canvas: &Canvas<'_>) {
        let plan = canvas.scene.document.plan();
        if let Some(other) = self.other.as_ref().and_then(|id| plan.runway(id)) {
            self.begin(other, canvas);
            (self.other, self.is_at_end) = (None, false);
        }
    }

    /// The other direction of its runway, where that was meant and is lacking.
    fn lacking(&self, scene: &Scene<'_>) -> Option<Runway> {
        let runway = self.runway.as_ref().filter(|_| self.is_at_end)?;
        runways::other_direction(scene.document.plan(), runway, scene.ground.0).ok()
    }

    /// Where it begins, as it is drawn so far.
    fn begins(&self) -> Option<LatLon> {
        self.runway.as_ref()?;
        self.pen.pointer().map(|mark| mark.at).or(self.pen.last())
    }

    /// Shows what Enter would make of the places that were clicked.
    fn complement(&mut self, canvas: &Canvas<'_>) {
        let outwards = self.pen.clicked().skip(1).map(|mark| mark.place.clone()).collect();
        self.besides.follow(self.runway.as_ref().map(|runway| (runway, outwards)), canvas);
    }

    /// Flies from where the alarm would be raised to where it begins, as the aircraft would: directly, from its course.
    fn fly(&mut self, canvas: &Canvas<'_>) {
        self.raised = raised(canvas.scene);
        let Some((raised, to)) = self.raised.clone().zip(self.begins()) else { return self.trials.clear() };
        let aim = Aim::Spot(Spot::After(raised.leg));
        let drawn = Drawn::Place(Mark::at(to).place);
        let direct = new_leg::leg(LegChoice::Df, &drawn, &aim, Some(raised.at), canvas.scene.document.plan());
        self.trials.divert(direct, &aim, raised.at, canvas);
    }

    /// What to do, and from where it would be flown, how far and how long it is from there. A fault stands alone: there is room for
    /// two lines.
    fn drawing(&self, runway: &Id, scene: &Scene<'_>) -> String {
        let hint = format!("To {runway}: click its places outwards; Enter ends, Esc gives up.");
        let Some(raised) = &self.raised else { return format!("{hint} Select a leg to see the way in.") };
        let Some((trial, to)) = self.trials.get().zip(self.begins()) else { return hint };
        let leg = scene.document.label(&raised.leg);
        match &trial.fault {
            Some(fault) => format!("To {runway}: from {leg} it can't be flown so: {fault}."),
            None => format!("{hint} From {leg}: {}.", trial.words(raised.at.from, to, scene.units())),
        }
    }
}

impl Tool for DrawEmergency {
    fn card(&self) -> &'static Card {
        &Card { id: "emergency", name: "Draw an emergency plan", symbol: "⚑", key: Key::E }
    }

    fn status(&self, scene: &Scene<'_>) -> Option<String> {
        // on a small map there is room for two lines
        Some(match &self.runway {
            _ if scene.document.plan().runways.is_empty() => {
                "Emergency plan: draw a runway first, it lands on one.".into()
            }
            None => "Emergency plan: click the runway it leads to. Esc ends it.".into(),
            Some(runway) if self.lacking(scene).is_some() => {
                format!(
                    "You clicked the end of {runway}: “{ADD_OTHER}” lets it land from there. Or click its places outwards."
                )
            }
            Some(runway) => self.drawing(runway, scene),
        })
    }

    fn options(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let Some(other) = self.lacking(scene) else { return };
        let lands = format!("The emergency plan leads to {} then", other.id);
        if ui.button(ADD_OTHER).on_hover_text(lands).clicked() {
            self.other = Some(other.id.clone());
            queue.edit(Edit::Add(Box::new(Thing::Runway(other))));
        }
    }

    fn hover(&mut self, at: Option<Pos2>, canvas: &Canvas<'_>) {
        self.turn(canvas);
        self.pen.hover(at, canvas);
        let gone = |id: &Id| canvas.scene.document.plan().runway(id).is_none();
        if self.pen.len() == 0 || self.runway.as_ref().is_some_and(gone) {
            self.leave();
        }
        self.fly(canvas);
        self.complement(canvas);
    }

    fn press(&mut self, pointer: Pointer, canvas: &Canvas<'_>, queue: &mut Queue) {
        if self.runway.is_some() {
            return self.put(snap(pointer.at, canvas), canvas, queue);
        }
        match runway_near(pointer.at, canvas) {
            Some(runway) => {
                self.is_at_end = is_nearer_to_end(pointer.at, runway, canvas);
                self.begin(runway, canvas);
                // what was asked for is done
                queue.view(ViewCommand::DismissNotice);
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
        self.trials.clear();
        (self.runway, self.raised, self.other, self.is_at_end) = (None, None, None, false);
        self.besides = Besides::default();
    }

    fn is_busy(&self) -> bool {
        self.trials.is_flying()
    }

    fn cursor(&self) -> CursorIcon {
        CursorIcon::Crosshair
    }

    fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, _touch: Touch, p: &Palette) {
        if let (Some(raised), Some(to)) = (&self.raised, self.begins()) {
            match self.trials.get().filter(|trial| trial.cost.is_some()) {
                Some(trial) => trial.paint_in(p.contingency, painter, canvas, p),
                None => bands::paint(painter, canvas, raised.at.from, &[Band { to, is_alternate: true }], p),
            }
        }
        self.besides.paint(painter, canvas, p);
        self.pen.paint(painter, canvas, false, p);
    }
}
