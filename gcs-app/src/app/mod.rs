//! The window. `logic` drains what the workers found out, `ui` draws and then carries out what was
//! asked for. Nothing here waits for file, network or computation.

mod clock;
mod even;
mod file_name;
mod filing;
mod focus;
mod ground;
mod inbox;
mod keys;
mod layout;
mod links;
mod making;
mod messages;
mod orders;
mod press;
mod preview;
mod pushing;
mod remembered;
mod screenshot;
mod settings;
mod tips;
mod window;

pub use clock::TimeOfDay;
pub(crate) use orders::plan_label;
pub use screenshot::Screenshot;
pub use window::{Options, WindowError, has_display, run};

use crate::actions::{Action, Fittings, PanelEntry};
use crate::command::{Queue, Replacement};
use crate::connections::Connections;
use crate::dock::Dock;
use crate::document::Document;
use crate::files::Files;
use crate::forecast::{Aboard, Analysis, Forecast, Worker};
use crate::jobs::Task;
use crate::layers::Layers;
use crate::link::Links;
use crate::map::MapState;
use crate::panels::help::Help;
use crate::panels::palette::{self, CommandPalette};
use crate::panels::{self, Elevations, Panel, Scene, ViewState, field, inspector, row_menu, tree};
use crate::recent::Recent;
use crate::recovery::Keeper;
use crate::shelf::Shelf;
use crate::state::{Toasts, Vehicle, VehicleName, Vehicles};
use crate::story::{Chapter, Story};
use crate::theme;
use clock::Now;
use remembered::Remembered;
use settings::Settings;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;
use terrain::Terrain;

/// The ground station.
pub struct App {
    document: Document,
    /// Those before and after it.
    shelf: Shelf,
    vehicles: Vehicles,
    view: ViewState,
    palette: CommandPalette,
    /// What was typed before the palette was there.
    typed_ahead: Vec<egui::Event>,
    help: Help,
    analysis: Analysis,
    map: MapState,
    panels: Vec<Box<dyn Panel>>,
    dock: Dock,
    queue: Queue,
    links: Links,
    worker: Worker,
    aboard: Aboard,
    layers: Layers,
    /// Wakes the window.
    wake: Arc<dyn Fn() + Send + Sync>,
    files: Files,
    toasts: Toasts,
    /// The notice that was put into the log last.
    noted: Option<String>,
    /// Why a gesture did nothing, and until when that is said, seconds of the window's clock.
    refusal: Option<(String, f64)>,
    /// The documents that are being written, or asked where to, by their numbers.
    saving: BTreeSet<u64>,
    /// Plans that are about to be proposed.
    pushes: Vec<pushing::Push>,
    recent: Recent,
    connections: Connections,
    /// `None`: no copy of unsaved changes is kept.
    keeper: Option<Keeper>,
    /// The folder of such copies is being looked into; or why it can't be.
    opening_copies: Option<Task<Result<Keeper, String>>>,
    /// The vehicle whose plan aboard the document is, and the document's version.
    mirrored: Option<(VehicleName, u64)>,
    time_of_day: TimeOfDay,
    /// When the aircraft were looked at last, seconds of the window's clock.
    looked_s: f64,
    /// The vehicle that was shown then, if it was in an emergency.
    in_emergency: Option<VehicleName>,
    /// The window closes, whatever was not saved.
    leaving: bool,
    /// What happens when all that is to be saved is saved.
    after_saving: Option<Replacement>,
    screenshot: Option<Screenshot>,
    /// What the next run finds, if this one is ended by force.
    stored: Remembered,
    settings: Settings,
    /// The theme of earlier runs, while one that this run was told to begin with takes its place.
    theme_of_old: Option<egui::ThemePreference>,
    /// The tour has been offered, in this window or an earlier one.
    tour_seen: bool,
    /// What a demo tells, and where it had come to in the last frame.
    story: Option<(Story, Chapter)>,
    /// The document whose first error was selected, if it has one; 0: none.
    looked_through: u64,
}

impl std::fmt::Debug for App {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("App").finish_non_exhaustive()
    }
}

/// Settings are saved so often, whatever has changed.
const SAVED_EVERY: Duration = Duration::from_secs(30);
/// Ages on the screen are refreshed at least so often while a vehicle is connected.
const REFRESH: Duration = Duration::from_millis(100);

