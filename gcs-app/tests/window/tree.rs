//! The tree's menus.

use super::{SQUARE, Window};
use egui_kittest::kittest::Queryable;
use flight_plan::create::{LegChoice, Shape};
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
                let call = after.leg(&window.selected().as_str().into()).unwrap().leg;
                assert!(matches!(call.kind, LegKind::Call(_)), "the next call goes behind it");
            }
            _ => assert!(!legs(&after).contains(&"side2".to_owned())),
        }
        window.click("Undo");
        assert_eq!(window.plan(), before, "{entry} is one step");
    }
}

#[test]
fn a_runway_gets_an_emergency_plan_and_a_fix_is_deleted_without_breaking_its_legs() {
    // all rows of the tree fit
    let mut window = Window::open_with(SQUARE, egui::vec2(1280.0, 1000.0), None);
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

/// A fix stays where it is wherever its procedure is called; the place of it that became the leg's own moves along.
#[test]
fn the_fixes_of_a_procedure_are_moved_along_with_it() {
    for from_menu in [true, false] {
        let mut window = Window::open_with(SQUARE, egui::vec2(1280.0, 1000.0), None);
        window.until_analysed();
        choose(&mut window, "TF side2", "Make a procedure of it");
        let at = window.plan().fix(&"B".into()).unwrap().position;
        let move_along = "Move its fixes along with the procedure";
        match from_menu {
            true => choose(&mut window, "PROC procedure1", move_along),
            false => {
                window.click("TF side2");
                assert!(window.shows("stays where it is wherever the procedure is called"));
                window.click(move_along);
            }
        }
        let plan = window.plan();
        let (_, leg) = plan.procedure_leg(&"side2".into()).unwrap();
        assert_eq!(leg.place(), Some(&flight_plan::Place::Position(flight_plan::Value::Constant(at))));
        assert!(plan.fix(&"B".into()).is_some() && !window.shows("stays where it is wherever"));
        window.click("Undo");
        assert_eq!(window.plan().procedures[0].legs[0].place(), Some(&flight_plan::Place::Fix("B".into())));
    }
}

/// The `+` of a heading, and an entry of its menu.
fn add(window: &mut Window, to: &str, entry: &str) {
    window.click(&format!("Add to {to}"));
    let at = window.harness.get_by_label(entry).rect().center();
    window.click_at(at);
}

#[test]
fn stages_variables_and_emergency_plans_are_made_from_the_headings() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = window.plan();
    add(&mut window, "main plan", "Mission stage");
    let made = window.selected();
    let plan = window.plan();
    let ids: Vec<&str> = plan.stages.iter().map(|stage| stage.id.as_str()).collect();
    assert_eq!(ids.iter().position(|id| *id == made), Some(ids.len() - 2), "before the landing: {ids:?}");
    window.click("Undo");
    assert_eq!(window.plan(), before);
    for kind in ["Number", "Yes or no", "Text", "Position", "Area"] {
        add(&mut window, "variables", kind);
        assert!(window.plan().variable(&window.selected().as_str().into()).is_some(), "{kind}");
    }
    add(&mut window, "emergency plans", "Land on R05");
    assert_eq!(window.plan().emergency_plans.len(), before.emergency_plans.len() + 1);
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
}

#[test]
fn stage_is_moved_from_its_menu() {
    let mut window = Window::open(SQUARE);
    choose(&mut window, "ENR circuit", "Move up");
    let plan = window.plan();
    let ids: Vec<&str> = plan.stages.iter().map(|stage| stage.id.as_str()).collect();
    assert_eq!(ids, ["circuit", "take-off", "land"]);
}

#[test]
fn leg_becomes_every_kind_that_its_menu_offers() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = window.plan();
    let mut changed = 0;
    for choice in LegChoice::ALL.into_iter().filter(|choice| choice.shape() != Shape::Nothing) {
        window.harness.get_by_label("TF side2").click_secondary();
        window.steps(3);
        let kinds = window.harness.get_by_label_contains("Change its kind").rect().center();
        window.click_at(kinds);
        let offered = choice != LegChoice::Tf && window.is_enabled(&choice.name());
        if offered {
            let at = window.harness.get_by_label(&choice.name()).rect().center();
            window.click_at(at);
            assert_eq!(LegChoice::of(&window.plan().leg(&"side2".into()).unwrap().leg.kind), choice);
            window.until_analysed();
            // an arc between straight tracks is never smooth at both ends, and that is said
            if choice != LegChoice::Rf {
                assert_eq!(window.errors(), Vec::<String>::new(), "{}", choice.name());
            }
            window.click("Undo");
            assert_eq!(window.plan(), before, "{}", choice.name());
            changed += 1;
        } else {
            window.press(egui::Key::Escape);
            assert!(!window.shows("Change its kind"), "Escape closes the menu");
        }
    }
    assert!(changed >= 12, "{changed} kinds");
}

