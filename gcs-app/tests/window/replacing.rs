//! Another plan takes the place of the one that is shown: what is kept of that, and what is not.

use super::creating::{SIZE, begun};
use super::filing::{edit, name, open, until_listed, window, window_on};
use super::interchange::{fixture, until_imported};
use super::{SQUARE, Window};
use egui::{Key, vec2};
use gcs_app::files::Stamp;

#[test]
fn what_was_discarded_is_not_asked_about_again() {
    let mut window = begun(SIZE);
    window.click("Create");
    window.press_ctrl(Key::N);
    window.click("Discard the changes");
    window.press_ctrl(Key::Q);
    assert!(!window.shows("unsaved changes") && window.app().is_leaving());
}

/// Nobody said that they need not be kept: undo brings them back.
#[test]
fn an_import_gives_up_no_changes_of_the_plan_that_it_takes_the_place_of() {
    let mut window = window(SQUARE);
    edit(&mut window);
    window.click("Legwork");
    window.click("Import…");
    until_listed(&mut window);
    name(&mut window, &fixture("survey.plan"));
    window.click("Open");
    until_imported(&mut window);
    window.click("Import the plan");
    window.press_ctrl(Key::Q);
    assert!(window.shows("2 plans have unsaved changes") && !window.app().is_leaving());
}

#[test]
fn another_plan_begins_without_what_was_tried_with_the_last() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.press(Key::Space);
    window.right_click_at(window.centre("Map") + vec2(90.0, 60.0));
    assert!(window.app().view().cursor_s.is_some() && window.shows("Make a fix here"));
    window.press_ctrl(Key::N);
    let view = window.app().view();
    assert!(view.cursor_s.is_none() && !view.playing && view.what_if == Default::default());
    assert!(!window.shows("Make a fix here"));
}

#[test]
fn a_saved_plan_that_was_undone_and_redone_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("first.xml"), folder.path().join("second.xml"));
    std::fs::write(&second, SQUARE.replace("side2", "other")).unwrap();
    let mut window = window_on(&first, SQUARE);
    edit(&mut window);
    window.press_ctrl(Key::S);
    window.until("saved", |app| !app.document().is_dirty());
    open(&mut window, &second);
    for key in [Key::Z, Key::Z, Key::Y, Key::Y] {
        window.press_ctrl(key);
    }
    assert_eq!(window.app().document().path(), Some(second.as_path()));
    window.press_ctrl(Key::Q);
    assert!(window.app().is_leaving() && !window.shows("unsaved changes"));
}

#[test]
fn a_file_that_only_this_window_has_saved_was_changed_by_no_other_program() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.xml");
    let mut window = window_on(&path, SQUARE);
    let first = window.app().document().id();
    open(&mut window, &path);
    window.until("opened again", |app| app.document().id() != first);
    edit(&mut window);
    window.press_ctrl(Key::S);
    window.until("saved", |app| !app.document().is_dirty());
    let saved = std::fs::read_to_string(&path).unwrap();
    window.press_ctrl(Key::Z);
    window.press_ctrl(Key::Z);
    let document = window.app().document();
    assert!(document.id() == first && document.is_dirty());
    assert_eq!(document.stamp(), Stamp::of(&path), "nobody else wrote it");
    window.press_ctrl(Key::S);
    until_listed(&mut window);
    assert!(window.shows("saved from this window since"));
    window.press(Key::Escape);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), saved);
    window.press_ctrl(Key::Y);
    window.press_ctrl(Key::Y);
    window.press_ctrl(Key::Q);
    assert!(window.app().is_leaving() && !window.shows("unsaved changes"));
}

#[test]
fn what_is_typed_at_once_takes_the_place_of_the_name_and_not_of_the_format() {
    let mut window = window(SQUARE);
    window.press_ctrl(Key::S);
    until_listed(&mut window);
    window.steps(2);
    window.harness.event(egui::Event::Text("mine".into()));
    window.steps(2);
    assert_eq!(window.app().view().browsing.as_ref().unwrap().name, "mine.xml");
}

/// Another plan stood there, and nothing said why.
#[test]
fn undo_and_redo_that_lead_to_another_plan_say_so_and_what_leads_back() {
    let mut window = window(SQUARE);
    edit(&mut window);
    let before = window.plan().name;
    window.press_ctrl(Key::N);
    window.click("Discard the changes");
    let new = window.plan().name;
    assert!(new != before && !window.shows("Undone") && !window.shows("Redone"));
    window.press_ctrl(Key::Z);
    assert_eq!(window.plan().name, before);
    assert!(
        window.shows(&format!("Undone: the plan “{before}” is shown. Redo (Ctrl+Y) brings “{new}” back"))
    );
    window.press_ctrl(Key::Y);
    assert_eq!(window.plan().name, new);
    assert!(
        window.shows(&format!("Redone: the plan “{new}” is shown. Undo (Ctrl+Z) brings “{before}” back"))
    );
}
