//! Plans from and to other programs.

use super::filing::{name, until_listed, window, window_on};
use super::reach::Missing as Dropped;
use super::{SQUARE, Window};
use egui::Key;
use egui_kittest::kittest::{NodeT, Queryable};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file of another program.
pub fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/interchange/tests/fixtures").join(name)
}

pub fn drop_file(window: &mut Window, path: &Path) {
    window.harness.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
    window.steps(2);
}

pub fn until_imported(window: &mut Window) {
    window.until("the import", |app| app.view().imported.is_some());
    // a dialog that is centred finds its place
    window.steps(5);
}

#[test]
fn plan_of_another_program_is_imported_after_its_losses_were_shown() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_on(&folder.path().join("mine.xml"), SQUARE);
    let before = window.plan();
    window.press_ctrl(Key::O);
    until_listed(&mut window);
    name(&mut window, &fixture("survey.plan"));
    window.click("Open");
    until_imported(&mut window);
    assert_eq!(window.plan(), before, "nothing is replaced yet");
    assert!(window.shows("Import “survey.plan” (QGC plan)") && window.shows("ASSUMED, CHANGED OR LEFT OUT"));
    let note = window.app().view().imported.as_ref().unwrap().import.notes[0].clone();
    assert!(window.shows(&format!("{}: {}", note.place, note.message)), "as on the command line: {note}");
    let list = window.harness.get_by_label_contains("choose it in the inspector").rect();
    assert!(list.height() > 20.0, "a long note is wrapped, not cut: {list}");
    window.press(Key::Escape);
    assert!(window.plan() == before && window.app().view().imported.is_none());

    drop_file(&mut window, &fixture("survey.plan"));
    until_imported(&mut window);
    window.click("Import the plan");
    let document = window.app().document();
    assert!(document.is_dirty() && document.path().is_none() && *document.plan().as_ref() != before);
    window.press_ctrl(Key::Z);
    assert_eq!(window.plan(), before);
    window.press_ctrl(Key::Y);
    assert_ne!(window.plan(), before);
}

#[test]
fn dropped_files_are_known_by_their_content() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window("");
    for file in ["patrol.waypoints", "places.kml", "places.geojson", "tour.gpx"] {
        let misnamed = folder.path().join("plan");
        std::fs::copy(fixture(file), &misnamed).unwrap();
        drop_file(&mut window, &misnamed);
        until_imported(&mut window);
        window.press(Key::Escape);
        assert!(window.app().view().imported.is_none(), "{file}");
    }
}

#[test]
fn areas_of_a_drawing_are_what_the_user_says() {
    let mut window = window("");
    drop_file(&mut window, &fixture("places.kml"));
    until_imported(&mut window);
    let zones = |window: &Window| window.app().view().imported.as_ref().map(|i| i.import.plan.zones.len());
    assert_eq!(zones(&window), Some(0));
    window.click("zones to keep out of");
    window.until("the import as a zone", |app| {
        app.view()
            .imported
            .as_ref()
            .is_some_and(|imported| imported.choices.areas == interchange::Areas::KeepOut)
    });
    assert_eq!(zones(&window), Some(1));
    window.click("Import the plan");
    assert_eq!(window.plan().zones.len(), 1);
    // one without areas has no such question
    let mut window = self::window("");
    drop_file(&mut window, &fixture("tour.gpx"));
    until_imported(&mut window);
    assert!(!window.shows("zones to keep out of"));
}

#[test]
fn what_is_no_plan_or_too_long_is_refused_in_words_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window(SQUARE);
    let before = window.plan();
    let long = folder.path().join("long.xml");
    std::fs::write(&long, SQUARE).unwrap();
    let photo = folder.path().join("photo.xml");
    std::fs::write(&photo, b"\xff\xd8\xff\xe0\0\x10JFIF").unwrap();
    // its text, and then nothing for a long way
    std::fs::write(&long, SQUARE.repeat(8)).unwrap();
    std::fs::OpenOptions::new().write(true).open(&long).unwrap().set_len(300 << 20).unwrap();
    for (path, why) in [(&long, "it has 300 MB, and at most 64 MB are read"), (&photo, "it is no text")] {
        drop_file(&mut window, path);
        window.until("notice", |app| app.view().notice.as_ref().is_some_and(|notice| notice.contains(why)));
        assert!(window.plan() == before && !window.app().document().is_dirty());
    }
}

#[test]
fn plan_is_exported_after_its_losses_were_shown() {
    let folder = tempfile::tempdir().unwrap();
    let folder = std::fs::canonicalize(folder.path()).unwrap();
    let mut window = window(SQUARE);
    window.click("Legwork");
    window.click("Export");
    window.click("Export as GPX…");
    window.until("the export", |app| app.view().exported.is_some());
    window.steps(3);
    assert!(window.shows("as GPX") && window.shows("waypoints, as they are flown"));
    let note = window.app().view().exported.as_ref().unwrap().notes[0].clone();
    assert!(window.shows(&note.message), "{note}");
    window.press(Key::Enter);
    until_listed(&mut window);
    name(&mut window, &folder.join("flown"));
    window.click("Save here");
    let written = folder.join("flown.gpx");
    window.until("the file", |_| written.exists());
    assert!(std::fs::read_to_string(&written).unwrap().contains("<gpx"));
    window.until("the end", |app| app.view().exported.is_none());
    assert!(window.app().document().path().is_none(), "an export is no save");
}

#[test]
fn export_is_called_as_the_file_of_the_plan() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_on(&folder.path().join("mine.xml"), SQUARE);
    window.click("Legwork");
    window.click("Export");
    window.click("Export as GPX…");
    window.until("the export", |app| app.view().exported.is_some());
    window.steps(3);
    window.press(Key::Enter);
    until_listed(&mut window);
    assert_eq!(window.app().view().browsing.as_ref().unwrap().name, "mine.gpx");
}

