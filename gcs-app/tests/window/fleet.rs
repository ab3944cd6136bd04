//! Several vehicles: one is shown, the others are remembered, nothing of one shows under another.

use super::store::plan_event;
use super::vehicle::{position, status};
use super::{SQUARE, Window};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_exec::{Command, Phase};
use gcs_app::link::{Call, LinkEvent, LinkId, LinkState, Loss, Order, PlainValue, Reply, Telemetry};
use gcs_app::state::{ActivePlan, Outcome};
use gcs_app::story::{End, Story};
use std::sync::Arc;
use usal::contract::{AutopilotLink, AutopilotLinks, Recording, Stamped};

const ONE: LinkId = LinkId(1);
const TWO: LinkId = LinkId(2);

fn connected(window: &mut Window, vehicle: &str, link: LinkId, altitude_m: f64) {
    window.send_of(vehicle, link, LinkEvent::Link(LinkState::Connected("tcp/127.0.0.1:7447".into())));
    for i in 0..20 {
        window.send_of(vehicle, link, LinkEvent::Telemetry(position(f64::from(i), altitude_m, false)));
    }
    let value = flight_exec::Status { plan: Some("0badc0de".into()), ..status(Phase::Flying) };
    let stamped = Stamped { time_s: 1.0, validity_s: 2.0, value };
    window.send_of(vehicle, link, LinkEvent::Telemetry(Telemetry::Status(Box::new(stamped))));
}

/// Two vehicles in flight; the second one was connected by hand and is shown.
pub fn two() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("○ Connect");
    window.click("Connect");
    connected(&mut window, "uav1", ONE, 500.0);
    window.send_of("uav1", ONE, LinkEvent::Telemetry(plan_event(7, 7.0)));
    connect_by_form(&mut window, "uav2");
    window
}

/// Types a name into the form and connects.
fn connect_by_form(window: &mut Window, name: &str) {
    open_chip(window);
    // by the mouse: a click into a field must not close the form
    let field = window.harness.get_all_by_role(egui::accesskit::Role::TextInput).nth(1).unwrap();
    let at = field.rect().center();
    window.harness.hover_at(at);
    window.harness.drag_at(at);
    window.harness.drop_at(at);
    window.steps(3);
    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.harness.event(egui::Event::Text(name.into()));
    window.steps(2);
    window.click("Connect");
}

fn open_chip(window: &mut Window) {
    window.harness.query_all_by_label_contains(" · ").find(is_chip).unwrap().click();
    window.steps(3);
}

fn is_chip(node: &egui_kittest::Node<'_>) -> bool {
    node.rect().top() < 42.0 && node.accesskit_node().label().is_some_and(|l| l.contains("uav"))
}

fn orders(window: &mut Window) -> Vec<Order> {
    std::iter::from_fn(|| window.far.orders.try_recv().ok()).collect()
}

#[test]
fn a_second_vehicle_shows_nothing_of_the_first() {
    let mut window = two();
    assert!(window.shows("uav2 · Looking for it"));
    let vehicle = window.app().vehicle();
    assert!(vehicle.trail.points().is_empty() && vehicle.status.is_none() && vehicle.received_s.is_none());
    for of_the_first in ["⏸ Hold", "Airspeed", "keeps its old pattern"] {
        assert!(!window.shows(of_the_first), "{of_the_first}");
    }
    // the first is still received, and still not shown
    window.send_of("uav1", ONE, LinkEvent::Telemetry(position(30.0, 500.0, false)));
    assert!(window.app().vehicle().position.is_none());
    connected(&mut window, "uav2", TWO, 900.0);
    assert_eq!(window.app().vehicle().position.as_ref().unwrap().value.altitude_amsl_m, 900.0);
    assert!(window.shows("● uav2 · Link 0."));
}

/// The vehicle reports which plan is aboard, is asked for it, and gives it.
fn reports_its_plan(window: &mut Window, vehicle: &str, link: LinkId, name: &str) {
    let plan = flight_plan::read(SQUARE.replace("Square circuit", name).as_bytes()).plan;
    let hash = Arc::<str>::from(flight_plan::hash(&plan));
    let value = flight_exec::Status { plan: Some(hash.clone()), ..status(Phase::Flying) };
    let stamped = Stamped { time_s: 2.0, validity_s: 2.0, value };
    window.send_of(vehicle, link, LinkEvent::Telemetry(Telemetry::Status(Box::new(stamped))));
    window.steps(2);
    let asked = |order: Order| match order {
        Order::Call { link: to, ticket, call: Call::PlanAboard } if to == link => Some(ticket),
        _ => None,
    };
    let ticket = orders(window).into_iter().find_map(asked).unwrap();
    let aboard = ActivePlan { hash, plan: Arc::new(plan) };
    window.send_of(vehicle, link, LinkEvent::Answer { ticket, result: Ok(Reply::Plan(Some(aboard))) });
    window.steps(2);
}

