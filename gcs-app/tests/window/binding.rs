//! Values that become what a variable says: from the inspector, by key, and in the palette.

use super::{SQUARE, Window};
use egui::Key;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::{LegKind, Place, Value, VariableValue, create};

/// A square with a position and a number.
fn window() -> Window {
    window_with("", "")
}

/// With something else in the place of a part of it.
fn window_with(part: &str, other: &str) -> Window {
    let variables = r#"<variables><variable name="fire" type="position" initial="36.322 -84.168"/><variable name="fast" type="number" unit="m/s" initial="24"/></variables>"#;
    let square = if part.is_empty() { SQUARE.to_owned() } else { SQUARE.replace(part, other) };
    let mut window = Window::open(&square.replace("<mainPlan", &format!("{variables}<mainPlan")));
    window.until_analysed();
    window
}

/// A track leg that was drawn behind the second one, and is selected.
fn drawn_leg(window: &mut Window) -> String {
    window.select_row(("TF side2", 0));
    window.steps(2);
    window.press(Key::T);
    let at = window.centre("Map");
    window.tap_at(at);
    window.press(Key::V);
    window.selected()
}

fn speed(window: &Window, leg: &str) -> Option<Value<f64>> {
    window.plan().leg(&leg.into()).unwrap().leg.speed_mps.clone()
}

#[test]
fn a_number_is_bound_beside_its_field() {
    let mut window = window();
    window.select_row(("TF side2", 0));
    window.steps(2);
    window.click_role(Role::Button, "Own airspeed");
    window.steps(2);
    let before = window.plan();
    window.click_role(Role::Button, "Airspeed: bind to a variable");
    window.steps(2);
    let offered = window.harness.query_by_role_and_label(Role::Button, "fire");
    assert!(offered.is_none(), "a position is no speed");
    window.click_role(Role::Button, "fast");
    assert_eq!(speed(&window, "side2"), Some(Value::Expression("fast".into())));
    window.steps(2);
    window.click_role(Role::Button, "Airspeed: number or formula");
    assert_eq!(speed(&window, "side2"), Some(Value::Constant(24.0)), "what the variable says, as its own");
    window.press_ctrl(Key::Z);
    window.press_ctrl(Key::Z);
    assert_eq!(window.plan(), before);
    window.click_role(Role::Button, "Airspeed: bind to a variable");
    window.steps(2);
    window.click_role(Role::Button, "A new variable with its value");
    window.steps(2);
    assert_eq!(window.selected(), "side2_speed");
    let made = window.plan().variable(&"side2_speed".into()).unwrap().initial.clone();
    assert!(matches!(made, VariableValue::Number(_)));
    assert_eq!(speed(&window, "side2"), Some(Value::Expression("side2_speed".into())));
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    window.press_ctrl(Key::Z);
    assert_eq!(window.plan(), before, "one step");
}

#[test]
fn where_a_leg_goes_is_bound_beside_its_field() {
    let mut window = window();
    let leg = drawn_leg(&mut window);
    window.click_role(Role::Button, "Place: bind to a variable");
    window.steps(2);
    window.click_role(Role::Button, "fire");
    let place = |window: &Window| window.plan().leg(&leg.as_str().into()).unwrap().leg.place().cloned();
    assert_eq!(place(&window), Some(Place::Position(Value::Expression("fire".into()))));
    window.steps(2);
    window.click_role(Role::Button, "Place: bind to a variable");
    window.steps(2);
    window.click_role(Role::Button, "Nothing: a value of its own");
    assert!(matches!(place(&window), Some(Place::Position(Value::Constant(_)))));
}

#[test]
fn the_area_of_a_scan_is_bound_beside_its_choice() {
    let mut window = window();
    let scan = drawn_scan(&mut window);
    window.click_role(Role::Button, "Area: bind to a variable");
    window.steps(2);
    window.click_role(Role::Button, "A new variable with its value");
    let plan = window.plan();
    let made = plan.variable(&window.selected().as_str().into()).unwrap();
    assert!(matches!(made.initial, VariableValue::Polygon(_)));
    assert_eq!(create::bound_to(plan.leg(&scan.as_str().into()).unwrap().leg), Some(made.name.clone()));
}

#[test]
fn a_place_that_is_bound_is_called_by_its_variable() {
    let mut window = window();
    let leg = drawn_leg(&mut window);
    window.press(Key::B);
    window.harness.event(egui::Event::Text("place fire".into()));
    window.steps(3);
    window.press(Key::Enter);
    window.press(Key::V);
    window.select_row((&format!("TF {leg}"), 0));
    window.steps(2);
    let to = window.harness.get_by_role_and_label(Role::ComboBox, "To");
    assert_eq!(to.accesskit_node().value().as_deref(), Some("the variable fire"));
    assert!(window.paints("the variable fire"), "whole");
}