impl App {
    /// A ground station that talks through `links` and flies over `terrain`.
    ///
    /// # Errors
    /// No thread can be started.
    pub fn new(
        creation: &eframe::CreationContext<'_>,
        document: Document,
        links: Links,
        terrain: Arc<dyn Terrain>,
    ) -> std::io::Result<Self> {
        let ctx = creation.egui_ctx.clone();
        theme::install(&ctx);
        ctx.add_plugin(press::PressFirst::default());
        ctx.add_plugin(tips::UnderDialogs::default());
        let wake: Arc<dyn Fn() + Send + Sync> = {
            let ctx = ctx.clone();
            Arc::new(move || ctx.request_repaint())
        };
        let remembered = creation.storage.map(Remembered::read).unwrap_or_default();
        let stored = remembered.clone();
        let panels = panels::all();
        let mut app = Self {
            document,
            shelf: Shelf::default(),
            vehicles: Vehicles::default(),
            view: remembered.view(),
            palette: CommandPalette::default(),
            typed_ahead: Vec::new(),
            help: Help::default(),
            analysis: Analysis::default(),
            map: MapState::default(),
            dock: Dock::new(&panels, creation.storage),
            panels,
            queue: Queue::default(),
            links,
            worker: Worker::spawn(terrain.clone(), wake.clone())?,
            aboard: Aboard::spawn(terrain.clone(), wake.clone())?,
            layers: Layers::new(terrain, remembered.layers, wake.clone()),
            wake: wake.clone(),
            files: Files::new(wake),
            toasts: Toasts::default(),
            noted: None,
            refusal: None,
            saving: BTreeSet::new(),
            pushes: Vec::new(),
            recent: remembered.recent,
            connections: remembered.connections,
            keeper: None,
            opening_copies: None,
            mirrored: None,
            time_of_day: jiff::Timestamp::now,
            looked_s: f64::NEG_INFINITY,
            in_emergency: None,
            leaving: false,
            after_saving: None,
            screenshot: None,
            stored,
            settings: Settings::new(),
            theme_of_old: None,
            tour_seen: remembered.tour_seen,
            story: None,
            looked_through: 0,
        };
        app.map.fit();
        Ok(app)
    }

    /// The plan being edited.
    pub fn document(&self) -> &Document {
        &self.document
    }
    /// The window is about to close.
    pub fn is_leaving(&self) -> bool {
        self.leaving
    }
    /// What is known of the vehicles.
    pub fn vehicles(&self) -> &Vehicles {
        &self.vehicles
    }
    /// What is known of the vehicle that is shown.
    pub fn vehicle(&self) -> &Vehicle {
        self.vehicles.shown()
    }
    /// Everything is so large from now on, as when it is chosen in the menu.
    pub fn scale_to(&mut self, scale: theme::Scale) {
        self.view.scale = scale;
    }
    /// What the operator looks at.
    pub fn view(&self) -> &ViewState {
        &self.view
    }
    /// Where the panels are.
    pub fn dock(&self) -> &Dock {
        &self.dock
    }
    /// The maps and elevations that were brought.
    pub fn layers(&self) -> &Layers {
        &self.layers
    }
    /// The messages that are shown.
    pub fn toasts(&self) -> &Toasts {
        &self.toasts
    }
    /// What the map shows.
    pub fn map(&self) -> &MapState {
        &self.map
    }
    /// What was found out about the plan.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Something that was asked for is being done in the background, and a frame will bring it soon. A panel that is not drawn takes
    /// nothing.
    pub fn is_busy(&self) -> bool {
        let drawn = || self.panels.iter().filter(|panel| self.dock.draws(panel.id()));
        let is_begun = self.opening_copies.is_some() || !self.pushes.is_empty();
        self.map.is_busy() || is_begun || drawn().any(|panel| panel.is_busy())
    }

    /// The path of the plan aboard the vehicle that is shown, if it was asked for and is known.
    pub fn path_aboard(&self) -> Option<&Forecast> {
        path_aboard(&self.aboard, self.vehicles.shown())
    }

