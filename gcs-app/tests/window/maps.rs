//! The map itself: moving about it, and the maps and elevations that users bring.

use super::{SQUARE, Window};
use egui::{Event, Key, Modifiers, MouseWheelUnit, Pos2, TouchPhase, vec2};

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// Turns the wheel by some notches, and waits until the map stands still.
fn wheel(window: &mut Window, at: Pos2, notches: f32) {
    window.harness.hover_at(at);
    window.steps(1);
    window.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, notches),
        phase: TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    window.steps(40);
}

#[test]
fn the_wheel_zooms_in_small_steps_around_the_pointer() {
    let mut window = window();
    let (a, b) = (window.centre("Fix A"), window.centre("Fix B"));
    let apart = a.distance(b);
    wheel(&mut window, a, 1.0);
    assert!(window.centre("Fix A").distance(a) < 1.5, "{a} {}", window.centre("Fix A"));
    let step = window.centre("Fix A").distance(window.centre("Fix B")) / apart;
    assert!((1.1..1.3).contains(&step), "a notch: {step}");
    wheel(&mut window, a, -2.0);
    assert!(window.centre("Fix A").distance(a) < 1.5);
    assert!(window.centre("Fix A").distance(window.centre("Fix B")) < apart * 0.95);
}

#[test]
fn keys_zoom_and_pan_the_map() {
    let mut window = window();
    let (a, b) = (window.centre("Fix A"), window.centre("Fix B"));
    window.press(Key::Minus);
    let apart = window.centre("Fix A").distance(window.centre("Fix B"));
    assert!((apart / a.distance(b) - 0.5f32.sqrt()).abs() < 0.02);
    window.press(Key::Plus);
    assert!(window.centre("Fix A").distance(a) < 1.0);
    window.press(Key::ArrowRight);
    assert!((window.centre("Fix A") - a).x < -50.0, "the map moves under the view");
}

#[test]
fn the_aircraft_is_followed_while_zooming_and_left_by_panning() {
    let mut window = window();
    window.connect();
    window.click("Follow the aircraft");
    assert!(window.app().view().follow);
    let middle = window.centre("Map");
    let away = window.centre("Fix D") - middle;
    wheel(&mut window, middle + vec2(150.0, 100.0), -1.0);
    assert!(window.app().view().follow);
    let zoomed = window.centre("Fix D") - middle;
    assert!((zoomed - away * (-0.25f32).exp2()).length() < 2.0, "around the aircraft: {away} {zoomed}");
    window.click("Zoom out");
    assert!(window.app().view().follow);
    window.press(Key::ArrowLeft);
    assert!(!window.app().view().follow);
}

#[test]
fn a_double_click_does_not_move_the_map() {
    let mut window = window();
    let a = window.centre("Fix A");
    let at = window.centre("Map") + vec2(40.0, 120.0);
    window.click_at(at);
    window.click_at(at);
    window.steps(20);
    assert!(window.centre("Fix A").distance(a) < 0.5);
}