#[test]
fn binding_and_a_new_way_have_keys() {
    let mut window = window();
    window.press(Key::B);
    assert!(window.app().view().palette.is_none(), "nothing is selected");
    let leg = drawn_leg(&mut window);
    window.press(Key::B);
    window.harness.event(egui::Event::Text("place fire".into()));
    window.steps(3);
    assert!(window.shows(&format!("Bind the place of {leg} to fire")));
    assert!(!window.shows("Bind the selected leg"), "that led here");
    window.press(Key::Enter);
    let place = window.plan().leg(&leg.as_str().into()).unwrap().leg.place().cloned();
    assert_eq!(place, Some(Place::Position(Value::Expression("fire".into()))));
    window.press(Key::W);
    assert!(window.shows(&format!("Draw legs on a new way from {leg}")));
}

#[test]
fn a_variable_is_dragged_from_the_plan_to_what_it_says() {
    let mut window = window();
    window.select_row(("TF side2", 0));
    window.steps(2);
    let before = window.plan();
    let row = |window: &Window, name: &str| {
        window.harness.get_by_role_and_label(Role::TreeItem, name).rect().lerp_inside(egui::vec2(0.4, 0.5))
    };
    let field = window.harness.get_by_role_and_label(Role::SpinButton, "Airspeed").rect().center();
    let from = row(&window, "VAR fast");
    window.drag(from, field - from);
    assert_eq!(speed(&window, "side2"), Some(Value::Expression("fast".into())));
    window.press_ctrl(Key::Z);
    assert_eq!(window.plan(), before, "one step");
    let from = row(&window, "VAR fire");
    // onto the line of the leg
    let to = window.centre("Fix A") + (window.centre("Fix B") - window.centre("Fix A")) * 0.5;
    window.drag(from, to - from);
    let place = window.plan().leg(&"side2".into()).unwrap().leg.place().cloned();
    let says = |name: &str| Some(Place::Position(Value::Expression(name.into())));
    assert_eq!(place, says("fire"));
    window.press_ctrl(Key::Z);
    assert_eq!(window.plan(), before, "one step");
    // a number is no place
    let from = row(&window, "VAR fast");
    window.drag(from, to - from);
    assert!(window.plan() == before && window.shows("on its field in the inspector"));
}

/// It was nowhere on the map.
#[test]
fn a_variable_that_is_an_area_is_drawn_with_its_name_and_selected_on_the_map() {
    let area = r#"<variables><variable name="burnt_area" type="polygon" initial="36.33 -84.185, 36.33 -84.175, 36.325 -84.18"/></variables><mainPlan"#;
    let mut window = Window::open(&SQUARE.replacen("<mainPlan", area, 1));
    window.until_analysed();
    let name = window.places_of(|text| text == "burnt area");
    let map = window.harness.get_by_label("Map").rect();
    assert!(name.iter().any(|name| map.contains_rect(*name)), "{name:?}");
    let colour = gcs_app::theme::palette(true).caution;
    assert!(window.lines_within("Map", colour) > 0);
    window.click("Variable burnt area");
    assert_eq!(window.selected(), "burnt_area");
}

/// It had no handles: whoever dragged it moved the map.
#[test]
fn an_area_variable_is_moved_as_a_whole_and_by_its_corners_one_step_each() {
    let area = r#"<variables><variable name="burnt_area" type="polygon" initial="36.33 -84.185, 36.33 -84.175, 36.325 -84.18"/></variables><mainPlan"#;
    let mut window = Window::open(&SQUARE.replacen("<mainPlan", area, 1));
    window.until_analysed();
    assert!(!window.shows("Corner 1 of burnt_area"), "only those of the selected one");
    window.click("Variable burnt area");
    window.steps(4);
    let corners = |window: &Window| match &window.plan().variables[0].initial {
        flight_plan::VariableValue::Polygon(corners) => corners.clone(),
        other => panic!("{other:?}"),
    };
    let before = corners(&window);
    let middle = window.centre("Middle of burnt_area");
    // all of it by its middle and by what is inside, a corner alone, and a mark that becomes one
    let inside = middle + egui::vec2(14.0, -6.0);
    let corner = window.centre("Corner 3 of burnt_area");
    let mark = window.centre("New corner 2 of burnt_area");
    for (from, len, moved) in [(middle, 3, 3), (inside, 3, 3), (corner, 3, 1), (mark, 4, 1)] {
        window.drag(from, egui::vec2(30.0, 20.0));
        let after = corners(&window);
        assert_eq!(after.len(), len);
        assert_eq!(after.iter().filter(|at| !before.contains(at)).count(), moved, "{after:?}");
        window.press_ctrl(Key::Z);
        assert_eq!(corners(&window), before, "one step");
    }
    window.click("Corner 1 of burnt_area");
    window.press(Key::Delete);
    assert!(corners(&window) == before && window.shows("An area has at least 3 points"));
}

#[test]
fn the_place_that_is_nearest_is_bound_by_key() {
    let far = r#"<variables><variable name="far_away" type="position" initial="36.5 -84.0"/>"#;
    let plan = SQUARE.replacen("<mainPlan", &format!("{far}<variable name=\"corner\" type=\"position\" initial=\"36.3211 -84.1538\"/></variables><mainPlan"), 1);
    let mut window = Window::open(&plan);
    window.until_analysed();
    let leg = drawn_leg(&mut window);
    window.press(Key::B);
    window.press(Key::Enter);
    let place = window.plan().leg(&leg.as_str().into()).unwrap().leg.place().cloned();
    assert_eq!(place, Some(Place::Position(Value::Expression("corner".into()))));
}

