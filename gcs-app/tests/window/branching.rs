//! Ways on from a fork, drawn on the map.

use super::drawing::choose;
use super::pasting::taken;
use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Key, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::Id;

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// The legs of the circuit in their order, each with where it says that it leads.
fn ways(window: &Window) -> Vec<String> {
    let plan = window.plan();
    let said = |next: &Option<Id>| next.as_ref().map_or(String::new(), |next| format!(">{next}"));
    let legs = plan.stage(&"circuit".into()).unwrap().legs.iter();
    legs.map(|leg| {
        let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches).iter();
        let branches: String = branches.map(|b| format!(" {}{}", b.id, said(&b.next))).collect();
        format!("{}{}{branches}", leg.id, said(&leg.next))
    })
    .collect()
}

#[test]
fn a_new_way_is_drawn_from_a_leg_and_taken_back_in_one_step_each() {
    let mut window = window();
    let before = ways(&window);
    window.row_menu(("TF side2", 0), "Draw a new way from it");
    window.steps(3);
    assert!(window.shows("Draw legs on a new way from side2"));
    let at = window.centre("Map");
    window.click_at(at + vec2(40.0, 90.0));
    window.click_at(at + vec2(-30.0, 120.0));
    let drawn = ["side1", "side2", "fork1 on>side3 way2>leg1", "leg1", "leg2", "side3", "side4"];
    assert_eq!(ways(&window), drawn);
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    window.press(Key::Backspace);
    assert_eq!(ways(&window)[3..], ["leg1", "side3", "side4"]);
    for _ in 0..3 {
        window.click("Undo");
    }
    assert_eq!(ways(&window), before);
}

#[test]
fn with_a_fork_selected_legs_are_drawn_into_the_branch_that_is_chosen() {
    let mut window = window();
    window.harness.get_by_label("TF side2").click_secondary();
    window.steps(3);
    let at = window.harness.get_by_label_contains("Fork before it").rect().center();
    window.click_at(at);
    window.press(Key::T);
    choose(&mut window, "Where: behind fork1", "on “Go on” from fork1");
    let at = window.centre("Map");
    window.click_at(at + vec2(40.0, 90.0));
    assert_eq!(ways(&window), ["side1", "fork1 on>leg1 skip>side3", "leg1", "side2", "side3", "side4"]);
    assert!(window.shows("Draw legs: ") || window.shows("Next leg"), "the next click goes on from there");
}

/// What a close look after the scan needs; the branch is called after what is drawn into it.
#[test]
fn a_fork_is_put_behind_a_leg_and_its_other_way_is_named_by_what_is_drawn() {
    let mut window = window();
    window.row_menu(("TF side2", 0), "Fork behind it");
    window.steps(2);
    assert_eq!(ways(&window)[..4], ["side1", "side2", "fork1 on>side3 way2>side3", "side3"]);
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    window.select_row(("▸ Way 2", 0));
    window.press(Key::O);
    let at = window.centre("Map") + vec2(60.0, 120.0);
    window.click_at(at);
    window.click_at(at + vec2(50.0, 0.0));
    let look = window.selected();
    window.press(Key::V);
    assert_eq!(ways(&window)[2], format!("fork1 on>side3 way2>{look}"));
    assert_eq!(window.plan().branch_label(&Id::new("fork1"), &Id::new("way2")), "Orbit");
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
}

#[test]
fn a_branch_that_is_selected_has_its_own_fields_first() {
    let mut window = with_drawn_way(800.0);
    window.select_row(("▸ Way 2", 0));
    window.steps(2);
    let own = window.harness.get_by_role_and_label(Role::TextInput, "Selected branch: Label").rect();
    let of_fork = window.harness.query_all_by_role_and_label(Role::TextInput, "Name").next().unwrap().rect();
    assert!(own.bottom() < of_fork.top(), "{own} {of_fork}");
    assert!(own.top() < 800.0 && window.shows("branch of fork1"));
    window.fill_in(Role::TextInput, "Selected branch: Label", "Close look");
    assert_eq!(window.plan().branch_label(&Id::new("fork1"), &Id::new("way2")), "Close look");
    window.select_row(("FORK fork1", 0));
    window.steps(2);
    assert!(!window.shows("Selected branch: Label"));
}

/// The square with a second way from side2, over two legs that were drawn, in a window of this height.
pub fn with_drawn_way(height: f32) -> Window {
    let mut window = Window::open_with(SQUARE, vec2(1280.0, height), None);
    window.until_analysed();
    window.row_menu(("TF side2", 0), "Draw a new way from it");
    window.steps(3);
    let at = window.centre("Map");
    window.click_at(at + vec2(40.0, 90.0));
    window.click_at(at + vec2(-30.0, 120.0));
    window.press(Key::V);
    window
}

#[test]
fn what_is_drawn_goes_into_the_branch_that_is_selected() {
    let mut window = with_drawn_way(800.0);
    window.select_row(("▸ Way 2", 0));
    window.press(Key::O);
    assert!(window.shows("on “Way 2” from fork1"));
    let at = window.centre("Map") + vec2(-60.0, 60.0);
    window.click_at(at);
    window.click_at(at + vec2(30.0, 0.0));
    let drawn = Id::new(&window.selected());
    assert_eq!(ways(&window)[2], format!("fork1 on>side3 way2>{drawn}"));
}

