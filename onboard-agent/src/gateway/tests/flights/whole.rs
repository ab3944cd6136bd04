//! Gateway, driver and FP Manager together, in lockstep with the simulator and without sockets.

use super::*;
use crate::fp_manager::{Config, Effect, Manager};
use flight_exec::{Command, Event, Executor, Refusal};
use std::collections::VecDeque;
use std::sync::Arc;

/// A plan around the field: out for 3 km, a leg across, and home. `aside_m` moves the end of the leg out to the right.
pub fn plan(aside_m: f64) -> String {
    let place = |ahead_m: f64, right_m: f64| {
        let p = HOME.destination(HEADING_DEG, ahead_m).destination(HEADING_DEG + 90.0, right_m);
        format!(r#"lat="{:.7}" lon="{:.7}""#, p.lat_deg, p.lon_deg)
    };
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<flightPlan xmlns="urn:legwork:flight-plan:1" name="Whole" aircraft="trainer">
  <runways>
    <runway id="R" {threshold} elevation="{GROUND_M}" heading="{HEADING_DEG}" length="600" priority="1"/>
  </runways>
  <mainPlan emergency="home">
    <stage id="to" type="take-off" runway="R" altitude="80" altitudeReference="home"/>
    <stage id="round" type="en-route" altitude="120" altitudeReference="home">
      <TF id="near" {near}/>
      <TF id="out" {out}/>
      <TF id="across" {across}/>
      <TF id="back" {back}/>
      <TF id="final" {last} altitude="70" altitudeReference="home"/>
    </stage>
    <stage id="land" type="land" runway="R"/>
  </mainPlan>
  <emergencyPlans>
    <emergencyPlan id="home" runway="R">
      <stage id="h" type="arrival" altitude="100" altitudeReference="home">
        <DF id="h1" {home}/>
        <TF id="h2" {last} altitude="70" altitudeReference="home"/>
      </stage>
      <stage id="h-land" type="land" runway="R"/>
    </emergencyPlan>
  </emergencyPlans>
</flightPlan>
"#,
        threshold = place(0.0, 0.0),
        near = place(1700.0, 0.0),
        out = place(5000.0, aside_m),
        across = place(5000.0, 2500.0),
        back = place(-1800.0, 900.0),
        last = place(-1200.0, 0.0),
        home = place(-1800.0, -900.0),
    )
}

/// A flight with its FP Manager.
pub struct Whole {
    pub flight: Flight,
    pub manager: Manager,
    /// It does nothing, as if it were stopped.
    pub frozen: bool,
    config: Config,
    /// Events of the gateway that it has heard.
    heard: usize,
    pub happened: Vec<Event>,
}

impl Whole {
    /// On the ground, joined.
    pub fn new(personality: Personality, seed: u64, faults: &[&str]) -> Self {
        Self::over(personality, Arc::new(terrain::Flat(GROUND_M)), seed, faults)
    }

    /// The same, and both know this ground.
    pub fn over(
        personality: Personality,
        terrain: Arc<dyn terrain::Terrain>,
        seed: u64,
        faults: &[&str],
    ) -> Self {
        let mut flight = Flight::on_ground(personality, seed, faults);
        flight.station = station_over(terrain.clone());
        let config = Config { terrain, simulated: true, ..Config::new("test", "") };
        let executor = Executor::new(config.executor.clone(), config.terrain.clone(), config.profile.clone());
        let mut whole = Self {
            flight,
            manager: Manager::new(executor, Time::ZERO),
            frozen: false,
            config,
            heard: 0,
            happened: vec![],
        };
        whole.appeared();
        whole.run_until(30.0, "joined", |w| w.manager.is_joined() && w.flight.state() == GatewayState::Stop);
        whole
    }

    /// In the air on its way along the second leg of such a plan.
    pub fn flying(personality: Personality, seed: u64, faults: &[&str], plan: &str) -> Self {
        let mut whole = Self::new(personality, seed, faults);
        whole.start(plan);
        whole.run_until(200.0, "out", |w| w.entered("out"));
        whole
    }

    /// Off along such a plan.
    pub fn start(&mut self, plan: &str) {
        self.run_until(20.0, "a position", |w| w.flight.station.gateway().telemetry().gps.is_some());
        let commit = self.propose(plan);
        self.command(commit).unwrap();
        self.command(Command::Start).unwrap();
    }

    /// Puts a plan forward; the command that makes it the active one.
    pub fn propose(&mut self, plan: &str) -> Command {
        let config = &self.config;
        let program =
            flight_plan::compile_document(plan.as_bytes(), &config.profile, config.terrain.as_ref()).unwrap();
        let mut effects = vec![];
        let report = self.manager.propose(self.flight.now, program, None, &mut effects).unwrap();
        self.perform(effects);
        self.flight.plan = report.hash.to_string().leak();
        Command::Commit { hash: report.hash, entry: None }
    }

    pub fn command(&mut self, command: Command) -> Result<(), Refusal> {
        let mut effects = vec![];
        let answer = self.manager.command(self.flight.now, command, "operator", None, &mut effects);
        self.perform(effects);
        answer
    }

    /// It was on this leg.
    pub fn entered(&self, leg: &str) -> bool {
        self.happened
            .iter()
            .any(|event| matches!(event, Event::LegEntered { place } if place.leg.as_str() == leg))
    }

    /// The FP Manager notices that the gateway is there.
    pub fn appeared(&mut self) {
        let mut effects = vec![];
        self.manager.gateway_appeared(self.flight.now, &mut effects);
        self.perform(effects);
    }

