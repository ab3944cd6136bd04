//! The store of vehicles: whatever comes in whichever order, each vehicle is as if it were alone.

use super::vehicle::{position, status};
use flight_exec::Phase;
use gcs_app::link::{LinkEvent, LinkId, LinkMessage, LinkState, Loss, Numbered, Reply, Telemetry};
use gcs_app::state::{Ticket, VehicleName, Vehicles};
use proptest::prelude::*;
use usal::contract::Stamped;

/// Something that happens to one of the vehicles.
#[derive(Debug, Clone, Copy)]
enum Step {
    Connect,
    Receive(Sent),
    /// Over a link that was replaced.
    ReceiveLate(Sent),
    Close,
    Ask,
    Answer(u64, bool),
    Show,
}

#[derive(Debug, Clone, Copy)]
enum Sent {
    Position(u16),
    Status(u8),
    Event(u8),
    Lost(u8),
    Connected,
}

fn sent() -> impl Strategy<Value = Sent> {
    prop_oneof![
        any::<u16>().prop_map(Sent::Position),
        any::<u8>().prop_map(Sent::Status),
        any::<u8>().prop_map(Sent::Event),
        any::<u8>().prop_map(Sent::Lost),
        Just(Sent::Connected),
    ]
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        2 => Just(Step::Connect),
        8 => sent().prop_map(Step::Receive),
        2 => sent().prop_map(Step::ReceiveLate),
        1 => Just(Step::Close),
        2 => Just(Step::Ask),
        2 => (1..6u64, any::<bool>()).prop_map(|(ticket, good)| Step::Answer(ticket, good)),
        1 => Just(Step::Show),
    ]
}

fn event(sent: Sent) -> LinkEvent {
    let number = |n: u8| f64::from(n);
    match sent {
        Sent::Position(n) => LinkEvent::Telemetry(position(f64::from(n), f64::from(n), n % 2 == 0)),
        Sent::Status(n) => {
            let value = flight_exec::Status { revision: n.into(), ..status(Phase::Flying) };
            let stamped = Stamped { time_s: number(n), validity_s: 2.0, value };
            LinkEvent::Telemetry(Telemetry::Status(Box::new(stamped)))
        }
        Sent::Event(n) => LinkEvent::Telemetry(plan_event(n.into(), number(n))),
        Sent::Lost(n) => LinkEvent::Lost(Loss::Events(n.into())),
        Sent::Connected => LinkEvent::Link(LinkState::Connected("tcp/127.0.0.1:7447".into())),
    }
}

pub fn plan_event(sequence: u32, time_s: f64) -> Telemetry {
    let value =
        flight_exec::Event::PatternRefused { leg: "sweep".into(), reason: format!("reason {sequence}") };
    Telemetry::PlanEvent(Numbered { sequence, event: Stamped { time_s, validity_s: 2.0, value } })
}

/// A store with the links that were opened to each vehicle.
#[derive(Default)]
struct Store {
    vehicles: Vehicles,
    links: std::collections::BTreeMap<VehicleName, Vec<LinkId>>,
}

impl Store {
    fn send(&mut self, vehicle: &VehicleName, link: LinkId, event: LinkEvent, now_s: f64) {
        self.vehicles.receive(LinkMessage { link, vehicle: vehicle.clone(), event }, now_s);
    }

