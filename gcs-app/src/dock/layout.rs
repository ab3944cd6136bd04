//! A layout as it is stored: which panel is where, and how big. What comes from a file is checked
//! before it is used; whatever is wrong with it, the default layout takes its place.

use super::{MAP, PanelTree};
use crate::panels::{Panel, PanelId, Place};
use egui::Vec2;
use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Changes whenever an older program's layout would make no sense any more.
pub const VERSION: u32 = 1;
/// Size for which the default layout's lengths are meant, screen points.
pub const NOMINAL: Vec2 = Vec2::new(1280.0, 758.0);
/// Deepest nesting that is believed.
const DEPTH_MAX: usize = 16;

/// A layout that can be stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stored {
    version: u32,
    /// Panels that the operator has hidden.
    pub hidden: BTreeSet<String>,
    /// How many times as wide the sides of the default layout are, as long as the operator has changed nothing.
    #[serde(default)]
    pub grown: Option<f32>,
    root: Node,
}

/// A part of a layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Node {
    /// A panel, by its identifier.
    Panel(String),
    /// Side by side.
    Row(Vec<Part>),
    /// One above the other.
    Column(Vec<Part>),
    /// One behind the other.
    Tabs { active: usize, children: Vec<Self> },
}

/// A part with its length along the row or column, screen points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Part {
    length: f32,
    node: Node,
}

impl Stored {
    /// The layout that every panel asks for.
    pub fn default_of(panels: &[Box<dyn Panel>]) -> Self {
        let of = |side: fn(Place) -> Option<f32>| {
            panels.iter().filter_map(move |panel| Some((side(panel.place())?, panel.id())))
        };
        let left = of(|place| if let Place::Left { height } = place { Some(height) } else { None });
        let right = of(|place| if let Place::Right { height } = place { Some(height) } else { None });
        let below = of(|place| matches!(place, Place::Below).then_some(0.0));
        let tabs = Node::Tabs { active: 0, children: below.map(|(_, id)| Node::Panel(id.into())).collect() };
        let middle = Node::Column(vec![part(554.0, Node::Panel(MAP.into())), part(204.0, tabs)]);
        let root = Node::Row(vec![
            part(LEFT, column(left)),
            part(NOMINAL.x - LEFT - RIGHT, middle),
            part(RIGHT, column(right)),
        ]);
        let hidden = panels.iter().filter(|panel| !panel.is_shown_at_first());
        Self {
            version: VERSION,
            hidden: hidden.map(|panel| panel.id().to_owned()).collect(),
            grown: Some(1.0),
            root,
        }
    }

    /// As it is now.
    pub fn of(tree: &PanelTree, hidden: &BTreeSet<PanelId>, grown: Option<f32>) -> Option<Self> {
        let root = node(&tree.tiles, tree.root()?)?;
        let hidden = hidden.iter().map(|id| (*id).to_owned()).collect();
        Some(Self { version: VERSION, hidden, grown, root })
    }

    /// The tree of tiles, if every known panel is in it once, nothing else is, and all lengths make sense.
    pub fn tree(&self, known: &[PanelId]) -> Option<PanelTree> {
        if self.version != VERSION {
            return None;
        }
        let mut builder = Builder { tiles: Tiles::default(), missing: known.iter().copied().collect() };
        let root = builder.build(&self.root, DEPTH_MAX)?;
        let tree = PanelTree::new(egui::Id::unique("dock"), root, builder.tiles);
        builder.missing.is_empty().then_some(tree)
    }
}

/// Widths of the default layout's sides, screen points.
const LEFT: f32 = 268.0;
const RIGHT: f32 = 344.0;

fn part(length: f32, node: Node) -> Part {
    Part { length, node }
}

fn column<'a>(panels: impl Iterator<Item = (f32, &'a str)>) -> Node {
    Node::Column(panels.map(|(height, id)| part(height, Node::Panel(id.into()))).collect())
}

/// Makes tiles of nodes; gives up at the first that makes no sense.
struct Builder {
    tiles: Tiles<PanelId>,
    missing: BTreeSet<PanelId>,
}

