//! Whole flights: core, window and driver against the simulator's pure core, without sockets.

use super::fp_manager;
use crate::gateway::Station;
use crate::gateway::core::{Answer, Input, Settings, Snapshot};
use crate::gateway::driver::{self, FromLink, Setup};
use crate::gateway::order::Time;
use autopilot_link::Outbox;
use geometry::LatLon;
use sim::Personality;
use sim::core::{Peer, Simulator};
use std::sync::Arc;
use std::time::Duration;
use terrain::Terrain;
use usal::Instance;
use usal::contract::*;

/// At the other end of the first link, and of the second.
const PEERS: [Peer; 2] = [Peer(1), Peer(2)];
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
    /// Its session, if it says so.
    pub instance: Option<Instance>,
    /// It says in them that it flies this plan.
    pub plan: &'static str,
    /// So many were sent by its process.
    pub beats: u64,
    /// Entries of the autopilot's list that it steered to, with the place at that time.
    pub steered: Vec<LatLon>,
    /// Another link, beside the one in use.
    slower: Option<two_links::Slower>,
    /// A second link as good as the first: what is sent over it.
    second: Option<sim::frame::Decoder>,
    /// Links over which nothing comes and goes.
    cut: Vec<usize>,
    /// The radio, to us and to the autopilot, if it carries no more than so much.
    narrow: Option<[narrow::Radio; 2]>,
    outbox: Outbox,
    sim_decoder: sim::frame::Decoder,
    /// Number of the next waypoint.
    pub next: u64,
}

pub fn settings() -> Settings {
    Settings {
        vehicle: "test".into(),
        profile: aircraft::Profile::default(),
        terrain: None,
        exposed: false,
        replay: false,
    }
}

/// A station that starts, in lockstep with the simulator.
pub fn station(restored: Option<Snapshot>) -> Station {
    Station::new(settings(), restored, (driver::DEFAULT.make)(&Setup { lockstep: true, ..Setup::default() }))
}

/// The same, of a gateway that knows the ground.
pub fn station_over(terrain: Arc<dyn Terrain>) -> Station {
    let settings = Settings { terrain: Some(terrain), ..settings() };
    Station::new(settings, None, (driver::DEFAULT.make)(&Setup { lockstep: true, ..Setup::default() }))
}

impl Flight {
    pub fn new(seed: u64, faults: &[&str]) -> Self {
        Self::of(Personality::ArduPlane, seed, faults)
    }

    /// With another autopilot.
    pub fn of(personality: Personality, seed: u64, faults: &[&str]) -> Self {
        let config = sim::Config::default();
        let wind = aircraft::Wind::from_direction(270.0, 5.0);
        let mut sim = Simulator::of(personality, config.profile, config.home, wind, seed);
        sim.connect(PEERS[0]);
        for fault in faults {
            assert!(sim.inject(fault.parse().unwrap()));
        }
        Self {
            sim,
            station: station(None),
            now: Time::ZERO,
            events: vec![],
            alive: true,
            instance: fp_manager(),
            plan: "plan",
            beats: 0,
            steered: vec![],
            slower: None,
            second: None,
            cut: vec![],
            narrow: None,
            outbox: Outbox::default(),
            sim_decoder: sim::frame::Decoder::default(),
            next: 1,
        }
    }

    /// 100 ms. What the simulator answers comes with the next step.
    pub fn step(&mut self) {
        self.sim.step();
        self.sim.ask_time();
        self.now = Duration::from_nanos(self.sim.now_ns());
        let mut step = None;
        for (link, bytes) in self.arriving() {
            self.station.receive(link, FromLink::Stream(&bytes));
            while let Some(asked) = self.station.process(self.now) {
                step = Some(asked);
            }
            self.slower.iter_mut().for_each(|slower| slower.hear(self.now, &bytes));
        }
        while let Some(bytes) = self.slower.as_mut().and_then(|slower| slower.next(self.now)) {
            self.station.receive(1, FromLink::Stream(&bytes));
            while self.station.process(self.now).is_some() {}
        }
        if self.alive && self.now.as_millis().is_multiple_of(500) {
            self.beats += 1;
            let (count, plan) = (self.beats, Some(self.plan.into()));
            let from = self.instance;
            self.station.input(self.now, Input::Heartbeat { count, plan, from });
        }
        self.station.tick(self.now);
        self.station.answer_step(step.expect("every step asks for the time"));
        self.pass_on();
        let now_s = self.now.as_secs_f64();
        self.events.extend(self.station.take_events().into_iter().map(|e| (now_s, e)));
        self.watch_target();
    }

    /// What comes in this step, and over which link.
    fn arriving(&mut self) -> Vec<(usize, Vec<u8>)> {
        let sent = self.sim.take_outgoing().into_iter();
        let over = sent.map(|outgoing| (usize::from(outgoing.to == PEERS[1]), outgoing.bytes));
        let over = over.filter(|(link, _)| !self.cut.contains(link)).collect();
        match &mut self.narrow {
            Some([to_us, _]) => to_us.pass(over),
            None => over,
        }
    }

    fn pass_on(&mut self) {
        self.outbox.clear();
        self.station.send(&mut self.outbox);
        let decoders = [Some(&mut self.sim_decoder), self.second.as_mut()];
        for (link, (peer, decoder)) in PEERS.into_iter().zip(decoders).enumerate() {
            let Some(decoder) = decoder.filter(|_| !self.cut.contains(&link)) else { continue };
            let sent = self.outbox.frames_over(link).map(|bytes| (link, bytes.to_vec())).collect();
            let arriving = match &mut self.narrow {
                Some([_, to_it]) => to_it.pass(sent),
                None => sent,
            };
            for (_, bytes) in arriving {
                decoder.push(&bytes);
                for frame in sim::frame::take_frames(decoder) {
                    self.sim.receive(peer, frame);
                }
            }
        }
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
        self.join_knowing(plan, self.next - 1)
    }

