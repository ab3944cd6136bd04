//! Before the flight.

use super::{SQUARE, Window};
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::{Id, LegKind, Spacing, Value};
use gcs_app::command::Selection;

fn fix(window: &Window, id: &str) -> geometry::LatLon {
    window.app().document().plan().fix(&Id::new(id)).unwrap().position
}

#[test]
fn a_plan_opens_with_tree_map_and_profile() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    for label in
        ["TF side1", "T/O take-off", "ALT return", "FIX A", "RWY R05", "Map", "Fix A", "Vertical profile"]
    {
        assert!(window.shows(label), "{label}");
    }
    let forecast = &window.app().analysis().forecast;
    assert!(forecast.length_m() > 5000.0 && !forecast.waypoints.is_empty());
    assert!(window.shows("This plan can be flown"));
}

#[test]
fn dragging_a_waypoint_is_one_step_and_undo_puts_it_back_exactly() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = fix(&window, "A");
    assert!(!window.is_enabled("Undo"));
    let at = window.centre("Fix A");
    // clear of the runway's centre line, which snaps
    let way = vec2(70.0, -10.0);
    window.drag(at, way);
    let after = fix(&window, "A");
    assert!(after.lon_deg > before.lon_deg && after.lat_deg > before.lat_deg, "{before:?} {after:?}");
    assert!(window.centre("Fix A").distance(at + way) < 2.0, "it is where the pointer left it");
    assert_eq!(window.app().view().selection, Some(Selection::Fix("A".into())));
    window.click("Undo");
    assert_eq!(fix(&window, "A"), before);
    assert!(!window.is_enabled("Undo"), "the whole drag was one step");
    window.click("Redo");
    assert_eq!(fix(&window, "A"), after);
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.steps(2);
    assert_eq!(fix(&window, "A"), before);
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    window.steps(2);
    assert_eq!(fix(&window, "A"), after);
}

#[test]
fn dragging_a_waypoint_changes_neither_its_altitude_nor_what_that_counts_from() {
    let placed = r#"<TF id="side2" lat="36.3209" lon="-84.1537" altitude="120" altitudeReference="agl"/>"#;
    let mut window = Window::open(&SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, placed));
    window.until_analysed();
    let leg = |window: &Window| window.plan().leg(&"side2".into()).unwrap().leg.clone();
    let (before, at) = (leg(&window), window.centre("Waypoint side2"));
    window.drag(at, vec2(60.0, 30.0));
    let after = leg(&window);
    assert!(after.altitude.is_some() && after.altitude == before.altitude);
    assert!(after.place() != before.place());
}

#[test]
fn dragging_the_map_moves_the_map_and_not_the_plan() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let (at, map) = (window.centre("Fix A"), window.centre("Map"));
    window.drag(map + vec2(0.0, -200.0), vec2(50.0, 30.0));
    assert!(window.centre("Fix A").distance(at) > 20.0);
    assert!(!window.is_enabled("Undo"));
}

#[test]
fn a_new_path_follows_an_edit() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = window.app().analysis().forecast.length_m();
    let at = window.centre("Fix C");
    window.drag(at, vec2(-90.0, 90.0));
    window.until_analysed();
    let after = window.app().analysis().forecast.length_m();
    assert!(after > before + 100.0, "{before} {after}");
}

const SCAN: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="Scan" aircraft="trainer">
  <runways><runway id="R05" lat="36.3190" lon="-84.1730" elevation="349" heading="52" length="600" priority="1"/></runways>
  <variables>
    <variable name="fire" type="position" initial="36.31 -84.15"/>
    <variable name="size" type="number" unit="m" initial="600" min="100" max="5000"/>
  </variables>
  <mainPlan>
    <stage id="to" type="take-off" runway="R05" altitude="80" altitudeReference="home"/>
    <stage id="watch" type="mission" altitude="1000">
      <scan id="sweep" spacing="150"><area centre="= fire" radius="= size + 200.0"/></scan>
    </stage>
    <stage id="land" type="land" runway="R05"/>
  </mainPlan>
</flightPlan>"#;

