//! The window never waits: whatever is slow (the ground, a server) is held fast here, and frames go on.

use super::{SQUARE, Window};
use egui::vec2;
use egui_kittest::kittest::Queryable;
use gcs_app::layers::State;
use geometry::LatLon;
use std::net::TcpListener;
use std::sync::{Arc, Condvar, Mutex};
use std::thread::ThreadId;
use std::time::Duration;
use terrain::Terrain;

/// Elevations that nobody but the window's own thread gets until the gate is opened.
struct Held {
    window: ThreadId,
    gate: Arc<(Mutex<bool>, Condvar)>,
    ground: Arc<dyn Terrain>,
}

impl Terrain for Held {
    fn elevation_m(&self, at: LatLon) -> Option<f64> {
        if std::thread::current().id() != self.window {
            let (is_open, changed) = &*self.gate;
            drop(changed.wait_while(is_open.lock().unwrap(), |is_open| !*is_open).unwrap());
        }
        self.ground.elevation_m(at)
    }
}

#[test]
fn frames_and_edits_go_on_while_the_preview_waits_for_the_ground() {
    let gate = Arc::<(Mutex<bool>, Condvar)>::default();
    let held = Held {
        window: std::thread::current().id(),
        gate: gate.clone(),
        ground: gcs_app::assets::demo_terrain(),
    };
    let mut window = Window::open_over(SQUARE, vec2(1280.0, 800.0), None, Arc::new(held));
    window.steps(10);
    window.click("TF side2");
    window.press(egui::Key::Delete);
    assert!(window.plan().leg(&"side2".into()).is_none());
    let from = window.centre("Fix A");
    window.drag(from, vec2(30.0, 10.0));
    assert!(window.centre("Fix A").distance(from) > 20.0);
    assert!(!window.app().analysis().reviewed, "the ground is held fast");
    *gate.0.lock().unwrap() = true;
    gate.1.notify_all();
    window.until_analysed();
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
    let _asked = silent.accept().unwrap();
    window.steps(20);
    let layer = window.app().layers().iter().next().unwrap();
    assert_eq!(
        (layer.name(), window.app().map().pictures_of(layer.id)),
        (silent.local_addr().unwrap().to_string(), 0)
    );
    assert!(window.app().view().notice.is_none());
}

#[test]
fn the_clock_goes_on_in_a_window_that_nobody_touches() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.steps(200);
    let delays = |window: &Window| -> Vec<_> {
        window.harness.output().viewport_output.values().map(|out| out.repaint_delay).collect()
    };
    let [delay] = delays(&window)[..] else { panic!("one viewport") };
    assert!(delay > Duration::ZERO && delay <= Duration::from_secs(1), "{delay:?}");
    let viewport = window.harness.ctx.viewport_id();
    window.harness.input_mut().viewports.entry(viewport).or_default().minimized = Some(true);
    window.steps(5);
    assert!(delays(&window).iter().all(|delay| *delay > Duration::from_secs(1)), "nobody sees it");
}
