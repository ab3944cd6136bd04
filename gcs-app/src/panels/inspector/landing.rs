//! What is said of a landing that no approach leads to, and what goes with it to another runway.

use super::page::Page;
use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::Scene;
use crate::theme;
use egui::{Label, RichText, Ui};
use flight_plan::describe::Subject;
use flight_plan::{Edit, FlightPlan, Id, Stage, StageKind, create};

const ADD: &str = "Add an approach stage";

/// That it finds its way to the final alone; in the main plan with what puts an approach before it.
pub fn without_approach(ui: &mut Ui, scene: &Scene<'_>, stage: &Id, queue: &mut Queue) {
    let plan = scene.document.plan();
    let Some(stages) = around(plan, stage).filter(|stages| is_without(stages, stage)) else { return };
    let text = "No approach leads to it: from the last leg it flies straight to the runway's line, and begins its final 700 m before the threshold.";
    ui.add(Label::new(RichText::new(text).size(12.0).color(theme::of(ui).weak)).wrap());
    // a new stage is put before the last landing of the main plan
    let is_last = stages.last().is_some_and(|last| last.id == *stage)
        && plan.stages.iter().any(|other| other.id == *stage);
    if is_last && ui.button(ADD).clicked() {
        let (made, edit) = create::add_stage(plan, StageKind::Approach);
        queue.edit(edit);
        queue.view(ViewCommand::Select(Some(Selection::Stage(made))));
    }
}

/// What lets a landing or an emergency plan end on this runway, with the approach that leads there. `None`: it is neither.
pub fn on(page: &Page<'_, '_>, runway: &str) -> Option<Edit> {
    match page.subject() {
        Subject::Stage(of) | Subject::EmergencyPlan(of) => create::land_on(page.plan(), of, &runway.into()),
        _ => None,
    }
}

/// The stages of the plan that a stage is in.
fn around<'a>(plan: &'a FlightPlan, stage: &Id) -> Option<&'a [Stage]> {
    let emergencies = plan.emergency_plans.iter().map(|emergency| emergency.stages.as_slice());
    let mut lists = std::iter::once(plan.stages.as_slice()).chain(emergencies);
    lists.find(|stages| stages.iter().any(|other| other.id == *stage))
}

/// It is a landing, and the stage before it is no approach.
fn is_without(stages: &[Stage], landing: &Id) -> bool {
    let is_it = |stage: &Stage| stage.id == *landing && stage.kind == StageKind::Land;
    let before = stages.iter().position(is_it).map(|index| stages.get(index.wrapping_sub(1)));
    before.is_some_and(|before| before.is_none_or(|stage| stage.kind != StageKind::Approach))
}
