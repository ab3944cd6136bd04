//! A thousand deaths: a flight whose FP Manager dies at random bytes and instants, over a disk that keeps what was
//! synced and a random part of the rest, beside the same flight undisturbed.

mod asks;
mod gateway;
mod gateway_faults;
mod two_flights;

use crate::fp_manager::journal::faulty::{Death, Faulty, Random};
use crate::fp_manager::journal::{Job, Limits, Log, Saved, Storage, Writer, encode};
use crate::fp_manager::{Config, Effect, Manager, compile, restart};
use asks::{Ask, What, asks};
use flight_exec::{Command, Event, Refusal};
use gateway::Gateway;
use service::Time;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use terrain::Flat;
use usal::contract::{GatewayState, LatLon, Waypoint};
use wire::Convert;

const KILLS: u64 = 1000;
/// Segments are short, so that many deaths fall on a change of segments.
const LIMITS: Limits = Limits { turns: 20, bytes: 64 << 10, bytes_max: 1 << 20, plans: 8 };
/// A flight that takes longer does not end.
const STEPS_MAX: usize = 2000;

fn config() -> Config {
    Config { terrain: Arc::new(Flat(322.0)), simulated: true, ..Config::new("uav1", "") }
}

struct Process {
    manager: Manager,
    writer: Writer<Faulty>,
}

/// The process died.
#[derive(Debug)]
struct Dead;

struct Flight {
    disk: Faulty,
    config: Config,
    process: Process,
    gateway: Gateway,
    asks: VecDeque<Ask>,
    proposed: Option<Arc<str>>,
    answered: BTreeMap<String, Result<(), Refusal>>,
    since_answer: usize,
    time: Time,
    random: Random,
    deadly: bool,
    kills: u64,
    events: Vec<Event>,
    /// States after the latest turns; the last turn that was written, and the last that was synced for sure.
    history: VecDeque<(u64, Saved)>,
    turn: u64,
    written: u64,
    synced: u64,
}

fn begin(disk: &Faulty, config: &Config) -> (Process, Vec<String>) {
    let (mut log, found) = Log::open(disk.clone(), LIMITS);
    let past = restart(&mut log, found.as_deref().unwrap_or_default(), config, Time::ZERO);
    (Process { manager: past.manager, writer: Writer::new(log, None) }, past.troubles)
}

impl Flight {
    fn new(seed: u64, deadly: bool, emergency: bool) -> Self {
        let (disk, config) = (Faulty::default(), config());
        let (process, _) = begin(&disk, &config);
        let mut flight = Self {
            disk,
            config,
            history: VecDeque::from([(0, process.manager.saved().0)]),
            process,
            gateway: Gateway::new(LatLon::new(36.4905, -84.2710)),
            asks: asks(emergency),
            proposed: None,
            answered: BTreeMap::new(),
            since_answer: 0,
            time: Time::ZERO,
            random: Random(seed),
            deadly,
            kills: 0,
            events: Vec::new(),
            turn: 0,
            written: 0,
            synced: 0,
        };
        flight.hand_in_state();
        flight.light_fuse();
        flight
    }

    /// Most deaths come soon, some late, so that every kind of instant has its share.
    fn light_fuse(&mut self) {
        if self.deadly {
            let most = [300, 3_000, 30_000, 100_000][self.random.below(4) as usize];
            self.disk.light_fuse(1 + self.random.below(most));
        }
    }

    fn hand_in_state(&mut self) {
        let (saved, plans) = self.process.manager.state_to_keep();
        self.process.writer.perform(self.time, vec![Job::State(Box::new(saved), plans)]);
        if self.alive().is_ok() {
            self.all_is_synced();
        }
    }

    fn all_is_synced(&mut self) {
        self.synced = self.turn;
        self.history.retain(|(turn, _)| *turn >= self.synced);
    }

    fn alive(&self) -> Result<(), Dead> {
        if self.disk.is_dead() { Err(Dead) } else { Ok(()) }
    }

