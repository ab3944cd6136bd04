//! Files, on a desktop that offers no dialog for them.

use super::{SQUARE, Window};
use egui_kittest::kittest::Queryable;
use std::path::Path;

pub fn window(text: &str) -> Window {
    let mut window = Window::open(text);
    window.harness.state_mut().ask_for_files_here();
    window
}

pub fn until_listed(window: &mut Window) {
    window.until("folder", |app| app.view().browsing.as_ref().is_some_and(|b| b.entries.is_some()));
}

/// Types a name into the dialog.
pub fn name(window: &mut Window, path: &Path) {
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
    let proposed = first.app().view().browsing.as_ref().map(|browsing| browsing.name.clone());
    assert_eq!(proposed.as_deref(), Some("Square circuit.xml"), "the plan's name");
    name(&mut first, &folder.path().join(""));
    first.click("Go there");
    until_listed(&mut first);
    assert!(first.shows("below"), "the folder's folders");
    name(&mut first, Path::new("mine"));
    first.press(egui::Key::Enter);
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
fn a_name_that_is_typed_faster_than_the_window_draws_is_taken_whole() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window(SQUARE);
    window.press_ctrl(egui::Key::S);
    until_listed(&mut window);
    let path = std::fs::canonicalize(folder.path()).unwrap().join("mine.xml");
    // the letters and Enter are one frame
    window.fill_in(egui::accesskit::Role::TextInput, "File name", &path.display().to_string());
    window.until("saved", |app| app.document().path() == Some(path.as_path()));
}

#[test]
fn file_that_is_there_is_replaced_only_when_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.xml");
    std::fs::write(&path, "old").unwrap();
    let mut window = window(SQUARE);
    window.press_ctrl(egui::Key::S);
    until_listed(&mut window);
    name(&mut window, &folder.path().join(""));
    window.press(egui::Key::Enter);
    until_listed(&mut window);
    name(&mut window, Path::new("old.xml"));
    assert!(window.shows("What is in it would be lost: Enter does not do that, the button does"));
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

/// A window with a file of its own, opened by its dialog; the file's text is `text`.
pub fn window_on(path: &Path, text: &str) -> Window {
    std::fs::write(path, text).unwrap();
    let mut window = window("");
    open(&mut window, path);
    window
}

pub fn open(window: &mut Window, path: &Path) {
    window.press_ctrl(egui::Key::O);
    until_listed(window);
    name(window, path);
    window.click("Open");
    let path = path.to_owned();
    window.until("opened", move |app| app.document().path() == Some(path.as_path()));
}

#[test]
fn saving_keeps_the_comments_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.xml");
    let text = SQUARE.replacen("<mainPlan", "<!-- my words -->\n  <mainPlan", 1);
    let mut window = window_on(&path, &text);
    window.click("TF side2");
    window.press(egui::Key::Delete);
    window.press_ctrl(egui::Key::S);
    window.until("saved", |app| !app.document().is_dirty());
    let written = std::fs::read_to_string(&path).unwrap();
    let kept: Vec<&str> = text.lines().filter(|line| !line.contains("\"side2\"")).collect();
    assert_eq!(written.lines().collect::<Vec<_>>(), kept);
}

#[test]
fn what_was_asked_for_goes_on_once_the_plan_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("first.xml"), folder.path().join("second.xml"));
    std::fs::write(&second, SQUARE.replace("side2", "other")).unwrap();
    let mut window = window_on(&first, SQUARE);
    window.click("TF side2");
    window.press(egui::Key::Delete);
    window.press_ctrl(egui::Key::O);
    window.click("Save first");
    window.until("the dialog", |app| app.view().browsing.is_some());
    assert!(!std::fs::read_to_string(&first).unwrap().contains("\"side2\""), "it was saved");
    until_listed(&mut window);
    name(&mut window, &second);
    window.click("Open");
    window.until("opened", |app| app.document().path() == Some(second.as_path()));
}

#[test]
fn a_plan_that_comes_back_unchanged_is_reviewed_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_on(&folder.path().join("first.xml"), SQUARE);
    window.until_analysed();
    window.press_ctrl(egui::Key::N);
    window.until_analysed();
    window.press_ctrl(egui::Key::Z);
    window.until_analysed();
}

