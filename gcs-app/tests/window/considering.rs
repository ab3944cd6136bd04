//! Commands that lead elsewhere are looked at before they are given.

use super::emergency::{in_emergency, raised};
use super::fleet::tab;
use super::flying::{fly_its_plan, flying, flying_its_plan};
use super::vehicle::{place, position, status};
use super::whatif::FIRE_WATCH;
use super::{SQUARE, Window};
use egui_kittest::kittest::Queryable;
use flight_exec::{Command, Foresight, PathPoint, Phase};
use gcs_app::link::{Call, Reply};
use gcs_app::state::Ticket;
use geometry::LatLon;
use std::sync::Arc;
use terrain::{Flat, Terrain};
use usal::contract::GatewayState;

pub fn foresight() -> Foresight {
    let point = |i: i32| PathPoint {
        time_s: f64::from(i),
        position: LatLon::new(36.319, -84.173 + 0.001 * f64::from(i)),
        altitude_amsl_m: 500.0,
    };
    Foresight {
        path: (0..20).map(point).collect(),
        next_leg: Some("side3".into()),
        left_out: vec!["side2".into()],
        short_of_altitude_m: None,
        clearance_m: Some(85.0),
        problems: Vec::new(),
        time_s: 380.0,
        distance_m: 9000.0,
        battery_left: 0.43,
        landed: true,
        cut_short: None,
    }
}

/// Skip is looked at; the ticket of the question.
pub fn considered() -> (Window, Ticket) {
    let (mut window, _) = flying();
    window.click("⏭ Skip leg");
    let (ticket, call) = window.asked().unwrap();
    assert_eq!(call, Call::Foresee(Some(Command::SkipLeg)), "nothing is done yet");
    (window, ticket)
}

#[test]
fn escape_puts_a_command_aside_that_is_considered() {
    let (mut window, _) = considered();
    assert!(window.shows("Skip leg?"));
    window.press(egui::Key::Escape);
    assert!(!window.shows("Skip leg?") && window.asked().is_none());
}

/// What the window asks for itself filled the list.
#[test]
fn the_log_lists_the_commands_that_were_given() {
    let (mut window, ticket) = considered();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    window.click("⏸ Hold");
    tab(&mut window, "Log");
    assert!(!window.shows("Look ahead") && !window.shows("Read the plan aboard"));
    assert_eq!(window.harness.query_all_by_label("Hold").count(), 1, "a command that was given");
}

/// It was one leg skipped after another, or an emergency.
#[test]
fn the_landing_is_gone_to_by_its_row_and_by_the_palette_as_a_leg_is() {
    let mut window = flying_its_plan();
    let go_to = |leg: &str| Command::GoTo { leg: leg.into() };
    window.ask_for("land");
    window.click("Flight Land now on R05: go to the landing…");
    let (ticket, call) = window.asked().unwrap();
    assert_eq!(call, Call::Foresee(Some(go_to("land"))), "nothing is done yet");
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    assert!(window.shows("until the approach: 85 m") && window.shows("43 % energy left"));
    window.hold("Go to Landing (hold)", 90);
    assert_eq!(given(&mut window), Some(Call::Plan(go_to("land"))));
    window.click("LND land");
    window.click("Land now: go to this landing…");
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Foresee(Some(go_to("land")))));
    window.click("Cancel");
    // a stage with legs is no landing
    window.click("ENR circuit");
    assert!(!window.shows("Land now") && !window.shows("Go to this leg"));
}

#[test]
fn skip_shows_what_follows_and_is_given_by_a_button_named_by_its_effect() {
    let (mut window, ticket) = considered();
    assert!(window.shows("Looking ahead"));
    let text = gcs_app::theme::palette(true).text;
    let drawn = |window: &Window| window.lines_within("Map", text);
    let before = drawn(&window);
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    assert!(drawn(&window) > before, "its path");
    for text in [
        "Left out: side2",
        "until the approach: 85 m",
        "43 % energy left",
        "on the map: the path that would be flown",
    ] {
        assert!(window.shows(text), "{text}");
    }
    window.hold("Skip side2, fly side3 next (hold)", 90);
    assert_eq!(given(&mut window), Some(Call::Plan(Command::SkipLeg)));
    assert!(!window.shows("Left out"), "it was given");
    assert_eq!(drawn(&window), before);
}