#[test]
fn search_shows_what_matches_and_where_it_is_and_enter_goes_there() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.press_ctrl(egui::Key::F);
    window.harness.event(egui::Event::Text("SIDE3".into()));
    window.steps(3);
    assert!(window.shows("TF side3") && window.shows("ENR circuit") && window.shows("Main plan"));
    assert!(!window.shows("TF side2") && !window.shows("FIX A") && !window.shows("LND land"));
    window.press(egui::Key::Enter);
    assert_eq!(window.selected(), "side3");
    window.press_ctrl(egui::Key::F);
    window.harness.event(egui::Event::Text("-and-more".into()));
    window.steps(3);
    assert!(window.shows("Nothing in the plan has"));
    window.press(egui::Key::Escape);
    assert!(window.shows("TF side2") && window.shows("FIX A"), "all of it again");
    assert!(window.plan().leg(&"side3".into()).is_some());
}

#[test]
fn search_finds_what_is_called_so() {
    let named = r#"<TF id="side2" name="Along the river" fix="B"/>"#;
    let mut window = Window::open(&SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, named));
    window.until_analysed();
    window.press_ctrl(egui::Key::F);
    window.harness.event(egui::Event::Text("RIVER".into()));
    window.steps(3);
    assert!(window.shows("TF Along the river") && !window.shows("TF side3"));
    window.press(egui::Key::Enter);
    assert_eq!(window.selected(), "side2");
}

#[test]
fn conditions_are_found_by_what_is_in_them() {
    let mut window = Window::open(include_str!("../../../assets/plans/fire-watch.xml"));
    window.until_analysed();
    let plan = window.plan();
    let until = plan.all_legs().iter().find_map(|c| match &c.leg.kind {
        LegKind::Iterative { until: Some(until), .. } => Some((until.to_string(), c.leg.id.clone())),
        _ => None,
    });
    let (until, id) = until.unwrap();
    window.press_ctrl(egui::Key::F);
    window.harness.event(egui::Event::Text(until));
    window.steps(3);
    window.press(egui::Key::Enter);
    assert_eq!(window.selected(), id.as_str());
}

