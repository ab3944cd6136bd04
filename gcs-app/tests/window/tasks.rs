//! What somebody wants to get done, from beginning to end, by gestures alone.

use super::considering::foresight;
use super::creating::EMPTY;
use super::emergency::in_emergency;
use super::flying::{flying, report};
use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Key, Modifiers, Vec2, vec2};
use egui_kittest::kittest::Queryable;
use flight_exec::Command;
use flight_plan::template::{Extent, Template};
use flight_plan::{Cause, FlightPlan, Id, LegKind, Pattern, Spacing, compile};
use gcs_app::assets;
use gcs_app::link::{Call, Reply};

const SIZE: Vec2 = vec2(1280.0, 1000.0);

fn opened(text: &str) -> Window {
    let mut window = Window::open_with(text, SIZE, None);
    window.until_analysed();
    window
}

/// The plan as it is can be flown.
fn flies(window: &mut Window) {
    window.until_analysed();
    assert_eq!(window.errors(), Vec::<String>::new());
    let plan = window.plan();
    let profile = aircraft::Profile::by_name(&plan.aircraft).unwrap();
    assert!(compile(plan, &profile, assets::demo_terrain().as_ref()).is_ok());
}

/// What it looks like when it is done, compared with the picture that is kept.
fn done(window: &mut Window, task: &str) {
    window.until_analysed();
    while window.app().toasts().iter().next().is_some() {
        // messages go by themselves
        window.steps(10);
    }
    window.steps(30);
    window.picture(&format!("task-{task}"));
}

/// The same in flight: what the vehicle says is fresh.
fn done_in_flight(window: &mut Window, task: &str) {
    window.receive_position(false);
    window.receive_attitude();
    window.picture(&format!("task-{task}"));
}

/// Clicks places of the map, from its middle.
fn click_map(window: &mut Window, from_middle: &[Vec2]) {
    let middle = window.centre("Map");
    from_middle.iter().for_each(|at| window.tap_at(middle + *at));
}

fn leg(plan: &FlightPlan, id: &str) -> LegKind {
    plan.leg(&Id::new(id)).unwrap_or_else(|| panic!("no leg {id}")).leg.kind.clone()
}

#[test]
fn survey_with_alternates_from_an_empty_map() {
    let mut window = Window::open_with(EMPTY, SIZE, None);
    window.steps(3);
    window.click("Among the example's hills");
    window.click("✏ Draw the area");
    click_map(
        &mut window,
        &[vec2(140.0, -60.0), vec2(230.0, -70.0), vec2(240.0, -150.0), vec2(150.0, -140.0)],
    );
    window.press(Key::Enter);
    window.click("Create");
    let way_home = window.plan().emergency_plans[0].clone();
    // another runway, and the way there
    window.click("Draw a runway (R)");
    window.click_role(Role::CheckBox, "Both directions");
    click_map(&mut window, &[vec2(120.0, 120.0), vec2(170.0, 100.0)]);
    window.click("Select and move (V)");
    let other = window.plan().runways.last().unwrap().id.clone();
    window.add_to("emergency plans", &format!("Land on {other}"));
    let away = window.plan().emergency_plans.last().unwrap().clone();
    // the survey goes there, unless the engine fails
    window.select_row(("SCAN Scan the area", 0));
    window.choose_option("Alternate", &format!("{} ({})", away.name, away.id));
    window.click_role(Role::Button, "Add alternate by cause");
    window.choose_option("Alternate by cause 1: Plan", &format!("{} ({})", way_home.name, way_home.id));
    assert!(window.gestures <= 40, "{} gestures", window.gestures);
    let plan = window.plan();
    let scan = plan.leg(&"scan".into()).unwrap().leg;
    assert_eq!(scan.emergency.by_cause, [(None, away.id), (Some(Cause::Engine), way_home.id)]);
    flies(&mut window);
    done(&mut window, "survey");
}

/// A road, as a map of the web copies it.
const ROAD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><name>The road</name><LineString><coordinates>
  -84.1780,36.3060,0 -84.1690,36.3075,0 -84.1600,36.3062,0
</coordinates></LineString></Placemark></Document></kml>"#;

