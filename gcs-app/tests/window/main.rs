//! The window, driven as a person drives it: real buttons, real drags, a vehicle at the far end of
//! the link that the test plays.
#![cfg(test)]

mod acting;
mod alone;
mod announcing;
mod arranging;
mod bands;
mod binding;
mod branching;
mod bringing;
mod comparing;
mod connecting;
mod considering;
mod creating;
mod crossing;
mod dock;
mod drawing;
mod emergency;
mod filing;
mod finding;
mod fleet;
mod flown;
mod flying;
mod focusing;
mod following;
mod framing;
mod full;
mod gestures;
mod guarding;
mod handles;
mod holding;
mod inspecting;
mod interchange;
mod large;
mod lasting;
mod levels;
mod lines;
mod listing;
mod looks;
mod maps;
mod naming;
mod offered;
mod offering;
mod painted;
mod palette;
mod pasting;
mod placing;
mod planning;
mod pointing;
mod problems;
mod profile;
mod pushing;
mod reach;
mod reading;
mod recovering;
mod recreating;
mod reordering;
mod replacing;
mod runways;
mod scales;
mod sheets;
mod small;
mod starting;
mod states;
mod store;
mod table;
mod tasks;
mod telling;
mod telling_whole;
mod together;
mod tools;
mod tree;
mod typing;
mod unsteady;
mod vehicle;
mod waiting;
mod watching;
mod whatif;

