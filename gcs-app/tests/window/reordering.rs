//! Rows of the table find other places by drag, and legs that the preview does not fly are listed.

use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Key, Pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::FlightPlan;

const FIRE_WATCH: &str = include_str!("../../../assets/plans/fire-watch.xml");

fn opened(text: &str) -> Window {
    let mut window = Window::open_with(text, vec2(1600.0, 1400.0), None);
    window.until_analysed();
    super::fleet::tab(&mut window, "Table");
    window.steps(3);
    window
}

/// The square; all of its sides are in view.
fn opened_square() -> Window {
    let mut window = opened(SQUARE);
    window.click("TF side4");
    window.steps(5);
    window
}

fn legs(plan: &FlightPlan) -> String {
    let legs = plan.stages.iter().flat_map(|stage| &stage.legs);
    legs.map(|leg| leg.id.to_string()).collect::<Vec<_>>().join(" ")
}

impl Window {
    /// The row of a leg in the table, so far down in it.
    fn table_row(&self, leg: &str, down: f32) -> Pos2 {
        let name = format!("Altitude of {leg}");
        let mut cells = self.harness.get_all_by_role_and_label(Role::Button, &name);
        cells.next().unwrap().rect().lerp_inside(vec2(0.5, down))
    }

    fn grab_in_table(&mut self, from: Pos2, to: Pos2) {
        self.harness.hover_at(from);
        self.harness.drag_at(from);
        for part in 1..=4 {
            self.harness.hover_at(from + (to - from) * (part as f32 / 4.0));
            self.steps(1);
        }
        self.steps(2);
    }
}

#[test]
fn a_row_of_the_table_is_dragged_as_in_the_tree() {
    let mut window = opened_square();
    let before = window.plan();
    let (from, to) = (window.table_row("side4", 0.5), window.table_row("side2", 0.2));
    window.grab_in_table(from, to);
    // the line is between the two rows, across the table
    let accent = gcs_app::theme::palette(true).accent;
    let lines = window.level_lines(accent);
    let is_there = |[a, b]: &[Pos2; 2]| (a.y - to.y).abs() < 8.0 && a.y == b.y && b.x - a.x > 400.0;
    assert!(lines.iter().any(is_there), "no line near {to}: {lines:?}");
    assert_eq!(window.plan(), before, "nothing is moved before it is let go");
    window.harness.drop_at(to);
    window.steps(4);
    let in_table = window.plan();
    assert_eq!(legs(&in_table), "side1 side4 side2 side3");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
    window.drop_row("TF side4", "TF side2", 0.2);
    assert_eq!(window.plan(), in_table, "the tree does the same");
}

#[test]
fn escape_leaves_a_row_of_the_table_where_it_is_and_several_go_together() {
    let mut window = opened_square();
    let before = window.plan();
    let (from, to) = (window.table_row("side4", 0.5), window.table_row("side2", 0.2));
    window.grab_in_table(from, to);
    window.press(Key::Escape);
    window.harness.drop_at(to);
    window.steps(4);
    assert_eq!(window.plan(), before);
    window.click("TF side1");
    window.press_with(egui::Modifiers::SHIFT, Key::ArrowDown);
    window.until_analysed();
    let (from, to) = (window.table_row("side1", 0.5), window.table_row("side4", 0.9));
    window.grab_in_table(from, to);
    window.harness.drop_at(to);
    window.steps(4);
    assert_eq!(legs(&window.plan()), "side3 side4 side1 side2");
}

/// Another branch of a fork, the legs of emergency plans: they were in the tree alone.
#[test]
fn legs_that_the_preview_does_not_fly_are_listed_when_they_are_asked_for() {
    let mut window = opened(FIRE_WATCH);
    let flown = |window: &Window, leg: &str| {
        window.app().analysis().forecast.passages.iter().any(|passage| passage.leg.as_str() == leg)
    };
    let listed = |window: &mut Window, row: &str, leg: &str| {
        window.select_row((row, 0));
        window.steps(3);
        let name = format!("Name of {leg}");
        window.harness.query_all_by_role_and_label(Role::Button, &name).next().is_some()
    };
    let aside = [("ORB Close look", "look"), ("DF Direct to the final", "r1")];
    for (row, leg) in aside {
        assert!(!flown(&window, leg) && !listed(&mut window, row, leg), "{leg}");
    }
    window.click("All legs");
    window.steps(3);
    for (row, leg) in aside {
        assert!(listed(&mut window, row, leg), "{leg}");
    }
    let p = gcs_app::theme::palette(true);
    assert!(window.shows("Flown in an emergency only"));
    assert_eq!(window.colour_within("Name of r1", "Direct"), Some(p.weak), "dim");
    assert!(window.shows("Emergency plan Return to R05"), "its heading");
    // what can be seen is laid out, and no more
    let rows = window.harness.query_all_by_role(Role::Button);
    let names = rows.filter(|row| row.accesskit_node().label().is_some_and(|l| l.starts_with("Name of ")));
    assert!(names.count() < 60);
}
