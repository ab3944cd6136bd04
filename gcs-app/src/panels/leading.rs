//! The command that leads the aircraft to a leg, wherever that is offered: in the inspector, in the menu of the leg, in the palette.

use super::{Scene, emergency};
use crate::command::Queue;
use egui::Ui;
use flight_exec::{Command, Phase};
use flight_plan::{Id, LegContext, Section};

/// To a leg of the plan that is flown a go-to, to one of the main plan from an emergency the return; `None`: the aircraft does not
/// fly, or this leg is in an emergency plan that is not flown.
pub fn to(scene: &Scene<'_>, leg: &Id) -> Option<Command> {
    let aboard = scene.vehicle.aboard.as_ref().filter(|_| is_flying(scene))?;
    to_one_of(scene, &aboard.plan.leg(leg)?)
}

fn is_flying(scene: &Scene<'_>) -> bool {
    let flies = matches!(scene.vehicle.phase(), Phase::Flying | Phase::Holding | Phase::AwaitingDecision);
    flies && !emergency::has_come_down(scene)
}

fn to_one_of(scene: &Scene<'_>, context: &LegContext<'_>) -> Option<Command> {
    let leg = context.leg.id.clone();
    match (context.section, scene.vehicle.emergency()) {
        (Section::Main, None) => Some(Command::GoTo { leg }),
        (Section::Main, Some(_)) => Some(Command::ReturnToMain { leg }),
        (Section::Emergency(plan), flown) => (flown == Some(&plan.id)).then_some(Command::GoTo { leg }),
    }
}

/// All of them, each with what people call it.
pub fn all(scene: &Scene<'_>) -> Vec<(String, Command)> {
    let Some(aboard) = scene.vehicle.aboard.as_ref().filter(|_| is_flying(scene)) else { return Vec::new() };
    let legs = aboard.plan.all_legs().into_iter();
    legs.filter_map(|context| {
        let command = to_one_of(scene, &context)?;
        let name = scene.vehicle.name_of(&context.leg.id);
        let text = match command {
            Command::ReturnToMain { .. } => format!("Return to the main plan at {name}…"),
            _ => format!("Go to leg {name}…"),
        };
        Some((text, command))
    })
    .collect()
}

/// The button for it, which asks what would follow; true if it was clicked.
pub fn button(ui: &mut Ui, scene: &Scene<'_>, leg: &Id, queue: &mut Queue) -> bool {
    let Some(command) = to(scene, leg) else { return false };
    let text = match command {
        Command::ReturnToMain { .. } => "Return to the main plan here…",
        _ => "Go to this leg…",
    };
    let clicked = ui.button(text).on_hover_text("Shows what would follow, then asks").clicked();
    if clicked {
        queue.consider(command);
    }
    clicked
}
