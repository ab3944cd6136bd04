//! Whole flights: core, window and driver against the simulator's pure core, without sockets.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::Station;
use super::core::{Answer, Input, Settings, Snapshot};
use super::driver::{Decoder, encode};
use super::order::Time;
use geometry::LatLon;
use sim::core::{Peer, Simulator};
use std::time::Duration;
use usal::contract::*;

const PEER: Peer = Peer(1);
const HOME: LatLon = LatLon::new(36.3190, -84.1730);
const HEADING_DEG: f64 = 52.0;
const GROUND_M: f64 = 349.0;

/// A flight, and the FP Manager's side of it.
pub struct Flight {
    pub sim: Simulator,
    pub station: Station,
    pub now: Time,
    pub events: Vec<(f64, GatewayEvent)>,
    /// The FP Manager sends heartbeats.
    pub alive: bool,
    /// Entries of the autopilot's list that it steered to, with the place at that time.
    pub steered: Vec<LatLon>,
    decoder: Decoder,
    sim_decoder: sim::frame::Decoder,
    next: u64,
}

pub fn settings() -> Settings {
    Settings { vehicle: "test".into(), profile: aircraft::Profile::default(), terrain: None }
}

impl Flight {
    pub fn new(seed: u64, faults: &[&str]) -> Self {
        let config = sim::Config::default();
        let mut sim =
            Simulator::new(config.profile, config.home, aircraft::Wind::from_direction(270.0, 5.0), seed);
        sim.connect(PEER);
        for fault in faults {
            assert!(sim.inject(fault.parse().unwrap()));
        }
        Self {
            sim,
            station: Station::new(settings(), None, true),
            now: Time::ZERO,
            events: vec![],
            alive: true,
            steered: vec![],
            decoder: Decoder::default(),
            sim_decoder: sim::frame::Decoder::default(),
            next: 1,
        }
    }

    /// 100 ms. What the simulator answers comes with the next step.
    pub fn step(&mut self) {
        self.sim.step();
        self.sim.ask_time();
        self.now = Duration::from_nanos(self.sim.now_ns());
        let mut decoded = vec![];
        for outgoing in self.sim.take_outgoing() {
            self.decoder.feed(&outgoing.bytes, &mut decoded);
        }
        for (header, message) in decoded {
            self.station.receive(self.now, header, &message);
        }
        if self.alive && self.now.as_millis().is_multiple_of(500) {
            self.station.input(self.now, Input::Heartbeat { plan: Some("plan".into()) });
        }
        self.station.tick(self.now);
        let step = self.station.take_step().expect("every step asks for the time");
        self.station.answer_step(step);
        for message in self.station.take_messages() {
            let bytes = encode(self.station.header(0), &message);
            let mut frames = vec![];
            self.sim_decoder.push(&bytes, |f| frames.push(f));
            frames.into_iter().for_each(|f| self.sim.receive(PEER, f));
        }
        let now_s = self.now.as_secs_f64();
        self.events.extend(self.station.take_events().into_iter().map(|e| (now_s, e)));
        self.watch_target();
    }

    /// Where the autopilot really steers to, whatever anybody says.
    fn watch_target(&mut self) {
        let autopilot = &self.sim.autopilot;
        if autopilot.mode() != sim::Mode::Auto || !autopilot.is_armed() {
            return;
        }
        let current = usize::from(autopilot.run.current);
        if let Some(item) = autopilot.mission.items().get(current)
            && self.steered.last() != Some(&item.position)
        {
            self.steered.push(item.position);
        }
    }

    pub fn run_until(&mut self, seconds: f64, what: &str, mut done: impl FnMut(&Self) -> bool) {
        let end = self.now + Duration::from_secs_f64(seconds);
        while !done(self) {
            assert!(self.now < end, "{what}: not within {seconds} s; {}", self.report());
            self.step();
        }
    }

    pub fn run(&mut self, seconds: f64) {
        let end = self.now + Duration::from_secs_f64(seconds);
        while self.now < end {
            self.step();
        }
    }

