//! In flight, against a vehicle that the test plays.

use super::vehicle::{decision, engine_out, gateway_status, place, status};
use super::{SQUARE, Window};
use egui::{Key, Rect};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_exec::{Command, IterationPlace, Phase, ProposalReport};
use gcs_app::link::{Call, LinkEvent, LinkId, LinkMessage, LinkState, Order, Reply, Telemetry};
use gcs_app::state::{ActivePlan, Outcome};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use usal::contract::{
    Alarm, GatewayState, GatewayStatus, Navigation, PlanVariable, PlanVariables, Severity, Stamped,
    VariableValue,
};

pub fn report(hash: &str, acceptable: bool) -> ProposalReport {
    ProposalReport {
        hash: hash.into(),
        acceptable,
        problems: if acceptable { Vec::new() } else { vec!["side2 is too steep".into()] },
        added: vec!["side5".into()],
        removed: vec!["old".into()],
        changed: vec!["side2".into()],
        next_leg: Some("side2".into()),
        next_position: None,
        unchanged: 3,
        next_in_m: None,
        next_in_s: None,
        differs_in_m: None,
        differs_in_s: None,
        entry_needed: false,
        entries: Vec::new(),
    }
}

/// A window with a plan whose hash is known, connected.
pub fn connected() -> (Window, String) {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.connect();
    let hash = window.app().analysis().hash.clone();
    (window, hash)
}

/// Flying the document.
pub fn flying() -> (Window, flight_exec::Status) {
    let (mut window, hash) = connected();
    let mut value = status(Phase::Flying);
    value.plan = Some(hash.into());
    value.place = Some(place("circuit", "side2"));
    window.receive_position(false);
    window.receive_status(value.clone());
    // the window reads the plan aboard; this vehicle does not give it
    window.leave_open();
    (window, value)
}

/// Flying the document, which the window knows to be aboard.
pub fn flying_its_plan() -> Window {
    let (mut window, _) = connected();
    fly_its_plan(&mut window);
    window
}

/// The vehicle flies the document, and gives it when it is asked.
pub fn fly_its_plan(window: &mut Window) {
    window.connect();
    let hash = window.app().analysis().hash.clone();
    let aboard = ActivePlan { plan: Arc::new(window.plan()), hash: hash.as_str().into() };
    let mut value = status(Phase::Flying);
    value.plan = Some(hash.into());
    value.place = Some(place("circuit", "side2"));
    window.receive_position(false);
    window.receive_status(value);
    let (ticket, _) = window.asked().unwrap();
    window.answer(ticket, Ok(Reply::Plan(Some(aboard))));
    window.leave_open();
}

#[test]
fn connecting_asks_the_link_and_shows_what_came_of_it() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    assert!(!window.is_enabled("Push"));
    window.click("○ Connect");
    window.click("Connect");
    let order = window.far.orders.try_recv().unwrap();
    let (link, endpoint) = (LinkId(1), "tcp/127.0.0.1:7447".into());
    assert_eq!(order, Order::Connect { link, endpoint, vehicle: "uav1".into() });
    window.send(LinkEvent::Link(LinkState::Failed("nobody listens there".into())));
    assert!(window.shows("No link"));
    // it looks for the vehicle on, until it is asked to stop; the form stays open until the vehicle answers
    window.click("Disconnect");
    assert_eq!(window.far.orders.try_recv().unwrap(), Order::Disconnect { link });
    window.connect();
    assert!(window.shows("Link 0."));
    assert!(window.is_enabled("Push"));
}

