//! What can't be moved by hand: everything while the plan is locked, and what the aircraft has behind it.

use super::flying::{flying, report};
use super::{SQUARE, Window};
use egui::{Key, Modifiers, Vec2, vec2};
use egui_kittest::kittest::Queryable;
use flight_exec::ProposalReport;
use gcs_app::link::Reply;

fn notice(window: &Window) -> String {
    window.app().view().notice.clone().unwrap_or_default()
}

/// Drags a handle; true if that changed the plan.
fn moves(window: &mut Window, handle: &str, by: Vec2) -> bool {
    let before = window.plan();
    let from = window.centre(handle);
    window.drag(from, by);
    window.plan() != before
}

#[test]
fn locked_plan_is_not_dragged_by_accident() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.press_ctrl(Key::L);
    assert!(window.shows("Locked against accidents"));
    for handle in ["Fix C", "Altitude of side2"] {
        assert!(!moves(&mut window, handle, vec2(30.0, -30.0)), "{handle}");
        assert!(notice(&window).contains("Ctrl+L unlocks it"), "{handle}");
    }
    assert!(!window.is_enabled("Undo"), "no step was made");
    window.press_ctrl(Key::L);
    assert!(!window.app().view().locked);
    assert!(moves(&mut window, "Fix C", vec2(30.0, -30.0)));
}

/// A plan of which flown legs were raised was refused when it was pushed.
#[test]
fn what_is_behind_the_aircraft_is_not_raised_with_the_others() {
    let (mut window, _) = flying();
    window.ask_for("raise or lower");
    window.press(Key::Enter);
    assert!(window.shows("stay as they are: they were flown."));
    let of = |window: &Window, leg: &str| window.plan().leg(&leg.into()).unwrap().leg.altitude.clone();
    let before = of(&window, "side1");
    window.fill_in(egui::accesskit::Role::SpinButton, "Raise by", "50");
    assert_eq!(of(&window, "side1"), before);
    assert!(of(&window, "side2").is_some(), "ahead");
    window.receive_position(true);
    assert!(!window.shows("they were flown"), "on the ground again everything is ahead");
}

/// A flown leg's altitude was changed and pushed, and nothing said that it changes nothing.
#[test]
fn what_is_changed_behind_the_aircraft_says_that_only_go_to_flies_it() {
    let (mut window, _) = flying();
    window.click("TF side2");
    assert!(!window.shows("Behind the aircraft"), "it is flown now");
    window.click("TF side1");
    assert!(window.shows("Behind the aircraft: what is changed here is flown only by Go to"));
    window.fill_in(egui::accesskit::Role::SpinButton, "Altitude", "170");
    window.until_analysed();
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    let version = window.app().document().version();
    let drafted = window.app().analysis().hash_of(version).unwrap().to_string();
    let changed = vec!["side1".into(), "side2".into()];
    let report = ProposalReport { changed, ..report(&drafted, true) };
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report))));
    assert!(window.shows("Behind the aircraft, flown again only by Go to: side1"));
    assert!(!window.shows("only by Go to: side1, side2"));
}

#[test]
fn what_is_behind_the_aircraft_cannot_be_moved() {
    let (mut window, _) = flying();
    assert!(!moves(&mut window, "Fix A", vec2(30.0, -20.0)));
    assert!(notice(&window).contains("side1 is behind the aircraft"), "{}", notice(&window));
    // the leg that is flown, and one that is ahead
    assert!(moves(&mut window, "Fix B", vec2(20.0, -20.0)));
    assert!(moves(&mut window, "Fix D", vec2(20.0, -20.0)));
    // a set with one that is behind
    window.click("TF side1");
    window.select_row_with(("TF side2", 0), Modifiers::SHIFT);
    window.steps(2);
    assert!(!moves(&mut window, "Move what is selected", vec2(30.0, 30.0)));
    // on the ground again everything is ahead
    window.receive_position(true);
    // room for the handle above what is selected
    window.click("Zoom out");
    window.steps(20);
    assert!(moves(&mut window, "Move what is selected", vec2(30.0, 30.0)));
    assert!(window.harness.query_by_label("Fix A").is_some());
}