    /// A turn as the shell does it: recorded first, then carried out.
    fn perform(&mut self, effects: Vec<Effect>) -> Result<(), Dead> {
        let mut queue = VecDeque::from(effects);
        while !queue.is_empty() {
            let turn = std::mem::take(&mut queue).into_iter().collect();
            for effect in self.record(turn)? {
                self.disk.survives().then_some(()).ok_or(Dead)?;
                queue.extend(self.carry_out(effect));
            }
        }
        if self.process.writer.report(self.time).wants_state {
            self.hand_in_state();
        }
        self.alive()
    }

    fn record(&mut self, effects: Vec<Effect>) -> Result<Vec<Effect>, Dead> {
        let (mut jobs, mut entries, mut others, mut sync) = (Vec::new(), Vec::new(), Vec::new(), false);
        for effect in effects {
            match effect {
                Effect::Record(entry) => entries.push(entry),
                Effect::Keep(program) => jobs.push(Job::Plan(program)),
                Effect::Sync => sync = true,
                other => others.push(other),
            }
        }
        if entries.is_empty() {
            return Ok(others);
        }
        self.turn += 1;
        self.history.push_back((self.turn, self.process.manager.saved().0));
        jobs.push(Job::Turn { payload: encode(&entries).unwrap(), sync });
        self.process.writer.perform(self.time, jobs);
        self.alive()?;
        self.written = self.turn;
        if sync {
            self.all_is_synced();
        }
        Ok(others)
    }

    fn carry_out(&mut self, effect: Effect) -> Vec<Effect> {
        let (now, manager, mut out) = (self.time, &mut self.process.manager, Vec::new());
        match effect {
            Effect::Feed(feed) => {
                let answer = self.gateway.feed(feed);
                if self.disk.survives() {
                    manager.fed(now, Some(answer), &mut out);
                }
            }
            Effect::Join(join) => {
                let answer = self.gateway.join(join);
                if self.disk.survives() {
                    manager.joined(now, Some(answer), &mut out);
                }
            }
            Effect::Request(request) => {
                let answer = self.gateway.request(&request);
                if self.disk.survives() {
                    manager.requested(now, &request, answer, &mut out);
                }
            }
            Effect::Event(event) => self.events.push(event),
            Effect::Invoke { .. } => {}
            Effect::Record(_) | Effect::Keep(_) | Effect::Sync => unreachable!("recorded before"),
        }
        out
    }

    /// Something reaches the process. If it dies of it, the next one goes on, and this is not repeated.
    fn with_manager(&mut self, what: impl FnOnce(&mut Manager, Time, &mut Vec<Effect>)) {
        let mut effects = Vec::new();
        what(&mut self.process.manager, self.time, &mut effects);
        if self.perform(effects).is_err() {
            self.revive();
        }
    }

    /// The next process, and the next, should it die while it comes back.
    fn revive(&mut self) {
        loop {
            self.kills += 1;
            let death = if self.random.below(2) == 0 { Death::Kill } else { Death::PowerLoss };
            self.disk.reboot(death, &mut self.random);
            let (process, troubles) = begin(&self.disk, &self.config);
            assert_eq!(troubles, Vec::<String>::new());
            self.process = process;
            self.expect_same_place(death);
            self.enter_safe();
            self.light_fuse();
            self.hand_in_state();
            if self.alive().is_ok() && self.come_back().is_ok() {
                return;
            }
        }
    }

    /// The gateway does not always wait for the next process.
    fn enter_safe(&mut self) {
        use GatewayState::{Hold, Nav, SafeHold};
        if !matches!(self.gateway.state, Nav | Hold | SafeHold) {
            return;
        }
        let ahead = self.process.manager.executor().ahead().next().map(|w| w.token);
        // on its way home it has no waypoints that would say what was flown without a report
        let all_heard = ahead == self.gateway.navigation().current.convert();
        match self.random.below(4) {
            0 => self.gateway.safe_hold(),
            1 if all_heard => self.gateway.safe_return(),
            _ => {}
        }
    }