#[test]
fn a_leg_is_dragged_out_of_a_branch_into_the_stage_and_back() {
    let mut window = with_drawn_way(1400.0);
    let both = ["side1", "side2", "fork1 on>side3 way2>leg1", "leg1", "leg2", "side3", "side4"];
    assert_eq!(ways(&window), both);
    window.drop_row("TF leg1", "TF side2", 0.2);
    let out = ["side1", "leg1", "side2", "fork1 on>side3 way2>leg2", "leg2", "side3", "side4"];
    assert_eq!(ways(&window), out);
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    window.drop_row("TF leg1", "▸ Way 2", 0.4);
    assert_eq!(ways(&window), both, "back in its branch");
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    for step in [&out[..], &both] {
        window.click("Undo");
        assert_eq!(ways(&window), step, "one step each");
    }
}

/// The square with a way past side3 that is not flown unless somebody decides so: a leg, a call, an area, a leg.
fn beside() -> Window {
    let procedure = r#"<procedures><procedure id="look" reference="36.3205 -84.1650">
        <TF id="p1" lat="36.3205" lon="-84.1650"/><TF id="p2" lat="36.3180" lon="-84.1680"/></procedure></procedures>"#;
    let fork = r#"<intersection id="ask" default="on"><branch id="on" label="Straight on" next="side3"/>
        <branch id="by" label="Another way" next="n1"/></intersection>
        <TF id="n1" lat="36.3225" lon="-84.1600"/><call id="n2" procedure="look"/>
        <orbit id="n3" radius="250" turns="1" turn="right"><centre lat="36.3160" lon="-84.1640"/></orbit>
        <TF id="n4" lat="36.3130" lon="-84.1700" next="side3"/><TF id="side3""#;
    let text =
        SQUARE.replace("<mainPlan", &format!("{procedure}<mainPlan")).replace("<TF id=\"side3\"", fork);
    let mut window = Window::open(&text);
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    window
}

#[test]
fn every_leg_of_a_way_that_is_not_flown_is_on_the_map() {
    let mut window = beside();
    for leg in ["n1", "n2", "n3", "n4"] {
        let name = format!("Path of {leg}");
        assert!(window.harness.query_by_label(&name).is_some(), "{leg}");
        let at = window.centre(&name);
        window.click_at(at);
        assert_eq!(window.selected(), leg, "a click on its line selects it");
        let line = gcs_app::theme::palette(true).text;
        assert!(window.lines_within("Map", line) > 0);
    }
    assert!(window.paints("Another way"));
}

/// The clipboard holds no branches: the fork, which has them all, is not meant.
#[test]
fn a_branch_is_not_cut_and_its_fork_stays() {
    let mut window = beside();
    let before = window.plan();
    window.select_row(("▸ Another way", 0));
    window.steps(2);
    assert_eq!(taken(&mut window, egui::Event::Cut), "");
    assert!(window.plan() == before && window.shows("A branch can't be cut"));
}

#[test]
fn a_waypoint_is_dragged_out_of_the_first_line_of_a_way() {
    let mut window = beside();
    let before = ways(&window);
    let at = window.centre("Fix B").lerp(window.centre("Waypoint n1"), 0.25);
    window.drag(at, vec2(20.0, 25.0));
    let longer =
        ["side1", "side2", "ask on>side3 by>leg1", "leg1", "n1", "n2", "n3", "n4>side3", "side3", "side4"];
    assert_eq!(ways(&window), longer, "the way begins there");
    window.click("Undo");
    assert_eq!(ways(&window), before, "one step");
}

#[test]
fn places_and_names_stay_on_the_map_while_a_tool_is_on() {
    let mut window = beside();
    assert!(window.paints("n1") && window.paints("B"));
    for tool in [Key::T, Key::A, Key::Z, Key::E, Key::M] {
        window.press(tool);
        assert!(window.paints("n1") && window.paints("B") && window.paints("Another way"), "{tool:?}");
        let colour = window.colour_within("Map", "n1").unwrap();
        assert_ne!(colour, gcs_app::theme::palette(true).text, "fainter: {tool:?}");
    }
}

#[test]
fn a_branch_has_its_legs_below_it_and_is_renamed_moved_and_deleted_by_its_row() {
    let mut window = with_drawn_way(1000.0);
    let drawn = ways(&window);
    window.click("TF leg2");
    window.press(Key::ArrowLeft);
    window.press(Key::F2);
    window.harness.event(egui::Event::Text("Close look".into()));
    window.steps(2);
    window.press(Key::Enter);
    let fork = Id::new("fork1");
    assert_eq!(window.plan().branch_label(&fork, &Id::new("way2")), "Close look");
    assert!(window.shows("▸ Close look") && window.plan().any_leg(&fork).unwrap().name.is_empty());
    window.press_ctrl(Key::ArrowUp);
    assert_eq!(ways(&window)[2], "fork1 way2>leg1 on>side3");
    window.click("Undo");
    assert_eq!(ways(&window), drawn);
    window.press(Key::Delete);
    assert_eq!(ways(&window), ["side1", "side2", "fork1 on>side3", "side3", "side4"]);
    window.click("Undo");
    assert_eq!(ways(&window), drawn, "one step");
    window.row_menu(("▸ Close look", 0), "Delete it and its legs");
    assert_eq!(ways(&window).len(), 5);
}

#[test]
fn a_branch_is_dragged_among_those_of_its_fork() {
    let mut window = with_drawn_way(1400.0);
    let drawn = ways(&window);
    window.drop_row("▸ Way 2", "▸ Go on", 0.2);
    assert_eq!(ways(&window)[2], "fork1 way2>leg1 on>side3");
    window.click("Undo");
    assert_eq!(ways(&window), drawn, "one step");
    window.drag_row("▸ Way 2", "TF side1", 0.2);
    assert!(window.shows("A branch goes among those of its fork"));
}
