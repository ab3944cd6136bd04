//! What nobody must miss, also who looked elsewhere.

use super::Window;
use super::flying::{connected, flying};
use super::vehicle::{decision, gateway_status, place, status};
use egui_kittest::kittest::Queryable;
use flight_exec::{DecisionRequest, Event, Phase};
use gcs_app::link::{LinkEvent, LinkId, LinkState, Numbered, Reply, Telemetry};
use usal::contract::{GatewayState, GatewayStatus, Stamped};

pub fn event(sequence: u32, value: Event) -> LinkEvent {
    let event = Stamped { time_s: f64::from(sequence), validity_s: f64::MAX, value };
    LinkEvent::Telemetry(Telemetry::PlanEvent(Numbered { sequence, event }))
}

pub fn taken(leg: &str, by: &str) -> Event {
    Event::DecisionTaken { leg: leg.into(), branch: "again".into(), by: by.into() }
}

pub fn is_announced(window: &Window, text: &str) -> bool {
    // the log says it, too
    window.harness.query_all_by_label_contains(&format!("uav1: {text}")).next().is_some()
}

#[test]
fn a_missed_decision_is_announced_until_it_is_put_aside() {
    let (mut window, _) = flying();
    window.send(event(1, taken("ask", "operator")));
    assert!(!is_announced(&window, ""), "somebody decided");
    window.send(event(2, taken("ask", "default")));
    let text = "Nobody decided at ask in time: again was taken by default";
    assert!(is_announced(&window, text));
    let log = &window.app().vehicle().log;
    assert_eq!(log.from_newest(0).map(|line| line.text.as_str()), Some(text));
    window.steps(60 * 20);
    assert!(is_announced(&window, text), "it stays until it is read");
    // received again over another link, it is no news
    window.click("Put aside what uav1 announced");
    assert!(!is_announced(&window, text));
    let two = LinkId(2);
    window.send_of("uav1", two, LinkEvent::Link(LinkState::Connected("there".into())));
    window.send_of("uav1", two, event(2, taken("ask", "default")));
    assert!(!is_announced(&window, text));
}

/// It was accepted, and nothing moved: why stood in a line of the log alone.
#[test]
fn a_start_that_is_not_granted_says_what_to_do_until_that_is_read() {
    let (mut window, hash) = connected();
    window.harness.set_size(egui::vec2(960.0, 600.0));
    let mut value = status(Phase::Idle);
    value.plan = Some(hash.into());
    window.receive_status(value);
    window.leave_open();
    window.hold("Start and take off (hold)", 90);
    let (ticket, _) = window.asked().unwrap();
    window.answer(ticket, Ok(Reply::Done));
    assert!(window.shows("Start and take off: accepted"));
    let refused = Event::NotGranted { request: "launch".into(), reason: NEED.into() };
    // the executor asks again and again
    window.send(event(1, refused.clone()));
    window.send(event(2, refused));
    let text = format!("⚠ uav1: Not started: {NEED}");
    assert!(window.paints_whole(&text), "nothing of it is cut");
    assert_eq!(window.harness.query_all_by_label(&text).count(), 1);
    assert!(!window.shows("Start and take off: accepted"), "that is not so any more");
    window.steps(60 * 20);
    assert!(is_announced(&window, "Not started"), "it stays until it is read");
    window.click("Put aside what uav1 announced");
    assert!(!is_announced(&window, "Not started"));
}

/// It stayed through a push, an accepted start and a flight, and a window that came later showed it without a time.
#[test]
fn a_start_that_came_to_nothing_is_not_announced_once_another_is_accepted() {
    let refused = Event::NotGranted { request: "launch".into(), reason: "the autopilot refused Arm".into() };
    let phase = |phase| Event::PhaseChanged { phase };
    let (mut window, _) = connected();
    window.send(event(1, taken("ask", "default")));
    for (number, said) in [(2, phase(Phase::Flying)), (3, refused.clone()), (4, phase(Phase::Idle))] {
        window.send(event(number, said));
    }
    assert!(is_announced(&window, "Not started"), "nobody has started it since");
    window.send(event(5, phase(Phase::Flying)));
    assert!(!is_announced(&window, "Not started"));
    window.send(event(6, refused));
    assert!(is_announced(&window, "Not started"), "nor did this one");
    window.send(event(7, Event::LegEntered { place: place("take-off", "take-off") }));
    assert!(!is_announced(&window, "Not started"));
    assert!(is_announced(&window, "Nobody decided at ask"), "another thing is not put aside by that");
}