/// A click on a row with a key held down.
fn click_with(window: &mut Window, row: &str, modifiers: egui::Modifiers) {
    let at = window.centre(row);
    window.harness.event(egui::Event::PointerMoved(at));
    for pressed in [true, false] {
        let button = egui::PointerButton::Primary;
        window
            .harness
            .event_modifiers(egui::Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
        window.steps(1);
    }
    window.steps(3);
}

#[test]
fn several_legs_are_looped_raised_and_deleted_together() {
    let mut window = Window::open_with(SQUARE, egui::vec2(1280.0, 1000.0), None);
    window.until_analysed();
    let before = window.plan();
    window.click("TF side1");
    click_with(&mut window, "TF side3", egui::Modifiers::SHIFT);
    assert!(window.shows("3 legs"));
    choose(&mut window, "TF side2", "Put them into a loop");
    let plan = window.plan();
    let body: Vec<String> = plan
        .leg(&window.selected().as_str().into())
        .unwrap()
        .leg
        .body()
        .iter()
        .map(|l| l.id.to_string())
        .collect();
    assert_eq!(body, ["side1", "side2", "side3"]);
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");

    window.click("TF side1");
    click_with(&mut window, "TF side3", egui::Modifiers::SHIFT);
    choose(&mut window, "TF side2", "Put a fork around them");
    let plan = window.plan();
    let fork = plan.leg(&window.selected().as_str().into()).unwrap();
    let past = fork.leg.as_fork().unwrap().branches[1].clone();
    assert_eq!(
        (fork.index, past.label.as_str(), past.next),
        (0, "Skip side1 to side3", Some("side4".into()))
    );
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");

    window.click("TF side1");
    click_with(&mut window, "TF side3", egui::Modifiers::COMMAND);
    assert!(window.shows("2 legs"));
    click_with(&mut window, "ALT return", egui::Modifiers::COMMAND);
    assert!(window.shows("2 legs") && window.shows("This can't be selected together with others"));
    window.click("Raise them");
    let altitude = |window: &Window, leg: &str| match &window.plan().leg(&leg.into()).unwrap().leg.altitude {
        Some(altitude) => altitude.metres.clone(),
        None => panic!("{leg} has none of its own"),
    };
    assert_eq!(altitude(&window, "side1"), flight_plan::Value::Constant(130.0));
    assert_eq!(
        altitude(&window, "side3"),
        flight_plan::Value::Constant(180.0),
        "30 m above what it inherited"
    );
    assert!(window.plan().leg(&"side2".into()).unwrap().leg.altitude.is_none());
    window.click("Undo");
    window.press(egui::Key::Delete);
    assert_eq!(legs(&window.plan()), ["side2", "side4", "r1"]);
    window.click("Undo");
    assert_eq!(window.plan(), before);
    click_with(&mut window, "TF side1", egui::Modifiers::COMMAND);
    assert_eq!(window.selected(), "side3", "it is taken out");
    window.click("TF side2");
    assert!(!window.shows("2 legs"), "a click alone selects one");
}

#[test]
fn a_fix_that_is_left_behind_by_its_last_leg_is_told_of() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.select_row(("TF side2", 0));
    window.press(egui::Key::Delete);
    assert!(window.shows("No leg goes to B any more"));
    // it lay where one draws
    let there = window.harness.get_by_label("No leg goes to B any more").rect().center();
    window.harness.hover_at(there);
    window.steps(3);
    assert!(window.shows("No leg goes to B any more"), "nothing is drawn");
    window.press(egui::Key::T);
    window.harness.hover_at(there);
    window.steps(3);
    assert!(!window.shows("No leg goes to B any more"), "it gives way to the pointer of a tool");
    window.harness.hover_at(window.centre("Map"));
    window.steps(3);
    assert!(window.shows("No leg goes to B any more"));
}

/// What is expected on the ground shows behind the landing, in the timeline, and as fields of the stage.
#[test]
fn a_landing_before_another_flight_shows_what_is_expected_on_the_ground() {
    let flights = include_str!("../../../assets/docs/fragments/flights.xml");
    let mut window = Window::open_with(flights, egui::vec2(1280.0, 1000.0), None);
    window.until_analysed();
    assert!(window.harness.query_by_label_contains("2 flights").is_some());
    window.harness.get_by_label("LND Change the battery").click();
    window.steps(4);
    let fields = ["Next begins", "Ground time"];
    assert!(fields.iter().all(|field| window.shows(field)));
    // nothing is behind a mission that could be expected of a time on the ground
    window.harness.get_by_label("ENR circuit").click();
    window.steps(4);
    assert!(!fields.iter().any(|field| window.shows(field)));
}

#[test]
fn every_expression_is_found_wherever_in_a_leg_it_is() {
    let variables = r#"<variables><variable name="fuel_low" type="bool" initial="false"/>
        <variable name="reach" type="number" unit="m" initial="300"/></variables>"#;
    let legs = r#"<HM id="wait" fix="A" course="52" turn="right" length="600" until="fuel_low"/>
        <orbit id="look" radius="= reach + 41.0" turns="2" turn="right"><centre fix="B"/></orbit>"#;
    let text = SQUARE.replace("<mainPlan", &format!("{variables}<mainPlan"));
    let text = text.replace(r#"<TF id="side2" fix="B"/>"#, &format!(r#"<TF id="side2" fix="B"/>{legs}"#));
    let mut window = Window::open(&text);
    window.until_analysed();
    for (sought, found) in [("fuel_low", "HM wait"), ("41.0", "ORB look")] {
        window.press_ctrl(egui::Key::F);
        window.harness.event(egui::Event::Text(sought.into()));
        window.steps(3);
        assert!(window.shows(found) && !window.shows("TF side2"), "{sought}");
        window.press(egui::Key::Escape);
    }
    assert!(window.paints("until fuel_low"), "it stands beside its leg");
}
