//! One flight: a random plan, a simple aircraft, a gateway with faults, and whatever people and services may do.
//!
//! A flight is repeatable: its seed and the number of happenings give the same trace. After the last happening it is left
//! alone, helped where it asks for help, until it ends.

use crate::grid::{GROUND_M, HOME};
use crate::plans::Draft;
use crate::random::Random;
use crate::trace::{Moment, Seen, Stimulus, Trace};
use aircraft::Profile;
use flight_exec::{
    Action, AircraftState, Command, Config, Executor, Input, Output, Phase, RequestId, Snapshot, Time, Token,
    Waypoint,
};
use flight_plan::{Cause, Id, LegKind, Program, VariableValue};
use geometry::LatLon;
use std::collections::VecDeque;
use std::sync::Arc;
use terrain::Flat;

/// Over the ground: no wind.
pub const SPEED_MPS: f64 = 25.0;
/// Waypoints after which a flight left alone must have ended: four nested passes of the largest plan are half of it.
const MAX_WAYPOINTS: usize = 60_000;
/// Inputs for which an executor that was not killed is asked as well.
const TWIN_INPUTS: usize = 12;

const CAUSES: [Cause; 7] =
    [Cause::Operator, Cause::Payload, Cause::Traffic, Cause::Link, Cause::Gps, Cause::Energy, Cause::Engine];

pub struct Flight {
    random: Random,
    executor: Executor,
    twin: Option<(Executor, usize)>,
    plans: Vec<Arc<Program>>,
    ids: Vec<Id>,
    now: Time,
    buffer: VecDeque<Waypoint>,
    /// The waypoint that the executor was told to be steered to.
    told: Option<Token>,
    position: LatLon,
    altitude_amsl_m: f64,
    reported: Option<AircraftState>,
    gateway_controls: bool,
    refuses_next: bool,
    requests: u64,
    trace: Trace,
}

/// The flight of a seed, cut short after so many happenings.
pub fn fly(seed: u64, most_happenings: usize) -> Trace {
    let mut flight = Flight::new(seed);
    let happenings = (5 + flight.random.below(50)).min(most_happenings);
    for _ in 0..happenings {
        flight.happen();
    }
    flight.fly_out();
    flight.trace
}