/// The command that was given; the questions what would follow, asked each second, have no answer.
fn given(window: &mut Window) -> Option<Call> {
    loop {
        let (ticket, call) = window.asked()?;
        if !matches!(call, Call::Foresee(_)) {
            return Some(call);
        }
        window.answer(ticket, Err("others are being looked ahead for".into()));
    }
}

/// The question what would follow this command, within two seconds; others, of which there is one at a time, have no answer.
fn asked_about(window: &mut Window, command: &Command) -> Option<Ticket> {
    for _ in 0..120 {
        match window.asked() {
            Some((ticket, Call::Foresee(Some(about)))) if about == *command => return Some(ticket),
            Some((ticket, _)) => window.answer(ticket, Err("it is not known".into())),
            None => window.steps(1),
        }
    }
    None
}

/// The aircraft has flown on since.
#[test]
fn what_was_looked_at_long_ago_says_so() {
    let (mut window, ticket) = considered();
    window.receive(position(2.0, 500.0, false));
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    window.steps(60);
    assert!(!window.shows("Looked at"));
    let (refused, _) = window.asked().unwrap();
    window.answer(refused, Err("others are being looked ahead for".into()));
    window.steps(60 * 5);
    assert!(window.shows("⚠ Looked at 6 s ago: looking again"), "also where the aircraft's clock stands");
    window.receive(position(47.0, 500.0, false));
    assert!(window.shows("⚠ Looked at 45 s ago: looking again"));
}

/// It was to be clicked, then held, then clicked again, as the aircraft went from leg to leg: three clicks did nothing.
#[test]
fn the_command_is_held_whatever_is_known_and_stays_where_it_is() {
    let p = gcs_app::theme::palette(true);
    let (mut window, ticket) = considered();
    let top = |window: &Window, label: &str| window.harness.get_by_label(label).rect().left_top();
    let colour = |window: &Window| window.colour_of("Skip side2");
    let (button, cancel) = (top(&window, "Skip side2 (hold)"), top(&window, "Cancel"));
    assert_eq!(colour(&window), Some(p.caution), "nothing is known yet");
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    let named = "Skip side2, fly side3 next (hold)";
    assert_eq!((top(&window, named), top(&window, "Cancel")), (button, cancel));
    assert_eq!(colour(&window), Some(p.accent), "nothing is against it");
    assert!(window.paints("hold\u{a0}1\u{a0}s"), "it says so");
    window.click(named);
    window.steps(60 * 5);
    while let Some((_, call)) = window.asked() {
        assert!(matches!(call, Call::Foresee(_)), "a click does nothing: {call:?}");
    }
    assert!(window.shows("Nothing was done: hold it"), "that can be read");
    window.steps(60 * 2);
    assert!(!window.shows("Nothing was done: hold it"));
}

/// The agent answers one question of a window at a time, and refuses the next: "your last question is still being looked into".
#[test]
fn what_follows_is_asked_behind_what_the_window_wanted_to_know_for_itself() {
    let (mut window, landing) = raised();
    window.click("Return to the main plan at side3");
    assert!(window.shows("Looking ahead") && window.asked().is_none(), "the agent is at another question");
    window.answer(landing, Ok(Reply::Foresight(Box::new(foresight()))));
    let back = Command::ReturnToMain { leg: "side3".into() };
    let (ticket, call) = window.asked().unwrap();
    assert_eq!(call, Call::Foresee(Some(back.clone())));
    window.click("Cancel");
    window.click("Return to the main plan at side3");
    assert!(window.asked().is_none(), "the first one is still being answered");
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Foresee(Some(back))));
}

