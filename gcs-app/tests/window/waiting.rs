//! The window never waits: whatever is slow (the ground, a disk, the home, a server) is held fast here, and frames go on.

use super::dock::Memory;
use super::filing::window_on;
use super::interchange::drop_file;
use super::{SQUARE, Window};
use eframe::App as _;
use egui::vec2;
use egui_kittest::kittest::Queryable;
use gcs_app::app::App;
use gcs_app::assets;
use gcs_app::files::Disk;
use gcs_app::layers::State;
use gcs_app::link::{LinkEvent, LinkState};
use geometry::LatLon;
use std::io::Read;
use std::net::TcpListener;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::task::Poll;
use std::thread::ThreadId;
use std::time::Duration;
use terrain::Terrain;

/// Elevations on a disk that gives none before the gate is opened. The window's own thread must not wait for them.
struct Held {
    window: ThreadId,
    gate: Arc<(Mutex<bool>, Condvar)>,
    ground: Arc<dyn Terrain>,
}

impl Terrain for Held {
    fn elevation_m(&self, at: LatLon) -> Option<f64> {
        let (is_open, changed) = &*self.gate;
        let is_open = is_open.lock().unwrap();
        if !*is_open {
            assert_ne!(std::thread::current().id(), self.window, "the window's own thread reads elevations");
            drop(changed.wait_while(is_open, |is_open| !*is_open).unwrap());
        }
        self.ground.elevation_m(at)
    }

    fn at_once_m(&self, at: LatLon) -> Poll<Option<f64>> {
        if *self.gate.0.lock().unwrap() { Poll::Ready(self.ground.elevation_m(at)) } else { Poll::Pending }
    }
}

fn open(gate: &(Mutex<bool>, Condvar)) {
    *gate.0.lock().unwrap() = true;
    gate.1.notify_all();
}

/// A plan over that ground, and its gate.
pub fn over_held_ground(text: &str) -> (Window, Arc<(Mutex<bool>, Condvar)>) {
    let (gate, ground) = (Arc::<(Mutex<bool>, Condvar)>::default(), gcs_app::assets::demo_terrain());
    let held = Held { window: std::thread::current().id(), gate: gate.clone(), ground };
    (Window::open_over(text, vec2(1280.0, 800.0), None, Arc::new(held)), gate)
}

#[test]
fn frames_and_edits_go_on_while_the_preview_waits_for_the_ground() {
    let (mut window, gate) = over_held_ground(SQUARE);
    window.steps(10);
    window.click("TF side2");
    window.press(egui::Key::Delete);
    assert!(window.plan().leg(&"side2".into()).is_none());
    let from = window.centre("Fix A");
    window.drag(from, vec2(30.0, 10.0));
    assert!(window.centre("Fix A").distance(from) > 20.0);
    assert!(!window.app().analysis().reviewed, "the ground is held fast");
    open(&gate);
    window.until_analysed();
}

/// Nothing is said of a plan before all of it was looked at, as it is now.
#[test]
fn a_plan_is_being_checked_until_the_check_of_this_revision_is_there() {
    let (mut window, gate) = over_held_ground(SQUARE);
    window.steps(10);
    assert!(window.shows("Being checked…") && !window.shows("can be flown"));
    let set = |is_open: bool| {
        *gate.0.lock().unwrap() = is_open;
        gate.1.notify_all();
    };
    set(true);
    window.until_analysed();
    assert!(window.shows("This plan can be flown") && !window.shows("Being checked…"));
    set(false);
    let from = window.centre("Fix A");
    window.drag(from, vec2(30.0, 10.0));
    assert!(window.shows("Being checked…") && !window.shows("can be flown"), "another revision");
    set(true);
    window.until_analysed();
    assert!(window.shows("This plan can be flown"));
}