    pub fn report(&self) -> String {
        let status = self.station.gateway().status(self.now);
        let navigation = self.station.gateway().navigation();
        format!("{status:?}\n{navigation:?}\n{:?}", self.events)
    }

    pub fn state(&self) -> GatewayState {
        self.station.gateway().state()
    }

    pub fn ask(&mut self, request: GatewayRequest) -> Result<(), String> {
        match self.station.ask(self.now, |id| Input::Request(id, request)) {
            Some(Answer::Request(result)) => result,
            other => panic!("{other:?}"),
        }
    }

    pub fn join(&mut self, plan: &str) -> JoinAnswer {
        let join = Join { plan: Some(plan.into()), last_token: Token(self.next - 1) };
        match self.station.ask(self.now, |id| Input::Join(id, join)) {
            Some(Answer::Join(answer)) => answer,
            other => panic!("{other:?}"),
        }
    }

    pub fn feed(&mut self, cancel_after: Option<u64>, mut waypoints: Vec<Waypoint>) -> FeedAnswer {
        for w in &mut waypoints {
            w.token = Token(self.next);
            self.next += 1;
        }
        let feed = Feed { cancel_after: cancel_after.map(Token), waypoints };
        match self.station.ask(self.now, |id| Input::Feed(id, feed)) {
            Some(Answer::Feed(answer)) => answer,
            other => panic!("{other:?}"),
        }
    }

    pub fn progress(&self) -> Vec<Option<u64>> {
        let token = |e: &(f64, GatewayEvent)| match e.1 {
            GatewayEvent::Progress { current } => Some(current.map(|t| t.0)),
            _ => None,
        };
        self.events.iter().filter_map(token).collect()
    }

    pub fn changes(&self) -> Vec<(f64, GatewayState)> {
        let to = |e: &(f64, GatewayEvent)| match e.1 {
            GatewayEvent::StateChanged { to, .. } => Some((e.0, to)),
            _ => None,
        };
        self.events.iter().filter_map(to).collect()
    }

    /// On the ground with a plan aboard, then in the air on its way to waypoint 2.
    pub fn launch(&mut self, waypoints: Vec<Waypoint>) {
        self.run_until(20.0, "heard", |f| {
            f.state() == GatewayState::Stop && f.station.gateway().telemetry().gps.is_some()
        });
        assert!(self.join("plan").accepted);
        assert_eq!(self.feed(None, waypoints), FeedAnswer::Accepted);
        self.ask(GatewayRequest::Launch).unwrap();
        self.run_until(120.0, "launch", |f| f.state() == GatewayState::Nav);
    }
}

pub fn waypoint(position: LatLon, altitude_m: f64, action: Action) -> Waypoint {
    Waypoint {
        token: Token(0),
        position,
        altitude_amsl_m: altitude_m,
        airspeed_mps: 25.0,
        action,
        fly_over: false,
        leg: Id::from("leg"),
        end_of_plan: matches!(action, Action::Land { .. }),
    }
}

pub fn take_off() -> Waypoint {
    waypoint(
        HOME.destination(HEADING_DEG, 900.0),
        GROUND_M + 80.0,
        Action::TakeOff { heading_deg: HEADING_DEG },
    )
}

/// A zigzag to the north-east, `metres` between waypoints.
pub fn zigzag(from: usize, count: usize, metres: f64) -> Vec<Waypoint> {
    let place = |i: usize| {
        let side = if i.is_multiple_of(2) { 0.3 } else { -0.3 };
        HOME.destination(HEADING_DEG, 1500.0 + metres * i as f64)
            .destination(HEADING_DEG + 90.0, metres * side)
    };
    (from..from + count).map(|i| waypoint(place(i), GROUND_M + 120.0, Action::Fly)).collect()
}