/// In round 2 of 3 the emergency was raised; the way back flew all three again.
#[test]
fn the_way_back_into_a_loop_says_that_its_rounds_begin_anew() {
    let mut window = Window::open(FIRE_WATCH);
    window.until_analysed();
    fly_its_plan(&mut window);
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    value.emergency = Some("return".into());
    window.receive_status(value);
    window.leave_open();
    for (leg, begins_anew) in [("Sweep the fire", true), ("To the mountain front", false)] {
        window.ask_for(&format!("return to the main plan at {leg}"));
        window.press(egui::Key::Enter);
        let (ticket, _) = window.asked().unwrap();
        window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
        assert!(window.shows("Flies next: "), "{leg}");
        assert_eq!(window.shows("Rounds over the fire begins its rounds anew: 1 of 3"), begins_anew, "{leg}");
        window.click("Cancel");
        window.leave_open();
    }
}

/// Nobody decides by a height of a minute ago: it is looked at again by itself.
#[test]
fn what_follows_is_looked_at_again_while_it_is_read() {
    let mut window = flying_its_plan();
    let to = Command::GoTo { leg: "side4".into() };
    window.ask_for("go to side4");
    window.press(egui::Key::Enter);
    let (ticket, _) = window.asked().unwrap();
    window.receive(position(2.0, 500.0, false));
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    assert!(window.asked().is_none(), "it is fresh");
    let again = asked_about(&mut window, &to).expect("at least once a second");
    window.answer(again, Ok(Reply::Foresight(Box::new(foresight()))));
    assert!(!window.shows("Looked at"));
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    value.place = Some(place("circuit", "side3"));
    window.receive_status(value);
    window.receive(position(9.0, 500.0, false));
    assert!(window.shows("The aircraft is on another leg by now: looking again"));
    let again = asked_about(&mut window, &to).unwrap();
    let lower = Foresight { clearance_m: Some(42.0), ..foresight() };
    window.answer(again, Ok(Reply::Foresight(Box::new(lower))));
    assert!(window.shows("until the approach: 42 m") && !window.shows("on another leg by now"));
}

/// The button that has to be held made the card wider than its place: its left end was cut off.
#[test]
fn a_long_name_on_a_button_to_hold_takes_two_lines() {
    let name = r#"<TF id="side2" name="Along the long valley behind the second ridge" fix="B"/>"#;
    let mut window = Window::open(&SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, name));
    window.until_analysed();
    fly_its_plan(&mut window);
    window.click("⏭ Skip leg");
    let button =
        window.harness.get_by_label("Skip Along the long valley behind the second ridge (hold)").rect();
    assert!(button.left() > 0.0 && button.right() < 268.0 && button.height() > 35.0, "{button}");
}

#[test]
fn a_command_that_was_cancelled_is_not_given() {
    let (mut window, ticket) = considered();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    window.click("Cancel");
    assert!(!window.shows("Left out") && window.asked().is_none());
}

#[test]
fn who_is_in_a_hurry_holds_the_button_before_the_answer() {
    let (mut window, _) = considered();
    window.hold("Skip side2 (hold)", 20);
    assert!(window.asked().is_none() && window.shows("Keep it pressed for 1 s"));
    window.hold("Skip side2 (hold)", 90);
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(Command::SkipLeg)));
}

#[test]
fn a_climb_that_is_not_done_or_a_low_way_is_a_caution() {
    let low = Foresight { clearance_m: Some(12.0), ..foresight() };
    let late = Foresight { short_of_altitude_m: Some(120.0), ..foresight() };
    for (foresight, text) in [
        (low, "Only 12 m above the ground where it is lowest: a plan is written to keep 50 m"),
        (late, "Climb not done: it arrives 120 m"),
    ] {
        let (mut window, ticket) = considered();
        window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight))));
        assert!(window.shows(text), "{text}");
        let p = gcs_app::theme::palette(true);
        assert_eq!(window.colour_of("Skip side2, fly side3 next"), Some(p.caution));
    }
}

