//! What if: other worlds for the preview, and alarms at its cursor.

use super::painted::texts;
use super::{PATIENCE, SQUARE, Window};
use aircraft::{Profile, Wind};
use egui::accesskit::Role;
use egui::vec2;
use egui_kittest::kittest::{NodeT, Queryable};
use flight_exec::rehearse::{Act, Options, Reach, Scenario, Start, Trigger, When};
use flight_exec::{Command, preview};
use flight_plan::{Cause, Id, VariableValue, compile};
use gcs_app::app::App;
use gcs_app::forecast::Coverage;
use gcs_app::panels::what_if::CAUSES;
use std::sync::Arc;
use std::time::Instant;

pub const FIRE_WATCH: &str = include_str!("../../../assets/plans/fire-watch.xml");

fn opened(text: &str) -> Window {
    let mut window = Window::open(text);
    window.until_analysed();
    window.harness.get_all_by_label("What if").next().unwrap().click();
    window.steps(3);
    window
}

/// Moves a slider, and waits until the preview is that of the new world.
fn slide(window: &mut Window, name: &str, value: f64) {
    window.harness.get_by_role_and_label(Role::Slider, name).set_value_accesskit(value);
    window.steps(2);
    window.until("the other world", |app| app.analysis().what_if == app.view().what_if);
}

/// Chooses something that may have to be scrolled to.
fn choose(window: &mut Window, label: &str) {
    window.harness.get_by_label(label).click_accesskit();
    window.steps(3);
}

fn duration_s(window: &Window) -> f64 {
    window.app().analysis().forecast.duration_s()
}

fn is_current(app: &App) -> bool {
    app.analysis().what_if == app.view().what_if && app.analysis().version == app.document().version()
}

#[test]
fn wind_changes_the_preview_and_not_the_document() {
    let mut window = opened(SQUARE);
    let (before, calm_s) = (window.plan(), duration_s(&window));
    slide(&mut window, "Wind from", 240.0);
    slide(&mut window, "Wind speed", 10.0);
    assert!((window.app().view().what_if.wind.direction_from_deg() - 240.0).abs() < 1e-6);
    let windy_s = duration_s(&window);
    assert!((windy_s - calm_s).abs() > 5.0, "{calm_s} {windy_s}");
    assert!(window.shows("What if: wind 10.0 m/s from 240°"));
    assert_eq!(window.plan(), before);
    assert!(!window.is_enabled("Undo") && !window.app().document().is_dirty());
    window.until("the review stays the standard one", |app| app.analysis().reviewed);
    assert!(window.shows("This plan can be flown"));
    window.click("Back to the plan's own world");
    window.until("calm again", is_current);
    assert_eq!(duration_s(&window), calm_s);
    assert!(!window.shows("What if: wind"));
}

/// What came of an alarm stood below the fold: whoever asked saw nothing.
#[test]
fn in_a_small_window_what_comes_of_an_alarm_is_in_sight() {
    let mut window = Window::open_with(SQUARE, vec2(960.0, 600.0), None);
    window.until_analysed();
    window.harness.get_all_by_label("What if").next().unwrap().click();
    window.steps(3);
    let coverage = |window: &Window| window.harness.get_by_label("Coverage of the whole path").rect();
    let before = coverage(&window);
    window.click("Engine failure");
    window.until("the way out", |app| app.analysis().diversion().is_some());
    assert_eq!(coverage(&window), before, "it is asked for next, where it was");
    let answer = "Engine failure: R05 is";
    let lies = window.harness.query_all_by_label_contains(answer).next().unwrap().rect();
    let shapes = window.harness.output().shapes.iter();
    let painted =
        shapes.filter(|clipped| texts(&clipped.shape).iter().any(|text| text.galley.text().contains(answer)));
    let seen = painted.map(|clipped| clipped.clip_rect).next().unwrap();
    assert!(seen.contains_rect(lies.shrink(1.0)), "{lies} in {seen}");
}