pub fn landing() -> Vec<Waypoint> {
    let touchdown = HOME.destination(HEADING_DEG, 60.0);
    let out = |m: f64| HOME.destination(HEADING_DEG + 180.0, m);
    vec![
        waypoint(out(2500.0), GROUND_M + 100.0, Action::Fly),
        waypoint(out(1300.0), GROUND_M + 100.0, Action::Fly),
        waypoint(touchdown, GROUND_M, Action::Land { heading_deg: HEADING_DEG }),
    ]
}

fn assert_in_order(progress: &[Option<u64>], last: u64) {
    let tokens: Vec<u64> = progress.iter().flatten().copied().collect();
    assert!(tokens.windows(2).all(|w| w[0] < w[1]), "{tokens:?}");
    assert_eq!(tokens.last(), Some(&last));
}

#[test]
fn a_flight_of_more_waypoints_than_the_ring_holds_is_flown_from_take_off_to_landing() {
    let mut flight = Flight::new(1, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 60, 150.0));
    plan.extend(zigzag(0, 59, 150.0).into_iter().rev());
    plan.extend(landing());
    let last = plan.len() as u64;
    flight.launch(plan);
    flight.run_until(1800.0, "landing", |f| f.state() == GatewayState::Stop);
    let progress = flight.progress();
    assert_eq!(progress.last(), Some(&None));
    assert_in_order(&progress, last);
    assert_eq!(progress.len() as u64, last + 1, "every waypoint was steered to");
    let states: Vec<_> = flight.changes().into_iter().map(|c| c.1).collect();
    use GatewayState::*;
    assert_eq!(states, [Stop, TakeOff, Nav, Approach, Land, Stop]);
}

#[test]
fn packets_lost_0_to_30_percent_the_same_waypoints_are_flown() {
    for (seed, loss) in [(11, 0.0), (12, 0.1), (13, 0.2), (14, 0.3)] {
        println!("seed {seed}, loss {loss}");
        let fault = format!("packet-loss={loss}");
        let mut flight = Flight::new(seed, &[&fault, "duplicate=0.1", "reorder=0.1"]);
        let mut plan = vec![take_off()];
        plan.extend(zigzag(0, 50, 250.0));
        flight.launch(plan.clone());
        flight.run_until(1500.0, "the 45th waypoint", |f| f.progress().iter().flatten().any(|t| *t >= 45));
        assert_in_order(&flight.progress(), *flight.progress().iter().flatten().last().unwrap());
        let wanted: Vec<LatLon> = plan.iter().map(|w| w.position).collect();
        let known = |p: &LatLon| wanted.iter().any(|w| w.distance_m(*p) < 1.0);
        assert!(flight.steered.iter().all(known), "it steered to something that was never fed");
    }
}

#[test]
fn fp_manager_killed_holds_at_t1_returns_at_t2_and_lands() {
    let mut flight = Flight::new(2, &[]);
    let (threshold, id) = (HOME, "R05".to_owned());
    let runway = SafeRunway {
        id,
        threshold,
        elevation_amsl_m: GROUND_M,
        heading_deg: HEADING_DEG,
        length_m: 600.0,
        priority: 1,
    };
    flight.ask(GatewayRequest::SetRunways { runways: vec![runway] }).unwrap();
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 30, 300.0));
    flight.launch(plan);
    flight.run(30.0);
    flight.alive = false;
    let killed = flight.now.as_secs_f64();
    flight.run_until(5.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
    assert!(flight.now.as_secs_f64() - killed < 2.7, "T1 is 2 s after the last heartbeat");
    let held = flight.now.as_secs_f64();
    flight.run_until(30.0, "Safe.Return", |f| f.state() == GatewayState::SafeReturn);
    let waited = flight.now.as_secs_f64() - held;
    assert!((19.9..20.3).contains(&waited), "T2 is 20 s, not {waited}");
    flight.run_until(900.0, "landed", |f| f.state() == GatewayState::Stop);
    let states: Vec<_> = flight.changes().into_iter().map(|c| c.1).collect();
    use GatewayState::*;
    assert_eq!(states[3..], [SafeHold, SafeReturn, SafeApproach, SafeLand, Stop]);
    let place = flight.station.gateway().telemetry().position().unwrap().1.position;
    assert!(place.distance_m(HOME) < 700.0, "{} m from the runway", place.distance_m(HOME));
}