#[test]
fn push_shows_the_difference_and_commits_by_hash() {
    let (mut window, hash) = connected();
    assert!(window.shows("draft"));
    window.click("Push");
    let Some((ticket, Call::Propose(proposal))) = window.asked() else { panic!("no proposal") };
    assert!(proposal.xml.contains("side3") && proposal.seen_revision == Some(0));
    assert!(!window.is_enabled("Push"), "not twice at once");
    assert!(window.shows("Propose plan: pending"));
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
    for text in ["1 leg added", "side5", "1 leg removed", "1 leg changed", "would fly next"] {
        assert!(window.shows(text), "{text}");
    }
    window.click("Commit");
    let Some((ticket, call)) = window.asked() else { panic!("no commit") };
    assert_eq!(call, Call::Plan(Command::Commit { hash: hash.as_str().into(), entry: None }));
    window.answer(ticket, Ok(Reply::Done));
    assert!(window.shows("Commit plan: accepted"));
    let mut value = status(Phase::Idle);
    value.plan = Some(hash.into());
    window.receive_status(value);
    assert!(window.shows("aboard"));
    assert!(!window.is_enabled("Push"), "there is nothing to push");
}

#[test]
fn proposal_leaves_the_commands_of_the_flight_in_reach() {
    for size in [egui::vec2(960.0, 600.0), egui::vec2(1280.0, 800.0), egui::vec2(1920.0, 1080.0)] {
        let (mut window, mut value) = flying();
        value.plan = Some("another".into());
        window.receive_status(value);
        while window.asked().is_some() {}
        window.harness.set_size(size);
        window.steps(2);
        window.click("Push");
        let (ticket, _) = window.asked().unwrap();
        let hash = window.app().analysis().hash.clone();
        window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
        window.steps(3);
        let commit = window.centre("Commit");
        assert!(egui::Rect::from_min_size(egui::Pos2::ZERO, size).contains(commit));
        let buttons = window.harness.get_by_label("Zoom in").rect();
        // behind one button where the map is narrow
        let tools = window.harness.query_by_label("Select and move (V)");
        let tools = tools.unwrap_or_else(|| window.harness.get_by_label("Tools of the map")).rect();
        assert!(buttons.left() - tools.right() > 250.0, "{size}: {tools} {buttons}");
        let hold = window.centre("⏸ Hold");
        window.click_at(hold);
        assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(Command::Hold)), "{size}");
        window.click_at(commit);
        assert!(matches!(window.asked(), Some((_, Call::Plan(Command::Commit { .. })))), "{size}");
    }
}

#[test]
fn proposal_says_in_words_what_is_different_and_what_was_edited_since() {
    let (mut window, hash) = connected();
    let plan = Arc::new(window.plan());
    let aboard = ActivePlan { plan, hash: hash.as_str().into() };
    let mut value = status(Phase::Flying);
    value.plan = Some(hash.clone().into());
    window.receive_position(false);
    window.receive_status(value);
    let (ticket, _) = window.asked().unwrap();
    window.answer(ticket, Ok(Reply::Plan(Some(aboard))));
    window.click("TF side2");
    window.press(egui::Key::Delete);
    window.until_analysed();
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    let drafted = window.app().analysis().hash_of(window.app().document().version()).unwrap().to_string();
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&drafted, true)))));
    assert!(window.shows("leg side2 removed") && !window.shows("edited since"));
    window.click_at(window.centre("Path of side3"));
    window.press(egui::Key::Delete);
    window.until_analysed();
    assert!(window.shows("The draft was edited since"));
}

#[test]
fn a_proposal_with_warnings_is_amber_and_one_that_is_warned_of_only_here_is_not_green() {
    let p = gcs_app::theme::palette(true);
    let warning = "out of glide of every runway".to_owned();
    let cases = [
        (vec![], "Checked aboard: ", " can be flown", p.text),
        (vec![warning.clone()], "⚠ Checked aboard: ", " can be flown, 1 warning", p.caution),
        (vec![warning.clone(), warning], "⚠ Checked aboard: ", " can be flown, 2 warnings", p.caution),
    ];
    for (problems, begins, ends, colour) in cases {
        let (mut window, hash) = connected();
        window.click("Push");
        let (ticket, _) = window.asked().unwrap();
        let report = ProposalReport { problems, ..report(&hash, true) };
        window.answer(ticket, Ok(Reply::Proposal(Box::new(report))));
        let verdict =
            window.harness.get_by_label_contains("Checked aboard").accesskit_node().value().unwrap();
        assert!(verdict.starts_with(begins) && verdict.ends_with(ends), "{verdict}");
        assert_eq!(window.colour_of(begins), Some(colour), "{verdict}");
        assert!(window.is_enabled("Commit"));
        // the same fact in the same words, wherever it was found
        let here = window.shows("⚠ Checked here: it can be flown, 1 warning");
        assert_eq!(here, begins == "Checked aboard: ", "{verdict}");
    }
}

