//! The map: basemap, terrain, the plan, the path that will be flown, the aircraft; and the tools to
//! change the plan by hand.

mod acts;
pub mod aircraft;
pub mod basemap;
pub mod chips;
pub mod clipboard;
pub mod coverage;
mod draw;
pub mod drawings;
pub mod footprints;
pub mod foreseen;
pub mod furniture;
pub mod graticule;
mod ground;
pub mod guard;
mod held;
mod items;
mod kept;
mod kin;
mod left_out;
pub mod marks;
mod menu;
mod names;
pub mod navigate;
pub mod path;
pub mod places;
pub mod plan;
pub mod polyline;
pub mod rasters;
mod reveal;
mod sheet;
pub mod sketch;
pub mod text;
pub mod tool_chip;
pub mod tools;
mod variables;
pub mod view;
pub mod zones;

use crate::command::{Clip, Queue, ViewCommand};
use crate::derived::{Derived, Source};
use crate::layers::Opened;
use crate::panels::{Scene, field, start};
use egui::{DragPanButtons, Pos2, Ui};
use flight_plan::Variables;
use flight_plan::create::Way;
use geometry::LatLon;
use sketch::Sketch;
use std::sync::Arc;
use terrain::Terrain;
use tools::Toolbox;
use tools::new_leg::Side;
use usal::contract::PlanVariables;
use view::View;
use walkers::{Map, MapMemory, lat_lon};
use wire::Convert;

/// What is shown where nothing else asks for a place: where the shipped elevations are.
pub(crate) const HOME: LatLon = LatLon::new(36.319, -84.173);

/// Zoom level of a map without a plan: the world.
const WORLD_ZOOM: f64 = 2.0;
/// Its middle.
const WORLD: LatLon = LatLon::new(25.0, 0.0);
/// Zoom level at which a runway and what is around it are seen.
const NEAR_ZOOM: f64 = 12.5;

/// What the map remembers from frame to frame.
#[derive(Debug, Default)]
pub struct MapState {
    memory: MapMemory,
    /// Show everything as soon as the size of the map is known.
    fit: bool,
    /// Show where a new plan begins, likewise.
    begin: Option<LatLon>,
    ground: ground::Ground,
    /// What is to be brought into view, if it is not.
    reveal: Option<reveal::Wanted>,
    /// A box to be shown in the next frame.
    fit_to: Option<[LatLon; 2]>,
    path: path::Layer,
    aircraft: aircraft::Layer,
    tools: Toolbox,
    navigation: navigate::Navigation,
    menu: menu::Menu,
    /// What is to be done with the clipboard in the next frame.
    clip: Option<Clip>,
    /// Drawings on the clipboard that are being read.
    pastes: clipboard::Pastes,
    items: items::Items,
    /// With the variables as they are aboard.
    sketch: Derived<Option<PlanVariables>, Sketch>,
    /// The forecast that its ways begin by.
    ways_of: Option<u64>,
}

impl MapState {
    /// Shows the whole plan in the next frame.
    pub fn fit(&mut self) {
        self.fit = true;
    }

    /// Another plan is shown: what was asked about the last one is not asked any more.
    pub fn close_menu(&mut self) {
        self.menu.close();
    }

    /// Brings it nearer in the next frame, by so many levels of zoom.
    pub fn zoom(&mut self, by: f64) {
        self.navigation.zoom(by);
    }

    /// Copies or pastes in the next frame.
    pub fn clip(&mut self, clip: Clip) {
        self.clip = Some(clip);
    }

    /// Brings a place into the middle, near enough to see it.
    pub fn jump_to(&mut self, at: LatLon) {
        self.memory.center_at(lat_lon(at.lat_deg, at.lon_deg));
        if self.memory.zoom() < 12.0 {
            // 13 is within the map's range
            let _ = self.memory.set_zoom(13.0);
        }
    }

    /// Shows where a new plan begins, some kilometres around it.
    pub fn begin_at(&mut self, at: LatLon) {
        self.begin = Some(at);
    }