use egui::{Pos2, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gcs_app::app::App;
use gcs_app::assets;
use gcs_app::document::Document;
use gcs_app::link::{Endpoint, Links};
use pictures::Raster;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

const SQUARE: &str = include_str!("../../../assets/plans/square.xml");

/// A machine that is busy elsewhere may take so long for what the window waits for.
const PATIENCE: Duration = Duration::from_secs(60);
/// A frame that is due anyway need not be asked for, and then nobody is woken.
const A_WHILE: Duration = Duration::from_millis(20);

/// A window with its far end.
struct Window {
    harness: Harness<'static, App>,
    far: Endpoint,
    /// Clicks, drags, keys and words so far.
    gestures: usize,
    /// A worker has something for the window.
    woken: Receiver<()>,
}

/// What other threads than this one ask the window for.
fn wakes(ctx: &egui::Context) -> Receiver<()> {
    let (wakes, woken) = sync_channel(1);
    let own = thread::current().id();
    ctx.set_request_repaint_callback(move |_| {
        if thread::current().id() != own {
            // one that has not been seen yet is enough
            let _full = wakes.try_send(());
        }
    });
    woken
}

impl Window {
    fn open(text: &str) -> Self {
        Self::open_with(text, vec2(1280.0, 800.0), None)
    }

    /// A window of some size that remembers an earlier one.
    fn open_with(text: &str, size: Vec2, storage: Option<&'static dyn eframe::Storage>) -> Self {
        Self::open_over(text, size, storage, assets::demo_terrain())
    }

    /// The same over some ground.
    fn open_over(
        text: &str,
        size: Vec2,
        storage: Option<&'static dyn eframe::Storage>,
        ground: Arc<dyn terrain::Terrain>,
    ) -> Self {
        Self::open_stepping(text, size, storage, ground, 1.0 / 60.0)
    }

    /// The same, with so many seconds from frame to frame.
    fn open_stepping(
        text: &str,
        size: Vec2,
        storage: Option<&'static dyn eframe::Storage>,
        ground: Arc<dyn terrain::Terrain>,
        step_s: f32,
    ) -> Self {
        Self::open_linked(text, size, storage, ground, step_s, Links::pair())
    }

    /// The same over these links.
    fn open_linked(
        text: &str,
        size: Vec2,
        storage: Option<&'static dyn eframe::Storage>,
        ground: Arc<dyn terrain::Terrain>,
        step_s: f32,
        (links, far): (Links, Endpoint),
    ) -> Self {
        let document = Document::read(text.as_bytes(), None);
        let builder = Harness::builder().with_size(size).with_step_dt(step_s);
        let harness = builder.renderer(Raster::default()).build_eframe(move |creation| {
            creation.storage = storage;
            let mut app = App::new(creation, document, links, ground).unwrap();
            app.tell_time_by(|| jiff::Timestamp::constant(1_790_000_000, 0));
            app
        });
        let woken = wakes(&harness.ctx);
        Self { harness, far, gestures: 0, woken }
    }

    /// What the window looks like now, compared with the kept picture of that name; `LEGWORK_BLESS=1` keeps this one.
    fn picture(&mut self, name: &str) {
        let picture = pictures::halved(&self.harness.render().unwrap());
        check_picture(&picture, &format!("tests/pictures/{name}.png"));
    }

    /// The same in full size, for the guide.
    fn guide_picture(&mut self, name: &str) {
        let picture = self.harness.render().unwrap();
        check_picture(&picture, &format!("../assets/docs/pictures/{name}.png"));
    }

    fn app(&self) -> &App {
        self.harness.state()
    }

    /// So many frames, and those until what was begun in the background by then is there.
    fn steps(&mut self, steps: usize) {
        self.harness.run_steps(steps);
        let deadline = Instant::now() + PATIENCE;
        while self.app().is_busy() {
            assert!(Instant::now() < deadline, "something in the background does not end");
            self.wait();
            if !self.app().is_busy() {
                // what came of it is drawn
                (0..2).for_each(|_| self.held_frame());
            }
        }
    }

    /// Draws until something is so; the workers behind the window take their time, its clock stands still meanwhile.
    fn until(&mut self, what: &str, condition: impl Fn(&App) -> bool) {
        let deadline = Instant::now() + PATIENCE;
        while !condition(self.app()) {
            assert!(Instant::now() < deadline, "waited in vain: {what}");
            self.wait();
        }
        self.steps(2);
    }

    /// Until a worker asks for a frame, or a while is over; then there is one.
    fn wait(&mut self) {
        let _woken = self.woken.recv_timeout(A_WHILE);
        self.held_frame();
    }

    /// A frame in which no time passes: how long a worker takes is not to be seen.
    fn held_frame(&mut self) {
        let held = self.harness.input_mut().time;
        self.stop_clock(0.0);
        self.harness.step();
        self.harness.input_mut().time = held;
    }

    /// From so many seconds from now on no time passes, until [`Self::start_clock`].
    fn stop_clock(&mut self, in_s: f64) {
        let now_s = self.harness.ctx.input(|i| i.time);
        self.harness.input_mut().time = Some(now_s + in_s);
    }

    /// A frame takes its time again.
    fn start_clock(&mut self) {
        self.harness.input_mut().time = None;
    }

    /// The present version was checked whole, hashed and previewed.
    fn until_analysed(&mut self) {
        self.until("analysis", |app| {
            app.analysis().version == app.document().version() && app.analysis().is_complete
        });
    }

    fn click(&mut self, label: &str) {
        self.gestures += 1;
        self.harness.get_by_label(label).click();
        self.steps(3);
    }

    fn shows(&self, label: &str) -> bool {
        self.harness.query_all_by_label_contains(label).next().is_some()
    }

    fn is_enabled(&self, label: &str) -> bool {
        !self.harness.get_by_label(label).accesskit_node().is_disabled()
    }

    /// Clicks a place of the screen.
    fn click_at(&mut self, at: Pos2) {
        self.gestures += 1;
        self.harness.hover_at(at);
        self.steps(1);
        self.harness.drag_at(at);
        self.steps(1);
        self.harness.drop_at(at);
        self.steps(3);
    }

    /// Clicks a place of the screen with the right button.
    fn right_click_at(&mut self, at: Pos2) {
        self.gestures += 1;
        self.harness.hover_at(at);
        self.steps(1);
        for pressed in [true, false] {
            let (button, modifiers) = (egui::PointerButton::Secondary, egui::Modifiers::NONE);
            self.harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
            self.steps(1);
        }
        self.steps(3);
    }

    fn press(&mut self, key: egui::Key) {
        self.gestures += 1;
        self.harness.key_press(key);
        self.steps(3);
    }

    /// Presses a key with Ctrl, or Command on a Mac.
    fn press_ctrl(&mut self, key: egui::Key) {
        self.press_with(egui::Modifiers::COMMAND, key);
    }

    /// Presses a key with others that are held down.
    fn press_with(&mut self, modifiers: egui::Modifiers, key: egui::Key) {
        self.gestures += 1;
        self.harness.key_press_modifiers(modifiers, key);
        self.steps(3);
    }

    /// The present plan.
    fn plan(&self) -> flight_plan::FlightPlan {
        self.app().document().plan().as_ref().clone()
    }

    /// What is selected, by its identifier.
    fn selected(&self) -> String {
        self.app().view().selection.as_ref().map(|s| s.id().to_string()).unwrap_or_default()
    }

    /// Sentences of the errors of the present plan.
    fn errors(&self) -> Vec<String> {
        let problems = &self.app().analysis().problems;
        problems.iter().filter(|p| p.is_error()).map(ToString::to_string).collect()
    }

    fn centre(&self, label: &str) -> Pos2 {
        self.harness.get_by_label(label).rect().center()
    }

    /// Presses, moves in a few steps, lets go.
    fn drag(&mut self, from: Pos2, by: Vec2) {
        self.gestures += 1;
        self.harness.hover_at(from);
        self.harness.drag_at(from);
        for part in 1..=5 {
            self.harness.hover_at(from + by * (part as f32 / 5.0));
        }
        self.harness.drop_at(from + by);
        self.steps(4);
    }

    /// Presses and holds for so many frames of a sixtieth of a second.
    fn hold(&mut self, label: &str, frames: usize) {
        self.press_for(self.centre(label), frames);
    }

    /// The same at a place of the screen, whatever is there by then.
    fn press_for(&mut self, at: Pos2, frames: usize) {
        self.harness.hover_at(at);
        self.harness.drag_at(at);
        self.steps(frames);
        self.harness.drop_at(at);
        self.steps(3);
    }
}

fn check_picture(picture: &image::RgbaImage, path: &str) {
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    if let Err(mismatch) = pictures::check(picture, path.as_ref(), env!("CARGO_TARGET_TMPDIR").as_ref()) {
        panic!("{mismatch}");
    }
}