#[test]
fn a_refused_proposal_stays_a_draft_and_says_why() {
    let (mut window, hash) = connected();
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, false)))));
    assert!(window.shows("side2 is too steep"));
    assert!(!window.is_enabled("Commit"));
    window.click("Keep as draft");
    assert!(window.app().vehicle().proposal.is_none());
    assert!(window.asked().is_none(), "nothing was committed");
}

#[test]
fn a_proposal_without_the_current_leg_is_committed_only_with_an_entry() {
    let (mut window, hash) = connected();
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    let report = ProposalReport { entry_needed: true, next_leg: None, ..report(&hash, true) };
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report))));
    assert!(!window.is_enabled("Commit"));
}

#[test]
fn the_secondary_button_gives_no_command() {
    let (mut window, _) = flying();
    window.harness.get_by_label("⏸ Hold").click_secondary();
    window.steps(3);
    assert!(window.asked().is_none());
}

#[test]
fn a_refused_command_says_why() {
    let (mut window, _) = flying();
    window.click("⏸ Hold");
    let (ticket, call) = window.asked().unwrap();
    assert_eq!(call, Call::Plan(Command::Hold));
    assert!(window.shows("Hold: pending"));
    window.answer(ticket, Err("it holds already".into()));
    assert!(window.shows("Hold: refused, it holds already"));
}

#[test]
fn a_late_answer_is_not_taken_for_a_new_one() {
    let (mut window, _) = flying();
    window.click("⏸ Hold");
    let (first, _) = window.asked().unwrap();
    window.answer(first, Err("no answer within 5 s".into()));
    window.click("⏸ Hold");
    let (second, _) = window.asked().unwrap();
    window.answer(first, Ok(Reply::Done));
    assert_eq!(window.app().vehicle().requests.last().unwrap().outcome, Outcome::Pending);
    window.answer(second, Ok(Reply::Done));
    assert_eq!(window.app().vehicle().requests.last().unwrap().outcome, Outcome::Accepted);
}

/// The plan aboard is flown, whatever was edited here since.
#[test]
fn who_starts_with_a_draft_on_the_screen_is_told_that_another_plan_is_flown() {
    let (mut window, hash) = connected();
    let mut value = status(Phase::Idle);
    value.plan = Some(hash.into());
    window.receive_status(value.clone());
    assert!(!window.shows("with the plan aboard") && !window.shows("would not be flown"));
    window.click("TF side2");
    window.press(egui::Key::Delete);
    window.until_analysed();
    window.receive_status(value);
    assert!(window.shows("Start and take off with the plan aboard (hold)"));
    let caution = "⚠ What is shown is not aboard and would not be flown: push it first";
    assert!(window.shows(caution));
    let told = |window: &Window| window.harness.query_all_by_label_contains(caution).count();
    let beside_the_button = told(&window);
    window.ask_for("start and take off");
    window.press(Key::Enter);
    assert_eq!(told(&window), beside_the_button + 1, "in the palette, too");
}

#[test]
fn taking_off_needs_a_held_button() {
    let (mut window, hash) = connected();
    let mut value = status(Phase::Idle);
    value.plan = Some(hash.into());
    window.receive_status(value);
    while window.asked().is_some() {}
    window.click("Start and take off (hold)");
    window.hold("Start and take off (hold)", 30);
    assert!(window.asked().is_none(), "half a second is not enough");
    assert!(window.shows("Keep it pressed for 1 s"), "a short click is answered");
    window.hold("Start and take off (hold)", 90);
    assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(Command::Start)));
    assert!(window.asked().is_none(), "once");
}

