//! Take-off and landing for a file that has none: on a runway of the plan that is open, or on one before its first point.

use crate::airfields::Ground;
use crate::command::{DocumentCommand, Queue};
use crate::files::{Choices, Imported};
use crate::panels::Scene;
use crate::theme;
use egui::{Label, RichText, Ui};
use flight_plan::{FlightPlan, Runway, StageKind, transform};
use geometry::LatLon;

/// A runway that is made ends so far before the first point, metres.
const BEFORE_M: f64 = 1000.0;
/// What it is called.
const MADE: &str = "runway";
/// Its length, metres.
const LENGTH_M: f64 = 600.0;

/// Lets the runway be chosen, where the file leaves that open.
pub fn choose(ui: &mut Ui, imported: &Imported, scene: &Scene<'_>, queue: &mut Queue) {
    let plan = &imported.import.plan;
    let has = |kind| plan.stages.iter().any(|stage| stage.kind == kind);
    let chosen = &imported.choices.runway;
    if plan.all_legs().is_empty() || (chosen.is_none() && has(StageKind::TakeOff) && has(StageKind::Land)) {
        return;
    }
    let made = places(plan).and_then(|(first, second)| made(first, second, scene));
    let mut options = vec![("none".to_owned(), None)];
    let open = scene.document.plan().runways.first();
    options
        .extend(open.map(|runway| (format!("on {}, as in the open plan", runway.id), Some(runway.clone()))));
    options.extend(made.map(|runway| ("on a new runway before its first point".to_owned(), Some(runway))));
    ui.horizontal_wrapped(|ui| {
        ui.label("Take-off and landing:");
        for (label, runway) in options {
            let is_it = chosen.as_ref().map(|r| &r.id) == runway.as_ref().map(|r| &r.id);
            if ui.radio(is_it, label).clicked() && !is_it {
                let choices = Choices { runway, ..imported.choices.clone() };
                queue.document(DocumentCommand::ImportAs(Box::new(choices)));
            }
        }
    });
    if let Some(made) = chosen.as_ref().filter(|runway| runway.id.as_str() == MADE) {
        tell_ground(ui, made.threshold, scene);
    }
}

/// All altitudes over the runway count from its elevation, so who made it up is said.
fn tell_ground(ui: &mut Ui, threshold: LatLon, scene: &Scene<'_>) {
    let ground = Ground::of(scene.layers.ground().as_ref(), threshold);
    let p = theme::of(ui);
    let colour = if ground == Ground::Unknown { p.caution } else { p.text };
    let words = format!("Its ground: {}", ground.words(scene.units()));
    ui.add(Label::new(RichText::new(words).color(colour)).wrap());
}

/// The first two places that are flown to.
fn places(plan: &FlightPlan) -> Option<(LatLon, Option<LatLon>)> {
    let legs = plan.all_legs();
    let mut places = legs.iter().flat_map(|context| transform::places(plan, context.leg));
    let first = places.next()?;
    Some((first, places.find(|at| *at != first)))
}

/// A runway that leads to the first point, in the direction in which the flight goes on.
fn made(first: LatLon, second: Option<LatLon>, scene: &Scene<'_>) -> Option<Runway> {
    let heading_deg = second.map_or(0.0, |second| first.bearing_deg(second)).round().rem_euclid(360.0);
    let threshold = first.destination(heading_deg + 180.0, BEFORE_M + LENGTH_M);
    threshold.is_valid().then(|| Runway {
        id: MADE.into(),
        threshold,
        elevation_amsl_m: Ground::of(scene.layers.ground().as_ref(), threshold).amsl_m().round(),
        heading_deg,
        length_m: LENGTH_M,
        priority: 1,
        approach_entry: None,
    })
}
