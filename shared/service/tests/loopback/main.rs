//! A small service over loopback, on the machine's clock and on one that the test drives.
#![cfg(test)]

mod leader;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use service::*;
use std::future::Future;
use std::time::Duration;
use usal::contract::{Air, Empty, Refusal, Stamped};
use usal::topics::{Events, GATEWAY, Invocation, Variable, describe, gateway};
use usal::{CallError, Conductor, Occurrence, Rate, Raw, Said, Session, Spec, Start};

/// Longer than anything takes on a slow machine.
const DEADLINE: Duration = Duration::from_secs(30);

async fn within<F: Future>(future: F) -> F::Output {
    tokio::time::timeout(DEADLINE, future).await.expect("in time")
}

fn free_endpoint() -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    format!("tcp/{}", listener.local_addr().unwrap())
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct Sum {
    sum: f64,
    ticks: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct Add {
    addend: f64,
}

const SUM: Variable<Sum> = Variable::new("adder", "sum");
const ADDED: Events<Stamped<Sum>> = Events::new("adder", "added");
const ADD: Invocation<Add, Sum> = Invocation::new("adder", "add");
const PONDER: Invocation<Empty, Sum> = Invocation::new("adder", "ponder");

/// Adds up airspeeds and what it is asked to, and a thousand for each message of a stranger.
struct Adder {
    now: Sum,
    waiting: Vec<Reply<Sum>>,
}

enum Input {
    Tick,
    Air(f64),
    Strangers(u64),
    Add(Request<Add, Sum>),
    Ponder(Request<Empty, Sum>),
    Pondered(Result<f64, String>),
}

impl Adder {
    fn new() -> Self {
        Self { now: Sum { sum: 0.0, ticks: 0 }, waiting: Vec::new() }
    }

    fn add(&mut self, addend: f64, out: &mut Out<Input>) -> Result<Sum, Refusal> {
        if !addend.is_finite() || addend < 0.0 {
            return Err(Refusal { code: "negative".into(), reason: "only what is positive is added".into() });
        }
        self.now.sum += addend;
        out.emit(ADDED, 1.0, self.now.clone());
        out.keep("sum", self.now.sum.to_string().into_bytes());
        Ok(self.now.clone())
    }
}

impl Service for Adder {
    type Input = Input;
    type Output = Never;
    const SPEC: Spec = Spec {
        name: "adder",
        about: "adds up",
        says: &[
            Said::variable(SUM, Rate::Changed { repeated_ms: 1000 }, 2.0),
            Said::events(ADDED),
            Said::invocation(ADD),
            Said::invocation(PONDER),
        ],
    };

    fn wire(wiring: &mut Wiring<Input>) {
        wiring.follow(gateway::AIR, |received| Input::Air(received.stamped.value.airspeed_mps));
        wiring.strangers(|_, count| Input::Strangers(count));
        wiring.serve(ADD, Input::Add);
        wiring.serve(PONDER, Input::Ponder);
        wiring.tick(|| Input::Tick);
    }

    fn step(&mut self, _: Time, input: Input, out: &mut Out<Input>) {
        match input {
            Input::Tick => self.now.ticks += 1,
            Input::Air(airspeed_mps) => drop(self.add(airspeed_mps, out)),
            Input::Strangers(count) => drop(self.add(1000.0 * count as f64, out)),
            Input::Add(Request { request, reply, instance, .. }) => {
                // whoever asks is the one that it hears
                out.hear_only(GATEWAY, instance);
                let answer = self.add(request.addend, out);
                out.answer_when_kept(reply, answer);
            }
            Input::Ponder(request) => {
                self.waiting.push(request.reply);
                let sum = self.now.sum;
                let ponder = move || if sum > 0.0 { 0.5 } else { panic!("nothing to ponder, for the test") };
                out.work(ponder, Input::Pondered);
            }
            Input::Pondered(found) => {
                let answer = self.add(found.unwrap_or(f64::NAN), out);
                self.waiting.drain(..).for_each(|reply| out.answer(reply, answer.clone()));
            }
        }
    }

    fn publish(&mut self, _: Time, board: &mut Board) {
        board.changing(SUM, self.now.sum, |_| self.now.clone());
    }

    /// With a sum of 13 it is needed.
    fn may_end(&self) -> bool {
        (self.now.sum - 13.0).abs() > 1e-9
    }
}

/// The adder, its vehicle's hub and a client called `tester`.
struct Net {
    hub: Session,
    client: Session,
    endpoint: String,
    trigger: Trigger,
    task: tokio::task::JoinHandle<anyhow::Result<()>>,
}

impl Net {
    async fn open(config: impl FnOnce(Config) -> Config) -> Self {
        let endpoint = free_endpoint();
        let hub = Session::open(usal::Config::hub("uav1", &endpoint).named("hub")).await.unwrap();
        let config = config(Config::client("uav1", &endpoint));
        let (trigger, shutdown) = shutdown();
        let task = tokio::spawn(run_alone(config, Adder::new(), shutdown));
        let client = Session::open(usal::Config::client("uav1", &endpoint).named("tester")).await.unwrap();
        Self { hub, client, endpoint, trigger, task }
    }

    async fn add(&self, addend: f64) -> Result<Sum, CallError> {
        within(self.client.call(ADD, &Add { addend }, DEADLINE)).await
    }

    async fn end(self) {
        self.trigger.shut_down();
        within(self.task).await.unwrap().unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn requests_are_answered_events_emitted_and_variables_published() {
    let net = Net::open(|config| config).await;
    let mut events = net.client.listen(ADDED, Start::Remembered).unwrap();
    let mut sum = net.client.follow(SUM).unwrap();
    // work that panics ends in an answer, and nothing else ends
    let panicked = within(net.client.call(PONDER, &Empty {}, DEADLINE)).await;
    assert!(matches!(panicked, Err(CallError::Refused(_))), "{panicked:?}");
    assert!((net.add(2.0).await.unwrap().sum - 2.0).abs() < 1e-9);
    assert!(matches!(net.add(-1.0).await, Err(CallError::Refused(refusal)) if refusal.code == "negative"));
    let Occurrence::Event { event, .. } = within(events.recv()).await.unwrap() else { panic!("a gap") };
    assert!((event.value.sum - 2.0).abs() < 1e-9);
    within(async { while (sum.changed().await.unwrap().stamped.value.sum - 2.0).abs() > 1e-9 {} }).await;
    let pondered = within(net.client.call(PONDER, &Empty {}, DEADLINE)).await.unwrap();
    assert!((pondered.sum - 2.5).abs() < 1e-9);
    let described = within(net.client.call(describe("adder"), &Empty {}, DEADLINE)).await.unwrap();
    assert_eq!(described, Adder::SPEC.describe());
    assert_eq!(followed::<Adder>(), [Topic { service: "gateway", kind: usal::Kind::Variable, name: "air" }]);
    net.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn asked_to_end_it_goes_on_for_as_long_as_it_is_needed() {
    let net = Net::open(|config| config).await;
    net.add(13.0).await.unwrap();
    net.trigger.shut_down();
    // what is asked after that is answered
    assert!((net.add(0.0).await.unwrap().sum - 13.0).abs() < 1e-9);
    assert!(!net.task.is_finished());
    net.add(1.0).await.unwrap();
    within(net.task).await.unwrap().unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn whoever_insists_ends_it_although_it_is_needed() {
    let net = Net::open(|config| config).await;
    net.add(13.0).await.unwrap();
    net.trigger.shut_down();
    net.trigger.insist();
    within(net.task).await.unwrap().unwrap();
}

async fn adder_takes_part(conductor: &Conductor) {
    let joins = async {
        while conductor.participants() != ["adder"] {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    };
    within(joins).await;
}

fn measured(airspeed_mps: f64) -> Air {
    let (wind_east_mps, wind_north_mps) = (0.0, 0.0);
    Air { airspeed_mps, wind_east_mps, wind_north_mps, pressure_hpa: 1000.0, temperature_c: 15.0 }
}

#[tokio::test(flavor = "multi_thread")]
async fn time_of_a_lockstep_is_followed_beat_by_beat() {
    let net = Net::open(|config| Config { timing: Timing::Follows, ..config }).await;
    let mut conductor = Conductor::new(&net.hub).unwrap().patience(DEADLINE);
    let air = net.hub.publish(gateway::AIR).unwrap();
    let mut sum = net.client.follow(SUM).unwrap();
    adder_takes_part(&conductor).await;
    for n in 1..=10_u32 {
        let time_s = f64::from(n);
        air.set(time_s, 1.0, &measured(time_s));
        assert!(within(conductor.tick(time_s)).await.is_empty());
    }
    // what was said before a tick has been heard at it, and what came of it was shown at it
    let last = within(async {
        loop {
            let received = sum.changed().await.unwrap();
            if received.stamped.time_s >= 10.0 {
                return received.stamped.clone();
            }
        }
    })
    .await;
    assert_eq!(last, Stamped { time_s: 10.0, validity_s: 2.0, value: Sum { sum: 55.0, ticks: 10 } });
    net.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_flood_of_a_strangers_values_hides_no_true_one() {
    let net = Net::open(|config| Config { timing: Timing::Follows, ..config }).await;
    let mut conductor = Conductor::new(&net.hub).unwrap().patience(DEADLINE);
    let (air, strange) = (net.hub.publish(gateway::AIR).unwrap(), net.client.publish(gateway::AIR).unwrap());
    let sum = net.client.follow(SUM).unwrap();
    adder_takes_part(&conductor).await;
    within(net.hub.call(ADD, &Add { addend: 1.0 }, DEADLINE)).await.unwrap();
    let mut time_s = 0.0;
    let counted = async {
        // until the tenth was taken in, and a stranger was counted
        let taken =
            |seen: &usal::Received<Sum>| seen.stamped.time_s > 10.0 && seen.stamped.value.sum > 1000.0;
        while !sum.latest().is_some_and(|seen| taken(&seen)) {
            time_s += 1.0;
            let value = if time_s <= 10.0 { time_s } else { 0.0 };
            air.set(time_s, 1.0, &measured(value));
            (0..5).for_each(|_| strange.set(time_s, 1.0, &measured(0.5)));
            assert!(conductor.tick(time_s).await.is_empty());
        }
    };
    within(counted).await;
    let sum = sum.latest().unwrap().stamped.value.sum;
    assert!((sum.rem_euclid(1000.0) - 56.0).abs() < 1e-6, "1 + 55, and the strangers counted: {sum}");
    net.end().await;
}

/// After so much silence it is done again.
const AGAIN: Duration = Duration::from_secs(1);

#[tokio::test(flavor = "multi_thread")]
async fn everything_is_followed_and_every_answer_told_with_its_caller() {
    let net = Net::open(|config| config).await;
    let (sender, mut receiver) = tokio::sync::mpsc::unbounded_channel();
    let _everything = net
        .client
        .follow_everything(Start::Remembered, move |raw| {
            let _ = sender.send(raw);
        })
        .unwrap();
    net.add(2.0).await.unwrap();
    net.add(-1.0).await.unwrap_err();
    let mut seen = Vec::new();
    while seen.iter().filter(|name| *name == "audit").count() < 2
        || !["sum", "added"].iter().all(|wanted| seen.iter().any(|name| name == wanted))
    {
        match tokio::time::timeout(AGAIN, receiver.recv()).await.map(Option::unwrap) {
            Ok(Raw::Sample { key, .. }) => {
                assert_eq!(key.service, "adder");
                seen.push(key.name);
            }
            Ok(Raw::Gap { missed }) => panic!("{missed} lost"),
            // a variable is told to those who are known to follow it then, and nobody knew that yet
            Err(_) => drop(net.add(2.0).await.unwrap()),
        }
    }
    let mut trail = net.client.listen(audit("adder"), Start::Remembered).unwrap();
    let mut next = async || match within(trail.recv()).await.unwrap() {
        Occurrence::Event { event, .. } => event.value,
        Occurrence::Gap { missed } => panic!("{missed} lost"),
    };
    // those remembered first: an event that comes while they are asked for can take their place
    let (first, second) = (next().await, next().await);
    let nameless = Session::open(usal::Config::client("uav1", &net.endpoint)).await.unwrap();
    within(nameless.call(ADD, &Add { addend: 1.0 }, DEADLINE)).await.unwrap_err();
    let third = loop {
        let told = next().await;
        if told.caller.is_none() {
            break told;
        }
    };
    assert_eq!((first.invocation.as_str(), first.caller.as_deref()), ("add", Some("tester")));
    assert_eq!(first.request, serde_json::json!({"addend": 2.0}));
    assert!(first.accepted && first.answer.get("sum").is_some() && first.id.is_some());
    assert!(!second.accepted && second.answer.get("code") == Some(&"negative".into()));
    assert_eq!((third.caller, third.accepted, &third.answer["code"]), (None, false, &"anonymous".into()));
    assert_eq!(third.request, serde_json::json!({"addend": 1.0}));
    net.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn who_is_followed_is_asked_for_its_version_once_each_time_it_appears() {
    let net = Net::open(|config| config).await;
    let mut versions = net.hub.serve_description("gateway").unwrap();
    let mut presence = net.client.presence().unwrap();
    let of_another = || usal::contract::check_version(Some("2")).map(|()| unreachable!("it is another one"));
    let there = net.hub.announce("gateway").unwrap();
    let asked = within(versions.recv()).await.unwrap();
    assert_eq!(asked.from(), Some("adder"));
    asked.answer(of_another());
    // a refusal is told, and the service goes on; others come and go without a question
    let _other = net.hub.announce("camera").unwrap();
    assert!((net.add(2.0).await.unwrap().sum - 2.0).abs() < 1e-9);
    let asked = tokio::time::timeout(Duration::from_millis(300), versions.recv()).await;
    assert!(asked.is_err(), "once is enough");
    drop(there);
    // gone and back, as often as it takes to be noticed
    let again = async {
        loop {
            while presence.is_alive("gateway") {
                presence.changed().await.unwrap();
            }
            let there = net.hub.announce("gateway").unwrap();
            if let Ok(asked) = tokio::time::timeout(Duration::from_millis(500), versions.recv()).await {
                return (asked.unwrap(), there);
            }
            while !presence.is_alive("gateway") {
                presence.changed().await.unwrap();
            }
        }
    };
    let (asked, _there) = within(again).await;
    asked.answer(of_another());
    net.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_accepted_is_on_the_disk_and_a_second_one_does_not_start() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().to_owned();
    let net = Net::open(|config| Config { state_dir: Some(path.clone()), ..config }).await;
    for n in 1..=3 {
        net.add(1.0).await.unwrap();
        assert_eq!(std::fs::read_to_string(path.join("sum")).unwrap(), n.to_string());
    }
    for (state_dir, told) in [(None, "uav1"), (Some(path.clone()), "state directory")] {
        let second = Config { state_dir, ..Config::client("uav1", &net.endpoint) };
        let error = within(run_alone(second, Adder::new(), net_shutdown())).await.unwrap_err();
        assert!(error.is::<AlreadyRunning>() && error.to_string().contains(told), "{error:#}");
    }
    net.end().await;
}

/// Never asked for: its trigger is gone only with the process.
fn net_shutdown() -> Shutdown {
    let (trigger, shutdown) = shutdown();
    std::mem::forget(trigger);
    shutdown
}

#[tokio::test(flavor = "multi_thread")]
async fn session_that_is_closed_ends_the_service_with_a_message() {
    let (_trigger, shutdown) = shutdown();
    let config =
        Config { role: usal::Role::Hub { listen: "tcp/nowhere:x".into() }, ..Config::client("uav1", "") };
    let error = within(run_alone(config, Adder::new(), shutdown)).await.unwrap_err();
    assert!(format!("{error:#}").contains("adder"), "{error:#}");
}