#[test]
fn an_emergency_needs_a_held_button_and_is_named_by_its_effect() {
    let (mut window, mut value) = flying();
    value.emergency_in_force = Some("return".into());
    window.receive_status(value);
    while window.asked().is_some() {}
    window.hold("Emergency: fly return (hold)", 20);
    assert!(window.asked().is_none());
    window.hold("Emergency: fly return (hold)", 80);
    let call = window.asked().map(|(_, call)| call);
    assert_eq!(
        call,
        Some(Call::Plan(Command::Emergency { cause: flight_plan::Cause::Operator, plan: None }))
    );
}

#[test]
fn decisions_by_button_and_by_key() {
    let (mut window, mut value) = flying();
    value.decision = Some(decision(Some("again")));
    window.receive_status(value);
    assert!(window.shows("Decide at ask") && window.shows("36 s"));
    // both lead the same way at first
    let names = window.places_of(|text| ["1 Sweep again", "2 Close look"].contains(&text));
    assert!(names.len() == 2 && !names[0].intersects(names[1]), "on the map: {names:?}");
    window.click("2  Close look");
    let decide =
        |branch: &str| Some(Call::Plan(Command::Decide { leg: "ask".into(), branch: branch.into() }));
    assert_eq!(window.asked().map(|(_, call)| call), decide("close"));
    window.harness.key_press(Key::Num1);
    window.steps(2);
    assert_eq!(window.asked().map(|(_, call)| call), decide("again"));
    window.harness.key_press(Key::Num3);
    window.steps(2);
    assert!(window.asked().is_none(), "there are two branches");
}

#[test]
fn without_a_default_the_card_says_that_the_aircraft_will_hold() {
    let (mut window, mut value) = flying();
    value.decision = Some(decision(None));
    window.receive_status(value);
    assert!(window.shows("holds there and asks again"));
}

#[test]
fn values_that_expire_look_expired() {
    let (mut window, _) = flying();
    window.receive_attitude();
    assert!(window.shows("Airspeed") && !window.shows(" old"));
    window.steps(60 * 3);
    assert!(window.shows(" old"));
    assert!(window.shows("Primary flight display. No data"));
}

/// Agent and gateway repeat what they know, and that looked as fresh as before.
#[test]
fn what_a_silent_autopilot_said_looks_as_old_as_it_is_and_its_commands_say_that_nobody_hears_them() {
    let (mut window, value) = flying();
    let p = gcs_app::theme::palette(true);
    let silent = |window: &mut Window, autopilot_age_s: f64| {
        let gateway = GatewayStatus { autopilot_age_s, ..gateway_status(GatewayState::Nav) };
        window.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value: gateway }.into()));
        window.receive_status(value.clone());
        let way = navigation(812.0);
        window.receive(Telemetry::Navigation(Stamped { time_s: 1.0, validity_s: 2.0, value: way }));
    };
    let nobody = "⚠ The autopilot is silent: nobody hears a command now";
    let state = "Nav · AUTO · armed";
    silent(&mut window, 0.4);
    assert!(!window.shows(" old") && !window.shows(nobody));
    assert_eq!(window.colour_of(state), Some(p.good));
    silent(&mut window, 12.0);
    let rows = window.harness.query_all_by_label_contains("12 s old").count();
    assert!(rows >= 3, "leg, next and off track, and {rows} of all rows");
    assert!(window.shows("Flying circuit ▸ side2 · last heard 12 s ago"));
    for text in ["circuit ▸ side2", "0.8 km", state] {
        assert_eq!(window.colour_of(text), Some(p.weak), "{text}");
    }
    assert!(window.shows(nobody));
    window.click("⏸ Hold");
    let (ticket, _) = window.asked().unwrap();
    window.answer(ticket, Ok(Reply::Done));
    assert!(window.shows("Hold: accepted, waits until the autopilot is heard"));
    silent(&mut window, 0.4);
    assert!(!window.shows(" old") && !window.shows(nobody));
}

