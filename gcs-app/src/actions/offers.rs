//! What menus offer for what is selected and what is there now, as actions.

use super::{Action, Group, Kind};
use crate::command::{Command, DocumentCommand, PreviewCommand, Replacement, Selection, ViewCommand};
use crate::panels::Scene;
use crate::panels::timeline::SPEEDS;
use crate::panels::tree::{make, menu, title};

/// So many runways and procedures are offered.
const MOST: usize = 20;

/// All of them.
pub fn of(scene: &Scene<'_>) -> Vec<Action> {
    let mut actions = of_selection(scene);
    actions.extend(new_parts(scene));
    actions.extend(speeds(scene));
    actions.extend(recent(scene));
    actions
}

/// The menu of what is selected, without what has a key: that is an action of its own.
fn of_selection(scene: &Scene<'_>) -> Vec<Action> {
    let Some(selection) = &scene.view.selection else { return Vec::new() };
    let plan = scene.document.plan();
    let of = match scene.selected_legs() {
        legs if legs.len() > 1 => format!("{} legs", legs.len()),
        _ => scene.document.label(selection.id()).to_owned(),
    };
    let entries = menu::entries(scene, selection).into_iter().filter(|entry| entry.keys.is_empty());
    let mut actions: Vec<Action> = entries
        .map(|entry| Action::now(Group::Edit, format!("{}: {of}", entry.name), entry.command()))
        .collect();
    if let Selection::Leg(leg) = selection
        && let Some(context) = plan.leg(leg)
    {
        let kinds = menu::other_kinds(scene, context.leg).into_iter();
        actions.extend(kinds.map(|(choice, edit)| {
            let edit = edit.map(|edit| Command::Document(DocumentCommand::Edit(edit))).ok_or(menu::NOT_THAT);
            Action::now(Group::Edit, format!("Change the kind of {of} to {}", choice.name()), edit)
        }));
    }
    actions
}

/// What the headings of the plan's tree offer, besides the map's tools.
fn new_parts(scene: &Scene<'_>) -> Vec<Action> {
    let plan = scene.document.plan();
    let mut actions = Vec::new();
    let mut add = |name: String, command: Command| {
        actions.push(Action::now(Group::Edit, name, Ok(command)));
    };
    for (kind, name) in make::STAGES {
        add(format!("Add a stage: {name}"), make::stage(plan, kind));
    }
    for initial in make::kinds_of_variables(scene) {
        add(format!("Add a variable: {}", initial.kind()), make::variable(plan, initial));
    }
    for runway in plan.runways.iter().take(MOST) {
        let home = DocumentCommand::BringHome { runway: runway.id.clone(), outwards: Vec::new(), from: None };
        let name = format!("Emergency plan that lands on {}", runway.id);
        add(name, Command::Document(home));
    }
    for procedure in plan.procedures.iter().take(MOST) {
        let name = title(&procedure.name, procedure.id.as_str());
        let select = ViewCommand::Select(Some(Selection::Procedure(procedure.id.clone())));
        let place = [select, ViewCommand::Tool("procedure")].map(Command::View).into();
        add(format!("Place procedure {name} on the map"), Command::Each(place));
    }
    actions
}

fn speeds(scene: &Scene<'_>) -> impl Iterator<Item = Action> {
    let now = scene.view.speed.0;
    SPEEDS.into_iter().map(move |speed| {
        let command = Command::Preview(PreviewCommand::Speed(speed));
        let name = format!("Play the preview {speed:.0}× as fast");
        Action { kind: Kind::Choice(now == speed), ..Action::now(Group::View, name, Ok(command)) }
    })
}

fn recent(scene: &Scene<'_>) -> impl Iterator<Item = Action> {
    scene.recent.paths().iter().map(|path| {
        let open = DocumentCommand::Replace(Replacement::Open(path.clone()));
        let name = format!("Open recent: {}", path.display());
        Action::now(Group::File, name, Ok(Command::Document(open)))
    })
}
