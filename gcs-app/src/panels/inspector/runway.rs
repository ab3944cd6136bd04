//! The other direction of a runway: its threshold has an elevation of its own, for runways slope.

use crate::command::Queue;
use crate::panels::Scene;
use crate::theme;
use egui::{RichText, Ui};
use flight_plan::describe::{Change, Draft, Property, Row, Subject};
use flight_plan::{FlightPlan, Id, Runway};

/// So near to the end of one the other one's threshold lies, metres.
const NEAR_M: f64 = 100.0;

/// Says that the other direction begins at another elevation, and offers this one for it.
pub fn other_direction(ui: &mut Ui, scene: &Scene<'_>, id: &Id, queue: &mut Queue) {
    let plan = scene.document.plan();
    let Some(runway) = plan.runway(id) else { return };
    let Some(other) = opposite(plan, runway).filter(|o| o.elevation_amsl_m != runway.elevation_amsl_m) else {
        return;
    };
    let unit = scene.units().altitude();
    let text = format!(
        "{}, the other direction, begins at {}: its threshold is at this one's far end.",
        other.id,
        unit.show(other.elevation_amsl_m)
    );
    ui.add(egui::Label::new(RichText::new(text).size(12.0).color(theme::of(ui).weak)).wrap());
    let edit = level(plan, &other.id, runway.elevation_amsl_m);
    if ui.button(format!("{} there too", unit.show(runway.elevation_amsl_m))).clicked()
        && let Some(edit) = edit
    {
        queue.edit(edit);
    }
}

fn opposite<'a>(plan: &'a FlightPlan, runway: &Runway) -> Option<&'a Runway> {
    let end = runway.threshold.destination(runway.heading_deg, runway.length_m.clamp(1.0, 10_000.0));
    let turned = |other: &Runway| (other.heading_deg - runway.heading_deg).to_radians().cos() < -0.9;
    plan.runways
        .iter()
        .find(|other| other.id != runway.id && turned(other) && other.threshold.distance_m(end) < NEAR_M)
}

fn level(plan: &FlightPlan, id: &Id, elevation_m: f64) -> Option<flight_plan::Edit> {
    let draft = Draft::of(plan, &Subject::Runway(id.clone()))?;
    let is_it = |row: &Row| match row {
        Row::Property(property) if property.attribute == "elevation" => Some(*property),
        _ => None,
    };
    let elevation: Property = draft.description().rows().find_map(is_it)?;
    draft.edit(plan, &[], &Change::Set(elevation, Some(elevation_m.to_string()))).ok()
}
