//! The maps and elevations that were brought, as actions: each is shown or hidden.

use super::{Action, Group};
use crate::command::Command;
use crate::layers::LayerCommand;
use crate::panels::Scene;

/// All of them, the uppermost first.
pub fn of(scene: &Scene<'_>) -> Vec<Action> {
    let layers = scene.layers.iter().map(|layer| {
        let verb = if layer.kept.shown { "Hide" } else { "Show" };
        let command = Command::Layer(LayerCommand::Show(layer.id, !layer.kept.shown));
        Action::now(Group::Maps, format!("{verb} the layer {}", layer.name()), Ok(command))
    });
    layers.collect()
}
