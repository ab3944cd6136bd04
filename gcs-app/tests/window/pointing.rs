//! What can be done with what is under the pointer.

use super::maps::wheel;
use super::pasting::{legs, window};
use super::{SQUARE, Window};
use egui::{Key, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::create::LegChoice;
use flight_plan::{Cause, Id, Place, Value};
use gcs_app::forecast::Point;
use geometry::LatLon;

#[test]
fn a_right_click_puts_a_leg_where_the_pointer_is() {
    for (entry, choice, at) in [
        ("Add a waypoint here, behind side2", LegChoice::Tf, 2),
        ("Add a waypoint here, before side2", LegChoice::Tf, 1),
        ("Add a scan here", LegChoice::Scan, 2),
        ("Add an orbit here", LegChoice::Orbit, 2),
        ("Add a holding here", LegChoice::Hm, 2),
    ] {
        let mut window = window();
        window.click("TF side2");
        let here = window.centre("Map") + vec2(90.0, 60.0);
        window.right_click_at(here);
        window.click(entry);
        let made = window.selected();
        assert_eq!(legs(&window).iter().position(|id| *id == made), Some(at), "{entry}: {made}");
        assert_eq!(LegChoice::of(&window.plan().leg(&Id::new(&made)).unwrap().leg.kind), choice);
        assert!(!window.shows(entry), "the menu is closed");
        window.click("Undo");
        assert_eq!(legs(&window), ["side1", "side2", "side3", "side4"], "one step");
    }
}

#[test]
fn a_right_click_makes_a_fix_and_says_what_is_here() {
    let mut window = window();
    window.click("TF side2");
    let here = window.centre("Map") + vec2(90.0, 60.0);
    window.right_click_at(here);
    assert!(window.shows("Ground ") && window.shows(" m AMSL") && window.shows("From side2 "));
    window.click("Make a fix here");
    assert_eq!(window.selected(), "FIX1");
    assert!(window.centre("Fix FIX1").distance(here) < 2.0);
    window.right_click_at(here + vec2(60.0, 0.0));
    assert!(window.shows("From FIX1 "));
    window.press(Key::Escape);
    assert!(!window.shows("Make a fix here"));
}

#[test]
fn a_right_click_says_how_far_it_is_from_the_aircraft() {
    let mut window = window();
    let here = window.centre("Map") + vec2(90.0, 60.0);
    window.right_click_at(here);
    assert!(!window.shows("From the aircraft "), "there is none");
    window.press(Key::Escape);
    window.connect();
    window.receive_position(false);
    window.steps(3);
    window.right_click_at(here);
    assert!(window.shows("From the aircraft "));
}

#[test]
fn the_coordinates_under_the_pointer_are_copied() {
    let mut window = window();
    window.right_click_at(window.centre("Map") + vec2(90.0, 60.0));
    let entry = window.harness.get_by_label("Copy the coordinates");
    entry.click();
    window.harness.step();
    let copied = window.harness.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    assert!(gcs_app::coordinates::position(&copied.unwrap()).is_some());
}

#[test]
fn what_is_under_the_pointer_has_its_own_menu() {
    let mut window = window();
    let fix = window.centre("Fix A");
    window.right_click_at(fix);
    let entry = window.harness.get_all_by_label("Fix A").last().unwrap();
    entry.click();
    window.steps(3);
    window.click_beginning("Make its place a variable");
    window.steps(3);
    assert_eq!(window.selected(), "at_a");
    let plan = window.plan();
    assert!(plan.fix(&"A".into()).is_none() && plan.variable(&"at_a".into()).is_some());
    let bound = plan.all_legs().iter().filter(|context| {
        matches!(context.leg.place(), Some(Place::Position(Value::Expression(source))) if &**source == "at_a")
    }).count();
    assert!(bound > 0);
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    window.click("Undo");
    assert!(window.plan().fix(&"A".into()).is_some(), "one step");
}

#[test]
fn the_place_of_a_fix_is_made_a_variable_from_tree_and_palette_too() {
    for by_palette in [false, true] {
        let mut window = window();
        match by_palette {
            false => window.row_menu(("FIX A", 0), "Make its place a variable"),
            true => {
                window.select_row(("FIX A", 0));
                window.ask_for("make its place a variable");
                window.press(Key::Enter);
            }
        }
        window.steps(3);
        assert_eq!(window.selected(), "at_a", "by palette: {by_palette}");
        assert!(window.plan().fix(&"A".into()).is_none());
    }
}

/// Where the cursor of the preview is, as a share of the way from B to C.
fn share_of_side3(window: &Window) -> f64 {
    let cursor_s = window.app().view().cursor_s.unwrap();
    let at = window.app().analysis().forecast.at(cursor_s).unwrap().position;
    let [b, c] = ["B", "C"].map(|fix| window.plan().fix(&fix.into()).unwrap().position);
    b.distance_m(at) / b.distance_m(c)
}

#[test]
fn what_happens_at_a_place_is_asked_on_the_map_and_a_click_on_the_path_moves_it() {
    let mut window = window();
    let on_path = |window: &Window, share| window.centre("Fix B").lerp(window.centre("Fix C"), share);
    let at = on_path(&window, 0.3);
    window.right_click_at(at);
    window.click("What happens here");
    window.click("Link lost");
    assert_eq!(window.app().view().alarm, Some(Cause::Link));
    assert!((share_of_side3(&window) - 0.3).abs() < 0.05, "{}", share_of_side3(&window));
    window.until("the way out", |app| app.analysis().diversion().is_some());
    assert!(window.shows("Link lost: R05 is"));
    let at = on_path(&window, 0.6);
    window.click_at(at);
    assert!((share_of_side3(&window) - 0.6).abs() < 0.05, "{}", share_of_side3(&window));
    // where no path is there is nothing to happen
    let beside = window.centre("Map") + vec2(90.0, 60.0);
    window.right_click_at(beside);
    assert!(!window.shows("What happens here"));
}

#[test]
fn a_place_of_the_plan_is_tried_where_the_menu_was_opened() {
    let mut window = Window::open(super::whatif::FIRE_WATCH);
    window.until_analysed();
    let before = window.plan();
    let here = window.centre("Map") + vec2(90.0, 60.0);
    window.right_click_at(here);
    window.click("What if here is");
    window.click("fire_centre");
    let tried = &window.app().view().what_if.variables;
    assert!(matches!(tried[&Id::new("fire_centre")], flight_plan::VariableValue::Position(_)), "{tried:?}");
    assert_eq!(window.plan(), before);
}

#[test]
fn a_click_on_several_things_asks_which_is_meant() {
    let mut window = window();
    let at = window.centre("Map") + vec2(90.0, 60.0);
    // two zones with one edge
    window.press(Key::Z);
    for corner in [vec2(0.0, 0.0), vec2(60.0, 60.0)] {
        let far = vec2(60.0, 60.0) - corner;
        for offset in [vec2(60.0, 0.0), vec2(far.x, far.y) + (far - corner) * 0.2, vec2(0.0, 60.0)] {
            window.click_at(at + offset);
        }
        window.press(Key::Enter);
    }
    window.press(Key::V);
    window.press(Key::Escape);
    let edge = at + vec2(40.0, 20.0);
    window.click_at(edge);
    assert!(window.shows("Zone keep-out-1") && window.shows("Zone keep-out-2"));
    let second = window.harness.get_all_by_label("Zone keep-out-2").last().unwrap();
    second.click();
    window.steps(3);
    assert_eq!(window.selected(), "keep-out-2");
}

#[test]
fn on_a_narrow_map_the_legend_is_behind_a_button() {
    let mut window = Window::open_with(SQUARE, egui::vec2(960.0, 600.0), None);
    window.until_analysed();
    assert_eq!(window.colour_within("Map", "alternate"), None, "there is no room for it");
    window.click("What the lines mean");
    assert!(window.shows("Lines: planned, active, flown, alternate"));
    let mut wide = Window::open(SQUARE);
    wide.until_analysed();
    assert!(wide.colour_within("Map", "alternate").is_some() && !wide.shows("What the lines mean"));
    // what it lies over can't be seen there, and its mark puts it away
    let close = wide.centre("Put the legend away");
    wide.click_at(close + egui::vec2(-60.0, 60.0));
    assert_eq!(wide.selected(), "");
    wide.click("Put the legend away");
    assert_eq!(wide.colour_within("Map", "alternate"), None);
    wide.click("What the lines mean");
    wide.click("Leave it on the map");
    assert!(wide.colour_within("Map", "alternate").is_some() && !wide.shows("What the lines mean"));
}

#[test]
fn a_click_on_the_runway_means_the_take_off_as_a_stage() {
    let mut window = window();
    let threshold = window.plan().runways[0].threshold;
    let take_off = window.plan().stages[0].id.clone();
    let forecast = window.app().analysis().forecast.clone();
    assert!(
        forecast.passages[0].leg == take_off && forecast.points[0].position.distance_m(threshold) < 2000.0
    );
    let runway = window.harness.get_by_label("Runway R05").rect().center();
    window.click_at(runway);
    assert!(!window.shows("It is no longer in the plan") && !window.shows("Leg Take-off"));
}

/// On a near map the points of the path lie farther apart than the pointer reaches.
#[test]
fn a_click_between_two_points_of_the_path_means_it_on_the_nearest_map_too() {
    let far = window();
    let forecast = &far.app().analysis().forecast;
    let leg = Id::new("side3");
    let part = forecast.passages_of(&leg).next().unwrap();
    let apart_m = |ends: &&[Point]| ends[0].position.distance_m(ends[1].position);
    let ends = part.windows(2).max_by(|a, b| apart_m(a).total_cmp(&apart_m(b))).unwrap();
    let middle = ends[0].position.interpolate(ends[1].position, 0.5);
    // beside the path, with the place in the middle between them
    let [left, right] = [90.0, -90.0]
        .map(|turn_deg| middle.destination(ends[0].position.bearing_deg(ends[1].position) + turn_deg, 40.0));
    let fix = |id, at: LatLon| format!(r#"<fix id="{id}" lat="{:.9}" lon="{:.9}"/>"#, at.lat_deg, at.lon_deg);
    let fixes = format!("<fixes>{}{}", fix("left", left), fix("right", right));
    let plan = SQUARE.replace("<fixes>", &fixes);
    let ends_px = |window: &Window| ["Fix left", "Fix right"].map(|fix| window.centre(fix));
    let on_path = |window: &Window| ends_px(window)[0].lerp(ends_px(window)[1], 0.5);
    let near = || {
        let mut window = Window::open(&plan);
        window.until_analysed();
        // 80 m are 331 points at zoom level 19
        while ends_px(&window)[0].distance(ends_px(&window)[1]) < 331.0 {
            let at = on_path(&window);
            wheel(&mut window, at, 2.0);
        }
        window
    };
    let mut window = near();
    window.click_at(on_path(&window));
    assert_eq!(window.selected(), "side3");
    let mut window = near();
    window.right_click_at(on_path(&window));
    window.click("What happens here");
    window.click(Cause::Engine.name());
    let cursor_s = window.app().view().cursor_s.unwrap();
    let time_s = (ends[0].time_s + ends[1].time_s) / 2.0;
    assert!((cursor_s - time_s).abs() < 0.1, "{cursor_s}, not {time_s}");
}