#[test]
fn corridor_along_a_pasted_kml_line() {
    let mut window = opened(SQUARE);
    window.select_row(("TF side2", 0));
    window.paste(ROAD);
    let plan = window.plan();
    let made = plan.leg(&window.selected().as_str().into()).unwrap();
    assert_eq!(made.leg.name, "The road");
    let LegKind::Pattern(Pattern::Corridor { route, width_m, spacing: Spacing::Metres(apart_m) }) =
        &made.leg.kind
    else {
        panic!("no corridor")
    };
    assert_eq!((route.len(), width_m), (3, apart_m), "one track, along the line");
    window.fill_in(Role::SpinButton, "Width", "200");
    assert!(window.gestures <= 5, "{} gestures", window.gestures);
    flies(&mut window);
    done(&mut window, "corridor");
    window.click("Undo");
    window.click("Undo");
    assert_eq!(window.plan(), flight_plan::read(SQUARE).plan, "one step each");
}

#[test]
fn new_mission_along_a_pasted_kml_line() {
    let mut window = Window::open_with(EMPTY, SIZE, None);
    window.steps(3);
    window.paste(ROAD);
    let guide = window.app().view().guide.clone();
    assert_eq!(guide.template, Template::Corridor, "a line is one");
    assert!(guide.way_m().is_some_and(|way_m| way_m > 1500.0 && way_m < 10_000.0), "the runway is beside it");
    window.click("Create");
    let plan = window.plan();
    let is_it = |kind: &LegKind| matches!(kind, LegKind::Pattern(Pattern::Corridor { route, .. }) if route.len() == 3);
    assert!(plan.all_legs().iter().any(|context| is_it(&context.leg.kind)));
    flies(&mut window);
}

/// Where a place was said before, the drawing is what that mission asks for.
#[test]
fn pasted_line_is_no_area_of_a_survey() {
    let mut window = Window::open_with(EMPTY, SIZE, None);
    window.steps(3);
    window.click("Among the example's hills");
    window.paste(ROAD);
    assert!(window.shows("There is no area in what was copied"), "a survey is of an area");
    window.click("Corridor");
    window.paste(ROAD);
    assert_eq!(window.app().view().guide.template, Template::Corridor);
    assert!(matches!(&window.app().view().guide.extent, Some(Extent::Drawn(road)) if road.len() == 3));
}

#[test]
fn fork_with_a_close_look() {
    let mut window = opened(SQUARE);
    window.select_row(("TF side2", 0));
    window.click("Draw a circle or search (O)");
    click_map(&mut window, &[vec2(60.0, 60.0), vec2(100.0, 60.0)]);
    window.click("Select and move (V)");
    let look = window.selected();
    window.row_menu((&format!("ORB {look}"), 0), "Fork before it");
    window.fill_in(Role::TextInput, "Branch 1: Label", "Close look");
    window.fill_in(Role::TextInput, "Branch 2: Label", "Go on");
    window.choose_option("Default", "Go on (skip)");
    let LegKind::Intersection { branches, default, .. } = leg(&window.plan(), &window.selected()) else {
        panic!("no fork")
    };
    assert_eq!(default, Some("skip".into()));
    assert_eq!((branches[0].label.as_str(), branches[1].next.clone()), ("Close look", Some("side3".into())));
    flies(&mut window);
    let flown = |window: &Window| {
        window.app().analysis().forecast.passages.iter().any(|passage| passage.leg.as_str() == look)
    };
    assert!(!flown(&window), "it is flown past");
    done(&mut window, "fork");
}