/// A scan that was drawn behind the second leg, and is selected.
fn drawn_scan(window: &mut Window) -> String {
    window.select_row(("TF side2", 0));
    window.press(Key::A);
    let at = window.centre("Map");
    for by in [egui::vec2(0.0, 0.0), egui::vec2(90.0, 0.0), egui::vec2(90.0, 60.0)] {
        window.tap_at(at + by);
    }
    window.press(Key::Enter);
    window.press(Key::V);
    window.steps(2);
    window.selected()
}

#[test]
fn a_variable_is_dragged_onto_the_spacing_of_a_scan() {
    let mut window = window();
    let scan = drawn_scan(&mut window);
    assert!(window.harness.query_by_label("Spacing: bind to a variable").is_some());
    window.harness.get_by_role_and_label(Role::SpinButton, "Spacing").scroll_to_me();
    window.steps(10);
    let before = window.plan();
    let field = window.harness.get_by_role_and_label(Role::SpinButton, "Spacing").rect().center();
    let row = window.harness.get_by_role_and_label(Role::TreeItem, "VAR fast").rect();
    let from = row.lerp_inside(egui::vec2(0.4, 0.5));
    window.drag(from, field - from);
    let numbers = window.plan();
    let numbers = numbers.leg(&scan.as_str().into()).unwrap().leg.numbers();
    let spacing = numbers.into_iter().find(|(name, _)| *name == "spacing").and_then(|(_, value)| value);
    assert_eq!(spacing, Some(&Value::Expression("fast".into())));
    window.press_ctrl(Key::Z);
    assert_eq!(window.plan(), before, "one step");
}

/// Turns are not counted in metres per second.
#[test]
fn the_first_that_is_offered_for_an_orbit_is_its_place_and_no_count_is_a_speed() {
    let orbit = r#"<orbit id="round" radius="300" turns="2" turn="left"><centre fix="C"/></orbit>"#;
    let mut window = window_with(r#"<TF id="side3" fix="C"/>"#, orbit);
    window.select_row(("ORB round", 0));
    window.steps(2);
    window.press(Key::B);
    window.steps(3);
    assert!(window.shows("Bind the turns of round to a new variable"));
    assert!(
        !window.shows("Bind the turns of round to fast") && !window.shows("Bind the radius of round to fast")
    );
    window.press(Key::Enter);
    let place = Some(Place::Position(Value::Expression("fire".into())));
    let plan = window.plan();
    let LegKind::Orbit { centre, .. } = &plan.leg(&"round".into()).unwrap().leg.kind else {
        panic!("no orbit")
    };
    assert_eq!(Some(centre.clone()), place);
}

/// What comes from the window system when somebody types, each letter a key and a text.
fn type_letters(window: &mut Window, letters: &[(Key, &str)]) {
    for (key, text) in letters {
        let key = |pressed| egui::Event::Key {
            key: *key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        };
        window.harness.input_mut().events.extend([key(true), egui::Event::Text((*text).into()), key(false)]);
        window.harness.step();
    }
}

#[test]
fn letters_behind_the_formula_button_are_typed_into_its_field() {
    let mut window = window();
    window.select_row(("TF side2", 0));
    window.steps(2);
    window.click_role(Role::Button, "Own airspeed");
    window.steps(2);
    window.click_role(Role::Button, "Airspeed: number or formula");
    type_letters(&mut window, &[(Key::F, "f"), (Key::A, "a"), (Key::S, "s"), (Key::T, "t")]);
    assert!(!window.shows("Esc ends it"), "no tool was chosen");
    window.press(Key::Enter);
    window.steps(2);
    assert_eq!(speed(&window, "side2"), Some(Value::Expression("fast".into())), "in the place of the number");
}

#[test]
fn a_drag_that_leaves_the_tree_within_a_frame_does_not_move_the_map() {
    let mut window = window();
    let (fix, before) = (window.centre("Fix A"), window.plan());
    let row = window.harness.get_by_role_and_label(Role::TreeItem, "VAR fire").rect();
    let from = row.lerp_inside(egui::vec2(0.4, 0.5));
    let to = fix + (window.centre("Fix B") - fix) * 0.5;
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    let moved = egui::Event::PointerMoved;
    window.harness.hover_at(from);
    window.steps(1);
    for events in [vec![button(from, true), moved(to - egui::vec2(40.0, 30.0))], vec![moved(to)], vec![]] {
        window.harness.input_mut().events.extend(events);
        window.steps(1);
    }
    assert!(window.centre("Fix A").distance(fix) < 1.0, "the map stays");
    window.harness.drop_at(to);
    window.steps(3);
    assert_ne!(window.plan(), before, "what was pressed is dragged");
}
