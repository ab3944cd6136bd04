//! The executor: a flight made from bytes, with everything that people, services, autopilots and broken sensors may do.

mod occurrence;

use crate::plans::{Known, known, pick, resting, revived};
use arbitrary::{Arbitrary, Unstructured};
use flight_exec::{
    AircraftState, Command, Executor, Input, Output, Phase, RequestId, Snapshot, Time, Token, Waypoint,
};
use flight_plan::{Id, Program};
use geometry::LatLon;
use occurrence::{Occurrence, Order, Report};
use std::collections::VecDeque;
use std::sync::Arc;

/// Most things that happen on a flight.
const MAX_HAPPENINGS: usize = 200;
/// Most waypoints that are handed out and not flown: the horizon, and what an update keeps besides.
const MAX_AHEAD: usize = 64;
/// Most outputs of a step.
const MAX_OUTPUTS: usize = 1000;

/// Any bytes as a flight.
///
/// # Panics
/// A request that has not exactly one answer, a refused one that changed the plan, a waypoint that can't be flown, a token
/// used twice, a buffer without bound, or a place that does not survive a restart.
pub fn executor(bytes: &[u8]) {
    let mut story = Unstructured::new(bytes);
    let mut flight = Flight::new();
    for _ in 0..MAX_HAPPENINGS {
        if story.is_empty() {
            break;
        }
        let Ok(occurrence) = Occurrence::arbitrary(&mut story) else { break };
        flight.happen(occurrence);
    }
    flight.restart();
}

struct Flight {
    executor: Executor,
    now: Time,
    /// What the gateway holds: the waypoint steered to comes first.
    buffer: VecDeque<Waypoint>,
    highest: Token,
    requests: u64,
}

impl Flight {
    fn new() -> Self {
        Self { executor: resting(), now: Time::ZERO, buffer: VecDeque::new(), highest: Token(0), requests: 0 }
    }

    fn happen(&mut self, occurrence: Occurrence) {
        match occurrence {
            Occurrence::Wait { tenths_s } => {
                self.pass(Time::from_millis(100 * u64::from(tenths_s)));
                self.step(Input::Tick);
            }
            Occurrence::Leap { nanoseconds } => {
                self.pass(Time::from_nanos(nanoseconds));
                self.step(Input::Tick);
            }
            Occurrence::UntilDue => {
                self.now = self.executor.deadline().map_or(self.now, |due| due.max(self.now));
                self.step(Input::Tick);
            }
            Occurrence::Propose { plan, seen, forbidden } => self.propose(plan, seen, forbidden),
            Occurrence::Update { plan } => {
                self.propose(plan, None, false);
                self.command(Command::Commit {
                    hash: pick(&known().plans, plan).hash().clone(),
                    entry: None,
                });
            }
            Occurrence::Order(order) => self.command(ordered(order)),
            Occurrence::Fly { waypoints } => (0..waypoints % 32).for_each(|_| self.fly_one()),
            Occurrence::Report(report) => self.step(Input::Aircraft(reported(report))),
            Occurrence::Steered { token } => {
                self.step(Input::Progress { current: token.map(|t| Token(t.into())) });
            }
            Occurrence::Rejected { token } => {
                self.step(Input::Rejected { first: Token(token.into()), reason: "fuzz".into() });
            }
            Occurrence::GatewayControls(controls) => {
                self.buffer.clear();
                self.step(Input::GatewayControls(controls));
            }
            Occurrence::Restart => self.restart(),
        }
    }

    fn pass(&mut self, time: Time) {
        self.now = self.now.saturating_add(time);
    }

    fn request(&mut self) -> RequestId {
        self.requests += 1;
        RequestId(self.requests)
    }

    fn propose(&mut self, plan: u8, seen: Option<u8>, forbidden: bool) {
        let (request, program) = (self.request(), pick(&known().plans, plan));
        let objection = flight_plan::Problem::error("fuzz", "forbidden");
        let objections = forbidden.then_some(objection).into_iter().collect();
        self.step(Input::Propose { request, program, based_on: seen.map(u64::from), objections });
    }

    fn command(&mut self, command: Command) {
        let request = self.request();
        self.step(Input::Command { request, by: "operator".into(), command });
    }

    /// To the waypoint steered to, and on to the next.
    fn fly_one(&mut self) {
        let Some(reached) = self.buffer.pop_front() else { return };
        let airspeed_mps = reached.airspeed_mps;
        self.pass(Time::from_secs(20));
        self.step(Input::Aircraft(AircraftState {
            position: reached.position,
            altitude_amsl_m: reached.altitude_amsl_m,
            track_deg: 90.0,
            ground_speed_mps: airspeed_mps,
            airspeed_mps,
            wind_east_mps: 0.0,
            wind_north_mps: 0.0,
            battery: 0.9,
            fuel: None,
            on_ground: false,
            engine_out: false,
            heading_deg: None,
        }));
        let current = self.buffer.front().map(|w| w.token);
        if current.is_some() || reached.end_of_plan {
            self.step(Input::Progress { current });
        }
    }

