//! The default layout in a wide window: what is beside the map gets some of the room, until the operator has a layout of his own.

use super::PanelTree;
use super::fit::Wanted;
use super::layout::NOMINAL;
use egui_tiles::{Container, Tile, TileId};

/// Of what a window is wider than the nominal one the sides get so much.
const GROWS_BY: f32 = 0.5;
/// They become so many times as wide at most.
pub const MOST: f32 = 1.6;

/// Widens what is beside the map with the window, so long as the operator has changed nothing. `before`: how many times as wide
/// it was made before; gives how many times as wide it is now, and `None` once the layout is the operator's own.
pub fn grown(tree: &mut PanelTree, width: f32, before: Option<f32>, wanted: &Wanted) -> Option<f32> {
    let before = before?;
    let root = tree.root()?;
    let Some(Tile::Container(Container::Linear(linear))) = tree.tiles.get_mut(root) else { return None };
    let shares: Vec<(TileId, f32)> =
        linear.children.iter().map(|child| (*child, linear.shares[*child])).collect();
    if !shares.iter().all(|(child, share)| wanted.is_given(*child, *share)) {
        return None;
    }
    let now = (1.0 + GROWS_BY * (width / NOMINAL.x - 1.0)).clamp(1.0, MOST);
    if now != before {
        for (child, share) in shares {
            linear.shares.set_share(child, wanted.of(child, share) * now / before);
        }
    }
    Some(now)
}