#[test]
fn procedure_at_three_pylons() {
    let mut window = opened(SQUARE);
    window.select_row(("TF side2", 0));
    window.click("Draw a circle or search (O)");
    click_map(&mut window, &[vec2(60.0, 40.0), vec2(100.0, 40.0)]);
    window.click("Select and move (V)");
    let orbit = window.selected();
    window.row_menu((&format!("ORB {orbit}"), 0), "Make a procedure of it");
    assert_eq!(window.selected(), "call1", "the next call goes behind it");
    let procedure = window.plan().procedures[0].id.to_string();
    window.click("Draw legs (T)");
    window.choose_kind("Call of a procedure");
    click_map(&mut window, &[vec2(160.0, 60.0), vec2(200.0, -60.0)]);
    window.click("Select and move (V)");
    let plan = window.plan();
    let calls = plan.all_legs().into_iter().filter_map(|context| match &context.leg.kind {
        LegKind::Call(call) => Some(call.procedure.to_string()),
        _ => None,
    });
    assert_eq!(calls.collect::<Vec<_>>(), [procedure.as_str(); 3]);
    flies(&mut window);
    let rounds = window.app().analysis().forecast.passages.iter();
    assert_eq!(rounds.filter(|passage| passage.leg.as_str().ends_with(&orbit)).count(), 3);
    done(&mut window, "procedure");
}

#[test]
fn zone_around_a_village() {
    let mut window = opened(SQUARE);
    window.click("Draw a zone (Z)");
    let at = window.centre("Fix B");
    for by in [vec2(-30.0, -30.0), vec2(30.0, -30.0), vec2(30.0, 30.0), vec2(-30.0, 30.0)] {
        window.tap_at(at + by);
    }
    window.press(Key::Enter);
    window.click("Select and move (V)");
    window.fill_in(Role::TextInput, "Name", "Village");
    window.until_analysed();
    let errors = window.errors();
    assert!(errors.iter().any(|error| error.contains("[keep-out]")), "the path leads through it: {errors:?}");
    // above it is free
    window.click_beginning("Upper limit: ");
    window.fill_in(Role::SpinButton, "Up to", "360");
    flies(&mut window);
    done(&mut window, "zone");
}