#[test]
fn undo_brings_back_the_plan_before_new_and_open() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("first.xml"), folder.path().join("second.xml"));
    std::fs::write(&second, SQUARE.replace("side2", "other")).unwrap();
    let mut window = window_on(&first, SQUARE);
    let saved = window.plan();
    window.click("TF side2");
    window.press(egui::Key::Delete);
    let edited = window.plan();
    window.press_ctrl(egui::Key::N);
    window.click("Discard the changes");
    assert!(window.plan().stages.is_empty());
    open(&mut window, &second);
    assert!(!window.app().document().is_dirty());
    window.press_ctrl(egui::Key::Z);
    assert_eq!(window.plan(), edited, "an empty plan that nobody worked on is no step");
    assert_eq!(window.app().document().path(), Some(first.as_path()));
    assert!(window.app().document().is_dirty());
    window.press_ctrl(egui::Key::Z);
    assert!(window.plan() == saved && !window.app().document().is_dirty());
    for _ in 0..2 {
        window.press_ctrl(egui::Key::Y);
    }
    assert_eq!(window.app().document().path(), Some(second.as_path()));
    assert!(!window.is_enabled("Redo") && window.is_enabled("Undo"));
    window.press_with(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::Z);
    assert_eq!(window.app().document().path(), Some(second.as_path()), "nothing to redo is no undo");
}

#[test]
fn file_that_another_program_changed_is_loaded_or_kept_as_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shared.xml");
    let mut window = window_on(&path, SQUARE);
    let mine = window.plan();
    std::fs::write(&path, SQUARE.replace("side2", "their-side")).unwrap();
    window.until("question", |app| app.view().changed_outside.is_some());
    assert!(window.shows("Another program has changed shared.xml"));
    window.click("Load theirs");
    window.until("theirs", |app| app.document().plan().leg(&"their-side".into()).is_some());
    assert!(!window.app().document().is_dirty());
    window.press_ctrl(egui::Key::Z);
    assert!(window.plan() == mine && window.app().document().is_dirty());

    std::fs::write(&path, "something else").unwrap();
    window.until("question", |app| app.view().changed_outside.is_some());
    window.click("Keep mine");
    assert!(window.app().document().is_dirty());
    window.press_ctrl(egui::Key::S);
    window.until("saved", |app| !app.document().is_dirty());
    assert_eq!(flight_plan::read(std::fs::read(&path).unwrap()).plan, mine);
}

#[test]
fn file_that_vanished_is_told_and_written_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gone.xml");
    let mut window = window_on(&path, SQUARE);
    std::fs::remove_file(&path).unwrap();
    window.until("notice", |app| app.view().notice.is_some());
    assert!(window.shows("was deleted or moved") && window.app().document().is_dirty());
    window.press_ctrl(egui::Key::S);
    window.until("saved", |app| !app.document().is_dirty());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), SQUARE);
}

#[test]
fn plan_that_cannot_be_saved_stays_unsaved_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("below").join("plan.xml");
    std::fs::create_dir(path.parent().unwrap()).unwrap();
    let mut window = window_on(&path, SQUARE);
    window.click("TF side2");
    window.press(egui::Key::Delete);
    let edited = window.plan();
    std::fs::remove_dir_all(path.parent().unwrap()).unwrap();
    window.press_ctrl(egui::Key::S);
    window.until("notice", |app| app.view().notice.as_ref().is_some_and(|n| n.contains("Save it elsewhere")));
    assert!(window.plan() == edited && window.app().document().is_dirty());
}

/// Deletes a leg of the square.
pub fn edit(window: &mut Window) {
    window.click("TF side2");
    window.press(egui::Key::Delete);
    assert!(window.app().document().is_dirty());
}

