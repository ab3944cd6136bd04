//! The commands of the flight are in the window and nothing is drawn over them, at every size and whatever is open.

use super::emergency::in_emergency;
use super::filing::{name, until_listed, window_on};
use super::flying::{connected, fly_its_plan, flying, report};
use super::interchange::{fixture, until_imported};
use super::vehicle::{decision, status};
use super::{SQUARE, Window};
use egui::{Key, Order, Pos2, Rect, Vec2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_exec::Phase;
use gcs_app::link::Reply;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const SIZES: [Vec2; 3] = [vec2(960.0, 600.0), vec2(1280.0, 800.0), vec2(1920.0, 1080.0)];

/// Its buttons are all of it on the screen, and a click there meets no other layer.
fn assert_in_reach(window: &Window, size: Vec2, labels: &[&str], state: &str) {
    let ctx = window.harness.ctx.clone();
    for label in labels {
        let node = window.harness.query_all_by_label_contains(label).find(is_button);
        let rect = node.unwrap_or_else(|| panic!("{label}: {state} at {size}")).rect();
        let screen = Rect::from_min_size(Pos2::ZERO, size);
        assert!(screen.contains_rect(rect) && rect.is_positive(), "{label} at {rect}: {state} at {size}");
        let inside = rect.shrink(1.0);
        for at in [
            inside.center(),
            inside.left_top(),
            inside.right_top(),
            inside.left_bottom(),
            inside.right_bottom(),
        ] {
            let order = ctx.layer_id_at(at).map(|layer| layer.order);
            assert_eq!(order, Some(Order::Background), "{label} is covered at {at}: {state} at {size}");
        }
    }
}

fn is_button(node: &egui_kittest::Node<'_>) -> bool {
    node.accesskit_node().role() == egui::accesskit::Role::Button
}

/// A file that is dropped onto the window and can't be read.
#[derive(Debug)]
pub struct Missing(pub PathBuf);

impl egui::DroppedFile for Missing {
    fn path(&self) -> &Path {
        &self.0
    }
    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("missing".into())
    }
}

/// With a long text above everything.
fn with_notice(window: &mut Window) {
    let missing = Missing(PathBuf::from(format!("/{}", "missing/".repeat(40))));
    window.harness.input_mut().dropped_files.push(Arc::new(missing));
    window.until("notice", |app| app.view().notice.is_some());
}

#[test]
fn commands_in_flight_are_in_reach_whatever_is_open() {
    let labels = ["⏸ Hold", "Skip leg", "Emergency: fly"];
    for size in SIZES {
        let (mut window, mut value) = flying();
        value.plan = Some("another".into());
        value.decision = Some(decision(Some("again")));
        window.harness.set_size(size);
        window.receive_status(value);
        window.steps(5);
        while window.asked().is_some() {}
        assert_in_reach(&window, size, &labels, "a decision is asked for");
        window.click("Push");
        let (ticket, _) = window.asked().unwrap();
        let mut refused = report(&window.app().analysis().hash.clone(), false);
        refused.problems = vec!["a rather long sentence that says what is wrong with it".into(); 40];
        window.answer(ticket, Ok(Reply::Proposal(Box::new(refused))));
        window.steps(5);
        assert_in_reach(&window, size, &labels, "a proposal is shown");
        with_notice(&mut window);
        assert_in_reach(&window, size, &labels, "a notice is shown");
        window.click("⏸ Hold");
        let (ticket, _) = window.asked().unwrap();
        window.answer(ticket, Err("a long refusal, ".repeat(12)));
        window.steps(5);
        assert_in_reach(&window, size, &labels, "a refusal is shown");
    }
}

#[test]
fn commands_in_flight_are_in_reach_while_something_is_read_or_looked_up() {
    let labels = ["⏸ Hold", "Skip leg", "Emergency: fly"];
    for size in SIZES {
        let (mut window, _) = flying();
        window.harness.set_size(size);
        window.press(Key::F1);
        window.steps(5);
        assert!(window.shows("Search the help"));
        assert_in_reach(&window, size, &labels, "the help is open");
        window.press(Key::Escape);
        ["Legwork", "Maps", "Maps and elevations…"].iter().for_each(|name| window.click(name));
        window.steps(5);
        assert!(window.shows("Range rings"));
        assert_in_reach(&window, size, &labels, "the maps are listed");
        window.press_ctrl(Key::K);
        window.steps(5);
        assert_in_reach(&window, size, &labels, "the palette is open");
    }
}

/// Another program may write the plan's file in flight: nobody answers that before he may hold the aircraft.
#[test]
fn commands_in_flight_are_in_reach_while_a_question_of_a_file_waits() {
    let labels = ["⏸ Hold", "Skip leg", "Emergency: fly"];
    for size in SIZES {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shared.xml");
        let mut window = window_on(&path, SQUARE);
        window.until_analysed();
        fly_its_plan(&mut window);
        window.harness.set_size(size);
        std::fs::write(&path, SQUARE.replace("side2", "their-side")).unwrap();
        window.until("question", |app| app.view().changed_outside.is_some());
        window.steps(5);
        assert!(window.shows("Another program has changed shared.xml"));
        assert_in_reach(&window, size, &labels, "another program has changed the file");
        window.click("Keep mine");
        window.press_ctrl(Key::N);
        window.steps(5);
        assert!(window.app().view().unsaved.is_some());
        assert_in_reach(&window, size, &labels, "what is unsaved is asked about");
        window.press(Key::Escape);
        window.press_ctrl(Key::S);
        window.until("saved", |app| !app.document().is_dirty());
        window.press_ctrl(Key::O);
        until_listed(&mut window);
        window.steps(5);
        assert_in_reach(&window, size, &labels, "a file is chosen");
        name(&mut window, &fixture("survey.plan"));
        window.click("Open");
        until_imported(&mut window);
        assert_in_reach(&window, size, &labels, "an import is looked through");
    }
}

#[test]
fn commands_in_an_emergency_are_in_reach() {
    for size in SIZES {
        let mut window = in_emergency();
        window.harness.set_size(size);
        window.steps(5);
        assert_in_reach(&window, size, &["⏸ Hold", "Emergency: fly", "Return to the main plan"], "emergency");
    }
}

#[test]
fn start_is_in_reach() {
    for size in SIZES {
        let (mut window, hash) = connected();
        window.harness.set_size(size);
        let mut value = status(Phase::Idle);
        value.plan = Some(hash.into());
        window.receive_status(value);
        window.steps(5);
        assert_in_reach(&window, size, &["Start and take off"], "on the ground");
    }
}

#[test]
fn commands_stay_clear_of_the_map_and_so_of_the_aircraft() {
    let mut window = Window::open_with(SQUARE, SIZES[0], None);
    window.until_analysed();
    window.connect();
    window.receive_position(false);
    window.receive_status(status(Phase::Flying));
    window.steps(5);
    let map = window.harness.get_by_label("Map").rect();
    let hold = window.harness.get_by_label("⏸ Hold").rect();
    assert!(!map.intersects(hold), "{map} {hold}");
}
