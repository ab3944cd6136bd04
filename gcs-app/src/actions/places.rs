//! The places of the plan as actions: go to a leg, a stage, a fix.

use super::{Action, Group, Kind};
use crate::command::{Command, Selection, ViewCommand};
use flight_plan::FlightPlan;

/// Everything of a plan that can be selected, each by its name and its identifier.
pub fn of(plan: &FlightPlan) -> Vec<Action> {
    let mut actions = Vec::new();
    let mut add = |kind: &str, name: &str, selection: Selection| actions.push(go_to(kind, name, selection));
    for stage in plan.stages.iter().chain(plan.emergency_plans.iter().flat_map(|e| &e.stages)) {
        add("stage", &stage.name, Selection::Stage(stage.id.clone()));
    }
    for context in plan.all_legs() {
        add("leg", &context.leg.name, Selection::Leg(context.leg.id.clone()));
    }
    for emergency in &plan.emergency_plans {
        add("emergency plan", &emergency.name, Selection::Emergency(emergency.id.clone()));
    }
    plan.fixes.iter().for_each(|fix| add("fix", "", Selection::Fix(fix.id.clone())));
    plan.runways.iter().for_each(|runway| add("runway", "", Selection::Runway(runway.id.clone())));
    plan.zones.iter().for_each(|zone| add("zone", "", Selection::Zone(zone.id.clone())));
    plan.variables.iter().for_each(|v| add("variable", "", Selection::Variable(v.name.clone())));
    actions
}

fn go_to(kind: &str, name: &str, selection: Selection) -> Action {
    let id = selection.id();
    let name = if name.is_empty() || name == id.as_str() { String::new() } else { format!(", {name}") };
    Action {
        id: format!("go-to-{kind}-{id}").into(),
        name: format!("{kind} {id}{name}").into(),
        group: Group::GoTo,
        kind: Kind::Do,
        keys: Vec::new(),
        while_typing: false,
        command: Ok(Command::View(ViewCommand::JumpTo(selection))),
    }
}