/// Legs without a forecast are not legs in error.
#[test]
fn the_table_says_that_a_sound_plan_is_still_being_looked_at() {
    let (mut window, gate) = over_held_ground(SQUARE);
    super::fleet::tab(&mut window, "Table");
    window.steps(3);
    assert!(window.shows("Not flown yet. The preview is being computed"));
    assert!(!window.shows("the plan has an error"));
    open(&gate);
    window.until_analysed();
    assert!(!window.shows("Not flown yet"));
}

/// Whatever the ground does: a leg that is drawn is tried out over it in the background.
#[test]
fn drawing_goes_on_while_the_trial_of_a_leg_waits_for_the_ground() {
    let (mut window, gate) = over_held_ground(SQUARE);
    window.harness.run_steps(10);
    window.harness.key_press(egui::Key::T);
    window.harness.run_steps(2);
    let at = window.centre("Map");
    // none of these frames can wait for the trial: it does not end before they are over
    for number in 0..30 {
        window.harness.hover_at(at + vec2(number as f32, 40.0));
        window.harness.run_steps(1);
    }
    assert!(window.app().is_busy(), "it is being tried out");
    let legs = window.plan().all_legs().len();
    window.harness.drag_at(at + vec2(30.0, 40.0));
    window.harness.run_steps(1);
    window.harness.drop_at(at + vec2(30.0, 40.0));
    window.harness.run_steps(3);
    assert_eq!(window.plan().all_legs().len(), legs + 1, "a click draws it all the same");
    open(&gate);
    window.harness.hover_at(at + vec2(60.0, 60.0));
    window.steps(3);
    assert!(!window.app().is_busy(), "it was tried out");
    assert!(window.shows("ext leg"), "what came of it is said");
}

/// What is asked of the ground in a frame: below the pointer, in a menu, for a runway that is drawn, and below an aircraft.
#[test]
fn frames_go_on_while_elevations_are_read() {
    let (mut window, gate) = over_held_ground(SQUARE);
    window.steps(10);
    let at = window.centre("Map") + vec2(60.0, 120.0);
    window.harness.hover_at(at);
    window.steps(2);
    assert!(window.paints("elevation unknown"), "below the pointer");
    window.right_click_at(at);
    assert!(window.shows("The ground is not known here"), "in the menu");
    window.press(egui::Key::Escape);
    window.receive_position(false);
    window.steps(60);
    let runways = window.plan().runways.len();
    window.press(egui::Key::R);
    window.click_at(at);
    window.click_at(at + vec2(40.0, 0.0));
    assert_eq!(window.plan().runways.len(), runways + 2, "with both directions");
    window.press(egui::Key::Escape);
    open(&gate);
    window.harness.hover_at(at + vec2(0.0, 30.0));
    window.steps(2);
    assert!(window.paints(" · ground ") && !window.paints("elevation unknown"), "it was read");
    window.until_analysed();
}

/// A new plan is made of what is known by then.
#[test]
fn a_plan_is_made_from_nothing_while_elevations_are_read() {
    let gate = Arc::<(Mutex<bool>, Condvar)>::default();
    let (thread, ground) = (std::thread::current().id(), gcs_app::assets::demo_terrain());
    let held = Held { window: thread, gate: gate.clone(), ground };
    let mut window = Window::open_over(super::creating::EMPTY, vec2(1280.0, 800.0), None, Arc::new(held));
    window.steps(3);
    window.click("Among the example's hills");
    window.click("Create");
    assert!(!window.plan().stages.is_empty());
    open(&gate);
    window.until_analysed();
}

/// Almost as long as one may be that is pasted, of far more points than may be.
fn large_drawing() -> String {
    let point =
        "<Placemark><name>n</name><Point><coordinates>-84.15,36.33,0</coordinates></Point></Placemark>";
    format!("<kml>{}</kml>", point.repeat((4 << 20) / point.len() - 1))
}

