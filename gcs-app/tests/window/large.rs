//! A large plan: a frame draws and names what can be seen and grabbed of it, and no more.

use super::filing::window_on;
use super::interchange::drop_file;
use super::{SQUARE, Window};
use egui::vec2;
use egui_kittest::kittest::Queryable;
use flight_plan::Id;

const LEGS: usize = 200;
const SIDE: &str = r#"<TF id="side2" fix="B"/>"#;

/// Many legs in the place of one.
fn with_legs(leg: impl Fn(usize) -> String) -> Window {
    let legs: String = (0..LEGS).map(leg).collect();
    let mut window = Window::open(&SQUARE.replacen(SIDE, &legs, 1));
    window.until_analysed();
    window
}

fn named(window: &Window, label: &str) -> usize {
    window.harness.query_all_by_label_contains(label).count()
}

#[test]
fn of_many_waypoints_some_are_named_and_whichever_the_pointer_is_at_is_dragged() {
    let leg = |i: usize| {
        let (lat, lon) = (36.31 + 0.002 * (i / 20) as f64, -84.2 + 0.003 * (i % 20) as f64);
        format!(r#"<TF id="w{i}" lat="{lat:.4}" lon="{lon:.4}"/>"#)
    };
    let mut window = with_legs(leg);
    assert!((100..=150).contains(&named(&window, "Waypoint w")), "{}", named(&window, "Waypoint w"));
    let [first, row_end, second_row] =
        ["w0", "w19", "w20"].map(|leg| window.centre(&format!("Waypoint {leg}")));
    let last = row_end + 9.0 * (second_row - first);
    let before = window.plan();
    window.drag(last, vec2(9.0, 7.0));
    let after = window.plan();
    let is_moved = |id: &Id| after.leg(id).map(|c| c.leg) != before.leg(id).map(|c| c.leg);
    let moved: Vec<Id> =
        before.all_legs().iter().map(|c| c.leg.id.clone()).filter(|id| is_moved(id)).collect();
    assert_eq!(moved, [Id::new("w199")]);
}

#[test]
fn of_many_problems_those_near_the_view_are_drawn() {
    let mut window = with_legs(|i| format!(r#"<TF id="bad{i}" fix="NOWHERE{i}"/>"#));
    assert!(window.errors().len() >= LEGS, "{}", window.errors().len());
    assert!(named(&window, "Problem: ") < 10, "they are one entry");
    window.click(&format!("{} more like it ⏷", LEGS - 1));
    window.steps(3);
    let rows = named(&window, "Problem: ");
    assert!((10..60).contains(&rows), "{rows}");
}

/// A window with a small plan, and the file of a very large one beside it.
fn with_a_very_large_one() -> (tempfile::TempDir, Window, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.xml");
    let leg = |i: usize| format!(r#"<TF id="w{i}" lat="{:.4}" lon="-84.2"/>"#, 36.31 + 1e-4 * i as f64);
    std::fs::write(&path, SQUARE.replacen(SIDE, &(0..25_000).map(leg).collect::<String>(), 1)).unwrap();
    let mut window = window_on(&folder.path().join("square.xml"), SQUARE);
    window.until_analysed();
    (folder, window, path)
}

/// What a panel that was hidden waited for never came: the window was said to be busy for ever.
#[test]
fn a_panel_that_is_hidden_while_a_very_large_plan_is_looked_through_is_not_waited_for() {
    let (_folder, mut window, path) = with_a_very_large_one();
    let before = window.app().document().id();
    drop_file(&mut window, &path);
    while window.app().document().id() == before {
        window.wait();
    }
    assert!(window.app().is_busy());
    window.click("Hide Plan");
    assert!(!window.app().is_busy() && !window.shows("TF w0"));
}

/// In no frame it waits for a very large plan to be looked through, and the one before is not taken for it meanwhile.
#[test]
fn of_a_very_large_plan_map_and_tree_come_when_they_are_ready() {
    let (_folder, mut window, path) = with_a_very_large_one();
    assert!(window.shows("TF side2") && window.shows("Fix A"));
    let before = window.app().document().id();
    drop_file(&mut window, &path);
    while window.app().document().id() == before {
        window.wait();
    }
    assert!(window.app().is_busy() && !window.shows("TF side2") && !window.shows("Fix A"));
    window.steps(1);
    assert!(window.shows("TF w0") && window.shows("Waypoint w"));
    window.press_ctrl(egui::Key::Z);
    assert!(window.shows("TF side2") && window.shows("Fix A") && !window.shows("Waypoint w"));
}

/// What is kept of it is that of the plan as it is.
#[test]
fn the_draft_of_a_plan_that_cannot_be_flown_follows_its_places() {
    let mut window = Window::open(&SQUARE.replace(r#"<runway id="R05""#, r#"<runway id="R23""#));
    window.until_analysed();
    assert!(window.app().analysis().forecast.points.is_empty());
    let weak = gcs_app::theme::palette(true).weak;
    let before = window.triangles_within("Map", weak);
    window.drag(window.centre("Fix A"), vec2(60.0, -60.0));
    let after = window.triangles_within("Map", weak);
    assert!(before > 0 && after > before, "its line is longer: {before}, {after}");
}
