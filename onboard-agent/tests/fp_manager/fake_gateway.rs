//! A gateway as the contract has it, around an autopilot that flies a waypoint a step. It
//! conducts the clock, so the test drives time.

use std::collections::VecDeque;
use std::future::Future;
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
    conductor: Conductor,
    feed: Server<Feed, FeedAnswer>,
    join: Server<Join, JoinAnswer>,
    request: Server<GatewayRequest, Empty>,
    position: VariablePublisher<Position>,
    navigation: VariablePublisher<Navigation>,
    status: VariablePublisher<GatewayStatus>,
    events: EventPublisher<TimedGatewayEvent>,
    _announcement: Announcement,
    time_s: f64,
    here: LatLon,
    buffer: VecDeque<Waypoint>,
    highest: Token,
    pub state: GatewayState,
    pub flown: Vec<Waypoint>,
    pub joins: Vec<Join>,
    /// All but the storing of runways.
    pub requests: Vec<GatewayRequest>,
    /// As they were stored, each time.
    pub runways: Vec<Vec<SafeRunway>>,
    pub refuse_leg: Option<Id>,
    /// Launches are refused with this.
    pub refuse_launch: Option<String>,
    /// Raised now.
    alarms: Vec<Alarm>,
    resume_on_feed: bool,
}

impl FakeGateway {
    pub async fn open(endpoint: &str) -> Self {
        let session = Session::open(usal::Config::hub("uav1", endpoint)).await.unwrap();
        Self {
            conductor: Conductor::new(&session).unwrap().patience(DEADLINE),
            feed: session.serve(gateway::FEED).unwrap(),
            join: session.serve(gateway::JOIN).unwrap(),
            request: session.serve(gateway::REQUEST).unwrap(),
            position: session.publish(gateway::POSITION).unwrap(),
            navigation: session.publish(gateway::NAVIGATION).unwrap(),
            status: session.publish(gateway::STATE).unwrap(),
            events: session.emitter(gateway::EVENTS).unwrap(),
            _announcement: session.announce(GATEWAY).unwrap(),
            time_s: 0.0,
            here: LatLon { lat_deg: 36.3190, lon_deg: -84.1730 },
            buffer: VecDeque::new(),
            highest: Token(0),
            state: GatewayState::Stop,
            flown: Vec::new(),
            joins: Vec::new(),
            requests: Vec::new(),
            runways: Vec::new(),
            refuse_leg: None,
            refuse_launch: None,
            alarms: Vec::new(),
            resume_on_feed: false,
        }
    }

    pub async fn participants(&self, count: usize) {
        until(async || self.conductor.participants().len() == count).await;
    }

    pub fn launched(&self) -> bool {
        self.requests.contains(&GatewayRequest::Launch)
    }

    pub fn end_is_aboard(&self) -> bool {
        self.buffer.back().is_some_and(|w| w.end_of_plan)
    }

    pub fn finished(&self) -> bool {
        self.buffer.is_empty() && self.flown.last().is_some_and(|w| w.end_of_plan)
    }

    pub fn alarm(&mut self, cause: Cause) {
        let alarm = Alarm {
            id: "energy-low".into(),
            severity: Severity::Warning,
            source: "gateway".into(),
            advice: "land".into(),
            cause: Some(cause),
        };
        self.emit(GatewayEvent::AlarmRaised(alarm.clone()));
        self.alarms.push(alarm);
    }

    /// Safe.Hold with an empty buffer, until the FP Manager joins.
    pub fn safe_until_joined(&mut self) {
        self.state = GatewayState::SafeHold;
        self.buffer.clear();
    }

    fn emit(&self, value: GatewayEvent) {
        self.events.emit(&Stamped { time_s: self.time_s, validity_s: 1.0, value });
    }