/// A leg behind the aircraft may be lower: nobody read that it would descend there.
#[test]
fn a_change_of_altitude_on_the_way_is_told() {
    let along = |altitude_at: fn(f64) -> f64| {
        let mut foresight = foresight();
        for point in &mut foresight.path {
            point.time_s *= 10.0;
            point.altitude_amsl_m = altitude_at(point.time_s);
        }
        foresight
    };
    let descends: fn(f64) -> f64 = |s| (500.0 - 2.0 * s).max(380.0);
    let climbs: fn(f64) -> f64 = |s| if s < 100.0 { 500.0 + s } else { 700.0 - s };
    let is_level: fn(f64) -> f64 = |s| 500.0 + 5.0 * (s / 20.0).sin();
    for (altitude_at, told) in [
        (descends, Some("First descends 120 m, to 380 m AMSL")),
        (climbs, Some("First climbs 100 m, to 600 m AMSL")),
        (is_level, None),
    ] {
        let (mut window, ticket) = considered();
        window.answer(ticket, Ok(Reply::Foresight(Box::new(along(altitude_at)))));
        assert!(told.is_none_or(|told| window.shows(told)), "{told:?}");
        assert_eq!(window.shows("First "), told.is_some());
    }
}

/// It did not agree with the altitude of the leg that it named.
#[test]
fn a_climb_beyond_the_altitude_of_the_next_leg_says_that_it_goes_on() {
    let mut window = flying_its_plan();
    window.click("⏭ Skip leg");
    let (ticket, _) = window.asked().unwrap();
    let mut climbs = foresight();
    for point in &mut climbs.path {
        point.altitude_amsl_m += 10.0 * point.time_s;
    }
    window.answer(ticket, Ok(Reply::Foresight(Box::new(climbs))));
    assert!(window.shows("First climbs 190 m, to 690 m AMSL: to 499 m on side3, and on behind it"));
}

/// What the card of a Go to says where the agent has no elevations, and this window those of some ground.
fn over(ground: Arc<dyn Terrain>) -> Window {
    let mut window = Window::open_over(SQUARE, egui::vec2(1280.0, 800.0), None, ground);
    window.until_analysed();
    fly_its_plan(&mut window);
    window.click("⏭ Skip leg");
    let (ticket, _) = window.asked().unwrap();
    let unknown = Foresight { clearance_m: None, ..foresight() };
    window.answer(ticket, Ok(Reply::Foresight(Box::new(unknown))));
    window
}

#[test]
fn where_the_agent_has_no_elevations_the_window_measures_the_height_above_the_ground() {
    let window = over(Arc::new(Flat(380.0)));
    assert!(window.shows("until the approach: 120 m, by this window's elevations"));
    let p = gcs_app::theme::palette(true);
    assert_eq!(window.colour_of("Skip side2, fly side3 next"), Some(p.accent));
    let low = over(Arc::new(Flat(480.0)));
    assert!(low.shows("Only 20 m above the ground where it is lowest, by this window's elevations"));
    assert_eq!(low.colour_of("Skip side2, fly side3 next"), Some(p.caution));
}

#[test]
fn ground_that_nobody_knows_is_a_caution() {
    struct Unknown;
    impl Terrain for Unknown {
        fn elevation_m(&self, _: LatLon) -> Option<f64> {
            None
        }
    }
    let window = over(Arc::new(Unknown));
    let p = gcs_app::theme::palette(true);
    assert_eq!(window.colour_of("⚠ The ground below is known neither aboard nor here"), Some(p.caution));
    assert_eq!(window.colour_of("Skip side2, fly side3 next"), Some(p.caution));
}

#[test]
fn a_way_with_problems_has_to_be_held() {
    let (mut window, ticket) = considered();
    let problems = vec!["the path leads through keep-out zone village".to_owned()];
    window.answer(ticket, Ok(Reply::Foresight(Box::new(Foresight { problems, ..foresight() }))));
    assert!(window.shows("through keep-out zone village"));
    window.hold("Skip side2, fly side3 next (hold)", 20);
    assert!(window.asked().is_none() && window.shows("Keep it pressed for 1 s"));
    window.hold("Skip side2, fly side3 next (hold)", 90);
    assert_eq!(given(&mut window), Some(Call::Plan(Command::SkipLeg)));
}

#[test]
fn a_leg_that_was_not_looked_at_is_not_skipped() {
    let (mut window, ticket) = considered();
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    let mut value = status(Phase::Flying);
    value.place = Some(place("circuit", "side3"));
    window.receive_status(value);
    assert!(window.shows("on another leg by now") && !window.is_enabled("Skip side2, fly side3 next (hold)"));
    window.click("Look again");
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Foresee(Some(Command::SkipLeg))));
}