#[test]
fn plan_that_cannot_be_flown_is_not_exported() {
    let mut window = window(&SQUARE.replace("aircraft=\"trainer\"", "aircraft=\"zeppelin\""));
    window.click("Legwork");
    window.click("Export");
    window.click("Export as KML…");
    window.until("notice", |app| app.view().notice.is_some());
    assert!(window.shows("Nothing was exported: the plan has errors"));
}

#[test]
fn drawing_is_added_to_the_plan_that_is_open_by_one_step() {
    let mut window = window(SQUARE);
    let before = window.plan();
    for (areas, zones, scans) in [("scanned", 0, 1), ("zones to keep out of", 1, 0)] {
        drop_file(&mut window, &fixture("places.kml"));
        until_imported(&mut window);
        assert!(!window.shows("--"), "no option of the command line is spoken of");
        if areas != "scanned" {
            window.click(areas);
            window.until("the areas", |app| {
                let imported = app.view().imported.as_ref();
                imported.is_some_and(|i| i.choices.areas == interchange::Areas::KeepOut)
            });
        }
        window.click("Into this plan");
        let plan = window.plan();
        assert_eq!(plan.zones.len() - before.zones.len(), zones, "{areas}");
        let is_scan = |leg: &flight_plan::Leg| matches!(leg.kind, flight_plan::LegKind::Scan(_));
        assert_eq!(plan.all_legs().iter().filter(|c| is_scan(c.leg)).count(), scans, "{areas}");
        assert!(plan.fixes.len() > before.fixes.len(), "points are fixes");
        assert_eq!((&plan.name, plan.stages.len()), (&before.name, before.stages.len()));
        window.press_ctrl(Key::Z);
        assert_eq!(window.plan(), before, "one step");
    }
}

/// A field with a hole around a house: whoever flies above the house is told, as in a plan that is imported.
#[test]
fn the_holes_of_an_area_to_stay_inside_of_are_zones_in_the_plan_that_is_open_too() {
    const FIELD: &str = r#"{"type": "Feature", "properties": {"name": "Field"}, "geometry": {"type": "Polygon", "coordinates": [
        [[-84.20, 36.30], [-84.10, 36.30], [-84.10, 36.38], [-84.20, 36.38], [-84.20, 36.30]],
        [[-84.16, 36.33], [-84.16, 36.34], [-84.15, 36.34], [-84.15, 36.33], [-84.16, 36.33]]]}}"#;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("field.geojson");
    std::fs::write(&file, FIELD).unwrap();
    let mut window = window(SQUARE);
    let before = window.plan().zones.len();
    drop_file(&mut window, &file);
    until_imported(&mut window);
    window.click("zones to stay inside of");
    window.until("the areas", |app| {
        app.view().imported.as_ref().is_some_and(|i| i.choices.areas == interchange::Areas::KeepIn)
    });
    assert!(window.shows("2 zones"), "the dialog counts them");
    window.click("Into this plan");
    let plan = window.plan();
    let zones: Vec<_> = plan.zones[before..].iter().map(|zone| (zone.name.as_str(), zone.kind)).collect();
    let kinds = [flight_plan::ZoneKind::KeepIn, flight_plan::ZoneKind::KeepOut];
    assert_eq!(zones, [("Field", kinds[0]), ("Field, hole", kinds[1])]);
}

/// What is said of the choice is what comes of it.
#[test]
fn a_line_is_a_corridor_or_legs_as_was_chosen_and_the_dialog_says_which() {
    let mut window = window(SQUARE);
    let before = window.plan();
    let is_corridor = |kind: &flight_plan::LegKind| {
        matches!(kind, flight_plan::LegKind::Pattern(flight_plan::Pattern::Corridor { .. }))
    };
    for (choice, said, corridors) in
        [("corridors", "1 corridor", 1), ("legs from point to point", "3 legs", 0)]
    {
        drop_file(&mut window, &fixture("places.kml"));
        until_imported(&mut window);
        if corridors == 0 {
            window.click(choice);
            window.until("the lines", |app| {
                let imported = app.view().imported.as_ref();
                imported.is_some_and(|i| i.choices.lines == gcs_app::files::Lines::Tracks)
            });
        }
        assert!(window.shows("As a new plan it has ") && window.shows("Into this plan, as one step, come "));
        let told = window.harness.get_by_label_contains("Into this plan, as one step").accesskit_node();
        let told = told.value().or(told.label()).unwrap();
        assert!(told.contains(said) && told.contains("what is flown "), "{told}");
        window.click("Into this plan");
        let plan = window.plan();
        let added = plan.all_legs().len() - before.all_legs().len();
        assert_eq!(plan.all_legs().iter().filter(|c| is_corridor(&c.leg.kind)).count(), corridors);
        assert_eq!(added, if corridors == 1 { 2 } else { 4 }, "the line and the area");
        window.press_ctrl(Key::Z);
        assert_eq!(window.plan(), before, "one step");
    }
}

#[test]
fn drawing_without_a_runway_gets_take_off_and_landing_when_asked_for() {
    let mut window = window("");
    drop_file(&mut window, &fixture("tour.gpx"));
    until_imported(&mut window);
    window.click("on a new runway before its first point");
    window.until("the runway", |app| {
        app.view().imported.as_ref().is_some_and(|imported| imported.choices.runway.is_some())
    });
    window.click("Import the plan");
    let plan = window.plan();
    let kinds: Vec<_> = plan.stages.iter().map(|stage| stage.kind).collect();
    assert_eq!(kinds.first(), Some(&flight_plan::StageKind::TakeOff));
    assert_eq!(kinds.last(), Some(&flight_plan::StageKind::Land));
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
}