    /// One step of time: fly, publish, and let everybody do what is due.
    pub async fn step(&mut self) {
        self.time_s += STEP_S;
        self.fly();
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
                    reply(Ok(self.feed(feed)));
                }
                Some(incoming) = self.join.recv() => {
                    let (join, reply) = incoming.split();
                    reply(Ok(self.join(join)));
                }
                Some(incoming) = self.request.recv() => {
                    let (request, reply) = incoming.split();
                    reply(self.request(request));
                }
                late = self.conductor.settle() => return late,
            }
        }
    }

    fn feed(&mut self, feed: Feed) -> FeedAnswer {
        if self.state == GatewayState::SafeHold {
            return FeedAnswer::NotNow("join first".into());
        }
        let refused = self.refuse_leg.as_ref().and_then(|leg| feed.waypoints.iter().find(|w| w.leg == *leg));
        if let Some(waypoint) = refused {
            return FeedAnswer::Refused {
                faults: vec![(waypoint.token, "fence".into(), "not there".into())],
            };
        }
        if let Some(keep) = feed.cancel_after {
            self.buffer.retain(|w| w.token <= keep);
        }
        for waypoint in feed.waypoints {
            assert!(waypoint.token > self.highest, "{:?} fed after {:?}", waypoint.token, self.highest);
            self.highest = waypoint.token;
            self.buffer.push_back(waypoint);
        }
        if std::mem::take(&mut self.resume_on_feed) {
            self.state = GatewayState::Nav;
        }
        FeedAnswer::Accepted
    }

    fn join(&mut self, join: Join) -> JoinAnswer {
        self.joins.push(join);
        if self.state == GatewayState::SafeHold {
            self.state = GatewayState::Hold;
            self.resume_on_feed = true;
        }
        JoinAnswer {
            accepted: true,
            reason: String::new(),
            current: self.buffer.front().map(|w| w.token),
            last: self.buffer.back().map(|w| w.token),
            highest: self.highest,
        }
    }

    fn request(&mut self, request: GatewayRequest) -> Result<Empty, Refusal> {
        match request {
            GatewayRequest::Launch if self.refuse_launch.is_some() => {
                let reason = self.refuse_launch.clone().unwrap_or_default();
                return Err(Refusal { code: "refused".into(), reason });
            }
            GatewayRequest::Launch | GatewayRequest::Resume => {
                assert!(!self.buffer.is_empty(), "{request:?} before the waypoints");
                self.state = GatewayState::Nav;
            }
            GatewayRequest::Hold => self.state = GatewayState::Hold,
            GatewayRequest::Safe => self.state = GatewayState::SafeHold,
            GatewayRequest::SetRunways { runways } => {
                self.runways.push(runways);
                return Ok(Empty {});
            }
            _ => panic!("{request:?}"),
        }
        self.requests.push(request);
        Ok(Empty {})
    }

    fn fly(&mut self) {
        if self.state != GatewayState::Nav {
            return;
        }
        let Some(reached) = self.buffer.pop_front() else { return };
        self.here = reached.position;
        self.flown.push(reached);
        if self.finished() {
            self.state = GatewayState::Stop;
        }
        self.emit(GatewayEvent::Progress { current: self.buffer.front().map(|w| w.token) });
    }

    fn publish(&self) {
        let on_ground = self.state == GatewayState::Stop;
        let position = Position {
            position: self.here,
            altitude_amsl_m: 450.0,
            altitude_home_m: 100.0,
            velocity_north_mps: 0.0,
            velocity_east_mps: 22.0,
            velocity_down_mps: 0.0,
            track_deg: 90.0,
            ground_speed_mps: if on_ground { 0.0 } else { 22.0 },
            on_ground,
        };
        self.position.set(self.time_s, 1.0, &position);
        let navigation = Navigation {
            current: self.buffer.front().map(|w| w.token),
            next: self.buffer.get(1).map(|w| w.token),
            last: self.buffer.back().map(|w| w.token),
            distance_m: 100.0,
            eta_s: 5.0,
            cross_track_m: 0.0,
            buffer_waypoints: self.buffer.len(),
            buffer_s: 5.0 * self.buffer.len() as f64,
            room: 256 - self.buffer.len(),
            end_of_plan: self.buffer.back().is_some_and(|w| w.end_of_plan),
        };
        self.navigation.set(self.time_s, 1.0, &navigation);
        let status = GatewayStatus {
            state: self.state,
            cause: "test".into(),
            armed: !on_ground,
            autopilot_mode: "AUTO".into(),
            autopilot_age_s: 0.0,
            fp_manager_age_s: None,
            safe_return_in_s: None,
            alarms: self.alarms.clone(),
        };
        self.status.set(self.time_s, 1.0, &status);
    }
}
