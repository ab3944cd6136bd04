//! A window that is killed, and the next one.

use super::vehicle::status;
use super::{SQUARE, Window};
use egui_kittest::kittest::Queryable;
use flight_exec::{Command, Phase};
use flight_plan::FlightPlan;
use gcs_app::link::Call;
use std::path::Path;

pub fn window_in(folder: &Path, text: &str) -> Window {
    let mut window = Window::open(text);
    window.keep_copies(folder);
    window
}

impl Window {
    /// Keeps copies in this folder, and asks about what was left there.
    pub fn keep_copies(&mut self, folder: &Path) {
        self.harness.state_mut().keep_copies(folder);
        self.until("what was left there", |app| !app.is_busy());
    }
}

/// Deletes a leg; the window is gone without being closed.
pub fn edit_and_kill(folder: &Path) -> FlightPlan {
    let mut window = window_in(folder, SQUARE);
    window.click("TF side2");
    window.press(egui::Key::Delete);
    let plan = window.plan();
    assert!(plan.leg(&"side2".into()).is_none());
    plan
}

#[test]
fn killed_window_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let lost = edit_and_kill(folder.path());
    let mut window = window_in(folder.path(), "");
    assert!(window.shows("ended without saving") && window.shows("• “Square circuit”, without a file"));
    assert!(window.shows("last changed 20"), "with the day and the time of it");
    window.press(egui::Key::Enter);
    assert_eq!(window.plan(), lost);
    assert!(window.app().document().is_dirty() && !window.shows("ended without saving"));
    drop(window);
    // killed again, before it was saved
    assert!(window_in(folder.path(), "").shows("ended without saving"));
}

#[test]
fn the_question_says_when_the_last_change_was_made_however_often_it_was_copied() {
    let folder = tempfile::tempdir().unwrap();
    edit_and_kill(folder.path());
    let copy = folder.path().join("0.json");
    let mut kept: serde_json::Value = serde_json::from_slice(&std::fs::read(&copy).unwrap()).unwrap();
    kept["documents"][0]["changed_unix_s"] = 1_790_000_000_u64.into();
    std::fs::write(&copy, kept.to_string()).unwrap();
    let said = "last changed 2026-09-21 14:13 UTC, ";
    let mut window = window_in(folder.path(), "");
    assert!(window.shows(said));
    window.click("Recover the changes");
    drop(window);
    assert!(window_in(folder.path(), "").shows(said), "recovered and lost again");
}

#[test]
fn what_is_not_wanted_is_not_offered_again() {
    let folder = tempfile::tempdir().unwrap();
    edit_and_kill(folder.path());
    let mut window = window_in(folder.path(), SQUARE);
    window.click("Delete them (hold)");
    assert!(window.shows("ended without saving"), "a click is not enough for what no undo brings back");
    window.hold("Delete them (hold)", 90);
    assert!(!window.app().document().is_dirty());
    drop(window);
    assert!(!window_in(folder.path(), "").shows("ended without saving"));
}