    /// 100 ms.
    pub fn step(&mut self) {
        self.flight.alive = !self.frozen;
        self.flight.step();
        if self.frozen {
            return;
        }
        let (now, gateway, mut effects) = (self.flight.now, self.flight.station.gateway(), vec![]);
        let manager = &mut self.manager;
        for (_, event) in &self.flight.events[self.heard..] {
            manager.gateway_event(now, event.clone(), &mut effects);
        }
        self.heard = self.flight.events.len();
        manager.gateway_status(now, &gateway.status(now), &mut effects);
        manager.navigation(now, &gateway.navigation(), &mut effects);
        if let Some((_, position)) = gateway.telemetry().position() {
            manager.aircraft().position(position);
        }
        if let Some((_, air)) = gateway.telemetry().air {
            manager.aircraft().air(air);
        }
        if let Some((at, attitude)) = gateway.telemetry().attitude {
            manager.aircraft().attitude(at, attitude);
        }
        manager.tick(now, &mut effects);
        self.perform(effects);
    }

    fn perform(&mut self, effects: Vec<Effect>) {
        let (now, from, mut queue) = (self.flight.now, self.flight.instance, VecDeque::from(effects));
        while let Some(effect) = queue.pop_front() {
            let (station, manager, mut out) = (&mut self.flight.station, &mut self.manager, vec![]);
            match effect {
                Effect::Feed(feed) => match station.ask(now, |id| Input::Feed(id, feed, from)) {
                    Some(Answer::Feed(answer)) => manager.fed(now, Some(answer), &mut out),
                    other => panic!("{other:?}"),
                },
                Effect::Join(join) => match station.ask(now, |id| Input::Join(id, join, from)) {
                    Some(Answer::Join(answer)) => manager.joined(now, Some(answer), &mut out),
                    other => panic!("{other:?}"),
                },
                Effect::Request(request) => {
                    let asked = request.clone();
                    match station.ask(now, |id| Input::Request(id, asked)) {
                        Some(Answer::Request(answer)) => manager.requested(now, &request, answer, &mut out),
                        other => panic!("{other:?}"),
                    }
                }
                Effect::Event(event) => self.happened.push(event),
                Effect::Invoke { .. } | Effect::Record(_) | Effect::Keep(_) | Effect::Sync => {}
            }
            queue.extend(out);
        }
    }

    pub fn run_until(&mut self, seconds: f64, what: &str, mut done: impl FnMut(&Self) -> bool) {
        let end = self.flight.now + Duration::from_secs_f64(seconds);
        while !done(self) {
            let (events, report) = (&self.happened, || self.flight.report());
            assert!(self.flight.now < end, "{what}: not within {seconds} s; {}\n{events:?}", report());
            self.step();
        }
    }

    pub fn run(&mut self, seconds: f64) {
        let end = self.flight.now + Duration::from_secs_f64(seconds);
        while self.flight.now < end {
            self.step();
        }
    }
}

/// Simulated seconds until it is so.
fn takes_s(whole: &mut Whole, what: &str, done: impl FnMut(&Whole) -> bool) -> f64 {
    let since = whole.flight.now;
    whole.run_until(60.0, what, done);
    (whole.flight.now - since).as_secs_f64()
}

const PERSONALITIES: [Personality; 2] = [Personality::ArduPlane, Personality::Px4];

#[test]
fn an_fp_manager_that_is_frozen_is_followed_by_safe_hold_at_t1_and_is_back_within_2_s_of_its_return() {
    for personality in PERSONALITIES {
        let mut whole = Whole::flying(personality, 91, &[], &plan(0.0));
        let t1_s = SafeParameters::default().t1_s;
        whole.frozen = true;
        let held_s = takes_s(&mut whole, "Safe.Hold", |w| w.flight.state() == GatewayState::SafeHold);
        assert!(held_s <= t1_s + 0.2, "{personality}: Safe.Hold after {held_s:.1} s");
        whole.run(8.0);
        whole.frozen = false;
        let back_s = takes_s(&mut whole, "Nav", |w| w.flight.state() == GatewayState::Nav);
        assert!(back_s <= 2.0, "{personality}: back in its place after {back_s:.1} s");
        whole.run_until(400.0, "the way goes on", |w| w.entered("back"));
        let passes = |leg: &str| {
            let entered = |e: &&Event| matches!(e, Event::LegEntered { place } if place.leg.as_str() == leg);
            whole.happened.iter().filter(entered).count()
        };
        assert_eq!((passes("out"), passes("across")), (1, 1), "{personality}");
    }
}

#[test]
fn a_gateway_that_comes_back_alone_is_joined_within_2_s_and_nothing_runs_dry() {
    for personality in PERSONALITIES {
        let mut whole = Whole::flying(personality, 92, &[], &plan(0.0));
        whole.flight.station = station(Some(whole.flight.station.gateway().snapshot()));
        whole.appeared();
        let joined =
            |w: &Whole| w.manager.is_joined() && w.flight.state() == GatewayState::Nav && w.flight.alive;
        let back_s = takes_s(&mut whole, "joined in flight", joined);
        assert!(back_s <= 2.0, "{personality}: joined after {back_s:.1} s");
        whole.run_until(400.0, "the way goes on", |w| w.entered("back"));
        let states: Vec<_> = whole.flight.changes().into_iter().map(|(_, state)| state).collect();
        assert!(!states.contains(&GatewayState::SafeHold), "{personality}: it ran dry: {states:?}");
    }
}