/// It was accepted and said to be holding, and climbed straight on.
#[test]
fn what_was_asked_for_in_the_climb_says_until_when_it_waits() {
    let (mut window, mut value) = flying();
    let climb = |window: &mut Window, waits_for_height_m: Option<f64>| {
        let gateway = GatewayStatus { waits_for_height_m, ..gateway_status(GatewayState::TakeOff) };
        window.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value: gateway }.into()));
    };
    climb(&mut window, None);
    window.click("⏸ Hold");
    let (ticket, _) = window.asked().unwrap();
    window.answer(ticket, Ok(Reply::Done));
    assert!(window.shows("Hold: accepted") && !window.shows("waits"));
    value.phase = Phase::Holding;
    window.receive_status(value.clone());
    climb(&mut window, Some(40.0));
    let banner = "Climbing straight ahead until 40 m above home";
    assert!(window.shows("Hold: accepted, waits until 40 m above home"));
    assert!(window.shows(&format!("{banner}, then it holds")) && !window.shows("Holding on"));
    (value.phase, value.emergency) = (Phase::Flying, Some("return".into()));
    window.receive_status(value.clone());
    assert!(window.shows("EMERGENCY: climbing straight ahead until 40 m above home, then flying return"));
    (value.phase, value.emergency) = (Phase::Holding, None);
    window.receive_status(value);
    climb(&mut window, Some(40.0));
    climb(&mut window, None);
    assert!(window.shows("Holding on circuit ▸ side2") && !window.shows(banner));
    let log = window.app().vehicle().log.iter().filter(|line| line.text.contains("waits until 40 m"));
    assert_eq!(log.map(|line| line.times).collect::<Vec<_>>(), [1], "once");
}

pub fn navigation(distance_m: f64) -> Navigation {
    Navigation {
        current: None,
        next: None,
        last: None,
        distance_m,
        eta_s: 36.0,
        cross_track_m: 3.0,
        buffer_waypoints: 4,
        buffer_s: 50.0,
        room: 200,
        end_of_plan: false,
    }
}

#[test]
fn a_lost_link_is_a_caution_and_then_a_warning() {
    let (mut window, _) = flying();
    window.steps(60 * 2);
    assert!(!window.shows("LINK SILENT"));
    window.steps(60 * 3);
    assert!(window.shows("⚠ LINK SILENT") && window.shows("Silent for"));
    window.steps(60 * 7);
    assert!(window.shows("⛔ LINK SILENT"));
    window.receive_position(false);
    assert!(!window.shows("LINK SILENT"), "it clears itself");
}

#[test]
fn alarms_are_listed_the_worst_first_and_go_away() {
    let (mut window, _) = flying();
    let alarm = |id: &str, severity| Alarm {
        id: id.into(),
        severity,
        source: "gateway".into(),
        advice: format!("do something about {id}"),
        cause: None,
    };
    window
        .receive_gateway(vec![alarm("energy-low", Severity::Caution), alarm("gps-lost", Severity::Warning)]);
    let (warning, caution) = (window.centre("⛔ GPS LOST"), window.centre("⚠ ENERGY LOW"));
    assert!(warning.y < caution.y);
    assert!(window.shows("do something about gps-lost"));
    window.receive_gateway(Vec::new());
    assert!(!window.shows("GPS LOST") && window.shows("✔ No alarms"));
    // older than it may be believed, and not yet silent for long
    window.steps(150);
    assert!(!window.shows("✔ No alarms") && window.shows("No alarms known"));
}

