//! Things that are selected together, and the altitudes of all of them.

use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::Value;

fn opened() -> Window {
    let mut window = Window::open_with(SQUARE, vec2(1280.0, 1000.0), None);
    window.until_analysed();
    window
}

/// The altitude that a leg has of its own.
fn of_leg(window: &Window, leg: &str) -> Option<Value<f64>> {
    window.plan().leg(&leg.into()).unwrap().leg.altitude.clone().map(|own| own.metres)
}

fn of_stage(window: &Window, stage: &str) -> Option<Value<f64>> {
    window.plan().stage(&stage.into()).unwrap().altitude.clone().map(|own| own.metres)
}

#[test]
fn raising_all_altitudes_is_found_and_reaches_take_off_and_emergency_plans() {
    let mut window = opened();
    let before = window.plan();
    for letters in ["altitude", "raise", "lower"] {
        window.ask_for(letters);
        assert!(window.shows("Edit Raise or lower all altitudes…"), "{letters}");
        window.press(Key::Escape);
    }
    window.ask_for("raise or lower");
    window.press(Key::Enter);
    assert!(window.shows("3 stages and 5 legs"));
    window.harness.event(Event::Text("50".into()));
    window.steps(2);
    assert!(!window.shows("stay as they are: they say"), "they are left alone");
    window.click("Leave take-off and approaches alone");
    assert!(window.shows("land, r-land of return stay as they are: they say no altitude."));
    window.fill_in(Role::SpinButton, "Raise by", "50");
    let own = |metres: f64| Some(Value::Constant(metres));
    for (leg, raised) in [("side1", own(150.0)), ("side2", None), ("r1", own(200.0))] {
        assert_eq!(of_leg(&window, leg), raised, "{leg}");
    }
    for (stage, raised) in [("take-off", own(130.0)), ("circuit", own(200.0))] {
        assert_eq!(of_stage(&window, stage), raised, "{stage}");
    }
    assert!(window.shows("5 altitudes raised by 50 m"), "who is not told raises again");
    assert!(!window.shows("in all"));
    window.click("Raise them again");
    assert!(window.shows("5 altitudes raised by 50 m again: 100 m higher in all"));
    window.click("Undo");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step each");
    assert!(!window.shows("raised by"));
    let offered = |window: &Window| {
        let field = window.harness.get_by_role_and_label(Role::SpinButton, "Raise by");
        field.accesskit_node().value().unwrap_or_default()
    };
    assert!(offered(&window).starts_with("50"), "{}", offered(&window));
    window.select_row(("TF side2", 0));
    window.select_row_with(("TF side3", 0), Modifiers::COMMAND);
    assert!(offered(&window).starts_with("30"), "of others: {}", offered(&window));
}

/// What leads to and from a runway fits it; and what can't be meant is not where one presses.
#[test]
fn take_off_and_approaches_are_left_alone_unless_they_are_meant() {
    let approach = SQUARE.replacen(
        r#"<stage id="land" type="land""#,
        r#"<stage id="final" type="approach"><TF id="ap1" fix="D" altitude="80" altitudeReference="home"/></stage><stage id="land" type="land""#,
        1,
    );
    let mut window = Window::open_with(&approach, vec2(1280.0, 1000.0), None);
    window.until_analysed();
    let before = window.plan();
    window.ask_for("raise or lower");
    window.press(Key::Enter);
    let [raise, delete] = ["Raise them", "Delete them"].map(|name| window.harness.get_by_label(name).rect());
    assert!(delete.top() > raise.bottom() + 30.0, "{raise} {delete}");
    window.click("Raise them");
    assert_eq!(of_stage(&window, "circuit"), Some(Value::Constant(180.0)));
    for stage in ["take-off", "final"] {
        let legs = |plan: &flight_plan::FlightPlan| plan.stage(&stage.into()).cloned();
        assert_eq!(legs(&window.plan()), legs(&before), "{stage}");
    }
    window.click("Undo");
    window.select_row(("TF ap1", 0));
    window.select_row_with(("LND land", 0), Modifiers::COMMAND);
    assert!(!window.shows("Leave take-off"), "nothing else would be raised");
    window.click("Raise them");
    assert_eq!(of_leg(&window, "ap1"), Some(Value::Constant(110.0)));
}

#[test]
fn ctrl_a_selects_all_legs_and_stays_in_the_field_where_something_is_typed() {
    let mut window = opened();
    window.click("TF side2");
    window.press_ctrl(Key::A);
    assert!(window.shows("5 legs"));
    window.press(Key::Escape);
    window.press_ctrl(Key::F);
    window.press_ctrl(Key::A);
    assert_eq!(window.selected(), "");
}

