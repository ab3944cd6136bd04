//! A gateway as the contract has it, around an autopilot that flies a waypoint a step. It
//! conducts the clock, so the test drives time.

#[path = "../../src/fp_manager/tests/kills/gateway.rs"]
mod flying;

use flying::Gateway;
use std::future::Future;
use std::ops::{Deref, DerefMut};
use std::time::Duration;
use usal::contract::*;
use usal::topics::{GATEWAY, gateway};
use usal::{
    Announcement, CallError, Conductor, EventPublisher, PendingCall, Server, Session, VariablePublisher,
};

/// Longer than anything takes on a slow machine.
pub const DEADLINE: Duration = Duration::from_secs(60);
/// Simulated seconds a step.
const STEP_S: f64 = 0.5;

pub async fn within<F: Future>(future: F) -> F::Output {
    tokio::time::timeout(DEADLINE, future).await.expect("in time")
}

/// Waits until a condition holds.
pub async fn until(mut condition: impl AsyncFnMut() -> bool) {
    within(async {
        while !condition().await {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    })
    .await;
}

pub fn free_endpoint() -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    format!("tcp/{}", listener.local_addr().unwrap())
}

pub struct FakeGateway {
    flying: Gateway,
    conductor: Conductor,
    feed: Server<Feed, FeedAnswer>,
    join: Server<Join, JoinAnswer>,
    request: Server<GatewayRequest, Empty>,
    position: VariablePublisher<Position>,
    navigation: VariablePublisher<Navigation>,
    status: VariablePublisher<GatewayStatus>,
    events: EventPublisher<TimedGatewayEvent>,
    power: VariablePublisher<Power>,
    gps: VariablePublisher<Gps>,
    /// Share of the energy left.
    pub battery: f64,
    /// Time of day at the start, if satellites give it.
    pub unix_s: Option<i64>,
    _announcement: Announcement,
    time_s: f64,
}

impl Deref for FakeGateway {
    type Target = Gateway;

    fn deref(&self) -> &Gateway {
        &self.flying
    }
}

impl DerefMut for FakeGateway {
    fn deref_mut(&mut self) -> &mut Gateway {
        &mut self.flying
    }
}

impl FakeGateway {
    pub async fn open(endpoint: &str) -> Self {
        let session = Session::open(usal::Config::hub("uav1", endpoint)).await.unwrap();
        Self {
            flying: Gateway::new(LatLon { lat_deg: 36.3190, lon_deg: -84.1730 }),
            conductor: Conductor::new(&session).unwrap().patience(DEADLINE),
            feed: session.serve(gateway::FEED).unwrap(),
            join: session.serve(gateway::JOIN).unwrap(),
            request: session.serve(gateway::REQUEST).unwrap(),
            position: session.publish(gateway::POSITION).unwrap(),
            navigation: session.publish(gateway::NAVIGATION).unwrap(),
            status: session.publish(gateway::STATE).unwrap(),
            events: session.emitter(gateway::EVENTS).unwrap(),
            power: session.publish(gateway::POWER).unwrap(),
            gps: session.publish(gateway::GPS).unwrap(),
            battery: 1.0,
            unix_s: None,
            _announcement: session.announce(GATEWAY).unwrap(),
            time_s: 0.0,
        }
    }

    pub async fn participants(&self, count: usize) {
        until(async || self.conductor.participants().len() == count).await;
    }

    /// One step of time: fly, publish, and let everybody do what is due.
    pub async fn step(&mut self) {
        self.time_s += STEP_S;
        self.flying.fly();
        self.publish();
        self.conductor.start(self.time_s);
        let late = within(self.serve_until_settled()).await;
        assert!(late.is_empty(), "{late:?}");
    }

    /// Steps until an answer is there.
    pub async fn step_until_done<A>(&mut self, mut call: PendingCall<A>) -> Result<A, CallError> {
        within(async {
            loop {
                if let Some(answer) = call.try_take() {
                    return answer;
                }
                self.step().await;
            }
        })
        .await
    }

    async fn serve_until_settled(&mut self) -> Vec<String> {
        loop {
            tokio::select! {
                biased;
                Some(incoming) = self.feed.recv() => {
                    let (feed, reply) = incoming.split();
                    reply(Ok(self.flying.feed(feed)));
                }
                Some(incoming) = self.join.recv() => {
                    let (join, reply) = incoming.split();
                    reply(Ok(self.flying.join(join)));
                }
                Some(incoming) = self.request.recv() => {
                    let (request, reply) = incoming.split();
                    let refused = |reason| Refusal { code: "refused".into(), reason };
                    reply(self.flying.request(&request).map(|()| Empty {}).map_err(refused));
                }
                late = self.conductor.settle() => return late,
            }
        }
    }

    fn publish(&mut self) {
        let time_s = self.time_s;
        for value in self.flying.events.drain(..) {
            self.events.emit(&Stamped { time_s, validity_s: 1.0, value });
        }
        let power = Power { voltage_v: 24.0, current_a: 10.0, battery: self.battery, fuel: None };
        self.power.set(time_s, 1.0, &power);
        let unix_s = self.unix_s.map(|start| start + time_s as i64);
        self.gps.set(time_s, 1.0, &Gps { fix_3d: true, satellites: Some(12), hdop: 0.8, unix_s });
        self.position.set(time_s, 1.0, &self.flying.position());
        self.navigation.set(time_s, 1.0, &self.flying.navigation());
        self.status.set(time_s, 1.0, &self.flying.status());
    }
}