    /// Exactly a state that was, and not one before anything that had taken effect.
    fn expect_same_place(&mut self, death: Death) {
        let now = self.process.manager.saved().0;
        let least = if death == Death::Kill { self.written } else { self.synced };
        let found = self.history.iter().rev().find(|(turn, saved)| *turn >= least && *saved == now);
        let Some(turn) = found.map(|(turn, _)| *turn) else {
            let near: Vec<_> = self.history.iter().map(|(turn, saved)| (turn, *saved == now)).collect();
            panic!("after {death:?} in turn {}, at least turn {least} must be there: {near:?}", self.turn);
        };
        self.history.retain(|(t, _)| *t <= turn);
        (self.turn, self.written) = (turn, turn);
    }

    fn come_back(&mut self) -> Result<(), Dead> {
        let (status, mut effects) = (self.gateway.status(), Vec::new());
        let (now, manager) = (self.time, &mut self.process.manager);
        manager.aircraft().position(self.gateway.position());
        manager.tick(now, &mut effects);
        manager.gateway_appeared(now, &mut effects);
        manager.gateway_status(now, &status, &mut effects);
        self.perform(effects)
    }

    fn step(&mut self) {
        self.time += Time::from_millis(500);
        self.gateway.fly();
        while let Some(event) = self.gateway.events.pop_front() {
            self.with_manager(|manager, now, out| manager.gateway_event(now, event, out));
        }
        let (status, navigation, position) =
            (self.gateway.status(), self.gateway.navigation(), self.gateway.position());
        self.with_manager(|manager, now, out| manager.gateway_status(now, &status, out));
        self.with_manager(|manager, now, out| manager.navigation(now, &navigation, out));
        self.with_manager(|manager, now, out| {
            manager.aircraft().position(position);
            manager.tick(now, out);
        });
        self.ask();
        self.since_answer += 1;
    }

    /// The client repeats its request under the same name until it is answered.
    fn ask(&mut self) {
        // a waypoint that was flown without a report is flown again
        let flown = self.path().len();
        let due = |ask: &Ask| flown >= ask.flown && self.since_answer >= ask.steps;
        let Some(ask) = self.asks.pop_front_if(|ask| due(ask)) else { return };
        let id = format!("request-{}", self.asks.len());
        while self.ask_once(&ask.what, &id).is_err() {
            self.revive();
        }
        self.since_answer = 0;
    }

    fn ask_once(&mut self, what: &What, id: &str) -> Result<(), Dead> {
        let (now, mut effects) = (self.time, Vec::new());
        let manager = &mut self.process.manager;
        let command = match what {
            What::Propose(xml) => {
                let program = compile(xml.as_bytes(), &self.config).unwrap();
                let report = manager.propose(now, program, None, &mut effects).unwrap();
                self.perform(effects)?;
                self.proposed = Some(report.hash);
                return Ok(());
            }
            What::Alarm(cause) => {
                self.gateway.alarm("energy-low", *cause);
                self.gateway
                    .events
                    .drain(..)
                    .for_each(|event| manager.gateway_event(now, event, &mut effects));
                if self.perform(effects).is_err() {
                    self.revive();
                    // the event is gone for good: the gateway's state says so too
                    let status = self.gateway.status();
                    self.with_manager(|manager, now, out| manager.gateway_status(now, &status, out));
                }
                return Ok(());
            }
            What::Commit => Command::Commit { hash: self.proposed.clone().unwrap(), entry: None },
            What::Command(command) => command.clone(),
        };
        let answer = manager.command(now, command.clone(), "operator", Some(id), &mut effects);
        self.perform(effects)?;
        assert_eq!(answer, Ok(()), "{id}");
        let repeated = self.process.manager.command(now, command, "operator", Some(id), &mut Vec::new());
        assert_eq!(self.answered.entry(id.to_owned()).or_insert(answer), &repeated);
        Ok(())
    }

    fn fly(mut self) -> Self {
        for _ in 0..STEPS_MAX {
            if self.gateway.finished() {
                for _ in 0..3 {
                    self.step();
                }
                return self;
            }
            self.step();
        }
        panic!("it never lands: {:?}", self.path());
    }