/// Two documents with unsaved changes; the second is shown.
fn two_unsaved(folder: &Path) -> Window {
    let mut window = window_on(&folder.join("first.xml"), SQUARE);
    edit(&mut window);
    window.press_ctrl(egui::Key::O);
    window.click("Discard the changes");
    until_listed(&mut window);
    let second = folder.join("second.xml");
    std::fs::write(&second, SQUARE).unwrap();
    name(&mut window, &second);
    window.click("Open");
    window.until("opened", move |app| app.document().path() == Some(second.as_path()));
    // the first is wanted after all
    window.press_ctrl(egui::Key::Z);
    window.press_ctrl(egui::Key::Y);
    edit(&mut window);
    window
}

#[test]
fn quit_asks_for_every_document_and_saves_them_all() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = two_unsaved(folder.path());
    window.press_ctrl(egui::Key::Q);
    assert!(window.shows("2 plans have unsaved changes"));
    assert!(window.shows("first.xml") && window.shows("second.xml"));
    window.press(egui::Key::Escape);
    assert!(window.app().view().unsaved.is_none());
    window.press_ctrl(egui::Key::Q);
    window.click("Save and quit");
    let is_saved = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap() != SQUARE;
    window.until("both saved", |app| app.is_leaving());
    assert!(is_saved("first.xml") && is_saved("second.xml"));
}

#[test]
fn quit_stops_where_a_document_cannot_be_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = two_unsaved(folder.path());
    std::fs::write(folder.path().join("first.xml"), "theirs").unwrap();
    window.press_ctrl(egui::Key::Q);
    window.click("Save and quit");
    window.until("notice", |app| app.view().notice.is_some());
    assert!(window.shows("was changed by another program") && !window.app().is_leaving());
    assert_eq!(
        window.app().document().path(),
        Some(folder.path().join("first.xml").as_path()),
        "it is shown"
    );
}

#[test]
fn every_document_survives_a_crash() {
    let (folder, copies) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let mut killed = two_unsaved(folder.path());
    killed.keep_copies(copies.path());
    killed.steps(3);
    drop(killed);
    let mut next = window("");
    next.keep_copies(copies.path());
    next.steps(3);
    assert!(next.shows("second.xml") && next.shows("first.xml"));
    next.click("Recover all");
    assert!(next.shows("Recovered, too: “Square circuit” (first.xml). Undo (Ctrl+Z) leads there."));
    for name in ["second.xml", "first.xml"] {
        assert_eq!(next.app().document().path(), Some(folder.path().join(name).as_path()));
        assert!(next.app().document().is_dirty() && next.plan().leg(&"side2".into()).is_none());
        next.press_ctrl(egui::Key::Z);
    }
}

#[test]
fn file_that_could_not_be_read_whole_is_not_written_over_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.xml");
    let cut = &SQUARE[..SQUARE.find("id=\"side3\"").unwrap()];
    let mut window = window_on(&path, cut);
    edit(&mut window);
    window.press_ctrl(egui::Key::S);
    until_listed(&mut window);
    assert!(window.shows("could not be read whole") && window.shows("What is in it would be lost"));
    window.press(egui::Key::Escape);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), cut);
}

/// Its text is in the plan: it is told once, by the name of its leg, and nothing is lost where the file is written.
#[test]
fn a_number_that_could_not_be_read_is_told_once_and_its_file_saved_plainly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("feet.xml");
    let text = SQUARE.replacen("\"110\"", "\"250ft\"", 1);
    let mut window = window_on(&path, &text);
    window.until_analysed();
    assert_eq!(window.harness.query_all_by_label_contains("not \"250ft\"").count(), 1);
    let saved = |window: &mut Window| {
        window.press_ctrl(egui::Key::S);
        window.until("saved", |app| !app.document().is_dirty());
        std::fs::read_to_string(&path).unwrap()
    };
    // another property of its leg is changed
    window.click("TF side4");
    window.steps(2);
    window.fill_in(egui::accesskit::Role::TextInput, "Identifier", "fourth");
    window.steps(2);
    assert_eq!(saved(&mut window), text.replace("\"side4\"", "\"fourth\""));
    window.fill_in(egui::accesskit::Role::TextInput, "Altitude", "250 ft");
    window.steps(2);
    assert_eq!(saved(&mut window), text.replace("\"side4\"", "\"fourth\"").replace("250ft", "76.2"));
}
