//! The main states at the smallest and the largest scale that people use, with the zoom factor of a real window: nothing is cut off,
//! nothing lies over another thing, no text ends without an ellipsis and a tooltip.

use super::states::{self, THEMES, examine};
use super::{SQUARE, Window};
use egui::{Vec2, vec2};
use gcs_app::theme::Scale;

/// Pixels of the window, and how large everything is.
const SCALES: [(Vec2, f32); 2] = [(vec2(1280.0, 800.0), 0.8), (vec2(3840.0, 2160.0), 3.0)];
/// As the states are made.
const USUAL: Vec2 = vec2(1280.0, 800.0);

/// A window of so many pixels at a scale.
fn scale(window: &mut Window, pixels: Vec2, scale: f32) {
    window.harness.state_mut().scale_to(Scale::new(scale).unwrap());
    window.steps(3);
    // in points as they are now; they become others with the scale
    window.harness.set_size(pixels / window.harness.ctx.zoom_factor());
    window.steps(6);
}

fn at_all_scales(state: &str, window: &mut Window, found: &mut Vec<String>) {
    for (pixels, at) in SCALES {
        scale(window, pixels, at);
        assert_eq!(window.harness.ctx.zoom_factor(), at, "{state}");
        assert_eq!(window.harness.ctx.content_rect().size(), pixels / at, "{state}");
        for theme in THEMES {
            examine(&format!("{state} at {at}"), pixels, theme, window, found);
        }
    }
    scale(window, USUAL, 1.0);
}

#[test]
fn of_a_new_plan() {
    states::new_plan(at_all_scales);
}

#[test]
fn of_selections_and_tools() {
    states::selections_and_tools(at_all_scales);
}

#[test]
fn of_panels_and_dialogs() {
    states::panels_and_dialogs(at_all_scales);
}

#[test]
fn of_a_flight() {
    states::flight(at_all_scales);
}

#[test]
fn of_questions_and_emergencies() {
    states::questions_and_emergencies(at_all_scales);
}

/// It was made smaller without a word.
#[test]
fn a_scale_that_does_not_fit_the_window_is_told_where_it_is_chosen() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.harness.state_mut().scale_to(Scale::new(3.0).unwrap());
    window.steps(4);
    let said = |window: &mut Window, words: &str| {
        window.click("Legwork");
        window.click("View");
        let said = window.paints(words);
        window.press(egui::Key::Escape);
        window.press(egui::Key::Escape);
        window.steps(3);
        said
    };
    let shown = window.harness.ctx.zoom_factor();
    assert!(shown < 3.0);
    // the test's window keeps its points, whatever their size
    let words = format!("300 % does not fit this window: shown at {:.0} %", shown * 100.0);
    assert!(said(&mut window, &words), "{words}");
    scale(&mut window, USUAL, 1.0);
    let most = window.app().view().most_scale.unwrap() * 100.0;
    let words = format!("This window has room for {most:.0} % at most");
    assert!(most < 300.0 && said(&mut window, &words), "{words}");
    scale(&mut window, vec2(3840.0, 2160.0), 1.0);
    assert!(!said(&mut window, "room for"), "it has room for all");
}