/// 10 m/s from behind changed the times, and nothing was said; Problems spoke of calm air as if it were this world's.
#[test]
fn much_wind_from_behind_is_said_and_that_problems_do_not_count_it() {
    let mut window = opened(SQUARE);
    assert!(window.shows("This plan can be flown") && !window.shows("What if not counted"));
    slide(&mut window, "Wind from", 232.0);
    slide(&mut window, "Wind speed", 10.0);
    let both =
        "⚠ 10.0 m/s from behind for the take-off from R05, 10.0 m/s from behind for the landing on R05";
    assert!(window.shows(both) && window.shows(", What if not counted"));
    slide(&mut window, "Wind from", 52.0);
    assert!(!window.shows("from behind") && window.shows("What if not counted"));
    slide(&mut window, "Wind from", 232.0);
    slide(&mut window, "Wind speed", 20.0);
    assert!(window.shows("the aircraft can't take off with so much wind from behind"));
}

#[test]
fn in_warm_air_an_autopilot_is_faster() {
    let mut window = opened(SQUARE);
    let usual_s = duration_s(&window);
    slide(&mut window, "ISA deviation", 20.0);
    assert_eq!(duration_s(&window), usual_s, "true airspeeds are the same in any air");
    window.connect();
    let as_reviewed = window.app().analysis().forecast.clone();
    window.receive_autopilot("PX4 fixed wing", "px4");
    window.until("the vehicle's way", |app| !Arc::ptr_eq(&app.analysis().forecast, &as_reviewed));
    let warm_s = duration_s(&window);
    assert!(window.shows("What if: air 20 °C warmer than standard"));
    slide(&mut window, "ISA deviation", -20.0);
    let cold_s = duration_s(&window);
    assert!(cold_s > warm_s + 5.0 && window.shows("air 20 °C colder than standard"), "{cold_s} {warm_s}");
}

#[test]
fn what_is_being_drawn_is_tried_in_the_wind_that_is_set() {
    let mut window = opened(SQUARE);
    window.press(egui::Key::O);
    let at = window.centre("Map") + vec2(90.0, 40.0);
    window.click_at(at);
    let tried = |window: &mut Window| {
        window.harness.hover_at(at + vec2(50.0, 0.0));
        window.steps(3);
        let mut said = window.harness.query_all_by_label_contains("Orbit: ");
        said.find_map(|node| node.accesskit_node().value()).unwrap()
    };
    let accent = gcs_app::theme::palette(true).accent;
    let drawn = |window: &Window| window.lines_within("Map", accent);
    let before = drawn(&window);
    let calm = tried(&mut window);
    assert!(drawn(&window) > before + 20, "its path is drawn, dash by dash");
    assert!(calm.contains(" m · ") || calm.contains(" km · "), "length and time: {calm}");
    slide(&mut window, "Wind speed", 12.0);
    assert_ne!(tried(&mut window), calm, "against the wind it takes longer");
}

#[test]
fn a_slider_grows_the_scan_and_taking_it_into_the_plan_is_one_step() {
    let mut window = opened(FIRE_WATCH);
    let (before, short_m) = (window.plan(), window.app().analysis().forecast.length_m());
    slide(&mut window, "fire_radius", 600.0);
    let long_m = window.app().analysis().forecast.length_m();
    assert!(long_m > short_m + 500.0, "{short_m} {long_m}");
    assert_eq!(window.plan(), before);
    choose(&mut window, "Take into the plan");
    let radius = |window: &Window| window.plan().variable(&"fire_radius".into()).unwrap().initial.clone();
    assert_eq!(radius(&window), VariableValue::Number(600.0));
    assert!(window.app().view().what_if.is_nothing() && !window.is_enabled("Take into the plan"));
    window.until("the plan's own path", is_current);
    assert!((window.app().analysis().forecast.length_m() - long_m).abs() < 1.0);
    window.click("Undo");
    assert_eq!(window.plan(), before);
    assert!(!window.is_enabled("Undo"));
}