fn number(window: &Window, name: &str) -> f64 {
    match window.app().document().plan().variable(&Id::new(name)).unwrap().initial {
        flight_plan::VariableValue::Number(n) => n,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn a_scan_s_area_is_moved_and_resized_through_its_variables() {
    let mut window = Window::open(SCAN);
    window.until_analysed();
    let at = window.centre("Centre of sweep");
    window.drag(at, vec2(-40.0, 20.0));
    assert_eq!(window.app().view().notice, None);
    let moved = window.centre("Centre of sweep") - at;
    assert!((moved - vec2(-40.0, 20.0)).length() < 2.0, "{moved:?}");
    let rim = window.centre("Radius of sweep");
    let radius = (rim - window.centre("Centre of sweep")).x;
    window.drag(rim, vec2(radius * 0.5, 0.0));
    assert!(
        (number(&window, "size") - 1000.0).abs() < 15.0,
        "800 m and a half more, of which 200 m are added: {}",
        number(&window, "size")
    );
    window.click("Undo");
    assert_eq!(number(&window, "size"), 600.0);
}

#[test]
fn the_inspector_edits_what_is_selected() {
    let mut window = Window::open(SCAN);
    window.until_analysed();
    window.click("SCAN sweep");
    assert_eq!(window.app().view().selection, Some(Selection::Leg("sweep".into())));
    window.harness.get_by_role_and_label(egui::accesskit::Role::SpinButton, "Spacing").click();
    window.steps(2);
    for _ in 0..6 {
        window.harness.key_press(Key::Backspace);
    }
    window.harness.event(egui::Event::Text("200".into()));
    window.harness.key_press(Key::Enter);
    window.steps(3);
    let plan = window.app().document().plan().clone();
    let LegKind::Scan(scan) = &plan.leg(&"sweep".into()).unwrap().leg.kind else { panic!() };
    assert_eq!(scan.spacing, Spacing::Metres(Value::Constant(200.0)));
    window.click("Undo");
    let plan = window.app().document().plan().clone();
    let LegKind::Scan(scan) = &plan.leg(&"sweep".into()).unwrap().leg.kind else { panic!() };
    assert_eq!(scan.spacing, Spacing::Metres(Value::Constant(150.0)));
}

#[test]
fn a_problem_leads_to_its_place() {
    let far = r#"<TF id="side2" name="Far side" fix="NOWHERE"/>"#;
    let mut window = Window::open(&SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, far));
    window.until_analysed();
    assert!(!window.shows("This plan can be flown"));
    // people read its name, not its identifier
    window.harness.query_all_by_label_contains("Problem: Far side: ").next().unwrap().click();
    window.steps(3);
    assert_eq!(window.app().view().selection, Some(Selection::Leg("side2".into())));
}

#[test]
fn broken_text_opens_with_its_problems() {
    for text in
        ["", "<", "not a plan", "<flightPlan", "<flightPlan xmlns='urn:legwork:flight-plan:1' name='x'/>"]
    {
        let mut window = Window::open(text);
        window.until_analysed();
        assert!(window.shows("Problem: "), "{text:?}");
    }
}

#[test]
fn units_change_what_is_shown_and_nothing_else() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let hash = window.app().analysis().hash.clone();
    window.click("Legwork");
    window.click("Aviation: ft, kt, NM");
    assert!(window.shows("NM"));
    assert_eq!(window.app().analysis().hash, hash);
    assert!(!window.app().document().is_dirty());
}

#[test]
fn keys_delete_and_reorder_the_selected_leg() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let order = |window: &Window| -> Vec<String> {
        window.app().document().plan().stages[1].legs.iter().map(|l| l.id.to_string()).collect()
    };
    window.click("TF side2");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::ArrowDown);
    window.steps(2);
    assert_eq!(order(&window), ["side1", "side3", "side2", "side4"]);
    window.harness.key_press(Key::Delete);
    window.steps(2);
    assert_eq!(order(&window), ["side1", "side3", "side4"]);
}

const PROCEDURE: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="Called" aircraft="trainer">
  <procedures><procedure id="look" reference="36.33 -84.16" bearing="0"><TF id="inner" lat="36.33" lon="-84.16"/></procedure></procedures>
  <mainPlan><stage id="m" type="mission"/></mainPlan></flightPlan>"#;

#[test]
fn a_leg_inside_a_procedure_can_be_selected_in_the_tree() {
    let mut window = Window::open(PROCEDURE);
    window.click("TF inner");
    assert_eq!(window.app().view().selection, Some(Selection::Leg("inner".into())));
    assert!(!window.shows("It is no longer in the plan."));
}

#[test]
fn inherited_values_say_where_they_come_from_and_editing_begins_with_them() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let before = window.plan();
    let stage = before.stage(&"circuit".into()).unwrap().clone();
    assert!(before.leg(&"side3".into()).unwrap().leg.altitude.is_none() && stage.altitude.is_some());
    window.click("TF side3");
    assert!(window.shows("from circuit") && window.shows("from the aircraft's cruise"));
    for field in ["Altitude", "Airspeed"] {
        let at =
            window.harness.get_by_role_and_label(egui::accesskit::Role::SpinButton, field).rect().center();
        window.click_at(at);
        window.press(Key::Enter);
        assert_eq!(window.plan(), before, "{field}: what is only looked at is not changed");
    }
    window.fill_in(egui::accesskit::Role::SpinButton, "Altitude", "170");
    let own = window.plan().leg(&"side3".into()).unwrap().leg.altitude.clone().unwrap();
    assert_eq!((own.metres, own.reference), (Value::Constant(170.0), flight_plan::AltitudeReference::Home));
    window.click("Undo");
    window.click("Own altitude");
    let own = window.plan().leg(&"side3".into()).unwrap().leg.altitude.clone();
    assert_eq!(own, stage.altitude, "nothing jumps");
    window.until_analysed();
    window.harness.event(egui::Event::Text("185".into()));
    window.press(Key::Enter);
    let own = window.plan().leg(&"side3".into()).unwrap().leg.altitude.clone().unwrap();
    assert_eq!(own.metres, Value::Constant(185.0), "what is typed then is its number");
    window.click("Undo");
    window.click("Undo");
    assert_eq!(window.plan(), before);
}

