//! The command that leads the aircraft to a leg or to a landing, wherever that is offered: in the inspector, in the menu of its row, in
//! the palette.

use super::{Scene, emergency};
use crate::command::Queue;
use egui::Ui;
use flight_exec::{Command, Phase};
use flight_plan::{FlightPlan, Id, Section, Stage, StageKind};

/// To a part of the plan that is flown a go-to, to one of the main plan from an emergency the return; `None`: the aircraft does not
/// fly, or this part is in an emergency plan that is not flown.
pub fn to(scene: &Scene<'_>, id: &Id) -> Option<Command> {
    let plan = &scene.vehicle.aboard.as_ref().filter(|_| is_flying(scene))?.plan;
    let leg = plan.leg(id).map(|context| context.section);
    let section = leg.or_else(|| Some(landings(plan).find(|(_, landing)| landing.id == *id)?.0))?;
    to_one_of(scene, section, id)
}

fn is_flying(scene: &Scene<'_>) -> bool {
    let flies = matches!(scene.vehicle.phase(), Phase::Flying | Phase::Holding | Phase::AwaitingDecision);
    flies && !emergency::has_come_down(scene)
}

/// They are flown without legs, from wherever the aircraft is.
fn landings(plan: &FlightPlan) -> impl Iterator<Item = (Section<'_>, &Stage)> {
    plan.all_stages().filter(|(_, stage)| stage.kind == StageKind::Land)
}

/// Nothing follows what is being flown: it lands, and its plan has no other flight.
pub fn is_last_landing(scene: &Scene<'_>) -> bool {
    let Some(plan) = scene.vehicle.aboard.as_ref().map(|aboard| &aboard.plan) else { return false };
    let last = match scene.vehicle.emergency() {
        Some(flown) => plan.emergency_plan(flown).and_then(|plan| plan.stages.last()),
        None => plan.stages.last(),
    };
    let last = last.filter(|stage| stage.kind == StageKind::Land);
    last.is_some_and(|stage| scene.vehicle.current_leg() == Some(&stage.id))
}

fn to_one_of(scene: &Scene<'_>, section: Section<'_>, id: &Id) -> Option<Command> {
    let leg = id.clone();
    match (section, scene.vehicle.emergency()) {
        (Section::Main, None) => Some(Command::GoTo { leg }),
        (Section::Main, Some(_)) => Some(Command::ReturnToMain { leg }),
        (Section::Emergency(plan), flown) => (flown == Some(&plan.id)).then_some(Command::GoTo { leg }),
    }
}

/// All of them, each with what people call it.
pub fn all(scene: &Scene<'_>) -> Vec<(String, Command)> {
    let Some(aboard) = scene.vehicle.aboard.as_ref().filter(|_| is_flying(scene)) else { return Vec::new() };
    let plan = &aboard.plan;
    let legs = plan.all_legs().into_iter().filter_map(|context| {
        let command = to_one_of(scene, context.section, &context.leg.id)?;
        let name = scene.vehicle.name_of(&context.leg.id);
        let text = match command {
            Command::ReturnToMain { .. } => format!("Return to the main plan at {name}…"),
            _ => format!("Go to leg {name}…"),
        };
        Some((text, command))
    });
    let landings = landings(plan).filter_map(|(section, stage)| {
        let command = to_one_of(scene, section, &stage.id)?;
        let runway = stage.runway.as_ref().map(|runway| format!(" on {runway}")).unwrap_or_default();
        let text = match command {
            Command::ReturnToMain { .. } => format!("Return to the main plan at its landing{runway}…"),
            _ => format!("Land now{runway}: go to the landing…"),
        };
        Some((text, command))
    });
    legs.chain(landings).collect()
}

/// Where a place was pointed at: by the leg's name.
pub fn direct(ui: &mut Ui, scene: &Scene<'_>, leg: &Id, queue: &mut Queue) {
    let Some(command) = to(scene, leg) else { return };
    let name = scene.vehicle.name_of(leg);
    let text = match command {
        Command::ReturnToMain { .. } => format!("Return to the main plan at {name}…"),
        _ => format!("Direct to {name}…"),
    };
    if ui.button(text).on_hover_text(ASKS).clicked() {
        queue.consider(command);
    }
}

const ASKS: &str = "Shows what would follow, then asks";

/// The button for it, which asks what would follow; true if it was clicked.
pub fn button(ui: &mut Ui, scene: &Scene<'_>, id: &Id, queue: &mut Queue) -> bool {
    let Some(command) = to(scene, id) else { return false };
    let is_leg = scene.vehicle.aboard.as_ref().is_some_and(|aboard| aboard.plan.leg(id).is_some());
    let text = match command {
        Command::ReturnToMain { .. } => "Return to the main plan here…",
        _ if is_leg => "Go to this leg…",
        _ => "Land now: go to this landing…",
    };
    let clicked = ui.button(text).on_hover_text(ASKS).clicked();
    if clicked {
        queue.consider(command);
    }
    clicked
}