/// What is read tells so on its own thread, and frames were drawn before it did.
#[test]
fn no_frame_waits_for_a_large_drawing_that_is_pasted() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let own = std::thread::current().id();
    let others = Arc::<AtomicUsize>::default();
    let seen = others.clone();
    window.harness.ctx.set_request_repaint_callback(move |_| {
        seen.fetch_add(usize::from(std::thread::current().id() != own), Ordering::SeqCst);
    });
    window.harness.event(egui::Event::Paste(large_drawing()));
    window.harness.step();
    assert!(window.app().is_busy(), "it is being read");
    window.until("the refusal", |app| {
        app.view().notice.as_ref().is_some_and(|why| why.contains("100 can be pasted at once"))
    });
    assert!(others.load(Ordering::SeqCst) > 0, "it was read by the window's own thread");
}

/// While it was read another plan took the place of the one that it was pasted into.
#[test]
fn a_drawing_that_was_meant_for_another_plan_is_pasted_into_none() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.harness.event(egui::Event::Paste(large_drawing()));
    window.harness.step();
    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::N);
    window.harness.run_steps(2);
    assert!(window.app().is_busy() && window.plan().stages.is_empty(), "it is still being read");
    window.until("the refusal", |app| {
        app.view().notice.as_ref().is_some_and(|why| why.contains("not shown any more"))
    });
    assert!(window.plan().stages.is_empty());
}

/// A disk of which each read waits until the gate is opened. It has one long file and one that is read in many parts.
struct Slow {
    window: ThreadId,
    gate: Arc<(Mutex<bool>, Condvar)>,
    /// Reads that have begun.
    reads: Arc<AtomicUsize>,
}

impl Disk for Slow {
    fn length(&self, path: &Path) -> std::io::Result<Option<u64>> {
        assert_ne!(std::thread::current().id(), self.window, "the window's own thread asks the disk");
        Ok(Some(if path.ends_with("long.xml") { 100 << 20 } else { PARTS * PART }))
    }

    fn open(&self, path: &Path) -> std::io::Result<Box<dyn Read>> {
        assert_ne!(std::thread::current().id(), self.window, "the window's own thread opens a file");
        assert!(path.is_absolute());
        let text = std::io::Cursor::new(SQUARE).chain(std::io::repeat(b' ').take(PARTS * PART));
        Ok(Box::new(SlowFile { gate: self.gate.clone(), reads: self.reads.clone(), text }))
    }
}

/// Bytes of a file that comes in so many parts.
const PART: u64 = 1 << 20;
const PARTS: u64 = 8;

struct SlowFile<R> {
    gate: Arc<(Mutex<bool>, Condvar)>,
    reads: Arc<AtomicUsize>,
    text: R,
}

impl<R: Read> Read for SlowFile<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        self.reads.fetch_add(1, Ordering::SeqCst);
        let (is_open, changed) = &*self.gate;
        drop(changed.wait_while(is_open.lock().unwrap(), |is_open| !*is_open).unwrap());
        self.text.read(into)
    }
}

#[test]
fn frames_and_edits_go_on_while_the_disk_is_slow() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["long.xml", "plan.xml"] {
        let path = folder.path().join(file);
        std::fs::write(&path, SQUARE).unwrap();
        let (gate, reads) = (Arc::<(Mutex<bool>, Condvar)>::default(), Arc::<AtomicUsize>::default());
        let mut window = Window::open(super::creating::EMPTY);
        window.steps(3);
        let thread = std::thread::current().id();
        let slow = Slow { window: thread, gate: gate.clone(), reads: reads.clone() };
        window.harness.state_mut().use_disk(Arc::new(slow));
        drop_file(&mut window, &path);
        window.until("a read", |_| reads.load(Ordering::SeqCst) > 0);
        // none of these frames can wait for the disk: it does not answer before they are over
        window.steps(60);
        window.add_to("main plan", "Mission stage");
        assert_eq!(window.plan().stages.len(), 1);
        window.click("Undo");
        *gate.0.lock().unwrap() = true;
        gate.1.notify_all();
        match file {
            "long.xml" => window.until("the refusal", |app| {
                app.view().notice.as_ref().is_some_and(|why| why.contains("it has 100 MB, and at most 64 MB"))
            }),
            _ => window.until("the plan", |app| app.document().plan().stages.len() > 1),
        }
        assert!(file == "long.xml" || reads.load(Ordering::SeqCst) as u64 > PARTS);
    }
}

