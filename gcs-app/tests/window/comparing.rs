//! A proposal beside the plan aboard: both paths on the map, with their names.

use super::Window;
use super::flying::{connected, report};
use super::vehicle::status;
use flight_exec::Phase;
use gcs_app::link::Reply;
use gcs_app::state::ActivePlan;
use std::sync::Arc;

#[test]
fn proposal_shows_old_and_new_path_with_their_names_and_changes_in_words() {
    let (mut window, hash) = connected();
    let plan = Arc::new(window.plan());
    let mut value = status(Phase::Flying);
    value.plan = Some(hash.clone().into());
    window.receive_position(false);
    window.receive_status(value);
    let (ticket, _) = window.asked().unwrap();
    let aboard = ActivePlan { plan, hash: hash.into() };
    window.answer(ticket, Ok(Reply::Plan(Some(aboard))));
    let p = gcs_app::theme::palette(true);
    let drawn = |window: &Window| {
        (window.lines_within("Map", p.contingency), window.triangles_within("Map", p.accent))
    };
    let of_one_plan = drawn(&window);
    window.click("TF side2");
    window.press(egui::Key::Delete);
    window.until_analysed();
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    assert!(!shows_paths(&window));
    let version = window.app().document().version();
    let drafted = window.app().analysis().hash_of(version).unwrap().to_string();
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&drafted, true)))));
    window
        .until("path of the plan aboard", |app| app.path_aboard().is_some_and(|path| path.points.len() > 10));
    assert!(shows_paths(&window) && window.shows("leg side2 removed"));
    let of_both = drawn(&window);
    assert!(of_both.0 > of_one_plan.0 + 20, "the plan aboard, dash by dash: {of_both:?} {of_one_plan:?}");
    assert!(of_both.1 > of_one_plan.1 / 2, "and this plan: {of_both:?} {of_one_plan:?}");
    assert_ne!(window.app().path_aboard().unwrap().points, window.app().analysis().forecast.points);
    window.receive_status(status(Phase::Idle));
    assert!(!window.shows("on the map: the plan aboard"), "another agent, with nothing aboard");
    window.click("Keep as draft");
    assert!(!shows_paths(&window));
}

fn shows_paths(window: &Window) -> bool {
    window.shows("on the map: this plan") && window.shows("on the map: the plan aboard")
}
