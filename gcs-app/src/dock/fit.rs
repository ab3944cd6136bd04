//! Lengths of tiles. In egui_tiles they are shares; beside the map ours are screen points, so that the
//! map takes what the window gains and what a hidden panel leaves, and its neighbours keep their size.

use super::content::HEADER;
use super::{GAP, MAP, TAB_BAR};
use crate::panels::PanelId;
use egui::{Vec2, vec2};
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles};
use std::collections::HashMap;

/// The least the map gets before its neighbours shrink, screen points.
pub const LEAST: Vec2 = vec2(240.0, 200.0);
/// In flight the map of a low dock gets so much of that before its neighbours shrink: one looks there first.
const IN_FLIGHT: Vec2 = vec2(0.45, 0.6);
/// The neighbours are at least so wide then, both together: the values of the flight are not cut. Screen points.
const BESIDE: f32 = 530.0;

/// The least that the map gets in flight in a low dock of this size.
pub fn least_in_flight(dock: Vec2) -> Vec2 {
    let most = vec2((dock.x - BESIDE).max(0.0), dock.y);
    LEAST.max((dock * IN_FLIGHT).min(most))
}

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

/// The least that the map and the panels get where there is room for all of that, screen points.
#[derive(Debug)]
pub struct Least {
    /// Of the map.
    pub map: Vec2,
    /// Heights of panels, with what is around them.
    pub panels: HashMap<PanelId, f32>,
}

impl Least {
    /// The least height of a tile of this width.
    fn height(&self, tiles: &Tiles<PanelId>, tile: TileId, width: f32) -> f32 {
        match tiles.get(tile).filter(|_| tiles.is_visible_in_layout(tile)) {
            Some(Tile::Pane(MAP)) => self.map.y,
            Some(Tile::Pane(panel)) => self.panels.get(panel).copied().unwrap_or(0.0),
            Some(Tile::Container(container)) => {
                let heights = container.children().map(|child| self.height(tiles, *child, width));
                match container {
                    Container::Linear(linear) if linear.dir == LinearDir::Vertical => heights.sum(),
                    // a panel that is alone has a title that is as high
                    Container::Tabs(_) => heights.fold(0.0, f32::max) + header(width),
                    _ => heights.fold(0.0, f32::max),
                }
            }
            None => 0.0,
        }
    }
}

/// What a header takes that has no room beside tabs, screen points.
fn header(width: f32) -> f32 {
    // the tabs take about as much as it does
    if width < 2.0 * HEADER { TAB_BAR + 4.0 } else { 0.0 }
}