#[test]
fn without_an_answer_the_command_can_still_be_given() {
    let (mut window, ticket) = considered();
    window.answer(ticket, Err("nobody answers".into()));
    assert!(window.shows("What follows is not known: nobody answers"));
    window.hold("Skip side2 (hold)", 90);
    assert_eq!(given(&mut window), Some(Call::Plan(Command::SkipLeg)));
}

#[test]
fn a_plan_that_was_under_way_is_rewound_on_the_ground_only() {
    let (mut window, value) = flying();
    assert!(!window.shows("Rewind"));
    window.receive_position(true);
    window.receive_gateway_state(GatewayState::Stop);
    window.receive_status(value);
    window.hold("Rewind (hold)", 20);
    assert!(window.asked().is_none());
    window.hold("Rewind (hold)", 90);
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(Command::Rewind)));
}

/// What follows is asked for, and nothing else; then the command is given by its button.
fn is_looked_at_first(window: &mut Window, command: Command, button: &str) {
    let (ticket, call) = window.asked().unwrap();
    assert_eq!(call, Call::Foresee(Some(command.clone())), "nothing is done yet");
    assert!(window.asked().is_none());
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    assert!(window.shows("Left out: side2"));
    window.hold(&format!("{button} (hold)"), 90);
    assert_eq!(given(window), Some(Call::Plan(command)));
}

#[test]
fn skip_from_the_palette_shows_what_follows_before_it_acts() {
    let (mut window, _) = flying();
    window.ask_for("skip the leg");
    window.press(egui::Key::Enter);
    is_looked_at_first(&mut window, Command::SkipLeg, "Skip side2, fly side3 next");
}

#[test]
fn go_to_shows_what_follows_before_it_acts_from_inspector_map_and_palette() {
    let mut window = flying_its_plan();
    let go_to = || Command::GoTo { leg: "side4".into() };
    window.click("TF side4");
    window.click("Go to this leg…");
    is_looked_at_first(&mut window, go_to(), "Go to side4");
    window.right_click_at(window.centre("Path of side4"));
    window.harness.get_all_by_label("TF side4").last().unwrap().click();
    window.steps(3);
    window.harness.get_all_by_label("Go to this leg…").last().unwrap().click();
    window.steps(3);
    is_looked_at_first(&mut window, go_to(), "Go to side4");
    window.right_click_at(window.centre("TF side4"));
    window.harness.get_all_by_label("Go to this leg…").last().unwrap().click();
    window.steps(3);
    is_looked_at_first(&mut window, go_to(), "Go to side4");
}

#[test]
fn go_to_in_the_palette_flies_there_and_show_only_shows() {
    let mut window = flying_its_plan();
    window.ask_for("go to side4");
    window.press(egui::Key::Enter);
    is_looked_at_first(&mut window, Command::GoTo { leg: "side4".into() }, "Go to side4");
    window.ask_for("show leg side3");
    window.press(egui::Key::Enter);
    assert!(window.asked().is_none() && window.selected() == "side3");
}

#[test]
fn in_an_emergency_one_command_leads_to_a_leg() {
    let mut window = in_emergency();
    window.click("TF side4");
    assert!(!window.shows("Go to this leg…"), "that is not in the plan that is flown");
    window.click("Return to the main plan here…");
    let back = Command::ReturnToMain { leg: "side4".into() };
    let asked = std::iter::from_fn(|| window.asked()).last();
    assert_eq!(asked.map(|(_, call)| call), Some(Call::Foresee(Some(back))));
}

/// It was two menus away, and a fix had none.
#[test]
fn what_is_pointed_at_on_the_map_is_led_to_directly_once_what_follows_was_shown() {
    let mut window = flying_its_plan();
    let side3 = window.centre("Fix C");
    window.right_click_at(side3);
    window.click("Direct to side3…");
    let asked = std::iter::from_fn(|| window.asked()).map(|(_, call)| call);
    let asked: Vec<Call> =
        asked.filter(|call| matches!(call, Call::Foresee(Some(_)) | Call::Plan(_))).collect();
    assert_eq!(asked, [Call::Foresee(Some(Command::GoTo { leg: "side3".into() }))], "nothing is done yet");
    assert!(window.shows("Looking ahead"));
}
