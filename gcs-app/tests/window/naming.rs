//! Names come before identifiers, wherever a part of the plan is named.

use super::flying::fly_its_plan;
use super::whatif::FIRE_WATCH;
use super::{SQUARE, Window};
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

fn named() -> Window {
    let mut text = SQUARE.replace(r#"<fix id="A""#, r#"<fix id="A" name="Old barn""#);
    for (number, name) in [(1, "first"), (2, "second"), (3, "third"), (4, "fourth")] {
        let id = format!(r#"<TF id="side{number}""#);
        text = text.replace(&id, &format!(r#"{id} name="The {name} side""#));
    }
    let mut window = Window::open(&text);
    window.until_analysed();
    window
}

#[test]
fn on_the_map_and_on_the_profile() {
    let mut window = named();
    assert!(window.shows("Fix Old barn") && window.paints("Old barn"));
    assert!(window.harness.query_by_label("Fix A").is_none());
    let plot = window.harness.get_by_label_contains("Vertical profile").rect();
    window.click_at(plot.center());
    assert!(window.paints(" side · "), "the cursor is on one of the sides");
}

#[test]
fn in_the_palette_with_the_identifier_behind() {
    let mut window = named();
    for sought in ["second side", "side2"] {
        window.ask_for(sought);
        assert!(window.shows("Show leg The second side (side2)"), "{sought}");
        window.press(Key::Escape);
    }
    window.ask_for("show fix barn");
    assert!(window.shows("Show fix Old barn (A)"));
}

#[test]
fn of_several_legs_and_in_the_log() {
    let mut window = named();
    window.select_row(("TF The second side", 0));
    window.select_row_with(("TF The third side", 0), Modifiers::COMMAND);
    window.steps(3);
    assert!(window.shows("The second side, The third side"));
    window.press(Key::Escape);
    fly_its_plan(&mut window);
    window.ask_for("skip the leg");
    window.press(Key::Enter);
    window.leave_open();
    window.click("Cancel");
    window.select_row(("TF The fourth side", 0));
    window.steps(3);
    window.click("Go to this leg…");
    while window.asked().is_some() {}
    window.hold("Go to The fourth side (hold)", 90);
    assert!(window.shows("Go to The fourth side: pending"));
}

#[test]
fn of_decisions() {
    let mut window = Window::open(FIRE_WATCH);
    window.until_analysed();
    window.harness.get_all_by_label("What if").next().unwrap().click();
    window.steps(3);
    window.harness.get_by_label("Look closer?: Close look").click_accesskit();
    window.steps(3);
    assert!(window.shows("What if: Look closer?: Close look"));
}