#[test]
fn fp_manager_back_in_time_gets_the_aircraft_back() {
    let mut flight = Flight::new(3, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 30, 300.0));
    flight.launch(plan);
    flight.run(20.0);
    flight.alive = false;
    flight.run_until(5.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
    assert!(matches!(flight.feed(None, zigzag(30, 1, 300.0)), FeedAnswer::NotNow(_)));
    assert!(!flight.join("another plan").accepted);
    flight.run(10.0);
    flight.alive = true;
    let answer = flight.join("plan");
    assert!(answer.accepted, "{answer:?}");
    let current = answer.current.unwrap().0;
    flight.run_until(20.0, "Nav", |f| {
        f.state() == GatewayState::Nav && f.station.gateway().status(f.now).autopilot_mode == "AUTO"
    });
    flight.run_until(120.0, "further", |f| f.progress().iter().flatten().any(|t| *t > current + 2));
}

#[test]
fn fp_manager_back_during_the_return_gets_the_aircraft_back_too() {
    let mut flight = Flight::new(4, &[]);
    let (threshold, id) = (HOME, "R05".to_owned());
    let runway = SafeRunway {
        id,
        threshold,
        elevation_amsl_m: GROUND_M,
        heading_deg: HEADING_DEG,
        length_m: 600.0,
        priority: 1,
    };
    flight.ask(GatewayRequest::SetRunways { runways: vec![runway] }).unwrap();
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 30, 300.0));
    flight.launch(plan);
    flight.run(60.0);
    flight.alive = false;
    flight.run_until(40.0, "Safe.Return", |f| f.state() == GatewayState::SafeReturn);
    flight.run(5.0);
    flight.alive = true;
    let answer = flight.join("plan");
    assert!(answer.accepted && answer.current.is_none(), "{answer:?}");
    flight.run_until(10.0, "Hold", |f| f.state() == GatewayState::Hold);
    let first = answer.highest.0 + 1;
    assert_eq!(flight.feed(None, zigzag(10, 12, 300.0)), FeedAnswer::Accepted);
    flight.run_until(200.0, "Nav", |f| f.progress().iter().flatten().any(|t| *t > first + 3));
    assert_eq!(flight.state(), GatewayState::Nav);
    assert!(flight.progress().iter().flatten().all(|t| *t < 32 || *t >= first));
}

#[test]
fn an_emergency_replaces_everything_at_once_and_no_stale_waypoint_is_steered_to() {
    for (loss, within_s) in [("packet-loss=0", 0.6), ("packet-loss=0.2", 3.0)] {
        for (seed, more) in (5..).zip([45.0, 46.0, 47.0, 48.0, 49.0, 50.0, 51.0, 52.0]) {
            let mut flight = Flight::new(seed, &[loss]);
            let mut plan = vec![take_off()];
            plan.extend(zigzag(0, 60, 250.0));
            flight.launch(plan);
            flight.run(more);
            let place = flight.station.gateway().telemetry().position().unwrap().1.position;
            let away = |m: f64| waypoint(place.destination(320.0, m), GROUND_M + 150.0, Action::Fly);
            let replacement: Vec<_> = (1..=20).map(|i| away(f64::from(i) * 400.0)).collect();
            let (at, first) = (flight.now, flight.next);
            assert_eq!(flight.feed(Some(0), replacement.clone()), FeedAnswer::Accepted);
            let done = |f: &Flight| f.progress().iter().flatten().any(|t| *t == first);
            flight.run_until(within_s, "the emergency's first waypoint", done);
            println!("{loss}: switched after {:?}", flight.now - at);
            flight.steered.clear();
            flight.run(100.0);
            let known = |p: &LatLon| replacement.iter().any(|w| w.position.distance_m(*p) < 1.0);
            assert!(flight.steered.iter().all(known), "{:?}", flight.steered);
        }
    }
}

