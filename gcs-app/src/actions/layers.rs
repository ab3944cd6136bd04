//! The maps and elevations that were brought, as actions: all that the dialog of the maps does with each, and how others come.

use super::{Action, Group, Kind};
use crate::command::Command;
use crate::layers::{Layer, LayerCommand, Server, Source, State};
use crate::panels::Scene;
use std::path::PathBuf;

/// The action that opens the palette for the path of a map.
pub const ADD: &str = "add-map";
/// What is typed there then, before the path.
pub const QUERY: &str = "add the map ";

/// How opaque a map can be made, per cent.
const OPACITIES: [u8; 5] = [0, 25, 50, 75, 100];

/// All of them, the uppermost first.
pub fn of(scene: &Scene<'_>) -> Vec<Action> {
    let layers = scene.layers.iter().enumerate();
    layers.flat_map(|(place, layer)| of_layer(layer, place == 0)).chain([of_openstreetmap()]).collect()
}

/// What is typed is where a map is.
pub fn add(query: &str) -> Option<Action> {
    let (begin, typed) = query.split_at_checked(QUERY.len())?;
    let typed = begin.eq_ignore_ascii_case(QUERY).then(|| typed.trim())?;
    let source = Source::File(PathBuf::from(typed));
    let add = match typed {
        "" => Err("Type the path of a file, or of a folder of elevation tiles"),
        _ => Ok(Command::Layer(LayerCommand::Add(source))),
    };
    Some(Action::now(Group::Maps, format!("Add the map {typed}"), add))
}

fn of_layer(layer: &Layer, is_first: bool) -> Vec<Action> {
    let (id, name) = (layer.id, layer.name());
    let action = |verb: &str, command: Result<LayerCommand, &'static str>| {
        Action::now(Group::Maps, format!("{verb} the layer {name}"), command.map(Command::Layer))
    };
    let shown = layer.kept.shown;
    let raise = if is_first { Err("It is above all others already") } else { Ok(LayerCommand::Raise(id)) };
    let go_to = layer.bounds().map(|_| LayerCommand::GoTo(id)).ok_or("Nobody knows where it is");
    let mut actions = vec![
        action(if shown { "Hide" } else { "Show" }, Ok(LayerCommand::Show(id, !shown))),
        action("Raise", raise),
        action("Go to", go_to),
        action("Remove", Ok(LayerCommand::Remove(id))),
    ];
    if matches!(layer.state, State::Map(..)) {
        actions.extend(OPACITIES.map(|percent| {
            let opacity = f32::from(percent) / 100.0;
            let command = Command::Layer(LayerCommand::Opacity(id, opacity));
            let name = format!("Opacity {percent} % of the layer {name}");
            let is_so = (layer.kept.opacity - opacity).abs() < 0.005;
            Action { kind: Kind::Choice(is_so), ..Action::now(Group::Maps, name, Ok(command)) }
        }));
    }
    actions
}

/// The server that anybody may use; others need an address and whom to name, which the dialog asks for.
fn of_openstreetmap() -> Action {
    let add = LayerCommand::Add(Source::Online(Server::openstreetmap()));
    Action::now(Group::Maps, "Add the online map OpenStreetMap".into(), Ok(Command::Layer(add)))
}
