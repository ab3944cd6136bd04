//! Lines on the map: waypoints out of them, rubber bands, pictures along them, and the view on what is selected.

use super::Window;
use super::pasting::{legs, window};
use egui::accesskit::Role;
use egui::{Key, Pos2, vec2};
use egui_kittest::kittest::Queryable;

/// A quarter along the line to side3, where no mark is.
fn on_line(window: &Window) -> Pos2 {
    window.centre("Fix B").lerp(window.centre("Fix C"), 0.25)
}

#[test]
fn a_waypoint_is_dragged_out_of_the_line_anywhere() {
    let mut window = window();
    let before = window.plan();
    let at = on_line(&window);
    window.harness.hover_at(at);
    window.steps(2);
    assert!(window.shows("Line to side3"));
    let fix = window.centre("Fix A");
    window.drag(at, vec2(60.0, 30.0));
    assert_eq!(window.centre("Fix A"), fix, "the map stays");
    assert_eq!(legs(&window), ["side1", "side2", "leg1", "side3", "side4"]);
    assert_eq!(window.selected(), "leg1");
    assert!(window.centre("Waypoint leg1").distance(at + vec2(60.0, 30.0)) < 3.0);
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

#[test]
fn a_click_on_a_line_selects_and_a_drag_beside_it_moves_the_map() {
    let mut window = window();
    let at = on_line(&window);
    window.click_at(at);
    assert_eq!((window.selected(), legs(&window).len()), ("side3".into(), 4));
    let (beside, fix) = (at + vec2(40.0, 60.0), window.centre("Fix A"));
    window.drag(beside, vec2(50.0, 20.0));
    assert_eq!(legs(&window).len(), 4);
    assert!(window.centre("Fix A").distance(fix) > 20.0);
}

#[test]
fn every_tool_that_draws_legs_shows_what_they_lead_to() {
    let band = gcs_app::theme::palette(true).contingency;
    for tool in [Key::T, Key::A, Key::L, Key::O] {
        let mut window = window();
        window.click("TF side2");
        window.press(tool);
        let away = window.centre("Undo");
        window.harness.hover_at(away);
        window.steps(2);
        let before = window.lines_within("Map", band);
        let at = window.centre("Map") + vec2(60.0, 40.0);
        window.harness.hover_at(at);
        window.steps(2);
        assert!(window.lines_within("Map", band) > before, "{tool:?}: a band to the alternate");
    }
}

/// From where an alarm would be raised, not from wherever the path comes near: in the middle of the selected leg, or at the cursor.
#[test]
fn an_emergency_plan_shows_the_way_into_it_from_the_selected_leg_while_it_is_drawn() {
    let band = gcs_app::theme::palette(true).contingency;
    let mut window = window();
    let middle = |window: &Window, from: &str, to: &str| window.centre(from).lerp(window.centre(to), 0.5);
    let sides = [middle(&window, "Fix A", "Fix B"), middle(&window, "Fix C", "Fix D")];
    window.press(Key::E);
    let runway = window.centre("Runway R05");
    window.click_at(runway);
    let there = window.centre("Map") + vec2(60.0, 40.0);
    window.harness.hover_at(there);
    window.steps(2);
    assert!(window.shows("Select a leg to see the way in"));
    let ends = |window: &Window| sides.map(|side| window.line_ends_near(side, band));
    let before = ends(&window);
    for (leg, number) in [("side2", 0), ("side4", 1)] {
        window.click(&format!("TF {leg}"));
        window.harness.hover_at(there);
        window.steps(2);
        assert!(window.shows(&format!("From {leg}: ")), "how far and how long it is");
        let (now, other) = (ends(&window), 1 - number);
        assert!(now[number] > before[number] && now[other] == before[other], "{leg}: {before:?} {now:?}");
    }
    assert!(window.shows("Esc gives up"), "no undo brings the places back");
    window.press(Key::Escape);
    window.press(Key::Escape);
    assert_eq!(ends(&window), before);
}

/// From anywhere it is as high as the hills around the runway ask for.
#[test]
fn an_emergency_plan_that_is_drawn_from_a_leg_does_not_climb_without_need() {
    let drawn_from = |leg: Option<&str>| {
        let mut window = window();
        if let Some(leg) = leg {
            window.click(&format!("TF {leg}"));
        }
        let there = window.centre("Fix D") + vec2(-30.0, 30.0);
        window.press(Key::E);
        let runway = window.centre("Runway R05");
        window.click_at(runway);
        window.click_at(there);
        window.press(Key::Enter);
        window.steps(3);
        let plan = window.plan();
        let made = plan.emergency_plans.last().unwrap();
        let first = made.stages[0].legs[0].altitude.clone().unwrap();
        let flight_plan::Value::Constant(height_m) = first.metres else { panic!("{first:?}") };
        let forecast = &window.app().analysis().forecast;
        let path = forecast.middle_of_s(&"side2".into()).and_then(|time_s| forecast.at(time_s)).unwrap();
        let climb_m = height_m + plan.home().unwrap().elevation_amsl_m - path.altitude_amsl_m;
        let says_why = "above the path where it was drawn from: the ground on its way asks for that";
        (height_m, climb_m, window.shows(says_why))
    };
    let (anywhere_m, ..) = drawn_from(None);
    let (low_m, climb_m, says_why) = drawn_from(Some("side2"));
    assert!(low_m < anywhere_m, "{low_m} {anywhere_m}");
    assert_eq!(says_why, climb_m > 1.0, "{climb_m}");
}

#[test]
fn what_does_not_go_with_the_selection_is_fainter() {
    let zone = r#"<zones><keepOut id="quarry" lat="36.3141" lon="-84.1567" radius="150"/></zones><mainPlan"#;
    let mut window = Window::open(&super::SQUARE.replacen("<mainPlan", zone, 1));
    window.until_analysed();
    let colour = |window: &Window| window.colour_within("Map", "Keep out: quarry").unwrap();
    let alone = colour(&window);
    window.click("TF side3");
    window.steps(2);
    assert!(colour(&window).a() < alone.a(), "{alone:?}");
    window.harness.get_by_role_and_label(Role::TreeItem, "OUT quarry").scroll_to_me();
    window.steps(10);
    window.select_row(("OUT quarry", 0));
    window.steps(2);
    assert_eq!(colour(&window), alone);
}

#[test]
fn pictures_along_a_leg_are_taken_from_its_menu_and_seen_on_the_map() {
    let mut window = window();
    let before = window.plan();
    window.click("TF side3");
    let choose = |window: &mut Window, entry: &str| {
        window.harness.get_by_label("TF side3").click_secondary();
        window.steps(3);
        let at = window.harness.get_by_label_contains(entry).rect().center();
        window.click_at(at);
        window.until_analysed();
    };
    choose(&mut window, "Take pictures along it");
    assert_eq!(window.plan().leg(&"side3".into()).unwrap().leg.actions.len(), 1);
    assert_eq!(window.errors(), Vec::<String>::new());
    assert!(window.paints("Picture every") && window.paints("overlap"));
    choose(&mut window, "Take no pictures along it");
    assert_eq!(window.plan(), before);
    assert!(!window.paints("overlap"));
}

#[test]
fn what_is_selected_elsewhere_comes_into_view() {
    let mut window = window();
    let shown = window.centre("Fix B");
    window.click("TF side3");
    assert_eq!(window.centre("Fix B"), shown, "it was in view");
    let beside = window.centre("Map") + vec2(200.0, -120.0);
    for _ in 0..6 {
        window.drag(beside, vec2(-300.0, 0.0));
    }
    assert!(window.harness.query_by_label("Fix C").is_none(), "it is out of view");
    window.click("TF side2");
    window.click("TF side3");
    let map = window.harness.get_by_label("Map").rect();
    assert!(map.contains(window.centre("Fix C")), "it is back");
}
