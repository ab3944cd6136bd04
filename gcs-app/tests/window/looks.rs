//! What the window looks like, compared with pictures that are kept; those of the guide and the README's first among them.

use super::considering::{considered, foresight};
use super::creating::{EMPTY, SIZE, begun, draw, drawn_survey};
use super::emergency::in_emergency;
use super::flying::flying;
use super::interchange::{drop_file, fixture};
use super::vehicle::decision;
use super::*;
use egui::Key;
use flight_plan::template::Template;
use gcs_app::link::Reply;

const SMALL: Vec2 = vec2(960.0, 600.0);

/// A window with a plan, everything about it found out.
fn opened(text: &str, size: Vec2) -> Window {
    let mut window = Window::open_with(text, size, None);
    window.until_analysed();
    window.steps(30);
    window
}

fn with_theme(mut window: Window, letters: &str) -> Window {
    window.ask_for(letters);
    window.press(Key::Enter);
    window.steps(10);
    window
}

#[test]
fn plan_that_was_opened() {
    opened(SQUARE, vec2(1280.0, 800.0)).picture("plan");
    let mut light = with_theme(opened(SQUARE, SMALL), "theme light");
    light.picture("plan-light");
    light.guide_picture("guide-plan");
}

#[test]
fn window_without_a_plan() {
    let mut window = Window::open_with(EMPTY, SMALL, None);
    window.steps(30);
    let mut window = with_theme(window, "theme light");
    window.picture("new-light");
    window.guide_picture("guide-new");
}

#[test]
fn plan_drawn_from_nothing() {
    let mut window = drawn_survey(vec2(1280.0, 800.0));
    window.steps(30);
    window.guide_picture("guide-drawn");
}

#[test]
fn palette_and_help() {
    let mut window = with_theme(opened(SQUARE, SMALL), "theme light");
    window.ask_for("fl");
    window.steps(10);
    window.guide_picture("guide-palette");
    window.press(Key::Escape);
    window.press(Key::F1);
    window.steps(20);
    window.picture("help-light");
}

#[test]
fn in_flight() {
    let (mut window, _) = flying();
    window.receive_attitude();
    window.steps(20);
    window.picture("flying");
    let mut light = with_theme(window, "theme light");
    light.guide_picture("guide-flying");
}

#[test]
fn alternates_of_a_plan() {
    let text = include_str!("../../../assets/plans/alternates.xml");
    let mut window = with_theme(opened(text, vec2(1280.0, 900.0)), "theme light");
    window.select_row(("SCAN Ridge", 0));
    window.steps(2);
    let at = window.harness.get_by_label("ORB Peak").rect().center();
    window.harness.hover_at(at);
    // until it tells what is in force there
    window.steps(90);
    window.guide_picture("guide-alternates");
}

#[test]
fn plan_of_another_program() {
    let mut window = with_theme(opened(SQUARE, SMALL), "theme light");
    drop_file(&mut window, &fixture("survey.plan"));
    window.until("the import", |app| app.view().imported.is_some());
    window.steps(20);
    window.guide_picture("guide-import");
}

#[test]
fn cards_in_flight() {
    let (mut window, mut value) = flying();
    window.receive_attitude();
    value.decision = Some(decision(Some("again")));
    window.receive_status(value);
    with_theme(window, "theme light").guide_picture("guide-decision");
    let (mut window, ticket) = considered();
    window.receive_attitude();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    with_theme(window, "theme light").guide_picture("guide-considered");
    let mut window = with_theme(in_emergency(), "theme light");
    window.receive_attitude();
    window.click("Put aside: uav1: is heard again");
    window.guide_picture("guide-emergency");
}

/// The first picture of the README: from an empty map to a plan without a warning, over its hills.
#[test]
fn fire_watch_drawn_from_nothing() {
    let mut window = begun(SIZE);
    let ctx = window.harness.ctx.clone();
    window.harness.state_mut().shade_ground(&ctx);
    window.click(Template::FireWatch.name());
    window.click("✏ Draw the runway");
    draw(&mut window, &[vec2(-15.0, 62.0), vec2(28.0, 42.0)]);
    window.click("✏ Draw the circle");
    draw(&mut window, &[vec2(-20.0, -5.0), vec2(-2.0, -5.0)]);
    window.click("Create");
    window.until_analysed();
    window.click("Fix");
    window.until_analysed();
    assert!(window.shows("This plan can be flown") && !window.shows("warning"));
    window.click("Put the legend away");
    window.click("SCAN Scan the fire");
    window.harness.event(egui::Event::PointerGone);
    window.until("the hills", |app| app.map().has_all_tiles());
    window.steps(60);
    let picture = window.harness.render().unwrap();
    check_picture(&picture, "../assets/screenshots/window.png");
}