#[test]
fn dry_buffer_without_an_end_holds_and_new_waypoints_heal_it() {
    let mut flight = Flight::new(6, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 4, 300.0));
    flight.launch(plan);
    flight.run_until(200.0, "dry", |f| f.state() == GatewayState::SafeHold);
    assert!(flight.events.iter().any(|(_, e)| matches!(e, GatewayEvent::BufferLow { .. })));
    assert_eq!(flight.feed(None, zigzag(4, 6, 300.0)), FeedAnswer::Accepted);
    flight.run_until(100.0, "further", |f| f.progress().iter().flatten().any(|t| *t == 8));
    assert_eq!(flight.state(), GatewayState::Nav);
}

#[test]
fn the_pilot_has_priority_and_gives_back() {
    let mut flight = Flight::new(7, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 30, 300.0));
    flight.launch(plan);
    flight.run(10.0);
    assert!(flight.sim.autopilot.set_mode(sim::Mode::FlyByWireA));
    flight.run_until(3.0, "Manual", |f| f.state() == GatewayState::Manual);
    assert!(matches!(flight.feed(None, zigzag(30, 1, 300.0)), FeedAnswer::NotNow(_)));
    flight.run(10.0);
    assert_eq!(flight.sim.autopilot.mode(), sim::Mode::FlyByWireA, "the gateway keeps its hands off");
    assert!(flight.sim.autopilot.set_mode(sim::Mode::Auto));
    flight.run_until(3.0, "Nav", |f| f.state() == GatewayState::Nav);
}

#[test]
fn hold_resume_direct_and_terminate_are_confirmed_by_the_autopilot() {
    let mut flight = Flight::new(8, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 40, 300.0));
    flight.launch(plan);
    flight.ask(GatewayRequest::Hold).unwrap();
    assert_eq!(flight.state(), GatewayState::Nav, "nothing is claimed yet");
    flight.run_until(4.0, "Hold", |f| f.state() == GatewayState::Hold);
    assert_eq!(flight.sim.autopilot.mode(), sim::Mode::Loiter);
    flight.run(20.0);
    let direct = GatewayRequest::Direct { heading_deg: 90.0, altitude_amsl_m: 500.0, airspeed_mps: 25.0 };
    flight.ask(direct).unwrap();
    flight.run_until(4.0, "Directed", |f| f.state() == GatewayState::Directed);
    flight.run(60.0);
    let position = flight.station.gateway().telemetry().position().unwrap().1;
    assert!((position.track_deg - 90.0).abs() < 10.0, "{}", position.track_deg);
    assert!((position.altitude_amsl_m - 500.0).abs() < 15.0, "{}", position.altitude_amsl_m);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(4.0, "Nav", |f| f.state() == GatewayState::Nav);
    assert!(flight.ask(GatewayRequest::Terminate { confirm: "other".into() }).is_err());
    flight.ask(GatewayRequest::Terminate { confirm: "test".into() }).unwrap();
    flight.run_until(5.0, "disarmed", |f| !f.sim.autopilot.is_armed());
    assert_eq!(flight.state(), GatewayState::Terminate);
}

#[test]
fn gateway_killed_the_autopilot_flies_on_and_the_next_gateway_adopts_the_flight() {
    for with_memory in [true, false] {
        let mut flight = Flight::new(9, &[]);
        let mut plan = vec![take_off()];
        plan.extend(zigzag(0, 30, 300.0));
        flight.launch(plan);
        flight.run(25.0);
        let snapshot: Snapshot = flight.station.gateway().snapshot();
        let json = serde_json::to_string(&snapshot).unwrap();
        let before = flight.progress().iter().flatten().copied().last().unwrap();
        let restored = with_memory.then(|| serde_json::from_str(&json).unwrap());
        flight.station = Station::new(settings(), restored, true);
        flight.events.clear();
        let expected = if with_memory { GatewayState::Nav } else { GatewayState::SafeHold };
        flight.run_until(15.0, "adopted", |f| f.state() == expected);
        let answer = flight.join("plan");
        assert!(answer.accepted, "{answer:?}");
        if with_memory {
            assert!(answer.current.unwrap().0 >= before && answer.highest == Token(31));
            flight.run_until(100.0, "further", |f| f.progress().iter().flatten().any(|t| *t > before + 3));
        } else {
            assert_eq!(flight.feed(Some(0), zigzag(12, 10, 300.0)), FeedAnswer::Accepted);
            flight.run_until(300.0, "further", |f| f.progress().iter().flatten().any(|t| *t >= 34));
        }
    }
}