#[test]
fn iteration_and_active_leg_are_shown() {
    let (mut window, mut value) = flying();
    let mut at = place("circuit", "side2");
    at.iterations = vec![IterationPlace { leg: "patrol".into(), iteration: 3, of: Some(20), reverse: true }];
    value.place = Some(at);
    window.receive_status(value);
    assert!(window.shows("patrol 3/20"));
    assert!(window.shows("circuit ▸ side2"));
    window.click("TF side3");
    assert!(!window.shows("Go to this leg"), "not while the plan aboard is unknown");
}

#[test]
fn an_edit_in_flight_is_a_draft_until_it_is_pushed() {
    let (mut window, _) = flying();
    assert!(window.shows("active"));
    let at = window.centre("Fix C");
    window.drag(at, egui::vec2(40.0, 0.0));
    window.until_analysed();
    assert!(window.shows("aboard ") && window.shows(", edited "), "each with its own hash");
    assert!(window.is_enabled("Push"));
    window.click("Undo");
    window.until_analysed();
    assert!(!window.shows(", edited "));
}

#[test]
fn a_flood_of_news_never_stops_the_drawing() {
    let (mut window, _) = flying();
    for _ in 0..4000 {
        let value = status(Phase::Flying);
        let stamped = usal::contract::Stamped { time_s: 1.0, validity_s: 2.0, value };
        let event = LinkEvent::Telemetry(gcs_app::link::Telemetry::Status(Box::new(stamped)));
        let message = LinkMessage { link: LinkId(1), vehicle: "uav1".into(), event };
        let _ = window.far.messages.try_send(message);
    }
    window.steps(2);
    assert!(window.far.messages.capacity() > 4000, "all of it was taken in at once");
}

#[test]
fn between_two_flights_the_next_one_is_started() {
    let (mut window, value) = flying();
    assert!(window.harness.query_by_label_contains("Start the next flight").is_none());
    window.receive_status(flight_exec::Status { phase: Phase::Grounded, ..value });
    window.receive_position(true);
    window.steps(2);
    assert!(window.harness.query_by_label_contains("Start the next flight").is_some());
    assert!(!window.is_enabled("⏭ Skip leg"));
}

#[test]
fn a_window_that_watches_a_flight_asks_before_it_closes() {
    let (mut window, _) = flying();
    window.press_ctrl(Key::Q);
    assert!(window.shows("is in the air") && !window.app().is_leaving());
    window.click("Cancel");
    assert!(!window.shows("is in the air"));
    window.press_ctrl(Key::Q);
    window.click("Close all the same");
    assert!(window.app().is_leaving());
}

/// A click on Hold met the red button after the autopilot had fallen silent; another one, on its way to Leave Safe mode, opened a skip.
#[test]
fn every_command_keeps_its_place_in_every_state_and_none_comes_where_another_was() {
    for size in [egui::vec2(960.0, 600.0), egui::vec2(1280.0, 800.0)] {
        let (mut window, hash) = connected();
        window.harness.set_size(size);
        let mut value = status(Phase::Idle);
        value.plan = Some(hash.into());
        let mut places: BTreeMap<String, Rect> = BTreeMap::new();
        let air = [
            (Phase::Flying, GatewayState::Nav, 0.1),
            (Phase::Flying, GatewayState::Nav, 12.0),
            (Phase::Holding, GatewayState::Hold, 0.1),
            (Phase::Holding, GatewayState::SafeReturn, 0.1),
            (Phase::Flying, GatewayState::SafeReturn, 0.1),
            (Phase::Flying, GatewayState::Manual, 0.1),
            (Phase::AwaitingDecision, GatewayState::Nav, 0.1),
        ];
        let ground = [
            (Phase::Idle, GatewayState::Stop, 0.1),
            (Phase::Flying, GatewayState::TakeOff, 0.1),
            (Phase::Flying, GatewayState::Stop, 0.1),
            (Phase::Finished, GatewayState::Stop, 0.1),
        ];
        let states = ground.into_iter().map(|state| (state, true)).chain(air.map(|state| (state, false)));
        for ((phase, state, autopilot_age_s), on_ground) in states {
            value.phase = phase;
            window.receive_status(value.clone());
            let gateway = GatewayStatus { autopilot_age_s, ..gateway_status(state) };
            window
                .receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value: gateway }.into()));
            window.receive_position(on_ground);
            for label in COMMANDS {
                let Some(button) = window.harness.query_by_label(label) else { continue };
                let (place, first) = (button.rect(), button.rect());
                let first = *places.entry(label.to_owned()).or_insert(first);
                assert_eq!(place, first, "{label}, {phase:?} {state:?} at {size}");
            }
        }
        assert!(places.len() >= COMMANDS.len() - 1, "{places:?}");
        let rows: BTreeSet<i32> = places.values().map(|place| place.top() as i32).collect();
        assert_eq!(rows.len(), 1, "one row at {size}: {places:?}");
        let in_flight = &COMMANDS[..4];
        for (one, other) in places.iter().zip(places.iter().skip(1)) {
            let both_in_flight = in_flight.contains(&one.0.as_str()) || in_flight.contains(&other.0.as_str());
            assert!(!both_in_flight || !one.1.intersects(*other.1), "{one:?} {other:?}");
        }
    }
}

