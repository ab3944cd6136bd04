//! What a variable can give of the selected leg, as actions.

use super::{Action, Group, Kind};
use crate::command::{Command, DocumentCommand, Selection};
use crate::panels::Scene;
use flight_plan::Edit;
use flight_plan::create::bindings;

/// The action that opens the palette with these.
pub const ID: &str = "bind";
/// What is typed there then.
pub const QUERY: &str = "bind the ";

/// `Bind the radius of orbit1 to reach`.
pub fn of(scene: &Scene<'_>) -> Vec<Action> {
    let Some(Selection::Leg(leg)) = &scene.view.selection else { return Vec::new() };
    let mut actions = Vec::new();
    for binding in bindings(scene.document.plan(), leg) {
        let what = format!("the {} of {}", binding.name.to_lowercase(), scene.document.label(leg));
        let mut add = |to: &str, name: String, edit: Edit, is_it: bool| {
            let id = format!("bind-{}-{to}", binding.name);
            actions.push(action(id, name, edit, is_it));
        };
        for (variable, edit) in binding.choices {
            let is_it = binding.bound.as_ref() == Some(&variable);
            add(variable.as_str(), format!("Bind {what} to {variable}"), edit, is_it);
        }
        if let Some((_, edit)) = binding.new {
            add("new variable", format!("Bind {what} to a new variable"), edit, false);
        }
        if let Some(edit) = binding.free {
            add("nothing", format!("Bind {what} to nothing: a value of its own"), edit, false);
        }
    }
    actions
}

fn action(id: String, name: String, edit: Edit, is_it: bool) -> Action {
    Action {
        id: id.into(),
        name: name.into(),
        group: Group::Edit,
        kind: Kind::Switch(is_it),
        keys: Vec::new(),
        while_typing: false,
        caution: None,
        command: Ok(Command::Document(DocumentCommand::Edit(edit))),
    }
}