/// A pipe that nobody reads takes nothing: whoever writes into it waits.
#[cfg(unix)]
#[test]
fn frames_and_edits_go_on_while_a_plan_is_being_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.xml");
    let mut window = window_on(&path, SQUARE);
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::fs::rename(&pipe, &path).unwrap();
    let says = |window: &mut Window, words: &'static str| {
        window.until(words, |app| app.view().notice.as_ref().is_some_and(|why| why.contains(words)));
    };
    window.press_ctrl(egui::Key::S);
    says(&mut window, "was changed by another program");
    window.press_ctrl(egui::Key::S);
    // none of these frames can wait for the pipe: it takes nothing before they are over
    window.steps(60);
    window.click("TF side2");
    window.press(egui::Key::Delete);
    assert!(window.plan().leg(&"side2".into()).is_none());
    let written = std::fs::read_to_string(&path).unwrap();
    assert!(written.contains("side2"), "as it was when it was saved");
    says(&mut window, "edits made meanwhile are not in it yet");
}

/// The copy that an earlier window left in the home is a pipe: who reads it waits for somebody who writes, and the other way round.
#[cfg(unix)]
#[test]
fn frames_and_edits_go_on_while_the_home_is_slow() {
    let home = tempfile::tempdir().unwrap();
    let copy = home.path().join("0.json");
    assert!(std::process::Command::new("mkfifo").arg(&copy).status().unwrap().success());
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.harness.state_mut().keep_copies(home.path());
    // none of these frames can wait for the home: it gives nothing before they are over
    delete(&mut window, "side2");
    assert!(window.app().is_busy(), "the copy is being read");
    std::fs::write(&copy, r#"{"documents": []}"#).unwrap();
    window.steps(10);
    // nor these: now it takes nothing
    delete(&mut window, "side3");
    window.steps(200);
    let kept = std::fs::read_to_string(&copy).unwrap();
    assert!(kept.contains("side1") && !kept.contains("side2"), "{kept}");
    // what is kept from here on is kept in a file
    std::fs::remove_file(&copy).unwrap();
}

/// The window's library waits for its last write before the next one: there must be none before the disk has taken it.
#[test]
fn settings_are_not_written_again_before_the_home_has_taken_them() {
    let gate = Arc::<(Mutex<bool>, Condvar)>::default();
    let held = gate.clone();
    let sync = move || {
        let (is_open, changed) = &*held;
        drop(changed.wait_while(is_open.lock().unwrap(), |is_open| !*is_open).unwrap());
    };
    let mut window = Window::open(SQUARE);
    window.harness.state_mut().sync_settings_by(Arc::new(sync));
    let is_saved_again = |app: &App| app.auto_save_interval() < Duration::MAX;
    assert!(is_saved_again(window.app()));
    Memory::of(&mut window);
    window.steps(60);
    assert!(!is_saved_again(window.app()));
    open(&gate);
    window.until("the disk has taken them", is_saved_again);
}

/// Deletes a leg, whatever is being done in the background.
fn delete(window: &mut Window, leg: &str) {
    window.harness.get_by_label(&format!("TF {leg}")).click();
    window.harness.run_steps(3);
    window.harness.key_press(egui::Key::Delete);
    window.harness.run_steps(60);
    assert!(window.plan().leg(&leg.into()).is_none());
}

#[test]
fn frames_go_on_while_a_server_of_tiles_does_not_answer() {
    let silent = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/{{z}}/{{x}}/{{y}}.png", silent.local_addr().unwrap());
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("Legwork");
    window.click("Maps");
    window.click("Maps and elevations…");
    window.click("From a server");
    window.steps(30);
    assert!(!window.is_enabled("Add the server"));
    for (hint, text) in
        [("https://server/{z}/{x}/{y}.png", address.as_str()), ("Whom the map has to name", "Somebody")]
    {
        window.harness.get_by_role_and_label(egui::accesskit::Role::TextInput, hint).focus();
        window.steps(2);
        window.harness.event(egui::Event::Text(text.into()));
        window.steps(2);
    }
    window.click("Add the server");
    let is_ready = |app: &gcs_app::app::App| app.layers().iter().any(|l| matches!(l.state, State::Map(..)));
    window.until("a reader of tiles", is_ready);
    window.steps(20);
    // it was asked, and has all of its time to answer
    let asked = silent.accept().unwrap();
    window.steps(20);
    let layer = window.app().layers().iter().next().unwrap();
    assert_eq!(
        (layer.name(), window.app().map().pictures_of(layer.id)),
        (silent.local_addr().unwrap().to_string(), 0)
    );
    assert!(window.app().view().notice.is_none());
    assert!(window.paints("Somebody") && !window.paints("(offline)"), "the map names them");
    // it goes away
    drop((asked, silent));
    window.until("it is offline", |app| app.layers().attributions().any(|whom| whom == "Somebody (offline)"));
    assert!(window.paints("Somebody (offline)"));
}

#[test]
fn the_clock_goes_on_in_a_window_that_nobody_touches() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.steps(200);
    let delay = longest_delay(&window);
    assert!(delay > Duration::ZERO && delay <= Duration::from_secs(60), "no vehicle, no seconds: {delay:?}");
    window.receive_position(true);
    window.send(LinkEvent::Link(LinkState::Off));
    window.steps(200);
    let delay = longest_delay(&window);
    assert!(delay > Duration::ZERO && delay <= Duration::from_secs(1), "what is known grows old: {delay:?}");
    let viewport = window.harness.ctx.viewport_id();
    window.harness.input_mut().viewports.entry(viewport).or_default().minimized = Some(true);
    window.steps(5);
    assert!(longest_delay(&window) > Duration::from_secs(60), "nobody sees it");
}