    fn scene(&self, now: Now) -> Scene<'_> {
        Scene {
            document: &self.document,
            shelf: &self.shelf,
            jobs: self.files.jobs(),
            toasts: &self.toasts,
            story: self.story.as_ref().map(|(_, chapter)| chapter),
            can_undo: (self.shelf.can_undo(&self.document), self.shelf.can_redo(&self.document)),
            analysis: &self.analysis,
            vehicle: self.vehicles.shown(),
            aboard: self.path_aboard(),
            vehicles: &self.vehicles,
            view: &self.view,
            layers: &self.layers,
            recent: &self.recent,
            connections: &self.connections,
            left_behind: self.keeper.as_ref().and_then(Keeper::left_behind),
            ground: Elevations(self.layers.ground().as_ref()),
            now_s: now.window_s,
            utc: now.utc,
        }
    }

    /// A window with unsaved changes, or that watches a flight, stays open until the operator has decided.
    fn ask_before_closing(&mut self, ctx: &egui::Context) {
        if self.leaving {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        } else if ctx.input(|i| i.viewport().close_requested()) && self.may_not_close() {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.view.unsaved = Some(Replacement::Quit);
        }
    }

    /// All that the palette can offer, at this time of the window, seconds, and of the day.
    pub fn offered(&self, window_s: f64, utc: jiff::Timestamp) -> Vec<Action> {
        palette::everything(&self.scene(Now { window_s, utc }), &self.fittings())
    }

    /// Something would be lost with the window: changes, or the sight of a flight.
    fn may_not_close(&self) -> bool {
        self.has_unsaved() || self.vehicles.flying().next().is_some()
    }

    /// Some document has changes that are in no file, shown or not.
    fn has_unsaved(&self) -> bool {
        self.shelf.unsaved(&self.document).next().is_some()
    }

    /// What the window has besides the scene.
    fn fittings(&self) -> Fittings {
        let entry = |panel: &dyn Panel| PanelEntry {
            id: panel.id(),
            name: panel.name(),
            shown: self.dock.shows(panel.id()),
        };
        Fittings {
            panels: self.panels.iter().map(|panel| entry(panel.as_ref())).collect(),
            tools: self.map.tool_cards(),
        }
    }

    /// Theme and scale as they were asked for, and the keyboard to whom it was promised.
    fn look(&mut self, ctx: &egui::Context) {
        if ctx.options(|o| o.theme_preference) != self.view.theme {
            ctx.set_theme(self.view.theme);
        }
        let most = theme::Scale::most_in(ctx.content_rect().size() * ctx.zoom_factor());
        let scale = self.view.scale.get().min(most);
        if ctx.zoom_factor() != scale {
            ctx.set_zoom_factor(scale);
        }
        self.view.most_scale = Some(most);
        match std::mem::take(&mut self.view.panel_step) {
            0 => {}
            by => self.dock.step_keyboard(by, ctx),
        }
        if std::mem::take(&mut self.view.search) {
            tree::focus_search(ctx);
        }
        if std::mem::take(&mut self.view.row_menu) {
            row_menu::ask(ctx);
        }
        if let Some(what) = self.view.rename.take() {
            tree::rename(ctx, what);
        }
        if std::mem::take(&mut self.view.raise) {
            inspector::focus_raise(ctx);
        }
    }
}

/// The path of the plan aboard a vehicle, if it was asked for and is known.
fn path_aboard<'a>(aboard: &'a Aboard, vehicle: &Vehicle) -> Option<&'a Forecast> {
    aboard.path_of(&vehicle.aboard.as_ref()?.hash)
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.drain(ctx);
        self.tend_copy(ctx);
        self.ask_before_closing(ctx);
        if self.vehicles.any_link_wanted() {
            ctx.request_repaint_after(REFRESH);
        } else if !ctx.input(|i| i.viewport().minimized.unwrap_or(false)) {
            // the clock goes on, and without a link values grow old just the same; where no vehicle was heard, there are none
            let unit_s = if self.vehicles.any_heard() { 1 } else { 60 };
            ctx.request_repaint_after(self.now(ctx).until_next(unit_s));
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        let now = self.now(&ctx);
        let typed_ahead = std::mem::take(&mut self.typed_ahead);
        ctx.input_mut(|input| drop(input.events.splice(0..0, typed_ahead)));
        self.play(&ctx);
        self.view.notice = keys::refuse_long_paste(&ctx).or_else(|| self.view.notice.take());
        let mut queue = std::mem::take(&mut self.queue);
        // a menu takes Escape for itself
        if !self.scene(now).is_asking() && !egui::Popup::is_any_open(&ctx) {
            self.typed_ahead = keys::typed_for_palette(&ctx);
            self.map.keys(&ctx);
            keys::read(&ctx, &self.scene(now), &self.fittings(), &mut queue);
        }
        self.lay_out(ui, now, &mut queue);
        focus::ring(&ctx);
        field::note_typing(&ctx);
        // what was asked for was meant for the vehicle that was drawn
        let drawn = self.vehicles.shown_name().cloned();
        for command in queue.take() {
            self.carry_out(command, drawn.as_ref(), now.window_s);
        }
        self.queue = queue;
        self.look(&ctx);
        // what is dragged still is not decided yet
        if let Some(storage) = frame.storage_mut()
            && !ctx.input(|i| i.pointer.any_down())
            && self.settings.are_taken()
            && Remembered::of(self).keep(&mut self.stored, storage)
        {
            self.settings.write(&self.wake);
        }
        if let Some(screenshot) = &mut self.screenshot {
            screenshot.run(&ctx, now.window_s);
        }
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        if let Some(keeper) = &mut self.keeper {
            keeper.close();
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        Remembered::of(self).store(storage);
        self.dock.save(storage);
        self.settings.write(&self.wake);
    }

    fn auto_save_interval(&self) -> Duration {
        if self.settings.are_taken() { SAVED_EVERY } else { Duration::MAX }
    }
}