/// Those of a flight first.
const COMMANDS: [&str; 7] = [
    "Emergency: fly the alternate in force (hold)",
    "⏸ Hold",
    "▶ Resume",
    "⏭ Skip leg",
    "Start and take off (hold)",
    "Rewind (hold)",
    "Leave Safe mode (hold)",
];

/// The alarm went at touch-down, and the start was offered without a word.
#[test]
fn who_may_start_is_told_that_the_engine_has_failed() {
    let (mut window, _) = connected();
    let said = "⚠ Its engine has failed: look at it before a start";
    assert!(!window.shows(said));
    window.receive_gateway(vec![engine_out()]);
    assert!(window.shows(said));
    window.receive_position(false);
    assert!(!window.shows(said), "in the air its alarm says what to do");
}

/// It could be pressed, looked at and held, to be refused then.
#[test]
fn a_landing_that_nothing_follows_is_not_skipped() {
    let mut window = flying_its_plan();
    assert!(window.is_enabled("⏭ Skip leg"));
    let mut value = status(Phase::Flying);
    value.plan = Some(window.app().analysis().hash.clone().into());
    value.place = Some(place("land", "land"));
    window.receive_status(value);
    assert!(!window.is_enabled("⏭ Skip leg"));
    window.harness.hover_at(window.centre("⏭ Skip leg"));
    window.steps(60);
    assert!(window.shows("The landing is the last leg of the flight: there is nothing to skip to"));
}

/// It was red and could be held for a second, to be refused then.
#[test]
fn no_emergency_can_be_flown_where_no_alternate_is_in_force_and_it_says_so() {
    let (mut window, mut value) = flying();
    let name = "Emergency: fly the alternate in force (hold)";
    assert!(!window.is_enabled(name));
    window.harness.hover_at(window.centre(name));
    window.steps(60);
    assert!(window.shows("No emergency plan is in force here"));
    window.hold(name, 90);
    assert!(window.asked().is_none());
    value.emergency_in_force = Some("return".into());
    window.receive_status(value);
    assert!(window.is_enabled("Emergency: fly return (hold)"));
}

/// The executor refuses it: whoever presses it in a hurry learns that too late.
#[test]
fn hold_says_beforehand_that_a_glide_has_no_height_for_it() {
    let (mut window, mut value) = flying();
    window.receive_gateway(vec![engine_out()]);
    assert!(window.is_enabled("⏸ Hold"), "the main plan is flown: nobody believes the alarm");
    value.emergency = Some("return".into());
    window.receive_status(value.clone());
    assert!(!window.is_enabled("⏸ Hold"));
    window.harness.hover_at(window.centre("⏸ Hold"));
    window.steps(60);
    assert!(window.shows("Without an engine it would sink while it holds"));
    window.receive_gateway(Vec::new());
    assert!(window.is_enabled("⏸ Hold"));
}

