//! The tree by drag and by keyboard: legs, stages and emergency plans find their places.

use super::{SQUARE, Window};
use egui::{Key, Modifiers, Pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::{Cause, FlightPlan, Id, LegKind};

const FIRE_WATCH: &str = include_str!("../../../assets/plans/fire-watch.xml");

/// All rows of the tree fit.
fn opened(plan: &str) -> Window {
    let mut window = Window::open_with(plan, vec2(1280.0, 1400.0), None);
    window.until_analysed();
    window
}

fn legs(plan: &FlightPlan) -> String {
    let legs = plan.stages.iter().flat_map(|stage| &stage.legs);
    legs.map(|leg| leg.id.to_string()).collect::<Vec<_>>().join(" ")
}

impl Window {
    /// A row of the tree by its name, so far down in it.
    fn row(&self, name: &str, down: f32) -> Pos2 {
        let rect = self.harness.get_by_role_and_label(egui::accesskit::Role::TreeItem, name).rect();
        rect.lerp_inside(vec2(0.4, down))
    }

    /// Drags a row onto another one, so far down in it, and does not let it go yet.
    pub fn drag_row(&mut self, from: &str, to: &str, down: f32) {
        let (from, to) = (self.row(from, 0.5), self.row(to, down));
        self.harness.hover_at(from);
        self.harness.drag_at(from);
        for part in 1..=4 {
            self.harness.hover_at(from + (to - from) * (part as f32 / 4.0));
            self.steps(1);
        }
        self.steps(2);
    }

    pub fn drop_row(&mut self, from: &str, to: &str, down: f32) {
        let at = self.row(to, down);
        self.drag_row(from, to, down);
        self.harness.drop_at(at);
        self.steps(3);
    }
}

#[test]
fn rows_are_dragged_to_other_places_alone_and_together() {
    let mut window = opened(SQUARE);
    let before = window.plan();
    window.drop_row("TF side4", "TF side2", 0.2);
    assert_eq!(legs(&window.plan()), "side1 side4 side2 side3");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");

    window.click("TF side1");
    window.press_with(Modifiers::SHIFT, Key::ArrowDown);
    assert!(window.shows("2 legs"));
    window.drop_row("TF side1", "TF side4", 0.9);
    assert_eq!(legs(&window.plan()), "side3 side4 side1 side2");
    assert!(window.shows("2 legs"), "they are still selected");
    window.click("Undo");
    assert_eq!(window.plan(), before);

    window.drop_row("TF side2", "LND land", 0.5);
    let plan = window.plan();
    assert_eq!(plan.leg(&"side2".into()).unwrap().stage.id.as_str(), "land", "another stage");
    window.click("Undo");
    window.drop_row("ENR circuit", "T/O take-off", 0.2);
    let stages: Vec<String> = window.plan().stages.iter().map(|stage| stage.id.to_string()).collect();
    assert_eq!(stages, ["circuit", "take-off", "land"]);
}

#[test]
fn things_are_put_in_order_by_drag_by_key_and_by_menu() {
    let mut window = opened(SQUARE);
    let fixes =
        |window: &Window| -> String { window.plan().fixes.iter().map(|fix| fix.id.as_str()).collect() };
    assert_eq!(fixes(&window), "ABCD");
    window.drop_row("FIX D", "FIX B", 0.2);
    assert_eq!(fixes(&window), "ADBC");
    window.click("Undo");
    assert_eq!(fixes(&window), "ABCD", "one step");
    window.click("FIX A");
    window.press_with(Modifiers::ALT, Key::ArrowDown);
    assert_eq!((fixes(&window).as_str(), window.selected().as_str()), ("BACD", "A"));
    window.row_menu(("FIX A", 0), "Move up");
    assert_eq!(fixes(&window), "ABCD");
    window.drag_row("FIX A", "RWY R05", 0.5);
    assert!(window.shows("It goes among those of its own list"));
    let at = window.row("RWY R05", 0.5);
    window.harness.drop_at(at);
    window.steps(3);
    assert_eq!(fixes(&window), "ABCD");
}

#[test]
fn a_drop_where_it_cannot_be_says_why_and_changes_nothing() {
    let mut window = opened(SQUARE);
    let before = window.plan();
    window.drag_row("TF side2", "FIX A", 0.5);
    assert!(window.shows("Legs go into a stage, a loop, a branch or a procedure"));
    let at = window.row("FIX A", 0.5);
    window.harness.drop_at(at);
    window.steps(3);
    assert!(!window.shows("Legs go into"), "it is over");
    window.drag_row("TF side2", "TF side4", 0.9);
    window.press(Key::Escape);
    window.harness.drop_at(at);
    window.steps(3);
    assert_eq!(window.plan(), before, "Escape ends it");
    assert!(!window.app().document().can_undo());
}

#[test]
fn legs_are_put_into_a_loop_and_into_a_branch() {
    let mut window = opened(FIRE_WATCH);
    let plan = window.plan();
    let label = |id: &str| {
        let leg = plan.leg(&id.into()).unwrap().leg;
        if leg.name.is_empty() { id.to_owned() } else { leg.name.clone() }
    };
    let body = |plan: &FlightPlan, id: &str| -> Vec<String> {
        plan.leg(&id.into()).unwrap().leg.body().iter().map(|leg| leg.id.to_string()).collect()
    };
    let had = body(&plan, "patrol");
    let row = format!("TF {}", label("o1"));
    window.drop_row(&row, &format!("LOOP {}", label("patrol")), 0.5);
    assert_eq!(body(&window.plan(), "patrol").len(), had.len() + 1);
    assert_eq!(body(&window.plan(), "patrol").last().map(String::as_str), Some("o1"));
    window.click("Undo");
    assert_eq!(window.plan(), plan);
    // the branch leads to it now
    window.drop_row(&row, "▸ Close look", 0.4);
    let after = window.plan();
    let LegKind::Intersection { branches, .. } = &after.leg(&"ask".into()).unwrap().leg.kind else {
        panic!()
    };
    assert_eq!(branches[1].next, Some(Id::new("o1")));
    assert_eq!(after.leg(&"o1".into()).unwrap().successor().map(|leg| leg.id.as_str()), Some("look"));
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    window.click("Undo");
    assert_eq!(window.plan(), plan, "one step");
}

#[test]
fn arrows_walk_the_tree_and_open_and_close_it() {
    let mut window = opened(SQUARE);
    window.click("TF side1");
    window.press(Key::ArrowDown);
    assert_eq!(window.selected(), "side2");
    window.press(Key::ArrowLeft);
    assert_eq!(window.selected(), "circuit", "what it is in");
    window.press(Key::ArrowLeft);
    assert!(!window.shows("TF side1"), "closed");
    window.press(Key::ArrowRight);
    assert!(window.shows("TF side1"));
    window.press(Key::ArrowRight);
    assert_eq!(window.selected(), "side1");
    window.press_with(Modifiers::ALT, Key::ArrowDown);
    assert_eq!(legs(&window.plan()), "side2 side1 side3 side4");
    window.press(Key::Delete);
    assert_eq!(legs(&window.plan()), "side2 side3 side4");
    assert_eq!(window.selected(), "side3", "the keyboard stays at that place");
    window.press(Key::ArrowUp);
    assert_eq!(window.selected(), "side2");
    window.press(Key::End);
    assert_eq!(window.selected(), "R05");
}

#[test]
fn something_is_renamed_where_it_stands() {
    let mut window = opened(SQUARE);
    window.click("TF side2");
    window.press(Key::F2);
    window.harness.event(egui::Event::Text("Far corner".into()));
    window.steps(2);
    window.press(Key::Enter);
    assert_eq!(window.plan().leg(&"side2".into()).unwrap().leg.name, "Far corner");
    window.press(Key::ArrowDown);
    assert_eq!(window.selected(), "side3", "the keyboard is back in the tree");
    window.press(Key::F2);
    window.harness.event(egui::Event::Text("nothing".into()));
    window.steps(2);
    window.press(Key::Escape);
    assert_eq!(window.plan().leg(&"side3".into()).unwrap().leg.name, "", "as it was");
    window.click("RWY R05");
    window.press(Key::F2);
    window.harness.event(egui::Event::Text("R23".into()));
    window.steps(2);
    window.press(Key::Enter);
    assert!(window.plan().runway(&"R23".into()).is_some(), "a runway is known by its identifier");
    assert_eq!(window.selected(), "R23");
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
}

#[test]
fn the_menu_of_a_row_opens_by_key() {
    for (modifiers, key) in [(Modifiers::SHIFT, Key::F10), (Modifiers::NONE, Key::Menu)] {
        let mut window = opened(SQUARE);
        window.click("TF side2");
        window.press_with(modifiers, key);
        assert!(window.shows("Put into a loop"), "{key:?}");
        let at = window.harness.get_by_label_contains("Duplicate").rect().center();
        window.click_at(at);
        assert_eq!(window.plan().stages[1].legs.len(), 5);
    }
}

#[test]
fn what_is_selected_elsewhere_is_unfolded_and_brought_into_view() {
    let mut window = Window::open_with(FIRE_WATCH, vec2(1280.0, 500.0), None);
    window.until_analysed();
    window.click("Main plan");
    window.press(Key::ArrowLeft);
    assert!(!window.shows("T/O Take-off"), "folded");
    window.ask_for("show leg look");
    window.press(Key::Enter);
    let selected = window.selected();
    window.steps(3);
    let name = window.plan().leg(&selected.as_str().into()).unwrap().leg.name.clone();
    assert!(window.shows(&name), "{selected} is to be seen");
}

#[test]
fn an_emergency_plan_is_dropped_on_a_stage() {
    let mut window = opened(SQUARE);
    let before = window.plan();
    window.drop_row("ALT return", "ENR circuit", 0.5);
    assert!(window.shows("return for circuit: for which cause?"));
    window.click("Engine failure");
    let stage = window.plan().stage(&"circuit".into()).unwrap().clone();
    assert_eq!(stage.emergency.by_cause, [(Some(Cause::Engine), Id::new("return"))]);
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

#[test]
fn an_emergency_plan_is_dropped_on_a_leg_and_asks_for_the_cause() {
    let mut window = opened(FIRE_WATCH);
    let before = window.plan();
    assert!(before.leg(&"o1".into()).unwrap().leg.emergency.by_cause.is_empty());
    let (row, alternate) = {
        let leg = before.leg(&"o1".into()).unwrap().leg;
        let name = if leg.name.is_empty() { "o1" } else { &leg.name };
        let strip = before.emergency_plan(&"north-strip".into()).unwrap();
        let alternate = if strip.name.is_empty() { "north-strip" } else { &strip.name };
        (format!("TF {name}"), alternate.to_owned())
    };
    window.drop_row(&format!("ALT {alternate}"), &row, 0.5);
    assert!(window.shows("for which cause?"));
    window.click("Engine failure");
    let of = |window: &Window| window.plan().leg(&"o1".into()).unwrap().leg.emergency.by_cause.clone();
    assert_eq!(of(&window), [(Some(Cause::Engine), Id::new("north-strip"))]);
    // the tooltip says it for every cause
    let at = window.row(&row, 0.5);
    window.harness.hover_at(at);
    window.steps(90);
    assert!(window.shows("Link lost") && window.shows("from the plan"));
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");

    window.drop_row(&format!("ALT {alternate}"), "Main plan", 0.5);
    window.click("Any cause");
    assert_eq!(window.plan().emergency.plan_for(Cause::Traffic).map(Id::as_str), Some("north-strip"));
    window.click("Undo");
    window.ask_for(&format!("alternate plan link lost {alternate}"));
    window.press(Key::Enter);
    assert_eq!(window.plan().emergency.plan_for(Cause::Link).map(Id::as_str), Some("north-strip"));
}

#[test]
fn an_emergency_plan_of_a_stage_is_chosen_and_taken_back_in_its_menu() {
    let mut window = opened(SQUARE);
    let before = window.plan();
    for entry in ["GPS lost", "As around it"] {
        let at = window.row("ENR circuit", 0.5);
        window.right_click_at(at);
        let path = if entry == "GPS lost" {
            &["Emergency plan", "return", entry][..]
        } else {
            &["Emergency plan", entry]
        };
        for step in path {
            let is_it = |node: &egui_kittest::Node<'_>| {
                node.accesskit_node().label().is_some_and(|label| label.starts_with(step))
            };
            let found = {
                let mut buttons = window.harness.get_all_by_role(egui::accesskit::Role::Button);
                buttons.find(is_it).unwrap().rect().center()
            };
            window.click_at(found);
        }
    }
    assert_eq!(window.plan(), before, "taken back");
    window.click("Undo");
    let stage = window.plan().stage(&"circuit".into()).unwrap().clone();
    assert_eq!(stage.emergency.by_cause, [(Some(Cause::Gps), Id::new("return"))]);
}
