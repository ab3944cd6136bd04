//! The places of the plan as actions: go to a leg, a stage, a fix.

use super::{Action, Group, Kind};
use crate::command::{Command, Selection, ViewCommand};
use flight_plan::{FlightPlan, Id};

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
    let unnamed: [(&str, Vec<&Id>, fn(Id) -> Selection); 4] = [
        ("fix", plan.fixes.iter().map(|fix| &fix.id).collect(), Selection::Fix),
        ("runway", plan.runways.iter().map(|runway| &runway.id).collect(), Selection::Runway),
        ("zone", plan.zones.iter().map(|zone| &zone.id).collect(), Selection::Zone),
        ("variable", plan.variables.iter().map(|variable| &variable.name).collect(), Selection::Variable),
    ];
    for (kind, ids, selection) in unnamed {
        for id in ids {
            add(kind, "", selection(id.clone()));
        }
    }
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