/// Whoever took the aircraft: it is said by whom, in words and by an alarm, and there is a way back.
#[test]
fn an_aircraft_that_was_taken_over_says_by_whom_and_offers_to_resume() {
    let p = gcs_app::theme::palette(true);
    for (state, cause, said) in [
        (GatewayState::Manual, "the pilot switched to FBWA", "⚠ not in command: the pilot switched to FBWA"),
        (GatewayState::Directed, "a service directs it", "⚠ directed: a service directs it"),
    ] {
        let (mut window, _) = flying();
        assert!(!window.is_enabled("▶ Resume") && window.shows("Flying circuit ▸ side2"));
        let alarm = Alarm {
            id: "not-in-command".into(),
            severity: Severity::Caution,
            advice: "Resume when the pilot gives it back".into(),
            source: "gateway".into(),
            cause: None,
        };
        let value = GatewayStatus { cause: cause.into(), alarms: vec![alarm], ..gateway_status(state) };
        window.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value }.into()));
        assert_eq!(window.colour_of(said), Some(p.caution), "{state:?}");
        assert!(window.shows("NOT IN COMMAND") && window.shows("Resume when the pilot gives it back"));
        assert!(!window.shows("Flying circuit"), "that is not true any more");
        window.click("▶ Resume");
        assert_eq!(window.asked().map(|(_, call)| call), Some(Call::Plan(Command::Resume)), "{state:?}");
        window.receive_gateway_state(GatewayState::Nav);
        assert!(!window.is_enabled("▶ Resume") && !window.shows(said));
    }
}

#[test]
fn the_fire_on_the_map_grows_as_its_radius_does_aboard() {
    let mut window = Window::open(gcs_app::assets::FIRE_WATCH);
    window.until_analysed();
    fly_its_plan(&mut window);
    let caution = gcs_app::theme::palette(true).caution;
    let radius = |window: &Window| window.circles_within("Map", caution).into_iter().fold(0.0, f32::max);
    let before = radius(&window);
    assert!(before > 0.0);
    let grown = PlanVariable {
        name: "fire_radius".into(),
        value: VariableValue::Number(525.0),
        unit: "m".into(),
        min: None,
        max: None,
    };
    let value = PlanVariables { variables: vec![grown] };
    window.receive(Telemetry::Variables(Stamped { time_s: 2.0, validity_s: 60.0, value }));
    let times = radius(&window) / before;
    assert!((times - 1.5).abs() < 0.02, "from 350 m to 525 m: {times}");
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    value.plan = Some("another plan".into());
    window.receive_status(value);
    assert_eq!(radius(&window), before, "the fire of another plan is none of this one");
}

/// What is drawn in flight is what the legend has: the plan that is edited, and the one that is flown.
#[test]
fn an_edited_plan_and_the_one_aboard_are_told_apart_on_the_map_and_in_its_legend() {
    let mut window = flying_its_plan();
    let p = gcs_app::theme::palette(true);
    assert!(window.paints("planned") && !window.paints("plan aboard"));
    let (blue, aboard) =
        (window.triangles_within("Map", p.accent), window.lines_within("Map", p.contingency));
    let at = window.centre("Fix C");
    window.drag(at, egui::vec2(40.0, 0.0));
    window.until_analysed();
    window.until("the path aboard", |app| app.path_aboard().is_some());
    assert!(window.paints("edited plan") && window.paints("plan aboard") && !window.paints("planned"));
    assert!(window.triangles_within("Map", p.accent) > blue / 2, "the edited plan is one line, not dashes");
    assert!(window.lines_within("Map", p.contingency) > aboard, "the plan aboard is dashed");
    window.harness.set_size(egui::vec2(960.0, 600.0));
    window.steps(3);
    window.click("What the lines mean");
    assert!(window.shows("Lines: edited plan, plan aboard, active"));
}