/// A way to look at the window, and what is done for it.
type Look = (&'static str, fn(&mut Window));

/// Whoever asks for a frame asks the whole window to be drawn: in one that nobody touches it is the clock alone, at each full minute.
#[test]
fn nobody_asks_an_idle_window_for_a_frame() {
    let clock = Duration::from_secs(60 - 1_790_000_000 % 60);
    let size = vec2(1280.0, 800.0);
    let mut window =
        Window::open_stepping(super::whatif::FIRE_WATCH, size, None, assets::demo_terrain(), 0.1);
    window.until_analysed();
    let looks: [Look; 6] = [
        ("settled", |_| ()),
        ("a leg is selected", |w| w.select_row(("TF To the gap", 0))),
        ("the table", |w| super::fleet::tab(w, "Table")),
        ("what if", |w| super::fleet::tab(w, "What if")),
        ("a tool", |w| w.press(egui::Key::T)),
        ("the palette, where a field has the keyboard", |w| w.ask_for("fit")),
    ];
    for (what, look) in looks {
        look(&mut window);
        window.until_analysed();
        // messages go by themselves, tooltips and what comes into sight take their time: ten seconds
        window.steps(100);
        let asked = Arc::<Mutex<Vec<Duration>>>::default();
        let seen = asked.clone();
        window.harness.ctx.set_request_repaint_callback(move |info| seen.lock().unwrap().push(info.delay));
        window.harness.run_steps(50);
        window.harness.ctx.set_request_repaint_callback(|_| ());
        // a cursor that blinks is drawn by egui
        let least = if window.harness.ctx.text_edit_focused() { Duration::from_millis(50) } else { clock };
        let asked = asked.lock().unwrap();
        let sooner: Vec<_> = asked.iter().filter(|delay| **delay < least).collect();
        let causes = window.harness.ctx.repaint_causes();
        assert!(sooner.is_empty(), "{what}: {sooner:?} {causes:?}");
    }
}

/// How long the window rests if nothing happens.
fn longest_delay(window: &Window) -> Duration {
    let delays = window.harness.output().viewport_output.values().map(|out| out.repaint_delay);
    delays.max().expect("a viewport")
}
