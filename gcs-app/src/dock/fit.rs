//! Lengths of tiles. In egui_tiles they are shares; beside the map ours are screen points, so that the
//! map takes what the window gains and what a hidden panel leaves, and its neighbours keep their size.

use super::{GAP, MAP, TAB_BAR};
use crate::panels::PanelId;
use egui::{Vec2, vec2};
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles};
use std::collections::HashMap;

/// The least the map gets before its neighbours shrink, screen points.
pub const LEAST: Vec2 = vec2(240.0, 200.0);
/// The same while something beside it is read with the map.
pub const READ: Vec2 = vec2(400.0, 200.0);
/// A share that is no length: that of a tile that was just dropped here.
const FRESH: f32 = 1.0;

/// The lengths that tiles are to have, and those that they were given instead where there was no room.
#[derive(Debug, Default)]
pub struct Wanted(HashMap<TileId, (f32, f32)>);

impl Wanted {
    /// What a tile with this share is to have; a share that was not given here is what the operator wants.
    pub fn of(&self, tile: TileId, share: f32) -> f32 {
        self.0.get(&tile).filter(|(_, given)| *given == share).map_or(share, |(wanted, _)| *wanted)
    }

    /// It has the share that it was given.
    pub fn is_given(&self, tile: TileId, share: f32) -> bool {
        self.0.get(&tile).is_none_or(|(_, given)| *given == share)
    }
}

/// Makes the lengths of a tile of this size, and of those in it, add up. `least`: the least the map gets, screen points.
pub fn fit(tiles: &mut Tiles<PanelId>, tile: TileId, size: Vec2, least: Vec2, wanted: &mut Wanted) {
    let Some(Tile::Container(container)) = tiles.get(tile) else { return };
    let children: Vec<TileId> = container.children().copied().collect();
    let Container::Linear(linear) = container else {
        let below = vec2(size.x, size.y - TAB_BAR);
        return children.into_iter().for_each(|child| fit(tiles, child, below, least, wanted));
    };
    let along = match linear.dir {
        LinearDir::Horizontal => Vec2::X,
        LinearDir::Vertical => Vec2::Y,
    };
    let wishes = children.iter().map(|child| wanted.of(*child, linear.shares[*child])).collect();
    let (wishes, lengths) = lengths(tiles, linear, wishes, size.dot(along), least.dot(along));
    for ((child, wish), given) in children.iter().zip(wishes).zip(&lengths) {
        wanted.0.insert(*child, (wish, *given));
    }
    if let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(tile) {
        for (child, length) in children.iter().zip(&lengths) {
            linear.shares.set_share(*child, *length);
        }
    }
    let shown = children.into_iter().zip(lengths).filter(|(id, _)| tiles.is_visible_in_layout(*id));
    let shown: Vec<(TileId, f32)> = shown.collect();
    let total: f32 = shown.iter().map(|(_, length)| length).sum();
    let room = room(size.dot(along), shown.len());
    for (child, length) in shown {
        let part = size + along * (length / total.max(FRESH) * room - size.dot(along));
        fit(tiles, child, part, least, wanted);
    }
}

/// What is left of a length for so many tiles.
fn room(length: f32, tiles: usize) -> f32 {
    (length - GAP * tiles.saturating_sub(1) as f32).max(FRESH)
}

/// What each child is to have, and what it gets: that, and what is left for the one with the map.
fn lengths(
    tiles: &Tiles<PanelId>,
    linear: &Linear,
    mut wishes: Vec<f32>,
    length: f32,
    least: f32,
) -> (Vec<f32>, Vec<f32>) {
    let is_shown: Vec<bool> = linear.children.iter().map(|id| tiles.is_visible_in_layout(*id)).collect();
    let room = room(length, is_shown.iter().filter(|shown| **shown).count());
    settle_newcomers(&mut wishes, room);
    let mut lengths = wishes.clone();
    let Some(map) = linear.children.iter().position(|id| has_map(tiles, *id)) else {
        return (wishes, lengths);
    };
    let beside = lengths.iter().zip(&is_shown).enumerate().filter(|(i, (_, shown))| *i != map && **shown);
    let beside: f32 = beside.map(|(_, (length, _))| length).sum();
    let left = (room - beside).max(least.min(room));
    // the neighbours shrink only when the map has become too small
    let shrunk = if beside > room - left { ((room - left) / beside).max(0.0) } else { 1.0 };
    for (i, length) in lengths.iter_mut().enumerate() {
        *length = if i == map { left } else { (*length * shrunk).max(2.0 * FRESH) };
    }
    (wishes, lengths)
}