    /// `number` is that of the step: links are numbered by it, so that a vehicle alone has the same ones.
    fn take(&mut self, name: &VehicleName, step: Step, number: u64) {
        let now_s = number as f64 * 0.7;
        let links = self.links.entry(name.clone()).or_default();
        let (last, before) = (links.last().copied(), links.iter().rev().nth(1).copied());
        match (step, last) {
            (Step::Connect, _) => {
                links.push(LinkId(number));
                self.vehicles.open(name, LinkId(number), "tcp/127.0.0.1:7447", now_s);
            }
            (Step::Receive(what), Some(link)) => self.send(name, link, event(what), now_s),
            (Step::ReceiveLate(what), _) => {
                if let Some(link) = before {
                    self.send(name, link, event(what), now_s);
                }
            }
            (Step::Close, Some(link)) => self.send(name, link, LinkEvent::Link(LinkState::Off), now_s),
            (Step::Ask, _) => {
                if let Some(vehicle) = self.vehicles.get_mut(name) {
                    vehicle.requests.open("Hold", now_s);
                }
            }
            (Step::Answer(ticket, good), Some(link)) => {
                let result = if good { Ok(Reply::Done) } else { Err("no".to_owned()) };
                self.send(name, link, LinkEvent::Answer { ticket: Ticket(ticket), result }, now_s);
            }
            (Step::Show, _) => self.vehicles.show(name),
            _ => {}
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn vehicles_never_mix(steps in proptest::collection::vec((any::<bool>(), step()), 0..120)) {
        let names: [VehicleName; 2] = ["uav1".into(), "uav2".into()];
        let mut together = Store::default();
        let mut alone = [Store::default(), Store::default()];
        for (number, (second, step)) in (1..).zip(&steps) {
            let which = usize::from(*second);
            together.take(&names[which], *step, number);
            alone[which].take(&names[which], *step, number);
        }
        for (name, single) in names.iter().zip(&alone) {
            let (known, expected) = (together.vehicles.get(name), single.vehicles.get(name));
            // everything that is known, to the last field
            prop_assert_eq!(format!("{known:?}"), format!("{expected:?}"));
        }
    }
}

fn log(vehicles: &Vehicles) -> Vec<String> {
    let log = &vehicles.shown().log;
    (0..log.len()).rev().filter_map(|i| log.from_newest(i)).map(|line| line.text.clone()).collect()
}

#[test]
fn a_new_link_to_the_same_vehicle_keeps_its_history_and_repeats_no_event() {
    let (mut store, name) = (Store::default(), VehicleName::from("uav1"));
    let history: Vec<u8> = (1..=5).collect();
    store.take(&name, Step::Connect, 1);
    for n in &history {
        store.take(&name, Step::Receive(Sent::Event(*n)), 2);
        store.take(&name, Step::Receive(Sent::Position((*n).into())), 2);
    }
    let before = log(&store.vehicles);
    assert_eq!(before.iter().filter(|l| l.contains("keeps its old pattern")).count(), 5);
    store.take(&name, Step::Connect, 3);
    // the vehicle sends what it remembers, and one event more
    for n in history.iter().chain(&[6]) {
        store.take(&name, Step::Receive(Sent::Event(*n)), 4);
    }
    let after = log(&store.vehicles);
    assert_eq!(after.len(), before.len() + 1, "{after:?}");
    assert!(after.last().is_some_and(|l| l.contains("reason 6")));
    assert_eq!(store.vehicles.shown().trail.points().len(), 5);
}

#[test]
fn a_request_over_a_closed_link_is_refused_and_its_late_answer_counts_for_nothing() {
    let (mut store, name) = (Store::default(), VehicleName::from("uav1"));
    store.take(&name, Step::Connect, 1);
    store.take(&name, Step::Ask, 2);
    store.take(&name, Step::Connect, 3);
    let last = |store: &Store| format!("{:?}", store.vehicles.shown().requests.last().unwrap().outcome);
    assert!(last(&store).contains("the link was closed"));
    store.take(&name, Step::Answer(1, true), 4);
    assert!(last(&store).contains("the link was closed"));
}

#[test]
fn a_stranger_s_flood_of_names_is_bounded_and_keeps_the_vehicle_that_is_shown() {
    let mut store = Store::default();
    let shown = VehicleName::from("uav1");
    store.take(&shown, Step::Connect, 1);
    store.take(&shown, Step::Receive(Sent::Position(1)), 2);
    for i in 0..1000 {
        let name = format!("stranger {i}");
        store.send(&name.as_str().into(), LinkId(9), event(Sent::Position(1)), 3.0);
    }
    assert!(store.vehicles.len() <= 256, "{}", store.vehicles.len());
    assert_eq!(store.vehicles.shown_name(), Some(&shown));
    assert!(store.vehicles.shown().position.is_some());
}