    /// What was flown, each waypoint once.
    fn path(&self) -> Vec<String> {
        let line = |w: &Waypoint| format!("{} {:.6} {:.6}", w.leg, w.position.lat_deg, w.position.lon_deg);
        let mut path: Vec<String> = self.gateway.flown.iter().map(line).collect();
        path.dedup();
        path
    }

    fn variables(&self) -> String {
        format!("{:?}", self.process.manager.executor().variables())
    }
}

/// What happened once; of an event that measures, only what it is about.
fn happened(events: &[Event]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for event in events {
        let key = match event {
            Event::LegEntered { place } => {
                format!("leg {} {:?} {:?}", place.leg, place.plan, place.iterations)
            }
            Event::DecisionRequested(request) => format!("asked {}", request.leg),
            other => format!("{other:?}"),
        };
        *counts.entry(key).or_default() += 1;
    }
    counts
}

fn expect_as_undisturbed(killed: &Flight, undisturbed: &Flight) {
    let (path, other) = (killed.path(), undisturbed.path());
    let differs = path.iter().zip(&other).position(|(a, b)| a != b);
    let from = differs.unwrap_or(path.len().min(other.len())).saturating_sub(2);
    let rest = |path: &[String]| path.iter().skip(from).take(6).cloned().collect::<Vec<_>>();
    assert_eq!(rest(&path), rest(&other), "flown, from waypoint {from}");
    assert_eq!(killed.variables(), undisturbed.variables());
    assert_eq!(killed.gateway.launches(), 1);
    let (once, ever) = (happened(&undisturbed.events), happened(&killed.events));
    for (event, count) in ever {
        assert!(count <= once.get(&event).copied().unwrap_or(0), "{count} times {event}");
    }
}

#[test]
fn a_thousand_deaths_change_nothing_of_a_flight() {
    let seed = std::env::var("LEGWORK_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20261);
    let undisturbed = [false, true].map(|emergency| Flight::new(seed, false, emergency).fly());
    let (mut kills, mut flights) = (0, 0);
    while kills < KILLS {
        let (seed, emergency) = (seed + flights, flights % 3 == 2);
        println!("LEGWORK_SEED={seed} begins flight {flights}, {kills} deaths so far");
        let flight = Flight::new(seed, true, emergency).fly();
        expect_as_undisturbed(&flight, &undisturbed[usize::from(emergency)]);
        kills += flight.kills;
        flights += 1;
    }
    println!("{kills} deaths in {flights} flights, first seed {seed}");
}

#[test]
fn killed_while_the_disk_was_full_it_holds_and_says_that_its_place_is_not_known() {
    let mut flight = Flight::new(1, false, false);
    while flight.gateway.flown.len() < 9 {
        flight.step();
    }
    flight.disk.limit(flight.disk.size());
    while flight.gateway.flown.len() < 20 {
        flight.step();
    }
    flight.disk.repair();
    flight.disk.reboot(Death::Kill, &mut Random(1));
    let (process, troubles) = begin(&flight.disk, &flight.config);
    assert_eq!(troubles.len(), 1, "{troubles:?}");
    flight.process = process;
    flight.events.clear();
    flight.hand_in_state();
    flight.come_back().unwrap();
    assert_eq!(flight.gateway.state, GatewayState::Hold);
    let told = |event: &Event| matches!(event, Event::NotJournalled { reason } if reason.contains("place"));
    assert_eq!(flight.events.iter().filter(|e| told(e)).count(), 1, "{:?}", flight.events);
    for _ in 0..5 {
        flight.step();
    }
    assert_eq!(flight.gateway.flown.len(), 20);
    flight.asks.clear();
    flight.ask_once(&What::Command(Command::Resume), "resume").unwrap();
    flight.fly();
}

#[test]
fn disk_never_grows_without_bound() {
    let flight = Flight::new(1, false, false).fly();
    let mut disk = flight.disk.clone();
    let names = disk.names().unwrap();
    assert!(names.iter().filter(|name| name.starts_with("segment")).count() <= 2, "{names:?}");
    assert!(names.iter().filter(|name| name.starts_with("plan")).count() <= 2, "{names:?}");
    assert!(flight.turn > 5 * u64::from(LIMITS.turns), "{} turns are too few to tell", flight.turn);
}
