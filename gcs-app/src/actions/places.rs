//! The parts of the plan as actions: a leg, a stage, a fix is selected and shown. Flying there is another thing: see `flight`.

use super::{Action, Group, Kind};
use crate::command::{Command, Selection, ViewCommand};
use crate::document::Document;
use flight_plan::Leg;
use std::sync::Arc;

/// Everything of a plan that can be selected, each by its name, and its identifier where that is another.
pub fn of(document: &Document) -> Vec<Action> {
    let plan = document.plan();
    let mut actions = Vec::new();
    let mut add = |kind: &str, selection: Selection| actions.push(show(kind, document, selection));
    for stage in plan.stages.iter().chain(plan.emergency_plans.iter().flat_map(|e| &e.stages)) {
        add("stage", Selection::Stage(stage.id.clone()));
    }
    plan.all_legs().iter().for_each(|context| add("leg", Selection::Leg(context.leg.id.clone())));
    for procedure in &plan.procedures {
        add("procedure", Selection::Procedure(procedure.id.clone()));
        add_legs(&procedure.legs, &mut add);
    }
    plan.emergency_plans.iter().for_each(|e| add("emergency plan", Selection::Emergency(e.id.clone())));
    plan.fixes.iter().for_each(|fix| add("fix", Selection::Fix(fix.id.clone())));
    plan.runways.iter().for_each(|runway| add("runway", Selection::Runway(runway.id.clone())));
    plan.zones.iter().for_each(|zone| add("zone", Selection::Zone(zone.id.clone())));
    plan.variables.iter().for_each(|v| add("variable", Selection::Variable(v.name.clone())));
    actions
}

/// Legs of a procedure, and those inside of them.
fn add_legs(legs: &[Arc<Leg>], add: &mut impl FnMut(&str, Selection)) {
    for leg in legs {
        add("leg", Selection::Leg(leg.id.clone()));
        add_legs(leg.body(), add);
    }
}

fn show(kind: &str, document: &Document, selection: Selection) -> Action {
    let id = selection.id();
    let name = document.label(id);
    let aside = if name == id.as_str() { String::new() } else { format!(" ({id})") };
    Action {
        id: format!("go-to-{kind}-{id}").into(),
        name: format!("{kind} {name}{aside}").into(),
        group: Group::Show,
        kind: Kind::Do,
        keys: Vec::new(),
        while_typing: false,
        caution: None,
        command: Ok(Command::View(ViewCommand::JumpTo(selection))),
    }
}
