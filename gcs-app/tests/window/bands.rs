//! Rubber bands lead to wherever the flight may go on: to the next leg, to each branch, and while something is dragged.

use super::branching::with_drawn_way;
use super::pasting::window;
use super::{SQUARE, Window};
use egui::{Key, Pos2, Shape, vec2};
use egui_kittest::kittest::Queryable;

/// The discs of a shape.
fn discs(shape: &Shape) -> Vec<(Pos2, egui::Color32)> {
    match shape {
        Shape::Circle(circle) => vec![(circle.center, circle.fill)],
        Shape::Vec(several) => several.iter().flat_map(discs).collect(),
        _ => Vec::new(),
    }
}

/// Dots that are painted on the map in the colour of bands to what follows, along the way between two places.
fn dots(window: &Window, from: Pos2, to: Pos2) -> usize {
    let weak = gcs_app::theme::palette(true).weak;
    let map = window.harness.get_by_label("Map").rect().expand(1.0);
    let shapes = window.harness.output().shapes.iter().filter(|clipped| map.contains_rect(clipped.clip_rect));
    let way = (to - from).normalized();
    let is_on_way = |at: Pos2| {
        let by = at - from;
        (0.0..(to - from).length()).contains(&by.dot(way)) && by.dot(way.rot90()).abs() < 3.0
    };
    let discs = shapes.flat_map(|clipped| discs(&clipped.shape));
    discs.filter(|(at, fill)| *fill == weak && is_on_way(*at)).count()
}

/// The lines of a shape, with their colour.
fn strokes(shape: &Shape) -> Vec<([Pos2; 2], egui::Color32)> {
    match shape {
        Shape::LineSegment { points, stroke } => vec![(*points, stroke.color)],
        Shape::Vec(several) => several.iter().flat_map(strokes).collect(),
        _ => Vec::new(),
    }
}

/// Dashes that are painted on the map in the colour of contingencies, along the way between two places.
fn dashes(window: &Window, from: Pos2, to: Pos2) -> usize {
    let contingency = gcs_app::theme::palette(true).contingency;
    let way = (to - from).normalized();
    let is_on_way = |at: Pos2| {
        let by = at - from;
        (-1.0..(to - from).length() + 1.0).contains(&by.dot(way)) && by.dot(way.rot90()).abs() < 3.0
    };
    let lines = window.harness.output().shapes.iter().flat_map(|clipped| strokes(&clipped.shape));
    lines.filter(|(ends, colour)| *colour == contingency && ends.iter().all(|at| is_on_way(*at))).count()
}

#[test]
fn a_new_leg_has_dashes_to_its_alternate() {
    let mut window = window();
    window.click("TF side2");
    let at = window.centre("Map") + vec2(60.0, 40.0);
    let (alternate, other) = (window.centre("Fix D"), window.centre("Fix A"));
    assert_eq!(dashes(&window, at, alternate), 0, "nothing is drawn yet");
    window.press(Key::T);
    window.harness.hover_at(at);
    window.steps(2);
    assert!(dashes(&window, at, alternate) > 5, "{}", dashes(&window, at, alternate));
    assert!(dashes(&window, at, other) < 3, "they lead nowhere else");
}

#[test]
fn a_new_leg_leads_to_the_next_one() {
    let mut window = window();
    window.click("TF side2");
    let at = window.centre("Map") + vec2(60.0, 40.0);
    let (next, other) = (window.centre("Fix C"), window.centre("Fix A"));
    window.press(Key::T);
    window.harness.hover_at(at);
    window.steps(2);
    assert!(dots(&window, at, next) > 10, "{}", dots(&window, at, next));
    assert!(dots(&window, at, other) < 5, "it leads nowhere else");
}

#[test]
fn a_new_leg_before_a_fork_leads_to_each_of_its_branches() {
    let mut window = with_drawn_way(1000.0);
    window.until_analysed();
    window.click("TF side2");
    let at = window.centre("Map") + vec2(150.0, 20.0);
    let branches = [window.centre("Fix C"), window.centre("Waypoint leg1")];
    window.press(Key::T);
    window.harness.hover_at(at);
    window.steps(2);
    for to in branches {
        assert!(dots(&window, at, to) > 5, "to {to}: {}", dots(&window, at, to));
    }
}

#[test]
fn a_waypoint_that_is_dragged_leads_to_the_next_leg() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let (from, next) = (window.centre("Fix B"), window.centre("Fix C"));
    let to = from + vec2(40.0, 50.0);
    window.harness.hover_at(from);
    window.harness.drag_at(from);
    window.steps(2);
    assert_eq!(dots(&window, to, next), 0);
    window.harness.hover_at(from + vec2(20.0, 25.0));
    window.steps(1);
    window.harness.hover_at(to);
    window.steps(3);
    assert!(dots(&window, to, next) > 10, "{}", dots(&window, to, next));
    window.harness.drop_at(to);
    window.steps(3);
    assert_eq!(dots(&window, to, next), 0, "it is over");
}
