//! The profile shares its selection with map, tree and table.

use super::pasting::window;
use super::{SQUARE, Window};
use egui::{Pos2, vec2};
use gcs_app::panels::timeline;

/// On the path of a leg that is flown level, beside the mark at its end.
fn on_path(window: &Window) -> Pos2 {
    window.centre("Altitude of side3") - vec2(25.0, 0.0)
}

#[test]
fn a_click_on_the_path_selects_its_leg_everywhere() {
    let mut window = window();
    let drawn = gcs_app::theme::palette(true).text;
    let lines = |window: &Window| window.lines_within("Vertical profile", drawn);
    let before = lines(&window);
    let at = on_path(&window);
    window.click_at(at);
    assert_eq!(window.selected(), "side3");
    let cursor_s = window.app().view().cursor_s.unwrap();
    // the cursor is a line and a circle
    assert_eq!(lines(&window), before + 2, "the leg and the cursor");
    window.click("TF side1");
    window.click_at(at + vec2(-10.0, 30.0));
    assert!(window.app().view().cursor_s.unwrap() < cursor_s, "the cursor goes there");
    assert_eq!(window.selected(), "side1", "there is no path");
}

#[test]
fn what_is_selected_in_the_tree_is_drawn_stronger_in_the_profile() {
    let mut window = window();
    let drawn = gcs_app::theme::palette(true).text;
    let before = window.lines_within("Vertical profile", drawn);
    window.click("TF side2");
    assert_eq!(window.lines_within("Vertical profile", drawn), before + 1);
    window.press(egui::Key::Escape);
    assert_eq!(window.lines_within("Vertical profile", drawn), before);
}

#[test]
fn the_stages_of_the_timeline_follow_each_other_from_the_start_to_the_landing() {
    let window = window();
    let forecast = &window.app().analysis().forecast;
    let stages = timeline::stages(forecast);
    let names: Vec<&str> = stages.iter().map(|(stage, ..)| stage.as_str()).collect();
    assert_eq!(names, ["take-off", "circuit", "land"]);
    assert_eq!((stages[0].1, stages[2].2), (0.0, forecast.duration_s()));
    assert!(stages.windows(2).all(|two| two[0].1 < two[0].2 && two[0].2 == two[1].1), "{stages:?}");
    let part = |leg: &str| forecast.passages_of(&leg.into()).next().unwrap().to_vec();
    assert_eq!(stages[1].1, part("side1")[0].time_s);
    assert_eq!(stages[1].2, part("side4").last().unwrap().time_s);
}

#[test]
fn a_hand_that_is_not_still_changes_no_altitude() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = window.plan();
    let mark = window.centre("Altitude of side2");
    window.press_unsteadily(mark);
    assert!(window.plan() == before && !window.is_enabled("Undo"));
}