/// A tile that was just dropped gets as much as the others have on the average.
fn settle_newcomers(lengths: &mut [f32], room: f32) {
    let settled: Vec<f32> = lengths.iter().copied().filter(|length| *length > FRESH).collect();
    let mean = match settled.len() {
        0 => room / lengths.len().max(1) as f32,
        n => settled.iter().sum::<f32>() / n as f32,
    };
    for length in lengths.iter_mut().filter(|length| **length <= FRESH) {
        *length = mean;
    }
}

/// The map is in this tile, or is it.
fn has_map(tiles: &Tiles<PanelId>, tile: TileId) -> bool {
    match tiles.get(tile) {
        Some(Tile::Pane(panel)) => *panel == MAP,
        Some(Tile::Container(container)) => container.children().any(|child| has_map(tiles, *child)),
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dock::PanelTree;
    use crate::dock::layout::{NOMINAL, Stored};
    use crate::panels;

    fn default_tree() -> PanelTree {
        let all = panels::all();
        let known: Vec<PanelId> = std::iter::once(MAP).chain(all.iter().map(|p| p.id())).collect();
        Stored::default_of(&all).tree(&known).expect("sound")
    }

    /// Lengths of what is at the root, in a dock of this width.
    fn columns((tree, wanted): &mut (PanelTree, Wanted), width: f32) -> Vec<f32> {
        let root = tree.root().expect("not empty");
        fit(&mut tree.tiles, root, vec2(width, 900.0), LEAST, wanted);
        let Some(Tile::Container(Container::Linear(linear))) = tree.tiles.get(root) else { panic!("no row") };
        let shown: Vec<TileId> =
            linear.children.iter().copied().filter(|id| tree.tiles.is_visible_in_layout(*id)).collect();
        linear.shares.split(&shown, room(width, shown.len()))
    }

    #[test]
    fn the_map_takes_the_difference_while_there_is_room() {
        let mut tree = (default_tree(), Wanted::default());
        let nominal = columns(&mut tree, NOMINAL.x);
        for width in [960.0, 1100.0, 1920.0, 3840.0] {
            let new = columns(&mut tree, width);
            assert!((new[0] - nominal[0]).abs() < 0.5 && (new[2] - nominal[2]).abs() < 0.5, "{new:?}");
            assert!((new.iter().sum::<f32>() - room(width, 3)).abs() < 0.5);
        }
        let narrow = columns(&mut tree, 600.0);
        assert!((narrow[1] - LEAST.x).abs() < 0.5 && narrow[0] < nominal[0] && narrow[2] < nominal[2]);
        assert_eq!(columns(&mut tree, NOMINAL.x), nominal, "they grow again with the window");
        assert!(columns(&mut tree, 1.0).iter().all(|w| w.is_finite() && *w >= 0.0));
    }

    #[test]
    fn what_a_hidden_panel_leaves_goes_to_the_map_and_comes_back_from_it() {
        let mut tree = (default_tree(), Wanted::default());
        let before = columns(&mut tree, NOMINAL.x);
        let right: Vec<TileId> = tree
            .0
            .tiles
            .iter()
            .filter(
                |(_, tile)| matches!(tile, Tile::Pane(id) if ["inspector", "flight", "what-if"].contains(id)),
            )
            .map(|(id, _)| *id)
            .collect();
        right.iter().for_each(|id| tree.0.set_visible(*id, false));
        let hidden = columns(&mut tree, NOMINAL.x);
        assert_eq!(hidden.len(), 2);
        assert!((hidden[0] - before[0]).abs() < 0.5, "{before:?} {hidden:?}");
        right.iter().for_each(|id| tree.0.set_visible(*id, true));
        assert_eq!(columns(&mut tree, NOMINAL.x), before);
    }

    #[test]
    fn a_tile_that_was_just_dropped_is_no_sliver() {
        let mut lengths = [268.0, FRESH, 344.0];
        settle_newcomers(&mut lengths, 1280.0);
        assert_eq!(lengths, [268.0, 306.0, 344.0]);
        let mut both = [FRESH, FRESH];
        settle_newcomers(&mut both, 500.0);
        assert_eq!(both, [250.0, 250.0]);
    }
}
