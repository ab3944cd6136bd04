//! The tree's menus.

use super::{SQUARE, Window};
use egui_kittest::kittest::Queryable;
use flight_plan::{FlightPlan, LegKind};

/// Right click on a row, click on an entry.
fn choose(window: &mut Window, row: &str, entry: &str) {
    window.harness.get_by_label(row).click_secondary();
    window.steps(3);
    let at = window.harness.get_by_label_contains(entry).rect().center();
    window.click_at(at);
}

fn legs(plan: &FlightPlan) -> Vec<String> {
    plan.all_legs().iter().map(|c| c.leg.id.to_string()).collect()
}

#[test]
fn a_leg_is_duplicated_moved_looped_and_deleted_from_its_menu() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = window.plan();
    let at = legs(&before).iter().position(|id| id == "side2").unwrap();
    for entry in
        ["Duplicate", "Move up", "Put into a loop", "Fork before it", "Make a procedure of it", "Delete"]
    {
        choose(&mut window, "TF side2", entry);
        let after = window.plan();
        match entry {
            "Duplicate" => assert_eq!(after.all_legs().len(), before.all_legs().len() + 1),
            "Move up" => assert_eq!(legs(&after)[at - 1], "side2"),
            "Put into a loop" => {
                let looped = after.leg(&window.selected().as_str().into()).unwrap().leg;
                assert!(matches!(looped.kind, LegKind::Iterative { .. }));
                assert_eq!(looped.body()[0].id.as_str(), "side2");
            }
            "Fork before it" => {
                let fork = after.leg(&window.selected().as_str().into()).unwrap().leg;
                assert!(matches!(fork.kind, LegKind::Intersection { .. }));
            }
            "Make a procedure of it" => {
                assert_eq!(after.procedures.len(), 1);
                assert_eq!(after.procedures[0].id.as_str(), window.selected());
            }
            _ => assert!(!legs(&after).contains(&"side2".to_owned())),
        }
        window.click("Undo");
        assert_eq!(window.plan(), before, "{entry} is one step");
    }
}

#[test]
fn a_runway_gets_an_emergency_plan_and_a_fix_is_deleted_without_breaking_its_legs() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let had = window.plan().emergency_plans.len();
    choose(&mut window, "RWY R05", "Emergency plan that lands here");
    assert_eq!(window.plan().emergency_plans.len(), had + 1);
    window.until_analysed();
    choose(&mut window, "FIX A", "Delete");
    assert!(window.plan().fix(&"A".into()).is_none());
    window.until_analysed();
    let worst = window.app().analysis().problems.iter().map(|p| p.severity).max();
    assert!(worst < Some(flight_plan::Severity::Error), "{:?}", window.app().analysis().problems);
}