#[test]
fn plan_aboard_one_vehicle_does_not_stay_under_another() {
    const EMPTY: &str = "<flightPlan xmlns='urn:legwork:flight-plan:1' name='Empty' aircraft='trainer'/>";
    let mut window = Window::open(EMPTY);
    window.click("○ Connect");
    window.click("Connect");
    connected(&mut window, "uav1", ONE, 500.0);
    reports_its_plan(&mut window, "uav1", ONE, "Plan of one");
    assert_eq!(window.app().document().plan().name, "Plan of one");
    window.until_analysed();
    assert!(!window.app().analysis().forecast.points.is_empty());
    connect_by_form(&mut window, "uav2");
    assert!(window.app().document().plan().stages.is_empty(), "{}", window.app().document().plan().name);
    assert!(window.app().analysis().forecast.points.is_empty(), "its path is still drawn");
    window.until_analysed();
    assert!(window.app().analysis().forecast.points.is_empty(), "its path is drawn again");
    connected(&mut window, "uav2", TWO, 900.0);
    reports_its_plan(&mut window, "uav2", TWO, "Plan of two");
    assert_eq!(window.app().document().plan().name, "Plan of two");
}

#[test]
fn services_are_shown_with_what_they_say_and_only_under_their_vehicle() {
    let mut window = two();
    connected(&mut window, "uav2", TWO, 900.0);
    tab(&mut window, "Services");
    assert!(window.shows("○ storage · not there"));
    let there = ["gateway", "storage", "my-camera"].map(str::to_owned);
    window.send_of("uav2", TWO, LinkEvent::Services(Arc::new(there.into())));
    let recording = |failure: Option<&str>| {
        let failure = failure.map(str::to_owned);
        let file = failure.is_none().then(|| "uav2-1.mcap".to_owned());
        let value =
            Recording { file, file_bytes: 5 << 20, messages: 70, missed: 3, failure, longest_sync_ms: 1 };
        LinkEvent::Telemetry(Telemetry::Recording(Stamped { time_s: 1.0, validity_s: 3.0, value }))
    };
    window.send_of("uav2", TWO, recording(None));
    let rows = Stamped { time_s: 1.0, validity_s: 3.0, value: vec![("revision".into(), "7".into())] };
    let plan = PlainValue { service: "fp-manager", name: "plan", rows };
    window.send_of("uav2", TWO, LinkEvent::Telemetry(Telemetry::Plain(plan)));
    let shown = [
        "● storage · running",
        "● my-camera",
        "uav2-1.mcap · 5.0 MiB",
        "70 recorded, 3 missed",
        "plan · revision",
    ];
    for text in shown {
        assert!(window.shows(text), "{text}");
    }
    window.send_of("uav2", TWO, recording(Some("no space left")));
    assert!(window.shows("⚠ Services") && window.shows("⚠ Not recording: no space left"));
    tab(&mut window, "Log");
    assert!(window.shows("the flight is not recorded: no space left"));
    open_chip(&mut window);
    window.harness.query_all_by_label_contains("● uav1").next().unwrap().click();
    window.steps(3);
    tab(&mut window, "Services");
    assert!(!window.shows("my-camera") && !window.shows("plan · revision") && !window.shows("uav2-1"));
}

#[test]
fn chip_tells_when_a_link_of_the_autopilot_is_lost() {
    let mut window = two();
    connected(&mut window, "uav2", TWO, 900.0);
    let link = |alive| AutopilotLink { alive, in_use: alive, received: 9, ..AutopilotLink::default() };
    for (links, shown) in [(vec![link(true)], false), (vec![link(true), link(false)], true)] {
        let value = AutopilotLinks { links };
        let stamped = Stamped { time_s: 1.0, validity_s: 3.0, value };
        window.send_of("uav2", TWO, LinkEvent::Telemetry(Telemetry::Links(stamped)));
        window.steps(2);
        assert_eq!(window.shows("1 of 2 autopilot links"), shown);
    }
}

#[test]
fn both_sessions_stay_open_and_the_operator_chooses_which_is_shown() {
    let mut window = two();
    let opened: Vec<LinkId> = orders(&mut window)
        .into_iter()
        .filter_map(|order| match order {
            Order::Connect { link, .. } => Some(link),
            Order::Disconnect { .. } => panic!("the first session was closed"),
            Order::Call { .. } => None,
        })
        .collect();
    assert_eq!(opened, [ONE, TWO]);
    connected(&mut window, "uav2", TWO, 900.0);
    open_chip(&mut window);
    window.harness.query_all_by_label_contains("● uav1").next().unwrap().click();
    window.steps(3);
    assert!(window.shows("● uav1 · Link"));
    let vehicle = window.app().vehicle();
    assert_eq!(vehicle.trail.points().len(), 20, "its history is still there");
    assert_eq!(vehicle.position.as_ref().unwrap().value.altitude_amsl_m, 500.0);
}