#[test]
fn all_altitudes_are_raised_by_30_m() {
    let mut window = opened(SQUARE);
    let before = window.plan();
    window.select_row(("TF side1", 0));
    window.select_row_with(("TF side4", 0), Modifiers::SHIFT);
    window.click_role(Role::Button, "Raise them");
    window.until_analysed();
    let altitude = |plan: &FlightPlan, id: &str| {
        let context = plan.leg(&Id::new(id)).unwrap();
        let own = context.leg.altitude.clone().or(context.stage.altitude.clone());
        match own.unwrap().metres {
            flight_plan::Value::Constant(metres) => metres,
            flight_plan::Value::Expression(formula) => panic!("{formula}"),
        }
    };
    for id in ["side1", "side2", "side3", "side4"] {
        assert_eq!(altitude(&window.plan(), id), altitude(&before, id) + 30.0, "{id}");
    }
    done(&mut window, "altitudes");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

#[test]
fn three_faults_are_found_and_mended() {
    let faulty = SQUARE
        .replace(r#"<TF id="side2" fix="B"/>"#, r#"<TF id="side2" fix="BB"/>"#)
        .replace(r#"<TF id="side3" fix="C"/>"#, r#"<TF id="side3" fix="C" speed="90"/>"#)
        .replace(
            r#"type="land" runway="R05"/>
  </mainPlan>"#,
            r#"type="land"/>
  </mainPlan>"#,
        );
    let mut window = opened(&faulty);
    assert_eq!(window.errors().len(), 3, "{:?}", window.errors());
    for _ in 0..3 {
        window.until_analysed();
        let problems = window.app().analysis().problems.clone();
        let error = problems.iter().find(|problem| problem.is_error()).unwrap();
        let told = gcs_app::panels::problems::told(window.app().document(), error);
        window.click_role(Role::Button, &format!("Problem: {told}"));
        match window.selected().as_str() {
            "side2" => window.choose_option("Fix", "B"),
            "side3" => window.fill_in(Role::SpinButton, "Airspeed", "22"),
            "land" => window.choose_option("Runway", "R05"),
            other => panic!("{other}: {:?}", window.errors()),
        }
    }
    flies(&mut window);
    done(&mut window, "faults");
}

#[test]
fn what_if_the_engine_fails_here() {
    let mut window = opened(SQUARE);
    window.harness.get_all_by_label("What if").next().unwrap().click();
    window.steps(3);
    let strip = window.harness.get_by_label("Timeline").rect();
    window.tap_at(strip.center());
    window.ask_for("engine fails");
    window.press(Key::Enter);
    window.until("the way out", |app| app.analysis().diversion().is_some());
    let analysis = window.app().analysis().clone();
    assert_eq!(Some(analysis.diversion().unwrap().time_s), window.app().view().cursor_s);
    assert!(window.shows("Engine failure: R05 is reached without the engine on return, "));
    assert!(!window.is_enabled("Undo"), "the plan is what it was");
    done(&mut window, "engine");
}

#[test]
fn scan_is_bound_to_a_variable() {
    let mut window = opened(SQUARE);
    window.add_to("variables", "Position");
    window.fill_in(Role::TextInput, "Name", "fire");
    window.select_row(("TF side2", 0));
    window.click("Draw an area to scan (A)");
    window.click_role(Role::Button, "circle");
    click_map(&mut window, &[vec2(60.0, 60.0), vec2(130.0, 60.0)]);
    window.click("Select and move (V)");
    window.choose_option("Area", "a circle at a formula");
    window.fill_in(Role::TextInput, "Centre", "fire");
    window.fill_in(Role::TextInput, "Name", "Watch the fire");
    flies(&mut window);
    // where the fire is, the scan goes
    let before = window.centre("Centre of Watch the fire");
    window.select_row(("VAR fire", 0));
    window.fill_in(Role::TextInput, "Initial value", "36.3150, -84.1600");
    assert!(window.centre("Centre of Watch the fire").distance(before) > 20.0);
    flies(&mut window);
    done(&mut window, "variable");
}

#[test]
fn recovered_after_it_was_killed() {
    let folder = tempfile::tempdir().unwrap();
    let window_in = |text: &str| {
        let mut window = Window::open_with(text, SIZE, None);
        window.keep_copies(folder.path());
        window.steps(3);
        window
    };
    let mut killed = window_in(SQUARE);
    killed.until_analysed();
    killed.select_row(("TF side2", 0));
    killed.fill_in(Role::TextInput, "Name", "Along the road");
    let lost = killed.plan();
    drop(killed);
    let mut window = window_in("");
    window.click("Recover the changes");
    assert_eq!(window.plan(), lost);
    assert!(window.app().document().is_dirty());
    flies(&mut window);
    done(&mut window, "recovered");
}

#[test]
fn leg_is_moved_in_flight_and_pushed() {
    let (mut window, _) = flying();
    let at = window.centre("Fix C");
    window.drag(at, vec2(30.0, 30.0));
    window.until_analysed();
    window.click("Push");
    let Some((ticket, Call::Propose(proposal))) = window.asked() else { panic!("no proposal") };
    let sent = flight_plan::read(&*proposal.xml).plan;
    assert_eq!(sent, window.plan());
    let hash = flight_plan::hash(&sent);
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
    done_in_flight(&mut window, "push");
    window.click("Commit");
    let call = window.asked().map(|(_, call)| call);
    assert_eq!(call, Some(Call::Plan(Command::Commit { hash: hash.as_str().into(), entry: None })));
}

#[test]
fn emergency_is_flown_and_the_way_back_is_taken() {
    let (mut window, mut value) = flying();
    value.emergency_in_force = Some("return".into());
    window.receive_status(value);
    while window.asked().is_some() {}
    window.hold("Emergency: fly return (hold)", 80);
    let raised = Command::Emergency { cause: Cause::Operator, plan: None };
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(raised)));
    // it is flown now
    let mut window = in_emergency();
    while window.asked().is_some() {}
    window.click("Return to the main plan at side3");
    let back = Command::ReturnToMain { leg: "side3".into() };
    let Some((ticket, call)) = window.asked() else { panic!("nothing was asked") };
    assert_eq!(call, Call::Foresee(Some(back.clone())));
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    done_in_flight(&mut window, "way-back");
    window.hold("Return to the main plan at side3 (hold)", 90);
    let calls: Vec<Call> = std::iter::from_fn(|| window.asked()).map(|(_, call)| call).collect();
    assert!(calls.contains(&Call::Plan(back)), "{calls:?}");
}