/// Makes the lengths of a tile of this size, and of those in it, add up.
pub fn fit(tiles: &mut Tiles<PanelId>, tile: TileId, size: Vec2, least: &Least, wanted: &mut Wanted) {
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
    let is_moved = children.iter().any(|child| !wanted.is_given(*child, linear.shares[*child]));
    let is_map_in = children.iter().any(|child| has_map(tiles, *child));
    let wish = |child: &TileId| match linear.shares[*child] {
        // without the map shares are no lengths until some are raised: what the operator moves is a share of what is seen
        share if is_moved && !is_map_in => share,
        share => wanted.of(*child, share),
    };
    let wishes = children.iter().map(wish).collect();
    let (wishes, mut lengths) = lengths(tiles, linear, wishes, size.dot(along), least.map.dot(along));
    if linear.dir == LinearDir::Vertical {
        let leasts: Vec<f32> = children.iter().map(|child| least.height(tiles, *child, size.x)).collect();
        raise(&mut lengths, &leasts, &is_shown(tiles, linear), size.y);
    }
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
    let is_shown = is_shown(tiles, linear);
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

fn is_shown(tiles: &Tiles<PanelId>, linear: &Linear) -> Vec<bool> {
    linear.children.iter().map(|id| tiles.is_visible_in_layout(*id)).collect()
}

/// Gives those of a column that are too low what others have to spare. Where everyone has enough, nothing changes.
fn raise(lengths: &mut [f32], leasts: &[f32], is_shown: &[bool], height: f32) {
    let all = lengths.iter_mut().zip(leasts).zip(is_shown);
    let shown: Vec<_> = all.filter(|(_, shown)| **shown).map(|(tile, _)| tile).collect();
    let sum: f32 = shown.iter().map(|(length, _)| **length).sum();
    let scale = room(height, shown.len()) / sum.max(FRESH);
    let spare = |(length, least): &(&mut f32, &f32)| **length * scale - **least;
    let needed: f32 = shown.iter().map(|tile| (-spare(tile)).max(0.0)).sum();
    let left: f32 = shown.iter().map(|tile| spare(tile).max(0.0)).sum();
    let given = needed.min(left);
    if given <= 0.0 {
        return;
    }
    for tile in shown {
        let spare = spare(&tile);
        let share = spare / if spare < 0.0 { needed } else { left };
        *tile.0 = *tile.0 * scale - share * given;
    }
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

    fn least() -> Least {
        let panels = HashMap::from([("problems", 188.0), ("table", 200.0)]);
        Least { map: LEAST, panels }
    }

    /// Height of a tile with this panel, alone or in tabs, in a dock of this size.
    fn height(tree: &mut (PanelTree, Wanted), size: Vec2, panel: &str) -> f32 {
        let root = tree.0.root().expect("not empty");
        fit(&mut tree.0.tiles, root, size, &least(), &mut tree.1);
        let tiles = &tree.0.tiles;
        let is_it = |id: &TileId| matches!(tiles.get(*id), Some(Tile::Pane(pane)) if *pane == panel);
        let is_column = |linear: &Linear| linear.dir == LinearDir::Vertical;
        let columns = tiles.tiles().filter_map(|tile| match tile {
            Tile::Container(Container::Linear(linear)) if is_column(linear) => Some(linear),
            _ => None,
        });
        let holds = |id: &TileId| match tiles.get(*id) {
            Some(Tile::Container(Container::Tabs(tabs))) => tabs.children.iter().any(is_it),
            _ => is_it(id),
        };
        let (column, tile) = columns
            .filter_map(|column| Some((column, *column.children.iter().find(|id| holds(id))?)))
            .next()
            .expect("it is in a column");
        let at = column.children.iter().position(|id| *id == tile).expect("there");
        column.shares.split(&column.children, room(size.y, column.children.len()))[at]
    }

    #[test]
    fn panels_have_their_least_height_where_others_have_more_than_theirs() {
        let mut tree = (default_tree(), Wanted::default());
        let high = height(&mut tree, NOMINAL, "problems");
        for (size, problems, table) in [
            // below the map there is a row more where tabs and header have no room beside each other
            (vec2(960.0, 558.0), 188.0, 230.0),
            (vec2(1280.0, 600.0), 188.0, 204.0),
            (NOMINAL, high, 204.0),
        ] {
            let got = (height(&mut tree, size, "problems"), height(&mut tree, size, "table"));
            assert!((got.0 - problems).abs() < 1.0 && (got.1 - table).abs() < 1.0, "{size}: {got:?}");
        }
        let low = height(&mut tree, vec2(960.0, 300.0), "table");
        assert!((low - (299.0 - LEAST.y)).abs() < 1.0, "the map goes first: {low}");
    }

    #[test]
    fn what_the_operator_moves_in_a_low_window_stays() {
        let mut tree = (default_tree(), Wanted::default());
        let size = vec2(960.0, 558.0);
        height(&mut tree, size, "problems");
        let pane = |tree: &PanelTree, panel: &str| {
            let is_it = |tile: &&Tile<PanelId>| matches!(tile, Tile::Pane(pane) if *pane == panel);
            tree.tiles.iter().find(|(_, tile)| is_it(tile)).map(|(id, _)| *id).expect("there")
        };
        let (plan, problems) = (pane(&tree.0, "plan"), pane(&tree.0, "problems"));
        let column = tree.0.tiles.parent_of(plan).expect("in a column");
        if let Some(Tile::Container(Container::Linear(linear))) = tree.0.tiles.get_mut(column) {
            linear.shares.set_share(plan, 257.0);
            linear.shares.set_share(problems, 300.0);
        }
        for _ in 0..2 {
            assert!((height(&mut tree, size, "problems") - 300.0).abs() < 1.0);
        }
    }

    /// Lengths of what is at the root, in a dock of this width.
    fn columns((tree, wanted): &mut (PanelTree, Wanted), width: f32) -> Vec<f32> {
        let root = tree.root().expect("not empty");
        fit(&mut tree.tiles, root, vec2(width, 900.0), &least(), wanted);
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
    fn in_flight_the_map_of_a_low_window_is_larger() {
        let size = vec2(960.0, 477.0);
        let of_map = |map: Vec2| {
            let mut tree = default_tree();
            let root = tree.root().expect("not empty");
            fit(&mut tree.tiles, root, size, &Least { map, ..least() }, &mut Wanted::default());
            let Some(Tile::Container(Container::Linear(row))) = tree.tiles.get(root) else {
                panic!("no row")
            };
            let widths = row.shares.split(&row.children, room(size.x, 3));
            let Some(Tile::Container(Container::Linear(column))) = tree.tiles.get(row.children[1]) else {
                panic!("no column")
            };
            vec2(widths[1], column.shares.split(&column.children, room(size.y, 2))[0])
        };
        let (before, in_flight) = (of_map(LEAST), of_map(least_in_flight(size)));
        assert!(in_flight.x > before.x + 80.0 && in_flight.y > before.y + 30.0, "{before} {in_flight}");
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