    /// Keeps the aircraft in the middle from now on.
    pub fn follow(&mut self) {
        self.memory.follow_my_position();
    }

    /// Takes the keys that choose a tool, those that the tool in use understands, and those that move the map.
    pub fn keys(&mut self, ctx: &egui::Context) {
        if !field::is_typing(ctx) {
            self.tools.keys(ctx);
            self.navigation.keys(ctx);
        }
    }

    /// What of it gets the keyboard, once it was drawn.
    pub fn keyboard(&self) -> Option<egui::Id> {
        self.navigation.widget()
    }

    /// Each tool's card, and whether it is in use.
    pub fn tool_cards(&self) -> Vec<(&'static tools::Card, bool)> {
        self.tools.cards().collect()
    }

    /// It waits for the result of work on another thread.
    pub fn is_busy(&self) -> bool {
        self.tools.is_busy() || self.pastes.is_reading() || self.path.is_busy() || self.sketch.is_busy()
    }

    /// Puts a tool to use.
    pub fn choose_tool(&mut self, id: &str) {
        self.tools.choose(id);
    }

    /// Puts the tool that draws legs to use, for a new way from the selected leg.
    pub fn draw_way(&mut self) {
        self.tools.draw_legs(Side::Way(Way::New));
    }

    /// Shows a box in the next frame.
    pub fn fit_to(&mut self, corners: [LatLon; 2]) {
        self.fit_to = Some(corners);
    }

    /// Shades this ground, or none.
    pub fn shade(&mut self, ground: Option<&Arc<dyn Terrain>>, ctx: &egui::Context) {
        self.ground.shade(ground, ctx);
    }

    /// The ground is shaded.
    pub fn is_shaded(&self) -> bool {
        self.ground.is_shaded()
    }

    /// Shows a map's tiles from now on, as long as its layer is there.
    pub fn add_raster(&mut self, opened: Opened, ctx: &egui::Context) {
        self.ground.add_raster(opened, ctx);
    }

    /// So many pictures of a layer's tiles are here.
    pub fn pictures_of(&self, layer: u64) -> usize {
        self.ground.pictures_of(layer)
    }

    /// No tile of what was drawn last is on its way.
    pub fn has_all_tiles(&self) -> bool {
        self.ground.is_whole()
    }