/// Two plans were lost: each has its name, its age and its own buttons, and the other one waits.
#[test]
fn each_of_several_plans_is_recovered_or_deleted_by_itself() {
    let folder = tempfile::tempdir().unwrap();
    edit_and_kill(folder.path());
    let copy = folder.path().join("0.json");
    let mut kept: serde_json::Value = serde_json::from_slice(&std::fs::read(&copy).unwrap()).unwrap();
    let (first, now_s) = (kept["documents"][0].clone(), 1_790_000_000_u64);
    let mut other = first.clone();
    other["name"] = "Ridge".into();
    other["changed_unix_s"] = (now_s - 3665).into();
    kept["documents"] = serde_json::Value::Array(vec![first, other]);
    std::fs::write(&copy, kept.to_string()).unwrap();
    let mut window = window_in(folder.path(), "");
    assert!(window.shows("• “Square circuit”") && window.shows("• “Ridge”"));
    assert!(window.shows("13:12 UTC, 1:01:05 ago") && window.shows("Recover all opens the first one"));
    // whole in the least window, too
    window.harness.set_size(egui::vec2(960.0, 600.0));
    window.steps(3);
    let map = window.harness.get_by_label("Map").rect();
    for part in ["The last window ended without saving", "Recover all", "Delete all (hold)", "Later"] {
        let rect = window.harness.get_by_label(part).rect();
        assert!(map.contains_rect(rect), "{part}: {rect} in {map}");
    }
    window.harness.set_size(egui::vec2(1280.0, 800.0));
    window.steps(3);
    let second = |window: &Window, name: &str| {
        let mut found: Vec<_> = window.harness.query_all_by_label(name).map(|b| b.rect().center()).collect();
        found.sort_by(|a, b| a.y.total_cmp(&b.y));
        found[1]
    };
    let at = second(&window, "Recover");
    window.click_at(at);
    assert!(window.app().document().is_dirty());
    assert!(window.shows("• “Square circuit”") && !window.shows("• “Ridge”"), "the other one waits");
    drop(window);
    // the one that was recovered was not saved, either
    let mut window = window_in(folder.path(), "");
    assert!(window.shows("Delete all (hold)"));
    let at = second(&window, "Delete (hold)");
    window.harness.hover_at(at);
    window.harness.drag_at(at);
    window.steps(90);
    window.harness.drop_at(at);
    window.steps(3);
    assert!(window.shows("Recover the changes") && !window.shows("Recover all"), "one is left");
}

#[test]
fn copies_that_cannot_be_kept_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let mut window = window_in(&file, SQUARE);
    assert!(window.shows("No copy of unsaved changes"));
    window.click("TF side2");
    assert_eq!(window.selected(), "side2");
}

/// The next window, over a vehicle that flies.
fn watching_a_flight(folder: &Path) -> Window {
    let mut window = window_in(folder, "");
    window.connect();
    let mut value = status(Phase::Flying);
    value.plan = Some("the plan that is aboard".into());
    window.receive_position(false);
    window.receive_status(value);
    while window.asked().is_some() {}
    window
}

#[test]
fn the_question_hides_no_command_of_a_flight_and_takes_no_key() {
    let folder = tempfile::tempdir().unwrap();
    let lost = edit_and_kill(folder.path());
    let mut window = watching_a_flight(folder.path());
    let of = |part: &str| window.harness.query_all_by_label_contains(part).next().unwrap().rect();
    let question = of("ended without saving").union(of("Recover the changes")).union(of("Later"));
    let emergency = window.harness.get_by_label("Emergency: fly the alternate in force (hold)").rect();
    assert!(!question.intersects(emergency));
    window.press(egui::Key::Enter);
    assert!(window.shows("ended without saving"), "Return is meant for something else");
    window.click("Recover the changes");
    assert!(window.plan() == lost && !window.shows("ended without saving"));
    drop(window);

    let mut window = watching_a_flight(folder.path());
    window.click("⏸ Hold");
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(Command::Hold)));
    assert!(window.shows("ended without saving"));
}

#[test]
fn the_question_can_wait_for_the_menu_or_the_next_window() {
    let folder = tempfile::tempdir().unwrap();
    let lost = edit_and_kill(folder.path());
    let mut window = window_in(folder.path(), "");
    window.press(egui::Key::Escape);
    assert!(!window.shows("ended without saving"));
    window.click("Legwork");
    window.click("Recover unsaved changes…");
    window.click("Later");
    assert!(!window.shows("ended without saving"));
    drop(window);
    let mut next = window_in(folder.path(), "");
    next.click("Recover the changes");
    assert_eq!(next.plan(), lost);
}

/// In a small window its card lay below that for a new mission once that was clicked, and its button with it.
#[test]
fn the_question_stays_above_the_card_for_a_new_mission() {
    let folder = tempfile::tempdir().unwrap();
    let lost = edit_and_kill(folder.path());
    let mut window = Window::open_with("", egui::vec2(960.0, 600.0), None);
    window.keep_copies(folder.path());
    window.click("Among the example's hills");
    let corridor = window.centre("Corridor");
    window.click_at(corridor);
    let button = window.harness.get_by_label("Recover the changes").rect();
    window.click_at(button.left_center() + egui::vec2(6.0, 0.0));
    assert!(window.plan() == lost && !window.shows("ended without saving"));
}