impl Flight {
    fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let (draft, main) = Draft::flyable(&mut random, Draft::new);
        let draw = |r: &mut Random| if r.percent(70) { draft.edited(r) } else { Draft::new(r) };
        let (_, other) = Draft::flyable(&mut random, draw);
        let plans = vec![main, other];
        let ids = plans.iter().flat_map(|p| p.flown().all_legs().into_iter().map(|c| c.leg.id.clone()));
        let ids = ids
            .chain(["m".into(), "land".into(), "to2".into(), "m2".into(), "b-df".into(), "nowhere".into()])
            .collect();
        let executor = Executor::new(Config::default(), Arc::new(Flat(GROUND_M)), Profile::default());
        let start = seen(&executor, &VecDeque::new(), None, false);
        let mut flight = Self {
            random,
            executor,
            twin: None,
            plans,
            ids,
            now: Time::ZERO,
            buffer: VecDeque::new(),
            told: None,
            position: HOME,
            altitude_amsl_m: GROUND_M,
            reported: None,
            gateway_controls: false,
            refuses_next: false,
            requests: 0,
            trace: Trace { start, moments: Vec::new(), left_alone: usize::MAX },
        };
        flight.report();
        flight.update(0);
        flight.command(Command::Start);
        flight
    }

    // ---- what happens -------------------------------------------------------------------------------------------

    fn happen(&mut self) {
        match self.random.below(46) {
            0..8 => self.fly_some(),
            8..14 => self.approach(),
            14..28 => self.order(),
            28..30 => self.update_somehow(),
            30 if self.random.percent(50) => self.count_and_come_back(),
            30 => self.propose_only(),
            31 => self.command_twice(),
            32..34 => self.wait(),
            34..36 => self.restart(),
            36 => self.refuse(),
            37 => self.lose_progress(),
            38 => self.leap(),
            39 => self.strange_progress(),
            40 => self.lose_control(),
            41 => self.give_control_back(),
            42 => self.garbage(),
            43 => self.jump_aside(),
            44 => self.stand_still(),
            _ => self.unhold(),
        }
    }

    fn fly_some(&mut self) {
        for _ in 0..1 + self.random.below(10) {
            if !self.fly_one() {
                break;
            }
        }
    }

    /// Near to the waypoint steered to, so that stopping distance and deadlines matter.
    fn approach(&mut self) {
        let left_m = self.random.between(1.0, 900.0);
        let Some(front) = self.steered_to().map(|w| w.position) else { return self.wait() };
        let way_m = self.position.distance_m(front) - left_m;
        if way_m > 0.0 {
            self.position = self.position.destination(self.position.bearing_deg(front), way_m);
            self.pass_time(way_m / SPEED_MPS);
        }
        self.report();
    }

    fn order(&mut self) {
        let command = self.any_command();
        self.command(command);
    }

    /// Of the plan being flown, mostly.
    fn any_leg(&mut self) -> Id {
        let program = self.executor.program().filter(|_| self.random.percent(70));
        let flown = program.map(|p| Vec::from_iter(p.flown().all_legs().iter().map(|c| c.leg.id.clone())));
        self.random.pick(flown.as_ref().unwrap_or(&self.ids))
    }

    fn any_command(&mut self) -> Command {
        let id = self.any_leg();
        match self.random.below(26) {
            24 | 25 => self.count(),
            0 | 1 => Command::Hold,
            2 | 3 => Command::Resume,
            4 => Command::SkipLeg,
            5 | 6 => Command::GoTo { leg: id },
            7 | 8 => self.count(),
            9..13 => self.decision(),
            13..18 => self.write(),
            18 | 19 => self.emergency(),
            20 => Command::ReturnToMain { leg: id },
            21 => Command::Start,
            22 if self.random.percent(50) => Command::AbortToSafe,
            22 => Command::Commit { hash: "abc".into(), entry: None },
            _ => Command::GoTo { leg: id },
        }
    }

    fn emergency(&mut self) -> Command {
        let plan = self.random.pick(&[None, None, None, Some("back"), Some("other"), Some("none")]);
        Command::Emergency { cause: self.random.pick(&CAUSES), plan: plan.map(Id::new) }
    }

    fn count(&mut self) -> Command {
        let place = self.executor.status().place;
        let around: Vec<Id> = place.iter().flat_map(|p| &p.iterations).map(|i| i.leg.clone()).collect();
        let elsewhere = around.is_empty() || self.random.percent(20);
        let around = if elsewhere { vec!["m".into()] } else { around };
        Command::SetCount { leg: self.random.pick(&around), count: self.random.below(6) as u64 }
    }

    /// For the question asked, for one ahead, for one in the past, or for none.
    fn decision(&mut self) -> Command {
        let asked = self.executor.status().decision.map(|d| d.leg);
        let forks = self.ids.iter().filter(|id| {
            let leg = self.plans.iter().find_map(|p| p.leg(id));
            matches!(leg.map(|l| &l.kind), Some(LegKind::Intersection { .. }))
        });
        let mut legs: Vec<Id> = forks.cloned().chain(asked.clone()).chain(asked).collect();
        legs.extend(self.random.percent(10).then(|| self.random.pick(&self.ids)));
        let leg = if legs.is_empty() { Id::new("nowhere") } else { self.random.pick(&legs) };
        let kind = self.plans.iter().find_map(|p| p.leg(&leg)).map(|l| &l.kind);
        let mut names: Vec<Id> = match kind {
            Some(LegKind::Intersection { branches, .. }) => branches.iter().map(|b| b.id.clone()).collect(),
            _ => Vec::new(),
        };
        names.extend_from_within(..);
        names.push("x".into());
        Command::Decide { leg, branch: self.random.pick(&names) }
    }

    fn write(&mut self) -> Command {
        use VariableValue as V;
        let (r, n) = (self.random.between(0.0, 1600.0), 1.0 + self.random.below(4) as f64);
        let yes = self.random.percent(50);
        let (name, value) = match self.random.below(20) {
            0..8 => ("r", V::Number(r)),
            8..13 => ("stop", V::Bool(yes)),
            13..16 => ("n", V::Number(n)),
            16 => ("note", V::Text(if yes { "short".into() } else { "much too long".into() })),
            17 => (self.random.pick(&["r", "stop", "q"]), V::Text("wrong".into())),
            18 => ("r", V::Number(self.random.pick(&[f64::NAN, f64::INFINITY, -1.0, 1e9]))),
            _ => ("stop", V::Number(1.0)),
        };
        Command::SetVariable { name: name.into(), value }
    }

    fn update_somehow(&mut self) {
        let which = self.random.below(2);
        self.update(which);
    }

    /// Proposed, and committed at the same instant; with an entry leg when the own one is gone.
    fn update(&mut self, which: usize) {
        let program = self.propose(which);
        let hash = program.hash().clone();
        self.command(Command::Commit { hash: hash.clone(), entry: None });
        if self.executor.program().is_none_or(|p| *p.hash() != hash) {
            let entry = self.random.pick(&["z", "s", "m", "nowhere"]);
            self.command(Command::Commit { hash, entry: Some(entry.into()) });
        }
    }

    fn propose(&mut self, which: usize) -> Arc<Program> {
        let program = self.plans[which].clone();
        let request = self.request();
        self.settle();
        self.input(Input::Propose {
            request,
            program: program.clone(),
            based_on: None,
            objections: Vec::new(),
        });
        program
    }

    fn propose_only(&mut self) {
        let which = self.random.below(2);
        self.propose(which);
    }

    /// A count is set for the loop being flown, which is left and entered again.
    fn count_and_come_back(&mut self) {
        let place = self.executor.status().place;
        let Some(around) = place.and_then(|p| Some(p.iterations.first()?.leg.clone())) else { return };
        let count = 5 + self.random.below(3) as u64;
        self.command(Command::SetCount { leg: around.clone(), count });
        self.command(Command::GoTo { leg: "z".into() });
        self.fly_one();
        self.command(Command::GoTo { leg: around });
        self.fly_one();
    }

    fn command_twice(&mut self) {
        let command = self.any_command();
        self.command(command.clone());
        self.command(command);
    }

    fn wait(&mut self) {
        let seconds = self.random.between(0.0, 8.0);
        self.pass_time(seconds);
        self.report();
    }

    /// Killed, and back from what it wrote down; the one that was not killed is asked the same for a while.
    fn restart(&mut self) {
        let snapshot = self.executor.snapshot();
        let mut bytes = Vec::new();
        ciborium::into_writer(&snapshot, &mut bytes).unwrap();
        let read: Snapshot = ciborium::from_reader(bytes.as_slice()).unwrap();
        let plan = self.executor.program().cloned();
        let with = |plan, snapshot| {
            Executor::restore(Config::default(), Arc::new(Flat(GROUND_M)), Profile::default(), plan, snapshot)
        };
        let foreign = self.plans.iter().find(|p| plan.as_ref().is_none_or(|own| own.hash() != p.hash()));
        let foreign_refused = foreign.is_none_or(|f| with(Some(f.clone()), read.clone()).is_err());
        let mut restored = with(plan, read).unwrap();
        restored.go_on(self.executor.proposed().cloned(), self.executor.last_step());
        let stimulus =
            Stimulus::Restarted { same_snapshot: restored.snapshot() == snapshot, foreign_refused };
        let killed = std::mem::replace(&mut self.executor, restored);
        self.twin = Some((killed, TWIN_INPUTS));
        self.note(stimulus, Vec::new(), None);
    }

    /// The gateway refuses the next batch whole.
    fn refuse(&mut self) {
        self.refuses_next = true;
    }

    /// Several waypoints flown, one reported.
    fn lose_progress(&mut self) {
        let flown = self.random.below(3).min(self.buffer.len().saturating_sub(1));
        if self.is_steering() {
            self.buffer.drain(..flown);
            self.arrive_near_front();
            self.report();
        }
    }

    fn leap(&mut self) {
        let last = self.buffer.len().saturating_sub(1);
        if self.is_steering() && self.buffer.iter().take(last).all(|w| !is_loiter(w)) {
            self.buffer.drain(..last);
            self.arrive_near_front();
            self.report();
        }
    }

    /// Of the past, of the future, twice, of nobody.
    fn strange_progress(&mut self) {
        let highest = self.executor.last_token().0;
        let strange = [0, 1, highest + 1, u64::MAX, self.told.map_or(0, |t| t.0)];
        let token = Token(self.random.pick(&strange));
        self.input(Input::Progress { current: Some(token) });
    }

    /// Safe or Manual: the gateway forgets its buffer.
    fn lose_control(&mut self) {
        self.gateway_controls = true;
        self.buffer.clear();
        self.told = None;
        self.input(Input::GatewayControls(true));
    }

    fn give_control_back(&mut self) {
        self.gateway_controls = false;
        self.input(Input::GatewayControls(false));
    }

    fn garbage(&mut self) {
        let good = self.state();
        let bad = [
            AircraftState { position: LatLon::new(f64::NAN, 0.0), ..good },
            AircraftState { position: LatLon::new(123.0, 456.0), ..good },
            AircraftState { altitude_amsl_m: f64::INFINITY, ..good },
            AircraftState { track_deg: f64::NAN, ..good },
            AircraftState { ground_speed_mps: f64::NAN, ..good },
            AircraftState { airspeed_mps: f64::NEG_INFINITY, ..good },
            AircraftState { battery: f64::NAN, ..good },
            AircraftState { wind_east_mps: f64::NAN, ..good },
        ];
        let state = self.random.pick(&bad);
        self.settle();
        self.input(Input::Aircraft(state));
    }

    /// A position that jumps: a navigation system that has found itself again.
    fn jump_aside(&mut self) {
        let (bearing_deg, metres) = (self.random.between(0.0, 360.0), self.random.between(50.0, 5000.0));
        self.position = self.position.destination(bearing_deg, metres);
        self.report();
    }

    /// Time stands still, or goes back; then the same again.
    fn stand_still(&mut self) {
        if self.random.percent(30) {
            self.now = self.now.saturating_sub(Time::from_millis(700));
        }
        for _ in 0..3 {
            self.settle();
        }
    }

    fn unhold(&mut self) {
        match self.executor.status().phase {
            Phase::Holding => self.command(Command::Resume),
            Phase::Finished | Phase::Idle => self.command(Command::Start),
            Phase::Grounded => self.start_next(),
            _ => self.fly_some(),
        }
    }

    // ---- the end ------------------------------------------------------------------------------------------------

    /// Nobody disturbs any more.
    fn fly_out(&mut self) {
        self.refuses_next = false;
        self.give_control_back();
        self.trace.left_alone = self.trace.moments.len();
        for _ in 0..MAX_WAYPOINTS {
            let status = self.executor.status();
            match (status.phase, status.decision) {
                (Phase::Idle | Phase::Finished, _) => return,
                (Phase::Grounded, _) => self.start_next(),
                (Phase::Holding, _) => self.command(Command::Resume),
                // some can only be released
                (Phase::Flying, _) if self.is_held_by_the_plan() && self.random.percent(5) => {
                    self.command(Command::SkipLeg);
                }
                (Phase::AwaitingDecision, Some(asked)) => {
                    let branch = asked.options[0].branch.clone();
                    self.command(Command::Decide { leg: asked.leg, branch });
                }
                _ => {
                    self.fly_one();
                }
            }
            let stands = self.executor.status().phase == Phase::Grounded;
            if self.buffer.is_empty() && !stands {
                return;
            }
        }
    }

    /// The next flight of the plan, from where it takes off.
    fn start_next(&mut self) {
        (self.position, self.altitude_amsl_m) = (HOME, GROUND_M);
        self.report();
        self.command(Command::Start);
    }

    fn is_held_by_the_plan(&self) -> bool {
        let leg = self.executor.ahead().next().map(|w| &w.leg);
        let kind = leg.and_then(|id| self.executor.program()?.leg(id)).map(|l| &l.kind);
        matches!(kind, Some(LegKind::Hm { .. }))
    }

    // ---- the aircraft -------------------------------------------------------------------------------------------

    fn is_steering(&self) -> bool {
        self.executor.status().phase == Phase::Flying && !self.gateway_controls && !self.buffer.is_empty()
    }

    fn steered_to(&self) -> Option<&Waypoint> {
        self.buffer.front().filter(|w| self.is_steering() && !is_loiter(w))
    }

    /// To the waypoint steered to, and on to the next one. False: nothing to fly.
    fn fly_one(&mut self) -> bool {
        let Some(front) = self.steered_to().cloned() else {
            self.wait();
            return false;
        };
        let seconds = self.position.distance_m(front.position) / SPEED_MPS;
        self.pass_time(seconds);
        self.position = front.position;
        self.altitude_amsl_m = front.altitude_amsl_m;
        self.report();
        // the report may have changed the way
        if self.buffer.front().is_none_or(|w| w.token != front.token) || !self.is_steering() {
            return true;
        }
        self.buffer.pop_front();
        self.send_progress();
        !self.buffer.is_empty()
    }

    fn arrive_near_front(&mut self) {
        if let Some(front) = self.buffer.front().map(|w| w.position) {
            self.pass_time(60.0);
            self.position = front.destination(180.0, 300.0);
        }
        self.send_progress();
    }

    fn pass_time(&mut self, seconds: f64) {
        let then = self.now + Time::from_secs_f64(seconds);
        // a shell wakes at the deadline; once is enough here
        if let Some(due) = self.executor.deadline().filter(|due| *due > self.now && *due < then) {
            self.now = due;
            self.settle();
        }
        self.now = then;
    }

    fn state(&self) -> AircraftState {
        AircraftState {
            position: self.position,
            altitude_amsl_m: self.altitude_amsl_m,
            track_deg: 90.0,
            ground_speed_mps: SPEED_MPS,
            airspeed_mps: SPEED_MPS,
            wind_east_mps: 0.0,
            wind_north_mps: 0.0,
            battery: 0.8,
            fuel: None,
            on_ground: self.position == HOME,
            engine_out: false,
            heading_deg: None,
        }
    }

    fn report(&mut self) {
        let state = self.state();
        self.reported = Some(state);
        self.input(Input::Aircraft(state));
    }

    // ---- the gateway --------------------------------------------------------------------------------------------

    fn request(&mut self) -> RequestId {
        self.requests += 1;
        RequestId(self.requests)
    }

    /// First everything that time alone brings, so that what follows comes from the command alone.
    fn command(&mut self, command: Command) {
        self.settle();
        let request = self.request();
        self.input(Input::Command { request, by: "operator".into(), command });
    }

    fn settle(&mut self) {
        self.input(Input::Tick);
    }

    fn input(&mut self, input: Input) {
        let mut outputs = Vec::new();
        self.executor.step(self.now, input.clone(), &mut outputs);
        let twin = self.ask_twin(input.clone());
        let rejection = self.obey(&outputs);
        let brings_home = outputs.contains(&Output::Safe) && !self.buffer.is_empty();
        self.note(Stimulus::Input(input), outputs, twin);
        if brings_home {
            self.lose_control();
        }
        if let Some(first) = rejection {
            self.input(Input::Rejected { first, reason: "too steep".into() });
        }
        let steers_to = self.buffer.front().map(|w| w.token);
        if steers_to.is_some() && steers_to != self.told {
            self.send_progress();
        }
    }

    fn send_progress(&mut self) {
        self.told = self.buffer.front().map(|w| w.token);
        self.input(Input::Progress { current: self.told });
    }

    /// What the executor says that was not killed.
    fn ask_twin(&mut self, input: Input) -> Option<Vec<Output>> {
        let (mut twin, left) = self.twin.take().filter(|(_, left)| *left > 0)?;
        let mut outputs = Vec::new();
        twin.step(self.now, input, &mut outputs);
        self.twin = Some((twin, left - 1));
        Some(outputs)
    }

    /// The gateway's buffer; the first token of a batch that it refuses.
    fn obey(&mut self, outputs: &[Output]) -> Option<Token> {
        let mut rejection = None;
        for output in outputs {
            let Output::Feed { cancel_after, waypoints } = output else { continue };
            let first = waypoints.first().map(|w| w.token);
            if first.is_some() && (std::mem::take(&mut self.refuses_next) || rejection.is_some()) {
                rejection = rejection.or(first);
                continue;
            }
            if let Some(last) = cancel_after {
                self.buffer.retain(|w| w.token <= *last);
            }
            self.buffer.extend(waypoints.iter().cloned());
        }
        rejection
    }

    fn note(&mut self, stimulus: Stimulus, outputs: Vec<Output>, twin: Option<Vec<Output>>) {
        let after = seen(&self.executor, &self.buffer, self.reported, self.gateway_controls);
        self.trace.moments.push(Moment { now: self.now, stimulus, outputs, twin, after });
    }
}

fn is_loiter(waypoint: &Waypoint) -> bool {
    matches!(waypoint.action, Action::Loiter { .. })
}

fn seen(
    executor: &Executor,
    buffer: &VecDeque<Waypoint>,
    aircraft: Option<AircraftState>,
    gateway_controls: bool,
) -> Seen {
    Seen {
        status: executor.status(),
        ahead: executor.ahead().cloned().collect(),
        buffer: buffer.iter().cloned().collect(),
        variables: executor.variables().clone(),
        aircraft,
        program: executor.program().cloned(),
        gateway_controls,
        deadline: executor.deadline(),
    }
}