    /// Draws the map and takes what the operator does on it.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        self.sketch(scene);
        self.begin_ways(scene);
        // a large plan has no places yet
        if self.fit && !self.sketch.is_busy() {
            self.fit_now(ui, scene);
        }
        if let Some(corners) = self.fit_to.take() {
            self.show_all(&corners, ui, scene);
        }
        if let Some(at) = self.begin.take() {
            self.begin_now(at, ui.available_width());
        }
        let here = scene.vehicle.position.as_ref().map(|p| p.value.position);
        let here = here.or_else(|| scene.document.plan().home().map(|r| r.threshold)).unwrap_or(HOME);
        let mut memory = std::mem::take(&mut self.memory);
        let followed = memory.detached().is_none();
        // a drag with Shift draws around what is to be selected
        let selects = ui.input(|i| i.modifiers.shift) || self.tools.is_sweeping();
        let shown = Map::new(None, &mut memory, lat_lon(here.lat_deg, here.lon_deg))
            .zoom_gesture(false)
            .drag_pan_buttons(if selects { DragPanButtons::empty() } else { DragPanButtons::PRIMARY })
            .panning(false)
            .double_click_to_zoom(false)
            .show(ui, |ui, response, projector, _| {
                let view = View::of(projector);
                let pointer = if selects { None } else { pointer(ui, &view) };
                self.draw(ui, response, (&view, pointer), scene, queue);
                view
            });
        let follows = followed && scene.view.follow;
        self.navigation.run(&shown.response, &shown.inner, follows, &mut memory);
        if follows && memory.detached().is_some() {
            queue.view(ViewCommand::Follow(false));
        }
        let is_busy = self.sketch.is_busy();
        if let Some(wanted) = self.reveal.take_if(|_| !is_busy).filter(|_| !scene.view.follow)
            && self.come_to(&wanted, &shown.inner, scene, &mut memory)
        {
            ui.ctx().request_repaint();
        }
        furniture::buttons(ui, &mut memory, scene, queue);
        furniture::toolbar(ui, &mut self.tools, scene, queue);
        self.memory = memory;
    }

    /// Places the plan anew, when it or the variables aboard have changed.
    fn sketch(&mut self, scene: &Scene<'_>) {
        let live = live_variables(scene).cloned();
        let source = Source::new(scene.document, live.clone());
        let is_another = self.sketch.refresh(source, scene.layers.wake(), move |plan, former| {
            let mut variables = Variables::initial(plan);
            for v in live.into_iter().flat_map(|live| live.variables) {
                // a value the document's variable does not take belongs to another version of it
                let _ = variables.set(plan, &v.name.convert(), v.value.convert());
            }
            Sketch::new(plan, &variables, former)
        });
        if is_another {
            self.items = items::Items::default();
            self.path.forget_draft();
            self.ways_of = None;
        }
    }

    /// By the forecast of the plan as it is sketched.
    fn begin_ways(&mut self, scene: &Scene<'_>) {
        let of = Some(scene.analysis.forecast_version);
        if self.ways_of != of
            && scene.analysis.version == scene.document.version()
            && let Some(sketch) = self.sketch.get_mut()
        {
            sketch.begin_ways(scene.forecast());
            self.ways_of = of;
        }
    }

    /// In the middle of what the card for a new mission leaves free.
    fn begin_now(&mut self, at: LatLon, width: f32) {
        // within the map's range
        let _ = self.memory.set_zoom(NEAR_ZOOM);
        let aside = if width < furniture::NARROW { 0.0 } else { start::WIDTH / 2.0 };
        let degrees_per_point = 360.0 / (256.0 * NEAR_ZOOM.exp2());
        self.memory.center_at(lat_lon(at.lat_deg, at.lon_deg - f64::from(aside) * degrees_per_point));
    }

    fn fit_now(&mut self, ui: &Ui, scene: &Scene<'_>) {
        self.fit = false;
        let places = self.sketch.places();
        if !self.show_all(&places, ui, scene) {
            self.memory.center_at(lat_lon(WORLD.lat_deg, WORLD.lon_deg));
            let _ = self.memory.set_zoom(WORLD_ZOOM);
        }
    }

    /// False: there is nothing to be shown.
    fn show_all(&mut self, places: &[LatLon], ui: &Ui, scene: &Scene<'_>) -> bool {
        let map = ui.available_rect_before_wrap();
        let legend = furniture::legend(map, self.tools.cards().count(), scene);
        let legend = legend.map(|legend| legend.translate(-map.min.to_vec2()));
        let Some((centre, zoom)) = View::fit_beside(places, map.size(), legend) else { return false };
        self.memory.center_at(centre);
        // fit keeps within the map's range of zooms
        let _ = self.memory.set_zoom(zoom);
        true
    }
}

/// Where the pointer is over the map, or was pressed there; not over the choices of the tool in use.
fn pointer(ui: &Ui, view: &View) -> Option<Pos2> {
    let at = ui.input(|i| i.pointer.press_origin().or(i.pointer.hover_pos()));
    at.filter(|at| ui.rect_contains_pointer(view.rect) && !tool_chip::takes(ui.ctx(), *at))
}

/// The variables as they are in flight, if what is flown is this document.
fn live_variables<'a>(scene: &Scene<'a>) -> Option<&'a PlanVariables> {
    let hash = scene.analysis.hash_of(scene.document.version())?;
    let active = scene.vehicle.active_hash().is_some_and(|h| *h == *hash);
    active.then(|| scene.vehicle.variables.as_ref().map(|v| &v.value)).flatten()
}