/// As a gateway says it of PX4.
const NEED: &str = "The autopilot's parameter MIS_TKO_LAND_REQ is 2: PX4 then refuses a list without a landing, and so every list \
                    of a longer flight. Set it to 0.";

#[test]
fn what_keeps_an_autopilot_from_being_started_is_said_on_connecting_and_start_is_not_to_be_pressed() {
    let (mut window, hash) = connected();
    window.harness.set_size(egui::vec2(960.0, 600.0));
    let says = |window: &mut Window, unfit: Option<&str>| {
        let value = GatewayStatus { unfit: unfit.map(Into::into), ..gateway_status(GatewayState::Stop) };
        window.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value }.into()));
    };
    says(&mut window, Some(NEED));
    assert!(window.shows("No plan aboard") && window.shows(&format!("⚠ Can't be started. {NEED}")));
    let mut value = status(Phase::Idle);
    value.plan = Some(hash.into());
    window.receive_status(value);
    window.leave_open();
    assert!(!window.is_enabled("Start and take off (hold)") && window.shows(NEED));
    window.hold("Start and take off (hold)", 90);
    window.ask_for("start and take off");
    assert!(!window.is_enabled("Flight Start and take off"), "nor by the palette");
    window.press(egui::Key::Escape);
    assert!(window.asked().is_none());
    says(&mut window, None);
    assert!(window.is_enabled("Start and take off (hold)") && !window.shows("Can't be started"));
}

#[test]
fn a_vehicle_that_is_not_shown_announces_as_well() {
    let (mut window, _) = flying();
    let other = LinkId(7);
    window.send_of("uav9", other, LinkEvent::Link(LinkState::Connected("there".into())));
    window.send_of("uav9", other, event(1, Event::PhaseChanged { phase: Phase::AwaitingDecision }));
    assert!(window.shows("uav9: Nobody decided in time: the aircraft circles"));
}

/// It stood in the log alone, among all the lines that an emergency writes there.
#[test]
fn a_glide_that_falls_short_is_announced_until_it_is_read_or_down() {
    let (mut window, _) = flying();
    let ahead = |code: &str, lacks_m: u32| Event::ProblemAhead {
        leg: Some("r-land".into()),
        code: code.into(),
        reason: format!(
            "the engine is out, and the height does not suffice for all that is ahead: straight to `r-land`, even so {lacks_m} m are lacking: be ready to land elsewhere"
        ),
    };
    window.send(event(1, ahead("turn-too-tight", 30)));
    assert!(!is_announced(&window, "the engine is out"), "what a review finds is among the problems");
    window.send(event(2, ahead("glide-shortened", 30)));
    let said = "even so 30 m are lacking: be ready to land elsewhere";
    assert!(is_announced(&window, "the engine is out") && window.paints_whole(said));
    window.send(event(3, ahead("glide-shortened", 50)));
    assert!(
        window.paints_whole("even so 50 m are lacking") && !is_announced(&window, said),
        "the last one counts"
    );
    window.send(event(4, Event::PhaseChanged { phase: Phase::Finished }));
    assert!(!is_announced(&window, "the engine is out"), "it is down");
}

#[test]
fn of_many_announcements_the_latest_are_shown() {
    let (mut window, _) = flying();
    for n in 0..50 {
        window.send(event(n, taken(&format!("fork{n}"), "default")));
    }
    assert!(
        is_announced(&window, "Nobody decided at fork49")
            && is_announced(&window, "Nobody decided at fork47")
    );
    assert!(!is_announced(&window, "Nobody decided at fork46"), "the rest is in the log");
}

#[test]
fn bar_of_a_decision_runs_down_from_when_it_was_asked() {
    let (mut window, mut value) = flying();
    for (time_left_s, left) in
        [(36.0, "100 % of the time"), (18.0, "50 % of the time"), (9.0, "25 % of the time")]
    {
        value.decision = Some(DecisionRequest { time_left_s, ..decision(None) });
        window.receive_status(value.clone());
        assert!(window.shows(left), "{time_left_s} s");
    }
}