#[test]
fn a_flight_ended_by_force_stays_ended_when_the_gateway_starts_anew() {
    let mut flight = Flight::new(15, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 30, 300.0));
    flight.launch(plan);
    flight.ask(GatewayRequest::Terminate { confirm: "test".into() }).unwrap();
    let json = serde_json::to_string(&flight.station.gateway().snapshot()).unwrap();
    // killed before anything was sent
    flight.station = Station::new(settings(), Some(serde_json::from_str(&json).unwrap()), true);
    flight.run_until(5.0, "disarmed", |f| !f.sim.autopilot.is_armed());
    assert_eq!(flight.state(), GatewayState::Terminate);
    flight.run_until(300.0, "down", |f| f.sim.autopilot.aircraft.state().on_ground);
    let snapshot = flight.station.gateway().snapshot();
    flight.station = Station::new(settings(), Some(snapshot), true);
    flight.run(10.0);
    assert_eq!(flight.state(), GatewayState::Stop, "the next flight is free");
    assert!(!flight.station.gateway().snapshot().terminated);
}

#[test]
fn fp_manager_killed_during_the_take_off_holds_once_clear_of_the_ground() {
    let mut flight = Flight::new(16, &[]);
    flight.run_until(20.0, "heard", |f| {
        f.state() == GatewayState::Stop && f.station.gateway().telemetry().gps.is_some()
    });
    assert!(flight.join("plan").accepted);
    assert_eq!(flight.feed(None, vec![take_off()]), FeedAnswer::Accepted);
    flight.ask(GatewayRequest::Launch).unwrap();
    flight.run_until(20.0, "TakeOff", |f| f.state() == GatewayState::TakeOff);
    flight.alive = false;
    flight.run_until(60.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
    let height_m = flight.station.gateway().telemetry().position().unwrap().1.altitude_home_m;
    assert!((40.0..50.0).contains(&height_m), "{height_m}");
}

#[test]
fn a_landing_cancelled_on_the_approach_does_not_circle_for_ever() {
    let mut flight = Flight::new(17, &[]);
    let mut plan = vec![take_off()];
    plan.extend(zigzag(0, 2, 300.0));
    plan.extend(landing());
    flight.launch(plan);
    flight.run_until(900.0, "Approach", |f| f.state() == GatewayState::Approach);
    assert_eq!(flight.feed(Some(5), vec![]), FeedAnswer::Accepted);
    flight.run_until(200.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
}

#[test]
fn alarms_of_the_simulators_faults_reach_the_events() {
    for (fault, id, within_s) in [
        ("gps-loss@90", "gps-lost", 2.0),
        ("engine-out@90", "engine-out", 4.0),
        ("low-battery@90", "energy-low", 3.0),
        ("silence@90+8", "autopilot-silent", 4.0),
    ] {
        let mut flight = Flight::new(10, &[fault]);
        let mut plan = vec![take_off()];
        plan.extend(zigzag(0, 40, 300.0));
        flight.launch(plan);
        let raised = |f: &Flight| {
            f.events.iter().any(|(_, e)| matches!(e, GatewayEvent::AlarmRaised(a) if a.id == id))
        };
        flight.run_until(100.0, id, raised);
        let after_s = flight.now.as_secs_f64() - 90.0;
        assert!((0.0..within_s).contains(&after_s), "{id} after {after_s} s");
    }
}
