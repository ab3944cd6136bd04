//! Runways that are there already, and their other directions.

use super::{SQUARE, Window};
use egui::{Key, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::FlightPlan;

const OTHER: &str = "Add its other direction";

fn opened() -> Window {
    // all of the tree is in sight
    let mut window = Window::open_with(SQUARE, vec2(1280.0, 1000.0), None);
    window.until_analysed();
    window
}

fn ids(window: &Window) -> Vec<String> {
    window.plan().runways.iter().map(|runway| runway.id.to_string()).collect()
}

/// Where the runway begins on the screen, and where it ends.
fn ends(window: &Window) -> [Pos2; 2] {
    let along = vec2(52_f32.to_radians().sin(), -52_f32.to_radians().cos());
    let threshold = window.harness.get_by_label("Runway R05").rect().center();
    [threshold, threshold + along * 40.0]
}

/// It became R05L, over the runway that is there.
#[test]
fn a_runway_that_is_drawn_over_one_is_that_one_with_the_direction_that_it_lacks() {
    let mut window = opened();
    let [threshold, end] = ends(&window);
    let draw = |window: &mut Window, from, to| {
        window.press(Key::R);
        window.click_at(from);
        window.click_at(to);
        window.press(Key::Escape);
    };
    draw(&mut window, threshold, end);
    assert_eq!(ids(&window), ["R05", "R23"]);
    assert!(window.shows("Runway R05 lies there already: R23, its other direction, was added"));
    assert_eq!(window.selected(), "R23");
    let (one, other) = (window.plan().runways[0].clone(), window.plan().runways[1].clone());
    assert!(one.from_other_end().threshold.distance_m(other.threshold) < 1.0, "however it was drawn");
    // no double click
    window.steps(40);
    draw(&mut window, end + vec2(3.0, 2.0), threshold + vec2(3.0, 2.0));
    assert_eq!(ids(&window), ["R05", "R23"], "nothing is lacking");
    assert!(window.shows("Runway R23 lies there already: it is selected") && window.selected() == "R23");
    window.click("Undo");
    assert_eq!(ids(&window), ["R05"], "one step");
}

#[test]
fn the_other_direction_of_a_runway_is_added_in_inspector_menu_and_palette() {
    let ground = gcs_app::assets::demo_terrain();
    for how in 0..3 {
        let mut window = opened();
        window.select_row(("RWY R05", 0));
        window.steps(3);
        match how {
            0 => window.click(OTHER),
            1 => window.row_menu(("RWY R05", 0), OTHER),
            _ => {
                window.ask_for("add its other direction");
                window.press(Key::Enter);
            }
        }
        assert_eq!(
            (ids(&window), window.selected().as_str()),
            (vec!["R05".to_owned(), "R23".to_owned()], "R23")
        );
        let other = window.plan().runways[1].clone();
        let is_m = ground.elevation_m(other.threshold).unwrap();
        assert!((other.elevation_amsl_m - is_m).abs() < 2.0, "{} {is_m}", other.elevation_amsl_m);
        assert!(!window.shows(OTHER), "it has one now");
        window.ask_for("add its other direction");
        assert!(window.paints("Its other direction is in the plan already"));
    }
}

/// It led to the direction that was drawn first, and its places lay on the wrong side.
#[test]
fn an_emergency_plan_leads_to_the_direction_that_begins_where_the_runway_was_clicked() {
    for (runway, nearer) in [("R05", 0), ("R23", 1)] {
        let mut window = opened();
        let drawn = ends(&window);
        window.press(Key::R);
        drawn.into_iter().for_each(|at| window.click_at(at));
        window.press(Key::Escape);
        // no double click
        window.steps(40);
        let middle = window.harness.get_by_label("Runway R05").rect().center();
        let along = (drawn[1] - drawn[0]).normalized() * 12.0;
        window.press(Key::E);
        window.click_at([middle - along, middle + along][nearer]);
        assert!(window.shows(&format!("To {runway}: click its places outwards")), "{runway}");
    }
}

/// They stayed before the other end, and the landing was another one.
#[test]
fn the_approach_goes_with_an_emergency_plan_that_lands_on_the_other_direction() {
    let mut window = opened();
    window.row_menu(("RWY R05", 0), OTHER);
    window.press(Key::Escape);
    let [middle, towards] = ends(&window);
    window.press(Key::E);
    window.click_at(middle - (towards - middle).normalized() * 12.0);
    window.press(Key::Enter);
    window.press(Key::Escape);
    let before = window.plan();
    let id = before.emergency_plans.last().unwrap().id.clone();
    assert_eq!((id.as_str(), window.selected()), ("return2", id.to_string()), "what was made is selected");
    assert_eq!(before.emergency_plan(&id).unwrap().runway.as_str(), "R05");
    let last_leg_at = |plan: &FlightPlan| {
        let stages = &plan.emergency_plan(&id).unwrap().stages;
        let leg = stages.iter().rev().find_map(|stage| stage.legs.last()).unwrap();
        flight_plan::transform::places(plan, leg)[0]
    };
    window.choose_option("Lands on", "R23");
    let plan = window.plan();
    let at = last_leg_at(&plan);
    let [old, new] = &plan.runways[..] else { panic!("two") };
    assert_eq!(plan.emergency_plan(&id).unwrap().runway, new.id);
    assert!(at.distance_m(new.threshold) < at.distance_m(old.threshold), "before the other end");
    assert_eq!(plan.stages, before.stages);
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

/// It led to the one direction, and nobody said that the other one has to be in the plan first.
#[test]
fn an_emergency_plan_offers_the_direction_that_lacks_where_the_runway_was_clicked_at_its_end() {
    let mut window = opened();
    let [middle, towards] = ends(&window);
    let along = (towards - middle).normalized() * 12.0;
    window.press(Key::E);
    window.click_at(middle - along);
    assert!(window.shows("To R05: click its places outwards") && !window.shows(OTHER));
    window.press(Key::Escape);
    window.steps(40);
    window.click_at(middle + along);
    assert!(window.shows("You clicked the end of R05"));
    window.click(OTHER);
    assert_eq!(ids(&window), ["R05", "R23"]);
    assert!(window.shows("To R23: click its places outwards") && !window.shows(OTHER));
    window.press(Key::Enter);
    assert_eq!(window.plan().emergency_plans.last().unwrap().runway.as_str(), "R23");
}

/// It came as a surprise, far away from what was clicked.
#[test]
fn an_emergency_plan_shows_the_hold_and_the_final_that_it_gets_while_it_is_drawn() {
    let mut window = opened();
    // the hold is beyond the edge
    (0..2).for_each(|_| window.click("Zoom out"));
    let said = "Enter adds hold and final";
    let [middle, towards] = ends(&window);
    window.press(Key::E);
    assert!(!window.paints(said));
    window.click_at(middle - (towards - middle).normalized() * 12.0);
    let shown = window.places_of(|text| text == said)[0];
    window.press(Key::Enter);
    window.press(Key::V);
    window.steps(2);
    assert!(!window.paints(said), "it is there now");
    let made = window.plan().emergency_plans.last().cloned().unwrap();
    let hold = made.stages[0].legs.last().unwrap();
    let Some(flight_plan::Place::Fix(fix)) = hold.place() else { panic!("{hold:?}") };
    let there = window.harness.get_by_label(&format!("Fix {fix}")).rect().center();
    assert!(there.distance(shown.left_top()) < 20.0, "{there} {shown}");
}