#[test]
fn a_decision_takes_the_other_branch() {
    let mut window = opened(FIRE_WATCH);
    let looks = |window: &Window| {
        window.app().analysis().forecast.passages.iter().filter(|p| p.leg.as_str() == "look").count()
    };
    assert_eq!(looks(&window), 0);
    choose(&mut window, "Look closer?: Close look");
    window.until("the other branch", is_current);
    assert_eq!(looks(&window), 1);
    choose(&mut window, "Look closer?: as planned");
    window.until("the plan's branch", is_current);
    assert_eq!(looks(&window), 0);
}

#[test]
fn less_energy_at_the_start_is_less_at_the_end() {
    let mut window = opened(SQUARE);
    let full = window.app().analysis().forecast.battery_left.unwrap();
    slide(&mut window, "Energy at start", 50.0);
    let half = window.app().analysis().forecast.battery_left.unwrap();
    assert!((full - half - 0.5).abs() < 0.01, "{full} {half}");
}

#[test]
fn a_flight_for_which_the_energy_is_too_little_ends_early_and_says_why() {
    let mut window = opened(FIRE_WATCH);
    let whole_m = window.app().analysis().forecast.length_m();
    assert_eq!(window.app().analysis().forecast.cut_short, None);
    slide(&mut window, "Energy at start", 10.0);
    let forecast = &window.app().analysis().forecast;
    assert!(forecast.length_m() < whole_m - 500.0, "{} of {whole_m}", forecast.length_m());
    let why = forecast.cut_short.clone().unwrap();
    // at the end of the path there is room for its beginning
    let begins: String = why.chars().take(12).collect();
    assert!(why.contains("energy") && window.paints(&begins), "{why}");
}

/// Puts the cursor at a share of the flight, by the timeline.
fn scrub(window: &mut Window, share: f32) {
    let strip = window.harness.get_by_label("Timeline").rect();
    window.click_at(strip.left_center() + vec2(share * strip.width(), 0.0));
}