/// The preview flies no emergency plan: what the legs before it say holds.
#[test]
fn a_leg_of_an_emergency_plan_inherits_what_is_said_before_it() {
    let r1 = r#"<DF id="r1" fix="D" altitude="150" altitudeReference="home"/>"#;
    let mut window = Window::open(&SQUARE.replacen(r1, &format!(r#"{r1}<TF id="r2" fix="A"/>"#), 1));
    window.until_analysed();
    window.click("TF r2");
    assert!(window.shows("from the leg before"));
    window.click("Own altitude");
    let own = window.plan().leg(&"r2".into()).unwrap().leg.altitude.clone().unwrap();
    assert_eq!((own.metres, own.reference), (Value::Constant(150.0), flight_plan::AltitudeReference::Home));
}

#[test]
fn table_tells_name_energy_and_height_above_ground_of_each_leg() {
    let text = SQUARE.replacen("<TF id=\"side2\"", "<TF name=\"Second side\" id=\"side2\"", 1);
    let mut window = Window::open(&text);
    window.until_analysed();
    window.harness.get_all_by_label("Table").next().unwrap().click();
    window.steps(3);
    for shown in ["Energy left", "Above ground, m", "Second side"] {
        assert!(window.shows(shown), "{shown}");
    }
    assert!(window.harness.query_all_by_label_contains(" %").count() > 1, "energy of each leg");
}

#[test]
fn variables_that_are_a_place_are_on_the_map() {
    let mut window = Window::open(gcs_app::assets::FIRE_WATCH);
    window.until_analysed();
    window.harness.get_by_label("Variable fire centre").click_accesskit();
    window.steps(3);
    assert_eq!(window.selected(), "fire_centre");
}

/// Step by step back from a plan that flies to nothing: each path is that of the plan, or says that it is not.
#[test]
fn every_path_is_that_of_the_plan_that_undo_leaves_or_says_that_it_is_not() {
    let mut window = Window::open_with(super::creating::EMPTY, vec2(1280.0, 1000.0), None);
    window.steps(3);
    window.click("Among the example's hills");
    window.press(Key::Escape);
    window.click("Draw a runway (R)");
    let at = window.centre("Map");
    window.click_at(at);
    window.click_at(at + vec2(60.0, -30.0));
    window.click("Select and move (V)");
    for stage in ["Take-off stage", "Mission stage"] {
        window.add_to("main plan", stage);
    }
    window.click("Draw legs (T)");
    window.click_at(at + vec2(120.0, 60.0));
    window.until_analysed();
    assert!(window.app().analysis().forecast.length_m() > 100.0);
    while window.app().document().can_undo() {
        window.press_ctrl(Key::Z);
        window.until_analysed();
        window.steps(30);
        let plan = window.plan();
        let forecast = &window.app().analysis().forecast;
        let is_gone = |id: &Id| plan.leg(id).is_none() && plan.stage(id).is_none();
        let is_old = forecast.passages.iter().any(|passage| is_gone(&passage.leg));
        assert!(!is_old || window.paints("◌ Out of date"), "{:?}", forecast.passages);
        assert!(!plan.stages.is_empty() || forecast.points.is_empty());
    }
}

#[test]
fn figures_of_a_path_that_is_out_of_date_say_so() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    assert!(!window.shows("Out of date"));
    let weak = gcs_app::theme::palette(true).weak;
    let grey = |window: &Window, of: &str| window.lines_within(of, weak);
    // the path on the map is kept as triangles
    let (map, profile) = (window.triangles_within("Map", weak), grey(&window, "Vertical profile"));
    assert_eq!(profile, 0);
    window.click("TF side3");
    window.fill_in(egui::accesskit::Role::SpinButton, "Airspeed", "90");
    window.until_analysed();
    window.press(Key::Escape);
    // the map, the row above the profile, and the plan's figures
    assert!(window.harness.query_all_by_label_contains("Out of date").count() >= 3);
    assert!(window.triangles_within("Map", weak) > map, "the path on the map is grey");
    assert!(grey(&window, "Vertical profile") > 0, "the path in the profile is grey");
}

#[test]
fn a_landing_without_an_approach_says_so_and_gets_one() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.select_row(("LND land", 0));
    window.steps(2);
    assert!(window.shows("No approach leads to it"));
    window.click("Add an approach stage");
    window.steps(2);
    let plan = window.plan();
    let kinds: Vec<_> = plan.stages.iter().rev().take(2).map(|stage| stage.kind).collect();
    assert_eq!(kinds, [flight_plan::StageKind::Land, flight_plan::StageKind::Approach]);
    assert_eq!(window.selected(), plan.stages[plan.stages.len() - 2].id.as_str());
    window.select_row(("LND land", 0));
    window.steps(2);
    assert!(!window.shows("No approach leads to it"));
}
