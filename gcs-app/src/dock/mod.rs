//! The dock: where the panels are. Tiles beside, above and behind one another, with the map among them;
//! they are dragged by their titles, and the layout is remembered from run to run.

mod content;
mod fit;
mod grow;
mod layout;
mod stops;

pub use content::Content;

use crate::panels::{Panel, PanelId};
use egui::{Rect, Ui};
use egui_tiles::{Tile, TileId, Tree};
use layout::Stored;
use std::collections::BTreeSet;
use stops::Stop;

type PanelTree = Tree<PanelId>;

/// The map: the one tile that is always there and cannot be dragged.
pub const MAP: PanelId = "map";
/// Where the layout is stored.
const STORAGE_KEY: &str = "layout";
/// Between two tiles, screen points.
const GAP: f32 = 1.0;
/// In a dock that is lower a flight has no room for panels that it does not need, screen points.
const HIGH: f32 = 560.0;
/// Height of the titles, screen points.
const TAB_BAR: f32 = 26.0;

/// Where the panels are.
#[derive(Debug)]
pub struct Dock {
    tree: PanelTree,
    /// Panels that the operator has hidden; they keep their places.
    hidden: BTreeSet<PanelId>,
    wanted: fit::Wanted,
    /// How many times as wide the sides of the default layout are in a wide window; `None`: the operator has a layout of his own.
    grown: Option<f32>,
    /// The map and the panels that were drawn last.
    stops: Vec<Stop>,
    /// Those that were drawn last: neither hidden nor behind another one.
    drawn: BTreeSet<PanelId>,
    /// What the panels of the plan took beside the map when they were drawn last, screen points; `None`: they stand elsewhere.
    beside_map: Option<f32>,
}

impl Dock {
    /// The layout of the last run; the default one if there is none, or none that makes sense.
    pub fn new(panels: &[Box<dyn Panel>], storage: Option<&dyn eframe::Storage>) -> Self {
        let stored: Option<Stored> = storage.and_then(|s| eframe::get_value(s, STORAGE_KEY));
        stored.and_then(|stored| Self::of(&stored, panels)).unwrap_or_else(|| Self::default_of(panels))
    }

    fn default_of(panels: &[Box<dyn Panel>]) -> Self {
        let empty = || Self {
            tree: PanelTree::empty(egui::Id::unique("dock")),
            hidden: BTreeSet::new(),
            wanted: Default::default(),
            grown: None,
            stops: Vec::new(),
            drawn: BTreeSet::new(),
            beside_map: None,
        };
        // a test shows that it is sound
        let sound = Self::of(&Stored::default_of(panels), panels);
        sound.unwrap_or_else(empty)
    }

    fn of(stored: &Stored, panels: &[Box<dyn Panel>]) -> Option<Self> {
        let ids = || panels.iter().map(|panel| panel.id());
        let known: Vec<PanelId> = std::iter::once(MAP).chain(ids()).collect();
        let hidden = ids().filter(|id| stored.hidden.contains(*id)).collect();
        let tree = stored.tree(&known)?;
        // what is no factor of ours is nobody's
        let grown = stored.grown.filter(|grown| (1.0..=grow::MOST).contains(grown));
        let (wanted, stops, drawn) = Default::default();
        Some(Self { tree, hidden, wanted, grown, stops, drawn, beside_map: None })
    }

    /// Stores the layout for the next run.
    pub fn save(&self, storage: &mut dyn eframe::Storage) {
        if let Some(stored) = Stored::of(&self.tree, &self.hidden, self.grown) {
            eframe::set_value(storage, STORAGE_KEY, &stored);
        }
    }

    /// Back to the default layout, with every panel that is shown at first.
    pub fn reset(&mut self, panels: &[Box<dyn Panel>]) {
        *self = Self::default_of(panels);
    }

    /// Is this panel shown, as far as the operator is concerned?
    pub fn shows(&self, panel: PanelId) -> bool {
        !self.hidden.contains(panel)
    }

    /// Was the panel drawn in the last frame?
    pub fn draws(&self, panel: PanelId) -> bool {
        self.drawn.contains(panel)
    }

    /// Shows a panel, in front of others, or hides it.
    pub fn show_panel(&mut self, panel: PanelId, shown: bool) {
        if shown {
            self.hidden.remove(panel);
            self.tree.make_active(|_, tile| matches!(tile, Tile::Pane(id) if *id == panel));
        } else {
            self.hidden.insert(panel);
        }
    }

    /// The width of what is read with the map, if it stands in the place of the plan's panels.
    pub fn place_to_read(&self) -> Option<f32> {
        self.beside_map
    }

    /// Draws everything. Returns where the map is, if no other tile is in front of it. `is_read`: something stands beside the dock
    /// that is read with the map, in the place of the plan's panels: neither the map nor the flight's values move for it.
    pub fn show(&mut self, ui: &mut Ui, content: &mut Content<'_>, is_read: bool) -> Option<Rect> {
        self.grown = grow::grown(&mut self.tree, ui.available_width(), self.grown, &self.wanted);
        let left = ui.max_rect().left();
        let gives_place = is_read && self.beside_map.is_some();
        let is_low = ui.available_height() < HIGH;
        for (tile, panel) in self.panes() {
            let is_aside = (gives_place && content.is_of_the_plan(panel))
                || (is_low && content.gives_way_to_flight(panel));
            let is_shown = self.shows(panel) && content.is_relevant(panel) && !is_aside;
            self.tree.set_visible(tile, is_shown);
        }
        if let Some(root) = self.tree.root() {
            // what is read stands in the place of panels: the map keeps its size
            let aside = self.beside_map.filter(|_| gives_place).unwrap_or_default();
            let whole = ui.available_size() + egui::vec2(aside, 0.0);
            let is_wide = is_low && content.is_in_flight();
            let map = if is_wide { fit::least_in_flight(whole) } else { fit::LEAST };
            let least = fit::Least { map, panels: content.least_heights() };
            fit::fit(&mut self.tree.tiles, root, ui.available_size(), &least, &mut self.wanted);
        }
        content.begin(&self.tree.tiles);
        self.tree.ui(content, ui);
        self.stops = content.take_stops();
        self.drawn = content.take_drawn();
        if !is_read {
            let beside =
                content.map_rect().zip(content.plan_rect()).filter(|(map, plan)| plan.right() <= map.left());
            self.beside_map = beside.map(|(map, _)| map.left() - left);
        }
        content.map_rect()
    }

    /// Takes the keyboard to the next panel, or (`-1`) the one before.
    pub fn step_keyboard(&self, by: isize, ctx: &egui::Context) {
        stops::step(&self.stops, by, ctx);
    }

    fn panes(&self) -> Vec<(TileId, PanelId)> {
        let pane = |(id, tile): (&TileId, &Tile<PanelId>)| match tile {
            Tile::Pane(panel) => Some((*id, *panel)),
            Tile::Container(_) => None,
        };
        self.tree.tiles.iter().filter_map(pane).collect()
    }
}