    /// It has given out waypoints up to this one.
    pub fn join_knowing(&mut self, plan: &str, last_token: u64) -> JoinAnswer {
        self.join_after(&[], plan, last_token)
    }

    /// It flew other plans before, in this flight.
    pub fn join_after(&mut self, earlier: &[&str], plan: &str, last_token: u64) -> JoinAnswer {
        let earlier = earlier.iter().map(|&plan| plan.into()).collect();
        let join = Join { plan: Some(plan.into()), earlier, last_token: Token(last_token) };
        let from = self.instance;
        match self.station.ask(self.now, |id| Input::Join(id, join, from)) {
            Some(Answer::Join(answer)) => answer,
            other => panic!("{other:?}"),
        }
    }

    pub fn feed(&mut self, cancel_after: Option<u64>, mut waypoints: Vec<Waypoint>) -> FeedAnswer {
        for w in &mut waypoints {
            w.token = Token(self.next);
            self.next += 1;
        }
        let (feed, from) = (Feed { cancel_after: cancel_after.map(Token), waypoints }, self.instance);
        match self.station.ask(self.now, |id| Input::Feed(id, feed, from)) {
            Some(Answer::Feed(answer)) => answer,
            other => panic!("{other:?}"),
        }
    }

    pub fn progress(&self) -> Vec<Option<u64>> {
        let token = |e: &(f64, GatewayEvent)| match e.1 {
            GatewayEvent::Progress { current, .. } => Some(current.map(|t| t.0)),
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

    /// On the way home, as the FP Manager died.
    pub fn in_safe_return(seed: u64) -> Self {
        let mut flight = Self::on_zigzag(seed, &[], 30, 300.0);
        flight.store_runway();
        flight.run(60.0);
        flight.alive = false;
        flight.run_until(40.0, "Safe.Return", |f| f.state() == GatewayState::SafeReturn);
        flight.run(5.0);
        flight
    }

    /// Another process of the FP Manager, which has not joined.
    pub fn restart_fp_manager(&mut self, plan: &'static str) {
        (self.alive, self.plan, self.beats) = (true, plan, 0);
        self.run(2.0);
    }

    /// In the air on its way along a zigzag of `count` waypoints, `metres` apart.
    pub fn on_zigzag(seed: u64, faults: &[&str], count: usize, metres: f64) -> Self {
        let mut flight = Self::new(seed, faults);
        flight.launch(std::iter::once(take_off()).chain(zigzag(0, count, metres)).collect());
        flight
    }

    /// The same on either autopilot.
    pub fn in_flight(personality: Personality, seed: u64) -> Self {
        let mut flight = Self::on_ground(personality, seed, &[]);
        flight.launch(std::iter::once(take_off()).chain(zigzag(0, 30, 300.0)).collect());
        flight.run(20.0);
        flight
    }

    /// Either autopilot before a launch, able to fly a list without a landing.
    pub fn on_ground(personality: Personality, seed: u64, faults: &[&str]) -> Self {
        let mut flight = Self::of(personality, seed, faults);
        let is_px4 = personality != Personality::ArduPlane;
        assert!(!is_px4 || flight.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0));
        // it is asked for that parameter first
        flight.run(5.0);
        flight
    }

    /// Tells the gateway of the runway at home.
    pub fn store_runway(&mut self) {
        self.ask(GatewayRequest::SetRunways { runways: vec![runway_at(HOME)] }).unwrap();
    }

    /// It has been steered to this waypoint or to one after it.
    pub fn has_reached(&self, token: u64) -> bool {
        self.progress().iter().flatten().any(|t| *t >= token)
    }

    /// On the ground, with the first waypoints of a plan.
    pub fn load(&mut self, waypoints: Vec<Waypoint>) {
        self.run_until(20.0, "heard", |f| {
            f.state() == GatewayState::Stop && f.station.gateway().telemetry().gps.is_some()
        });
        assert!(self.join("plan").accepted);
        assert_eq!(self.feed(None, waypoints), FeedAnswer::Accepted);
    }

    /// On the ground with a plan aboard, then in the air on its way to waypoint 2.
    pub fn launch(&mut self, waypoints: Vec<Waypoint>) {
        self.load(waypoints);
        self.ask(GatewayRequest::Launch).unwrap();
        self.run_until(120.0, "launch", |f| f.state() == GatewayState::Nav);
    }
}

pub fn runway_at(threshold: LatLon) -> SafeRunway {
    SafeRunway {
        id: "R05".into(),
        threshold,
        elevation_amsl_m: GROUND_M,
        heading_deg: HEADING_DEG,
        length_m: 600.0,
        priority: 1,
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
        on_arc: false,
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

mod aftermath;
mod alternate;
mod by_hand;
mod circle;
mod climb_out;
mod corners;
mod disarmed;
mod ended;
mod faulted;
mod faults;
mod foretold;
mod gliding;
mod late;
mod met_in_flight;
mod million;
mod misfortunes;
mod narrow;
mod off_path;
mod px4;
mod refused;
mod replaced;
mod runways;
mod strangers;
mod taken_over;
mod tests;
mod two_links;
mod uploaded;
mod whole;