impl Builder {
    fn build(&mut self, node: &Node, depth: usize) -> Option<TileId> {
        let depth = depth.checked_sub(1)?;
        Some(match node {
            Node::Panel(id) => {
                let id = self.missing.take(id.as_str())?;
                self.tiles.insert_pane(id)
            }
            Node::Row(parts) => self.linear(LinearDir::Horizontal, parts, depth)?,
            Node::Column(parts) => self.linear(LinearDir::Vertical, parts, depth)?,
            Node::Tabs { active, children } => {
                let children: Option<Vec<TileId>> = children.iter().map(|c| self.build(c, depth)).collect();
                let mut tabs = Tabs::new(children.filter(|c| !c.is_empty())?);
                tabs.active = tabs.children.get(*active).copied();
                self.tiles.insert_container(tabs)
            }
        })
    }

    fn linear(&mut self, dir: LinearDir, parts: &[Part], depth: usize) -> Option<TileId> {
        let mut linear = Linear::new(dir, Vec::new());
        for part in parts {
            if !(part.length >= 1.0 && part.length < 100_000.0) {
                return None;
            }
            let child = self.build(&part.node, depth)?;
            linear.children.push(child);
            linear.shares.set_share(child, part.length);
        }
        (!parts.is_empty()).then(|| self.tiles.insert_container(linear))
    }
}

fn node(tiles: &Tiles<PanelId>, id: TileId) -> Option<Node> {
    Some(match tiles.get(id)? {
        Tile::Pane(panel) => Node::Panel((*panel).to_owned()),
        Tile::Container(Container::Tabs(tabs)) => Node::Tabs {
            active: tabs.children.iter().position(|c| Some(*c) == tabs.active).unwrap_or(0),
            children: tabs.children.iter().map(|c| node(tiles, *c)).collect::<Option<_>>()?,
        },
        Tile::Container(Container::Linear(linear)) => {
            let parts =
                linear.children.iter().map(|c| Some(part(linear.shares[*c].max(1.0), node(tiles, *c)?)));
            let parts = parts.collect::<Option<Vec<Part>>>()?;
            match linear.dir {
                LinearDir::Horizontal => Node::Row(parts),
                LinearDir::Vertical => Node::Column(parts),
            }
        }
        // no gesture makes one
        Tile::Container(Container::Grid(_)) => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panels;

    fn known() -> Vec<PanelId> {
        std::iter::once(MAP).chain(panels::all().iter().map(|p| p.id())).collect()
    }

    #[test]
    fn a_layout_survives_being_stored() {
        let stored = Stored::default_of(&panels::all());
        let tree = stored.tree(&known()).expect("the default layout is sound");
        assert_eq!(Stored::of(&tree, &BTreeSet::from([panels::what_if::ID]), Some(1.0)), Some(stored));
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        let good = Stored::default_of(&panels::all());
        let panel = |id: &str| Node::Panel(id.into());
        let row = |length: f32| Node::Row(vec![part(length, good.root.clone())]);
        let mut deep = good.root.clone();
        for _ in 0..DEPTH_MAX {
            deep = Node::Tabs { active: 0, children: vec![deep] };
        }
        let twice = Node::Tabs { active: 0, children: vec![good.root.clone(), panel(MAP)] };
        let foreign = Node::Tabs { active: 0, children: vec![good.root.clone(), panel("radio")] };
        let empty = Node::Tabs { active: 0, children: vec![good.root.clone(), Node::Row(Vec::new())] };
        let faults =
            [panel(MAP), row(f32::NAN), row(-1.0), row(f32::INFINITY), row(0.0), deep, twice, foreign, empty];
        for root in faults {
            let bad = Stored { root: root.clone(), ..good.clone() };
            assert!(bad.tree(&known()).is_none(), "{root:?}");
        }
        assert!(Stored { version: VERSION + 1, ..good.clone() }.tree(&known()).is_none());
        let far = Node::Tabs { active: 99, children: vec![good.root.clone()] };
        assert!(Stored { root: far, ..good }.tree(&known()).is_some(), "which tab is in front is no fault");
    }
}