#[test]
fn commands_go_to_the_vehicle_that_is_shown() {
    let mut window = two();
    connected(&mut window, "uav2", TWO, 900.0);
    orders(&mut window);
    window.click("⏸ Hold");
    let [Order::Call { link, call: Call::Plan(Command::Hold), .. }] = &orders(&mut window)[..] else {
        panic!("no hold")
    };
    assert_eq!(*link, TWO);
    assert!(window.app().vehicles().get(&"uav1".into()).unwrap().requests.last().is_none());
}

#[test]
fn an_answer_reaches_the_vehicle_that_was_asked() {
    let mut window = two();
    connected(&mut window, "uav2", TWO, 900.0);
    orders(&mut window);
    window.click("⏸ Hold");
    let Some(Order::Call { ticket, .. }) = orders(&mut window).pop() else { panic!("nothing was asked") };
    // an answer of the other vehicle with the same number
    window.send_of("uav1", ONE, LinkEvent::Answer { ticket, result: Ok(gcs_app::link::Reply::Done) });
    assert_eq!(window.app().vehicle().requests.last().unwrap().outcome, Outcome::Pending);
    window.send_of("uav2", TWO, LinkEvent::Answer { ticket, result: Err("not now".into()) });
    assert!(window.shows("Hold: refused, not now"));
}

#[test]
fn disconnecting_keeps_what_is_known_and_says_that_it_is_off() {
    let mut window = two();
    connected(&mut window, "uav2", TWO, 900.0);
    orders(&mut window);
    open_chip(&mut window);
    window.click("Disconnect");
    assert_eq!(orders(&mut window), [Order::Disconnect { link: TWO }]);
    window.send_of("uav2", TWO, LinkEvent::Link(LinkState::Off));
    assert!(window.shows("○ uav2 · Connect"));
    assert_eq!(window.app().vehicle().trail.points().len(), 20);
    // and again to the same vehicle
    connect_by_form(&mut window, "uav2");
    assert_eq!(window.app().vehicle().trail.points().len(), 20);
    let three = LinkId(3);
    window.send_of("uav2", three, LinkEvent::Link(LinkState::Connected("tcp/127.0.0.1:7447".into())));
    window.send_of("uav2", TWO, LinkEvent::Link(LinkState::Off));
    assert!(window.shows("● uav2 · Link"), "what the closed link still says is not listened to");
}

#[test]
fn lost_events_are_counted_and_shown() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.connect();
    assert!(!window.shows("lost"));
    window.send(LinkEvent::Lost(Loss::Events(11)));
    window.send(LinkEvent::Lost(Loss::Events(1)));
    assert!(window.shows("⚠ 12 lost"));
    let log = &window.app().vehicle().log;
    assert_eq!(log.from_newest(0).unwrap().text, "1 event was lost");
    assert_eq!(log.from_newest(1).unwrap().text, "11 events were lost");
    window.send(LinkEvent::Lost(Loss::Values(300)));
    assert!(window.shows("⚠ 12 lost"), "values that were left out are no events");
    assert_eq!(window.app().vehicle().losses.values, 300);
    // another vehicle lost nothing
    window.send_of("uav2", TWO, LinkEvent::Link(LinkState::Connected("tcp/127.0.0.1:7447".into())));
    assert_eq!(window.app().vehicles().get(&"uav2".into()).unwrap().losses.events, 0);
}

#[test]
fn messages_of_a_stranger_are_counted_and_told() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.connect();
    let strangers = |count| LinkEvent::Strangers { service: "gateway", count };
    window.send(strangers(4));
    window.send(strangers(3));
    assert!(window.shows("⚠ 7 ignored"));
    assert!(window.shows("7 messages of a stranger in the name of gateway are ignored"), "in the alarms");
    let log = &window.app().vehicle().log;
    assert!(log.from_newest(0).unwrap().text.starts_with("4 messages of a stranger"), "once");
    // over another link it is said again
    window.send_of("uav1", LinkId(9), LinkEvent::Link(LinkState::Connected("there".into())));
    assert!(!window.shows("ignored"));
    window.send_of("uav1", LinkId(9), strangers(1));
    assert!(window.shows("⚠ 1 ignored"));
}

pub fn tab(window: &mut Window, name: &str) {
    window.harness.get_all_by_label(name).next().unwrap().click();
    window.steps(3);
}

#[test]
fn a_demo_is_not_told_again_while_another_vehicle_is_in_the_air() {
    let mut window = two();
    connected(&mut window, "uav2", TWO, 900.0);
    let story = Story::default();
    window.harness.state_mut().listen_to(story.clone());
    story.end("The demo has failed", End { good: false, report: None });
    window.steps(5);
    window.click("Try again");
    assert!(!story.is_wanted_again() && !window.app().is_leaving());
    assert!(window.shows("uav1, uav2 are in the air"));
}