/// A short stage has no room for its name.
#[test]
fn the_timeline_tells_the_whole_name_of_the_stage_below_the_pointer() {
    let name = "The runway of the farm beside the northern ridge";
    let mut window =
        opened(&SQUARE.replacen(r#"<stage id="land""#, &format!(r#"<stage id="land" name="{name}""#), 1));
    let strip = window.harness.get_by_label("Timeline").rect();
    window.harness.hover_at(strip.right_center() - vec2(3.0, 0.0));
    window.steps(60);
    let told = window.harness.query_all_by_label(name).count();
    window.harness.hover_at(window.centre("Map"));
    window.steps(60);
    assert_eq!(window.harness.query_all_by_label(name).count() + 1, told, "its tooltip");
}

#[test]
fn an_engine_failure_at_the_cursor_leads_to_the_runway_of_the_plan_as_without_a_window() {
    let mut window = opened(SQUARE);
    scrub(&mut window, 0.5);
    let at_s = window.app().view().cursor_s.unwrap();
    assert!((at_s / duration_s(&window) - 0.5).abs() < 0.02);
    choose(&mut window, "Engine failure");
    window.until("the way out", |app| app.analysis().diversion().is_some());
    let analysis = window.app().analysis().clone();
    let found = analysis.diversion().unwrap();
    let first = "Engine failure: R05 is reached without the engine on return, ";
    assert!(window.shows(first) && window.shows(", over the threshold "), "how high, and when");
    assert!(window.shows("With an engine that runs: return, after "));
    assert_eq!(found.time_s, at_s);
    let threshold = window.plan().runway(&"R05".into()).unwrap().threshold;
    assert!(found.glide.as_ref().unwrap().path.last().unwrap().position.distance_m(threshold) < 500.0);
    let flown = found.powered.as_ref().unwrap();
    let whole = without_window(&window, at_s);
    assert!(flown.landed && whole.landed && whole.refusals.is_empty());
    assert!((flown.time_s - (whole.time_s - at_s)).abs() < 0.1);
    assert!((flown.battery_left - whole.battery_left).abs() < 1e-6);
    scrub(&mut window, 0.3);
    window.until("the way from there", |app| {
        app.analysis().diversion().is_some_and(|d| d.time_s < at_s && Some(d.time_s) == app.view().cursor_s)
    });
    window.press_ctrl(egui::Key::N);
    assert!(window.plan().stages.is_empty());
    assert!(window.app().view().alarm.is_none(), "another plan");
}

/// The runway of the plan was out of reach, and another one was just below: nobody said so.
#[test]
fn an_engine_failure_names_another_runway_that_is_reached() {
    let threshold = geometry::LatLon::new(36.3190, -84.1730);
    let far = threshold.destination(232.0, 9000.0);
    let near = geometry::LatLon::new(36.3132, -84.1660);
    let runways: String = [("FAR", far), ("NEAR", near)]
        .map(|(id, at)| {
            let (lat, lon) = (at.lat_deg, at.lon_deg);
            format!(
                r#"<runway id="{id}" lat="{lat}" lon="{lon}" elevation="349" heading="232" length="600"/>"#
            )
        })
        .concat();
    let (main, emergency) = SQUARE.split_once("<emergencyPlans>").unwrap();
    let text = format!(
        "{}<emergencyPlans>{}",
        main.replace("</runways>", &format!("{runways}</runways>")),
        emergency.replace("R05", "FAR")
    );
    let ground = Arc::new(terrain::Flat(349.0));
    let mut window = Window::open_over(&text, vec2(1280.0, 800.0), None, ground);
    window.until_analysed();
    window.click("What if");
    scrub(&mut window, 0.5);
    choose(&mut window, "Engine failure");
    window.until("the way out", |app| app.analysis().diversion().is_some());
    assert!(window.shows("Engine failure: FAR is not reached without the engine"));
    assert!(
        window.shows("Reached in a straight glide: NEAR ")
            && window.shows("In flight Safe mode decides then.")
    );
}

#[test]
fn the_way_out_goes_with_its_banner_and_with_its_cursor() {
    let mut window = opened(SQUARE);
    for close in ["✖", "Back to the plan's own world"] {
        scrub(&mut window, 0.5);
        choose(&mut window, "Engine failure");
        window.until("the way out", |app| app.analysis().diversion().is_some());
        assert!(window.colour_within("Map", "R05: ").is_some(), "on the map");
        assert!(window.shows("What if: Engine failure at "), "the map says so");
        assert!(window.colour_within("Map", "glide").is_some(), "the legend says what the dashes are");
        let chip = window.harness.get_by_label_contains("What if: Engine failure at ").rect();
        let north = window.places_of(|text| text == "N");
        assert!(!north.is_empty(), "the compass is on the map");
        assert!(north.iter().all(|north| !north.intersects(chip.expand(8.0))), "{north:?} {chip}");
        window.click(close);
        assert_eq!(window.colour_within("Map", "R05: "), None, "{close}");
        assert!(!window.shows("What if: ") && window.app().view().alarm.is_none(), "{close}");
    }
}

/// The same flight with the same alarm.
fn without_window(window: &Window, seconds: f64) -> flight_exec::Preview {
    let (profile, terrain) = (Profile::by_name("trainer").unwrap(), gcs_app::assets::demo_terrain());
    let program = Arc::new(compile(window.plan(), &profile, terrain.as_ref()).unwrap());
    let alarm = Act::Command(Command::Emergency { cause: Cause::Engine, plan: None });
    let scenario = Scenario { triggers: vec![Trigger { at: When::After { seconds }, then: vec![alarm] }] };
    let options = Options::default();
    preview(&program, &profile, &terrain, Wind::CALM, Start::Runway, &scenario, &options).unwrap()
}

/// They covered it while it was read.
#[test]
fn messages_stand_above_the_legend_of_the_coverage() {
    let mut window = opened(SQUARE);
    choose(&mut window, "Coverage of the whole path");
    window.until("the coverage", |app| app.analysis().coverage().is_some());
    window.ask_for("emergency plan that lands on R05");
    window.press(egui::Key::Enter);
    let (message, legend) = ("Put aside: Nothing leads to", "Put the coverage away");
    // what is changed is worked out anew, and no coverage is shown meanwhile
    let deadline = Instant::now() + PATIENCE;
    while !(window.shows(message) && window.shows(legend)) {
        assert!(Instant::now() < deadline, "waited in vain for both");
        window.wait();
    }
    let message = window.harness.get_by_label_contains(message).rect();
    let legend = window.harness.get_by_label(legend).rect();
    assert!(message.bottom() < legend.top(), "{message} {legend}");
}

/// What they had put on the map stayed there, and nothing was left to put it away with.
#[test]
fn closing_the_panel_ends_its_alarm_and_its_coverage() {
    let mut window = opened(SQUARE);
    choose(&mut window, "Engine failure");
    choose(&mut window, "Coverage of the whole path");
    assert!(window.app().view().alarm.is_some() && window.app().view().coverage);
    window.click("Hide What if");
    assert!(window.app().view().alarm.is_none() && !window.app().view().coverage);
}

#[test]
fn the_coverage_tells_parts_that_are_reached_from_parts_that_are_not() {
    let mut window = opened(FIRE_WATCH);
    choose(&mut window, "Coverage of the whole path");
    window.until("the coverage", |app| {
        let known = |c: &Coverage| c.share(Reach::Good) > 0.0 && c.share(Reach::Out) > 0.0;
        app.analysis().coverage().is_some_and(known)
    });
    let analysis = window.app().analysis().clone();
    let coverage = analysis.coverage().unwrap();
    let p = gcs_app::theme::palette(true);
    let parts = gcs_app::map::coverage::parts(&analysis.forecast.points, coverage);
    let look = |reach| gcs_app::map::coverage::look(Some(reach), p);
    for reach in [Reach::Good, Reach::Out] {
        assert!(parts.iter().any(|(found, _)| *found == Some(reach)), "{reach:?}");
    }
    assert_ne!(look(Reach::Good).0.color, look(Reach::Out).0.color);
    assert_ne!(look(Reach::Good).1, look(Reach::Out).1);
    assert!(window.shows("not reached") && window.shows("How the worst alarm would end"));
    // who selects a leg asks why it is red: what is selected lies below the colours
    let colour = look(Reach::Good).0.color;
    let below = |window: &Window| window.lines_below("Vertical profile", p.text, colour);
    let before = below(&window);
    window.select_row(("TF To the gap", 0));
    window.steps(3);
    assert_eq!((before, below(&window)), (0, 1));
}

/// The warnings of the new world came in above the slider that was being dragged.
#[test]
fn what_is_found_in_another_world_stands_below_what_is_chosen() {
    let mut window = opened(FIRE_WATCH);
    let take = |window: &Window| window.harness.get_by_label("Take into the plan").rect();
    let before = take(&window);
    slide(&mut window, "Energy at start", 20.0);
    window.until("the review", |app| app.analysis().what_if_problems().is_some());
    let remark = window.harness.get_by_label_contains("are previewed, not reviewed").rect();
    assert_eq!(take(&window), before);
    assert!(remark.top() >= before.bottom(), "{remark}");
}

#[test]
fn a_plan_with_an_error_still_draws_and_says_where_it_fails() {
    let broken = SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, r#"<TF id="side2" fix="NOWHERE"/>"#);
    let mut draft = opened(&broken);
    assert!(draft.app().analysis().no_forecast.is_some());
    assert!(draft.shows("A draft: drawn as far as it can be flown"));
    draft.click("Show the error");
    assert_eq!(draft.selected(), "side2");
}

#[test]
fn the_cursor_runs_as_fast_as_chosen() {
    let mut window = opened(SQUARE);
    let ran_s = |window: &mut Window, speed: &str| {
        window.harness.get_all_by_label_contains("Play speed").next().unwrap().click();
        window.steps(3);
        window.click(speed);
        scrub(window, 0.2);
        let from_s = window.app().view().cursor_s.unwrap();
        window.click("▶ Preview");
        window.steps(20);
        let ran_s = window.app().view().cursor_s.unwrap() - from_s;
        window.click("⏸ Pause");
        ran_s
    };
    let (slow, fast) = (ran_s(&mut window, "2×"), ran_s(&mut window, "50×"));
    assert!(slow > 0.0 && (fast / slow - 25.0).abs() < 1.0, "{slow} {fast}");
}

#[test]
fn each_cause_is_raised_in_the_panel_and_in_the_palette() {
    let mut window = opened(SQUARE);
    for (cause, letters) in CAUSES.into_iter().zip(["engine", "energy", "link", "gps", "operator"]) {
        choose(&mut window, cause.name());
        let found = |app: &App| app.analysis().diversion().is_some_and(|found| found.cause == cause);
        window.until("the way out", found);
        assert!(window.shows(&format!("{}: R05 is reached ", cause.name())), "{cause:?}");
        window.click("Back to the plan's own world");
        assert!(window.app().view().alarm.is_none());
        window.ask_for(&format!("what if {letters} here"));
        window.press(egui::Key::Enter);
        assert_eq!(window.app().view().alarm, Some(cause), "{letters}");
        window.click("Back to the plan's own world");
    }
}

#[test]
fn another_wind_aloft_changes_the_preview_and_says_so() {
    let mut window = opened(SQUARE);
    let (before, calm_s) = (window.plan(), duration_s(&window));
    choose(&mut window, "Another wind aloft");
    slide(&mut window, "Altitude aloft, AMSL", 400.0);
    slide(&mut window, "Wind aloft from", 240.0);
    slide(&mut window, "Wind aloft speed", 12.0);
    let (amsl_m, wind) = window.app().view().what_if.aloft[0];
    assert!(amsl_m == 400.0 && (wind.speed_mps() - 12.0).abs() < 1e-6);
    let with_one_s = duration_s(&window);
    assert!((with_one_s - calm_s).abs() > 5.0);
    assert!(window.shows("calm at the runway, 12.0 m/s from 240° at 400 m AMSL"));
    choose(&mut window, "Another wind aloft");
    slide(&mut window, "Altitude aloft 2, AMSL", 450.0);
    slide(&mut window, "Wind aloft 2 speed", 2.0);
    assert!(window.shows("12.0 m/s from 240° at 400 m AMSL, 2.0 m/s from 240° at 450 m AMSL"));
    assert!((duration_s(&window) - with_one_s).abs() > 5.0);
    assert_eq!(window.plan(), before);
    choose(&mut window, "Give up the wind aloft");
    assert_eq!(window.app().view().what_if.aloft.len(), 1);
    choose(&mut window, "Give up the wind aloft");
    window.until("calm again", is_current);
    assert_eq!(duration_s(&window), calm_s);
}

#[test]
fn texts_places_and_areas_are_tried_without_changing_the_plan() {
    const OWN: &str = r#"</runways><variables>
        <variable name="fire" type="position" initial="36.3200 -84.1500"/>
        <variable name="field" type="polygon" initial="36.32 -84.15, 36.32 -84.14, 36.33 -84.14"/>
        <variable name="crew" type="text" initial="north"/></variables>"#;
    let text = SQUARE.replacen("</runways>", OWN, 1).replacen(r#"fix="B"/>"#, r#"at="= fire"/>"#, 1);
    let mut window = opened(&text);
    assert_eq!(window.errors(), Vec::<String>::new());
    let (before, short_m) = (window.plan(), window.app().analysis().forecast.length_m());
    assert_eq!(before.variables.len(), 3);
    for (name, typed) in [
        ("fire", "090° 900 m from A"),
        ("field", "36.32 -84.15; 36.32 -84.14; 36.34 -84.14; 36.34 -84.15"),
        ("crew", "south"),
    ] {
        window.harness.get_by_role_and_label(Role::TextInput, name).scroll_to_me();
        window.steps(30);
        window.fill_in(Role::TextInput, name, typed);
        // what becomes of it, and is found in it, moves the fields
        window.until("the other world", |app| is_current(app) && app.analysis().what_if_problems().is_some());
    }
    let chosen = &window.app().view().what_if.variables;
    assert_eq!(chosen.len(), 3, "{chosen:?}");
    assert_eq!(chosen[&Id::new("crew")], VariableValue::Text("south".into()));
    assert!(matches!(&chosen[&Id::new("field")], VariableValue::Polygon(corners) if corners.len() == 4));
    assert_ne!(window.app().analysis().forecast.length_m(), short_m);
    window.fill_in(Role::TextInput, "field", "36.32 -84.15; nowhere");
    assert!(window.app().view().notice.as_ref().is_some_and(|why| why.contains("nowhere")));
    assert_eq!(window.plan(), before);
}

#[test]
fn the_flight_starts_at_the_time_that_is_chosen() {
    let mut window = opened(SQUARE);
    choose(&mut window, "Start at a time of day");
    let day_s = window.app().view().what_if.start_unix_s.unwrap().div_euclid(86_400) * 86_400;
    slide(&mut window, "UTC", 365.0);
    assert_eq!(window.app().view().what_if.start_unix_s, Some(day_s + 365 * 60));
    assert!(window.shows("What if: start 06:05 UTC"));
    assert!(!window.app().document().is_dirty());
    let start =
        |window: &Window| jiff::Timestamp::from_second(window.app().view().what_if.start_unix_s?).ok();
    window.harness.get_by_role_and_label(Role::Slider, "UTC").scroll_to_me();
    window.steps(5);
    window.write_beside("UTC", "2026-12-01 14:30");
    assert_eq!(start(&window).unwrap().to_string(), "2026-12-01T14:30:00Z");
    assert!(window.shows("What if: start 2026-12-01 14:30 UTC"));
    slide(&mut window, "UTC", 365.0);
    assert_eq!(start(&window).unwrap().to_string(), "2026-12-01T06:05:00Z", "on the day that was typed");
    window.write_beside("UTC", "14:30");
    assert_eq!(start(&window).unwrap().as_second(), day_s + (14 * 60 + 30) * 60, "today");
    window.write_beside("UTC", "1.12. 14:30");
    assert!(window.shows("14:30, which is today, or with its date: 2026-12-01 14:30"));
    choose(&mut window, "Start at a time of day");
    assert!(window.app().view().what_if.is_nothing());
}

/// A zone counts at the times of the flight that is tried.
#[test]
fn another_start_time_changes_what_the_preview_finds() {
    let day = "2026-09-21T";
    let zones = format!(
        r#"<zones><keepOut id="town" name="Town, by day" lat="36.4" lon="-84.1" radius="200">
        <active from="{day}06:00:00Z" until="{day}10:00:00Z"/></keepOut></zones><mainPlan "#
    );
    let mut window = opened(&SQUARE.replacen("<mainPlan ", &zones, 1));
    assert!(window.errors().is_empty(), "{:?}", window.errors());
    choose(&mut window, "Start at a time of day");
    for (minutes, is_over) in [(11.0 * 60.0, true), (7.0 * 60.0, false)] {
        slide(&mut window, "UTC", minutes);
        window.until("the review", |app| app.analysis().what_if_problems().is_some());
        let found = window.app().analysis().what_if_problems().unwrap();
        assert_eq!(found.iter().any(|problem| problem.code == "zone-expired"), is_over, "{minutes}");
        assert_eq!(window.shows("The review finds nothing more in this world"), !is_over, "{minutes}");
    }
}

#[test]
fn a_plan_that_is_opened_with_an_error_is_flown_until_there() {
    let broken = SQUARE.replace(r#"<TF id="side3" fix="C"/>"#, r#"<TF id="side3" fix="NOWHERE"/>"#);
    let window = opened(&broken);
    let forecast = &window.app().analysis().forecast;
    assert!(forecast.is_beginning && window.shows("drawn as far as it can be flown"));
    let flown: Vec<&str> = forecast.passages.iter().map(|passage| passage.leg.as_str()).collect();
    assert!(flown.contains(&"side2") && !flown.contains(&"side3") && !flown.contains(&"side4"), "{flown:?}");
    let end = forecast.points.last().unwrap().position;
    let b = window.plan().fix(&"B".into()).unwrap().position;
    assert!(end.distance_m(b) < 300.0, "{end:?}");
    assert!(window.paints("NOWHERE"), "the mark where it fails");
}

#[test]
fn a_path_that_ends_at_an_error_grows_when_that_is_mended() {
    let broken = SQUARE.replace(r#"<TF id="side3" fix="C"/>"#, r#"<TF id="side3" fix="NOWHERE"/>"#);
    let mut window = opened(&broken);
    let short_m = window.app().analysis().forecast.length_m();
    window.click("TF side3");
    window.press(egui::Key::Delete);
    window.until_analysed();
    let forecast = &window.app().analysis().forecast;
    assert!(!forecast.is_beginning && forecast.length_m() > short_m);
}

#[test]
fn what_stands_below_an_alarm_stays_in_its_place_when_it_is_raised() {
    let mut window = opened(SQUARE);
    let at = |window: &Window| window.harness.get_by_role_and_label(Role::Slider, "Wind speed").rect().min;
    let before = at(&window);
    for cause in [Cause::Engine, Cause::Operator] {
        choose(&mut window, cause.name());
        window.until("the way out", |app| app.analysis().diversion().is_some());
        assert_eq!(at(&window), before, "{cause:?}");
    }
}

#[test]
fn it_is_flown_by_the_vehicles_autopilot_unless_another_is_chosen() {
    let mut window = opened(SQUARE);
    let as_reviewed = window.app().analysis().forecast.clone();
    window.connect();
    window.receive_autopilot("PX4 fixed wing", "px4");
    window.until("the vehicle's way", |app| !Arc::ptr_eq(&app.analysis().forecast, &as_reviewed));
    let by_vehicle = window.app().analysis().forecast.points.clone();
    assert_ne!(by_vehicle, as_reviewed.points);
    let mut choose_autopilot = |shown: &str, other: &str| {
        let list = format!("Autopilot: {shown}");
        window.harness.get_by_role_and_label(Role::ComboBox, &list).scroll_to_me();
        window.steps(5);
        window.harness.get_by_role_and_label(Role::ComboBox, &list).click();
        window.steps(3);
        window.harness.get_by_label(other).click();
        window.steps(3);
        window.until("the other world", |app| app.analysis().what_if == app.view().what_if);
        window.app().analysis().forecast.points.clone()
    };
    assert_ne!(choose_autopilot("the vehicle's (PX4)", "ArduPlane"), by_vehicle);
    assert_eq!(choose_autopilot("ArduPlane", "PX4"), by_vehicle, "the same habits");
    assert!(window.shows("What if: flown by PX4"));
    choose(&mut window, "↺ Reset");
    assert!(window.app().view().what_if.is_nothing());
    // one whose habits nobody knows
    window.receive_autopilot("Glider", "thermals");
    window.until("as reviewed", |app| app.analysis().forecast.points == as_reviewed.points);
}

#[test]
fn sliders_take_the_room_of_the_panel_and_alarms_look_like_buttons() {
    let window = opened(SQUARE);
    let slider = window.harness.get_by_role_and_label(Role::Slider, "Wind speed").rect();
    let panel = window.harness.query_all_by_label_contains("Hide What if").next().unwrap().rect();
    assert!(slider.width() > 100.0 && slider.right() < panel.right(), "{slider}");
    for cause in CAUSES {
        let button = window.harness.get_by_label(cause.name()).rect();
        let inside = egui::Rect::from_center_size(button.center(), vec2(8.0, 8.0));
        assert!(window.plate_around(inside).unwrap().width() < button.width() + 4.0, "{cause:?}");
    }
}
