//! From an empty document to a plan that flies, and nothing lost on the way.

use super::Window;
use egui::{Key, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::template::Template;
use flight_plan::{LegKind, Pattern};

const EMPTY: &str = "<flightPlan xmlns='urn:legwork:flight-plan:1' name='New plan' aircraft='trainer'/>";

fn stages(window: &Window) -> usize {
    window.app().document().plan().stages.len()
}

#[test]
fn each_template_gives_a_plan_that_can_be_flown_and_undone() {
    for template in Template::ALL {
        let mut window = Window::open(EMPTY);
        window.steps(3);
        assert!(window.shows("New mission"));
        window.click(template.name());
        window.click("Create");
        assert!(!window.shows("New mission") && window.app().document().is_dirty());
        window.until_analysed();
        let errors: Vec<_> = window.app().analysis().problems.iter().filter(|p| p.is_error()).collect();
        assert!(errors.is_empty() && window.shows("can be flown"), "{template:?}: {errors:?}");
        assert!(window.app().analysis().forecast.length_m() > 5000.0);
        window.click("Undo");
        assert!(stages(&window) == 0 && window.shows("New mission"));
    }
}

#[test]
fn point_of_a_new_corridor_is_dragged_by_itself() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.click("Corridor");
    window.click("Create");
    window.until_analysed();
    let route = |window: &Window| {
        let context = window.app().document().plan().leg(&"strip".into()).unwrap().leg.clone();
        let LegKind::Pattern(Pattern::Corridor { route, .. }) = context.kind else { panic!("no corridor") };
        route
    };
    let before = route(&window);
    window.click("CORR Along the line");
    let at = window.centre("Corner 3 of strip");
    window.drag(at, vec2(-40.0, -30.0));
    let after = route(&window);
    assert_eq!(after[..2], before[..2]);
    assert_ne!(after[2], before[2]);
}

#[test]
fn card_fits_the_smallest_window() {
    let mut window = Window::open_with(EMPTY, vec2(960.0, 600.0), None);
    window.steps(5);
    for label in ["Create", "Open a plan…", "Survey", "Height"] {
        let rect = window.harness.get_all_by_label(label).next().unwrap().rect();
        assert!(rect.min.y > 42.0 && rect.max.y < 600.0 && rect.max.x < 960.0, "{label}: {rect:?}");
    }
    // the map, its tools and the tabs below it stay free
    let map = window.harness.get_by_label("Map").rect();
    for label in ["Create", "Open a plan…", "Survey", "Height", "New mission"] {
        let rect = window.harness.get_all_by_label(label).next().unwrap().rect();
        assert!(rect.max.x < map.min.x, "{label}: {rect:?} over {map:?}");
    }
    // by the pointer: what is covered can't be clicked
    let at = window.centre("Create");
    window.harness.hover_at(at);
    window.harness.drag_at(at);
    window.harness.drop_at(at);
    window.steps(3);
    assert!(stages(&window) > 0);
}

#[test]
fn plan_with_unsaved_changes_gives_way_only_when_told_to() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.click("Create");
    let made = stages(&window);
    window.press_ctrl(Key::N);
    assert!(window.shows("has unsaved changes") && stages(&window) == made);
    window.click("Cancel");
    assert!(!window.shows("has unsaved changes") && stages(&window) == made);
    window.press_ctrl(Key::N);
    window.click("Discard the changes");
    assert!(stages(&window) == 0 && !window.shows("has unsaved changes"));
    window.press_ctrl(Key::N);
    assert!(!window.shows("has unsaved changes"), "there is nothing to be lost");
}

#[test]
fn window_with_unsaved_changes_asks_before_it_closes() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.click("Create");
    let viewport = window.harness.ctx.viewport_id();
    let input = window.harness.input_mut();
    input.viewports.entry(viewport).or_default().events.push(egui::ViewportEvent::Close);
    window.steps(1);
    window.harness.input_mut().viewports.entry(viewport).or_default().events.clear();
    window.steps(1);
    assert!(window.shows("The window is about to close"));
    window.click("Cancel");
    assert!(!window.shows("The window is about to close"));
}
