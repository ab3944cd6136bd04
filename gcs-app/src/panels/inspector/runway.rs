//! The other direction of a runway: its threshold has an elevation of its own, for runways slope.

use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::Scene;
use crate::runways::{self, ADD_OTHER};
use crate::theme;
use egui::{RichText, Ui};
use flight_plan::describe::{Change, Draft, Property, Row, Subject};
use flight_plan::{Edit, FlightPlan, Id, Thing};

/// Offers the other direction where there is none; else says that it begins at another elevation, and offers this one for it.
pub fn other_direction(ui: &mut Ui, scene: &Scene<'_>, id: &Id, queue: &mut Queue) {
    let plan = scene.document.plan();
    let Some(runway) = plan.runway(id) else { return };
    let Some(other) = plan.opposite(runway) else { return add(ui, scene, id, queue) };
    if other.elevation_amsl_m == runway.elevation_amsl_m {
        return;
    }
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

fn add(ui: &mut Ui, scene: &Scene<'_>, id: &Id, queue: &mut Queue) {
    let Ok(other) = runways::other_direction(scene.document.plan(), id, scene.ground.0) else { return };
    let begins = format!("{}, from {} AMSL", other.id, scene.units().altitude().show(other.elevation_amsl_m));
    if ui.button(ADD_OTHER).on_hover_text(begins).clicked() {
        let made = Selection::Runway(other.id.clone());
        queue.edit(Edit::Add(Box::new(Thing::Runway(other))));
        queue.view(ViewCommand::Select(Some(made)));
    }
}

fn level(plan: &FlightPlan, id: &Id, elevation_m: f64) -> Option<Edit> {
    let draft = Draft::of(plan, &Subject::Runway(id.clone()))?;
    let is_it = |row: &Row| match row {
        Row::Property(property) if property.attribute == "elevation" => Some(*property),
        _ => None,
    };
    let elevation: Property = draft.description().rows().find_map(is_it)?;
    draft.edit(plan, &[], &Change::Set(elevation, Some(elevation_m.to_string()))).ok()
}
