//! What has no room, and what only the map says: names that are cut have a tooltip, a leg that is drawn says its time, and what would
//! be flown is a line like no other.

use super::considering::{considered, foresight};
use super::{SQUARE, Window};
use egui::{Key, vec2};
use gcs_app::link::Reply;

const LONG: &str =
    "From the old quarry along the northern ridge to the power line and back over the lake to the church";

/// Rests the pointer there.
fn rest(window: &mut Window, at: egui::Pos2) {
    window.harness.hover_at(at);
    window.steps(60);
}

/// Where the long name is painted, cut or whole.
fn painted(window: &Window, is_cut: bool) -> Vec<egui::Pos2> {
    let shapes = window.harness.output().shapes.iter();
    let texts = shapes.flat_map(|clipped| super::painted::texts(&clipped.shape));
    let found = texts.filter(|text| text.galley.text().contains(LONG) && text.galley.elided == is_cut);
    found.map(|text| text.galley.rect.translate(text.pos.to_vec2()).center()).collect()
}

#[test]
fn a_long_name_ends_with_an_ellipsis_and_is_whole_in_its_tooltip() {
    let plan = SQUARE.replace(r#"<TF id="side2""#, &format!(r#"<TF id="side2" name="{LONG}""#));
    let mut window = Window::open(&plan);
    window.until_analysed();
    super::fleet::tab(&mut window, "Table");
    window.click(&format!("TF {LONG}"));
    let away = window.centre("Map");
    rest(&mut window, away);
    let (cut, whole) = (painted(&window, true), painted(&window, false).len());
    assert!(cut.len() >= 2, "it has no room in the table and in the inspector: {cut:?}");
    let tree = window.centre(&format!("TF {LONG}"));
    for at in cut.into_iter().chain([tree]) {
        rest(&mut window, at);
        assert!(painted(&window, false).len() > whole, "all of it, where the pointer rests at {at}");
        rest(&mut window, away);
        assert_eq!(painted(&window, false).len(), whole, "it goes again: {at}");
    }
}

/// `1.2 km · 045° · 1:20`
#[test]
fn a_leg_that_is_drawn_says_course_distance_and_time_beside_the_pointer() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    window.press(Key::T);
    let at = window.centre("Map") + vec2(60.0, 90.0);
    window.harness.hover_at(at);
    window.steps(20);
    let is_label = |text: &str| {
        let parts: Vec<&str> = text.split(" · ").collect();
        let [length, course, time] = parts[..] else { return false };
        let is_time = time.split(':').count() == 2 || time.ends_with(" s");
        (length.ends_with(" km") || length.ends_with(" m")) && course.ends_with('°') && is_time
    };
    let labels = window.places_of(is_label);
    let [label] = labels[..] else { panic!("{labels:?}") };
    assert!(label.distance_to_pos(at) < 60.0, "beside the pointer: {label} {at}");
    let words = |window: &Window| {
        let shapes = window.harness.output().shapes.iter();
        let mut texts = shapes.flat_map(|clipped| super::painted::texts(&clipped.shape));
        texts.find(|text| is_label(text.galley.text())).unwrap().galley.text().to_owned()
    };
    let first = words(&window);
    window.harness.hover_at(at + vec2(120.0, 90.0));
    window.steps(20);
    assert_ne!(words(&window), first, "it is that of the place");
}

#[test]
fn what_would_be_flown_is_a_double_line_and_nothing_else_is() {
    let (mut window, ticket) = considered();
    let p = gcs_app::theme::palette(true);
    assert_eq!(window.double_lines(p.text, p.halo), 0);
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    window.steps(5);
    assert!(window.paints("would be flown"));
    assert!(window.double_lines(p.text, p.halo) > 0, "two lines with a gap between them");
    window.press(Key::Escape);
    window.steps(3);
    assert_eq!(window.double_lines(p.text, p.halo), 0);
}