#[test]
fn shift_selects_the_range_between_two_rows_stages_and_legs_together() {
    let mut window = opened();
    window.click("ENR circuit");
    window.select_row_with(("TF side2", 0), Modifiers::SHIFT);
    assert!(window.shows("1 stage and 4 legs"), "a stage stands for its legs");
    window.click_role(Role::Button, "Raise them");
    assert_eq!(of_stage(&window, "circuit"), Some(Value::Constant(180.0)));
    assert_eq!(of_leg(&window, "side1"), Some(Value::Constant(130.0)));
    assert_eq!(of_leg(&window, "side2"), None, "it inherits from its stage");
    assert_eq!(of_leg(&window, "side4"), Some(Value::Constant(140.0)));
    window.click("Undo");

    window.click("TF side4");
    window.select_row_with(("DF r1", 0), Modifiers::SHIFT);
    assert!(window.shows("2 stages and 2 legs"), "over the plans");

    window.click("TF side1");
    for (key, count) in [(Key::ArrowDown, 2), (Key::ArrowDown, 3), (Key::ArrowUp, 2)] {
        window.press_with(Modifiers::SHIFT, key);
        assert!(window.shows(&format!("{count} legs")), "{count}");
    }
}

#[test]
fn what_cannot_be_done_with_legs_together_says_why() {
    let mut window = opened();
    window.click("TF side1");
    window.select_row_with(("TF side3", 0), Modifiers::COMMAND);
    window.ask_for("fork around them");
    assert!(window.paints("They do not follow each other"));
}

/// A leg of the main plan and one of an emergency plan: some commands took only the first of them, without a word.
#[test]
fn what_cannot_be_done_with_legs_of_several_plans_says_why_and_all_stay_selected() {
    let mut window = opened();
    let before = window.plan();
    window.click("TF side2");
    window.select_row_with(("DF r1", 0), Modifiers::COMMAND);
    window.steps(3);
    assert!(window.shows("side2, r1 of return"));
    let several = "Several are selected: select one alone";
    let apart = "They are in several stages or loops: select legs of one";
    for (letters, why) in [
        ("rename what is selected", several),
        ("draw a new way from the selected leg", several),
        ("move what is selected up", apart),
        ("put them into a loop", apart),
        ("make a procedure of them", apart),
    ] {
        window.ask_for(letters);
        assert!(window.paints(why), "{letters}");
        window.press(Key::Escape);
        assert!(window.shows("2 legs"), "{letters}");
    }
    window.press(Key::B);
    assert!(window.app().view().palette.is_none(), "nor is one of them bound to a variable");
    assert_eq!(window.plan(), before);
    window.select_row_with(("FIX C", 0), Modifiers::COMMAND);
    window.steps(3);
    window.ask_for("move what is selected up");
    assert!(window.paints(apart), "a fix with them");
    window.press(Key::Escape);
    window.press(Key::Delete);
    let plan = window.plan();
    assert!(plan.leg(&"side2".into()).is_none() && plan.leg(&"r1".into()).is_none());
    assert!(plan.fix(&"C".into()).is_none(), "what can be done is done with all");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

#[test]
fn what_leaves_out_an_altitude_of_several_legs_keeps_away_from_the_edge_of_the_window() {
    let mut window = opened();
    window.select_row(("TF side1", 0));
    window.select_row_with(("TF side3", 0), Modifiers::SHIFT);
    let right = |name| window.harness.query_all_by_label_contains(name).next().unwrap().rect().right();
    let (button, panel) = (right("eave out the altitude"), right("Hide Inspector"));
    assert!(button <= panel, "{button} {panel}");
}

#[test]
fn what_goes_by_one_key_is_counted_and_brought_back() {
    let mut window = opened();
    let before = window.plan();
    window.press_ctrl(Key::A);
    window.press(Key::Delete);
    let legs = before.all_legs().len() - window.plan().all_legs().len();
    assert!(legs > 1 && window.paints(&format!("Removed {legs} legs")));
    window.click(&format!("Undo: Removed {legs} legs"));
    assert_eq!(window.plan(), before);
    assert!(!window.shows("Removed"), "it is so no more");
    window.select_row(("TF side2", 0));
    window.press(Key::Delete);
    assert!(!window.shows("Removed"), "one leg is seen to go");
}