    fn step(&mut self, input: Input) {
        let asked = match &input {
            Input::Command { request, .. } | Input::Propose { request, .. } => Some(*request),
            _ => None,
        };
        let before = self.in_force();
        let told = format!("{input:?}");
        let mut outputs = Vec::new();
        self.executor.step(self.now, input, &mut outputs);
        assert!(outputs.len() <= MAX_OUTPUTS, "{} outputs of {told}", outputs.len());
        let mut answered = None;
        for output in outputs {
            match output {
                Output::Feed { cancel_after, waypoints } => self.take(cancel_after, waypoints),
                Output::Answer { request, result } => {
                    assert_eq!((Some(request), answered), (asked, None), "{told}");
                    answered = Some(result.is_ok());
                }
                Output::Hold | Output::Safe | Output::Act { .. } | Output::Event(_) => {}
            }
        }
        assert_eq!(answered.is_some(), asked.is_some(), "one answer: {told}");
        if answered == Some(false) {
            assert_eq!(self.in_force(), before, "changed by a refused {told}");
        }
        self.forget_flown();
        self.executor.status();
        let due = self.executor.deadline();
        assert!(due.is_none_or(|due| due >= self.now), "due in the past after {told}");
    }

    /// The plan flown, its revision, and the plan that may be committed.
    fn in_force(&self) -> (Option<Arc<str>>, u64, Option<Arc<str>>) {
        let hash = |p: Option<&Arc<Program>>| p.map(|p| p.hash().clone());
        let revision = self.executor.status().revision;
        (hash(self.executor.program()), revision, hash(self.executor.proposed()))
    }

    /// What the executor takes for flown is no longer in the gateway's buffer either.
    fn forget_flown(&mut self) {
        let mut ahead = self.executor.ahead().map(|w| w.token).peekable();
        let first = ahead.peek().copied();
        assert!(ahead.count() <= MAX_AHEAD, "too many waypoints ahead");
        self.buffer.retain(|w| first.is_some_and(|first| w.token >= first));
    }

    fn take(&mut self, cancel_after: Option<Token>, waypoints: Vec<Waypoint>) {
        if let Some(last) = cancel_after {
            self.buffer.retain(|w| w.token <= last);
        }
        for waypoint in waypoints {
            assert!(waypoint.token > self.highest, "a token used twice: {waypoint:?}");
            assert!(flyable(&waypoint), "{waypoint:?}");
            self.highest = waypoint.token;
            self.buffer.push_back(waypoint);
        }
    }

    /// Killed, and back from what was written down.
    fn restart(&mut self) {
        let snapshot = self.executor.snapshot();
        let mut bytes = Vec::new();
        ciborium::into_writer(&snapshot, &mut bytes).unwrap();
        let read: Snapshot = ciborium::from_reader(bytes.as_slice()).unwrap();
        let mut restored = revived(read).unwrap();
        assert_eq!(restored.snapshot(), snapshot, "restored");
        restored.go_on(self.executor.proposed().cloned(), self.executor.last_step());
        self.executor = restored;
        assert!(self.executor.status_phase() != Phase::Flying || self.executor.program().is_some());
    }
}

fn flyable(waypoint: &Waypoint) -> bool {
    let speed = waypoint.airspeed_mps.is_finite() && waypoint.airspeed_mps > 0.0;
    waypoint.position.is_valid() && waypoint.altitude_amsl_m.is_finite() && speed
}

fn ordered(order: Order) -> Command {
    let Known { plans, legs, variables } = known();
    match order {
        Order::Start => Command::Start,
        Order::Hold => Command::Hold,
        Order::Resume => Command::Resume,
        Order::SkipLeg => Command::SkipLeg,
        Order::GoTo(leg) => Command::GoTo { leg: pick(legs, leg) },
        Order::SetCount(leg, count) => Command::SetCount { leg: pick(legs, leg), count },
        Order::Decide(leg, branch) => {
            let leg = pick(legs, leg);
            let branch = plans.iter().find_map(|p| p.leg(&leg).and_then(|l| occurrence::branch(l, branch)));
            Command::Decide { leg, branch: branch.unwrap_or_else(|| Id::new("nowhere")) }
        }
        Order::Set(variable, value) => {
            Command::SetVariable { name: pick(variables, variable), value: value.into() }
        }
        Order::Emergency(cause, plan) => {
            let ids: Vec<Id> =
                plans.iter().flat_map(|p| p.plan.emergency_plans.iter().map(|e| e.id.clone())).collect();
            Command::Emergency { cause: occurrence::cause(cause), plan: plan.map(|p| pick(&ids, p)) }
        }
        Order::ReturnToMain(leg) => Command::ReturnToMain { leg: pick(legs, leg) },
        Order::Commit(plan, entry) => Command::Commit {
            hash: pick(plans, plan).hash().clone(),
            entry: entry.map(|leg| pick(legs, leg)),
        },
    }
}

fn reported(report: Report) -> AircraftState {
    let [altitude_amsl_m, track_deg, ground_speed_mps, airspeed_mps] = report.motion;
    let [wind_east_mps, wind_north_mps, battery] = report.air;
    AircraftState {
        position: LatLon::new(report.position.0, report.position.1),
        altitude_amsl_m,
        track_deg,
        ground_speed_mps,
        airspeed_mps,
        wind_east_mps,
        wind_north_mps,
        battery,
        fuel: Some(battery),
        on_ground: report.on_ground,
        // nothing is left to run it with
        engine_out: battery <= 0.0,
        heading_deg: report.on_ground.then_some(track_deg),
    }
}
