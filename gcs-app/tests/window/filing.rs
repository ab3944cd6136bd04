//! Files, on a desktop that offers no dialog for them.

use super::{SQUARE, Window};
use egui_kittest::kittest::Queryable;
use std::path::Path;

fn window(text: &str) -> Window {
    let mut window = Window::open(text);
    window.harness.state_mut().ask_for_files_here();
    window
}

fn until_listed(window: &mut Window) {
    window.until("folder", |app| app.view().browsing.as_ref().is_some_and(|b| b.entries.is_some()));
}

/// Types a name into the dialog.
fn name(window: &mut Window, path: &Path) {
    let field = window.harness.get_by_label("File name");
    field.click();
    window.steps(2);
    window.press_ctrl(egui::Key::A);
    window.harness.get_by_label("File name").type_text(&path.display().to_string());
    window.steps(2);
}

#[test]
fn plan_is_saved_and_opened_without_a_desktops_dialog() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("below")).unwrap();
    let mut first = window(SQUARE);
    let written = first.plan();
    first.click("TF side2");
    first.press_ctrl(egui::Key::S);
    until_listed(&mut first);
    name(&mut first, &folder.path().join("mine"));
    first.click("Go there");
    until_listed(&mut first);
    assert!(first.shows("below"), "the folder's folders");
    first.click("Save here");
    let path = std::fs::canonicalize(folder.path()).unwrap().join("mine.xml");
    first.until("saved", |app| app.document().path() == Some(path.as_path()));
    assert_eq!(flight_plan::read(std::fs::read(&path).unwrap()).plan, written);

    let mut second = window("");
    second.press_ctrl(egui::Key::O);
    until_listed(&mut second);
    name(&mut second, &path);
    second.click("Open");
    second.until("opened", |app| app.document().path() == Some(path.as_path()));
    assert_eq!(second.plan(), written);
}

#[test]
fn file_that_is_there_is_replaced_only_when_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.xml");
    std::fs::write(&path, "old").unwrap();
    let mut window = window(SQUARE);
    window.press_ctrl(egui::Key::S);
    until_listed(&mut window);
    name(&mut window, &path);
    window.press(egui::Key::Enter);
    until_listed(&mut window);
    assert!(window.shows("What is in it would be lost"));
    window.press(egui::Key::Enter);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    window.click("Replace the file");
    window.until("saved", |app| app.document().path().is_some());
    assert_ne!(std::fs::read_to_string(&path).unwrap(), "old");
}

#[test]
fn file_that_the_list_does_not_show_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notes.txt");
    std::fs::write(&path, "old").unwrap();
    let mut window = window(SQUARE);
    window.press_ctrl(egui::Key::S);
    until_listed(&mut window);
    name(&mut window, &path);
    window.click("Go there");
    until_listed(&mut window);
    window.click("Save here");
    window.until("refusal", |app| app.view().notice.is_some());
    assert!(window.shows("is there already and was not overwritten"));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
}

#[test]
fn folder_that_cannot_be_read_is_said_and_the_dialog_can_be_left() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window(SQUARE);
    window.press_ctrl(egui::Key::O);
    until_listed(&mut window);
    name(&mut window, &folder.path().join("missing/"));
    window.press(egui::Key::Enter);
    until_listed(&mut window);
    assert!(window.shows("can't be read"));
    window.press(egui::Key::Escape);
    assert!(window.app().view().browsing.is_none());
}

#[test]
fn keys_do_nothing_behind_a_dialog() {
    let mut window = window(SQUARE);
    window.click("TF side2");
    let before = window.plan();
    window.press_ctrl(egui::Key::O);
    until_listed(&mut window);
    window.press(egui::Key::Delete);
    assert_eq!(window.plan(), before);
    window.press(egui::Key::Escape);
    window.press(egui::Key::Delete);
    assert_ne!(window.plan(), before);
}

#[test]
fn file_that_another_program_changed_is_not_overwritten_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.xml");
    let mut window = window(SQUARE);
    window.press_ctrl(egui::Key::S);
    until_listed(&mut window);
    name(&mut window, &path);
    window.click("Go there");
    until_listed(&mut window);
    window.click("Save here");
    window.until("saved", |app| app.document().path().is_some());
    std::fs::write(&path, "theirs").unwrap();
    window.press_ctrl(egui::Key::S);
    window.until("notice", |app| app.view().notice.is_some());
    assert!(window.shows("was changed by another program"));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "theirs");
    window.press_ctrl(egui::Key::S);
    window.until("saved", |_| std::fs::read_to_string(&path).unwrap() != "theirs");
}

#[test]
fn file_that_was_open_is_offered_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.xml");
    std::fs::write(&path, SQUARE).unwrap();
    let mut window = window("");
    window.press_ctrl(egui::Key::O);
    until_listed(&mut window);
    name(&mut window, &path);
    window.click("Open");
    window.until("opened", |app| app.document().path().is_some());
    window.press_ctrl(egui::Key::N);
    assert!(window.app().document().path().is_none());
    window.click("Legwork");
    window.click("Open recent");
    window.click("square.xml");
    window.until("opened", |app| app.document().path().is_some());
}
