//! An autopilot that is at once where it is sent.

use aircraft::Profile;
use flight_exec::{
    Action, AircraftState, Answer, Command, Config, Event, Executor, Input, Output, Phase, Refusal,
    RequestId, ResolvedAct, Time, Token, Waypoint,
};
use flight_plan::{Program, VariableValue};
use geometry::LatLon;
use std::collections::VecDeque;
use std::sync::Arc;
use terrain::{Flat, Terrain};

pub use crate::grid::{GROUND_M, HOME, document_with, fix};

pub fn program(document: &str) -> Arc<Program> {
    crate::grid::compiled(document).unwrap_or_else(|why| panic!("the test's plan has problems:\n{why}"))
}

/// A whole document around some legs of a mission stage.
pub fn document(legs: &str) -> String {
    document_with(legs, "", "")
}

/// The executor, and the gateway's buffer as it would be.
#[derive(Clone)]
pub struct Rig {
    pub executor: Executor,
    pub now: Time,
    pub buffer: VecDeque<Waypoint>,
    /// Waypoints steered to, in order.
    pub flown: Vec<Waypoint>,
    pub events: Vec<Event>,
    /// Actions, with leg and passage.
    pub acts: Vec<(String, u64, ResolvedAct)>,
    pub holds: usize,
    pub aborts: usize,
    pub feeds: usize,
    pub battery: f64,
    pub fuel: Option<f64>,
    pub engine_out: bool,
    pub wind_east_mps: f64,
    /// Reported instead of the waypoint's altitude.
    pub altitude_amsl_m: Option<f64>,
    pub position: LatLon,
    requests: u64,
}

impl Rig {
    pub fn new() -> Self {
        Self::over(Arc::new(Flat(GROUND_M)))
    }

    /// The executor knows this ground.
    pub fn over(terrain: Arc<dyn Terrain>) -> Self {
        let executor = Executor::new(Config::default(), terrain, Profile::default());
        Self {
            executor,
            now: Time::ZERO,
            buffer: VecDeque::new(),
            flown: Vec::new(),
            events: Vec::new(),
            acts: Vec::new(),
            holds: 0,
            aborts: 0,
            feeds: 0,
            battery: 1.0,
            fuel: None,
            engine_out: false,
            wind_east_mps: 0.0,
            altitude_amsl_m: None,
            position: HOME,
            requests: 0,
        }
    }

    /// A plan around some mission legs, committed and started.
    pub fn started(legs: &str) -> Self {
        Self::flying(&document(legs))
    }

    pub fn flying(document: &str) -> Self {
        Self::new().in_flight(document)
    }

    /// A plan, committed and started.
    pub fn in_flight(self, document: &str) -> Self {
        let mut rig = self;
        rig.update(&program(document)).unwrap();
        rig.command(Command::Start).unwrap();
        rig
    }

    pub fn propose(&mut self, program: &Arc<Program>) -> flight_exec::ProposalReport {
        self.requests += 1;
        let request = RequestId(self.requests);
        match self.step(Input::Propose {
            request,
            program: program.clone(),
            based_on: None,
            objections: Vec::new(),
        }) {
            Some(Ok(Answer::Proposal(report))) => *report,
            other => panic!("{other:?}"),
        }
    }

    pub fn update(&mut self, program: &Arc<Program>) -> Result<(), Refusal> {
        self.propose(program);
        self.command(Command::Commit { hash: program.hash().clone(), entry: None })
    }

    pub fn command(&mut self, command: Command) -> Result<(), Refusal> {
        self.requests += 1;
        let request = RequestId(self.requests);
        match self.step(Input::Command { request, by: "operator".into(), command }) {
            Some(Ok(Answer::Done)) => Ok(()),
            Some(Err(refusal)) => Err(refusal),
            other => panic!("{other:?}"),
        }
    }

    pub fn set(&mut self, name: &str, value: f64) -> Result<(), Refusal> {
        self.command(Command::SetVariable { name: name.into(), value: VariableValue::Number(value) })
    }

    /// One input; the gateway's side of the invariants is asserted on every output. Returns the answer.
    pub fn step(&mut self, input: Input) -> Option<Result<Answer, Refusal>> {
        let asked = match &input {
            Input::Command { request, .. } | Input::Propose { request, .. } => Some(*request),
            _ => None,
        };
        let mut out = Vec::new();
        self.executor.step(self.now, input, &mut out);
        let mut answers = Vec::new();
        for output in out {
            match output {
                Output::Feed { cancel_after, waypoints } => self.take(cancel_after, waypoints),
                Output::Hold => self.holds += 1,
                Output::Safe => self.aborts += 1,
                Output::Answer { request, result } => answers.push((request, result)),
                Output::Act { leg, passage, act } => self.acts.push((leg.to_string(), passage, act)),
                Output::Event(event) => self.events.push(event),
            }
        }
        assert_eq!(
            answers.iter().map(|(r, _)| *r).collect::<Vec<_>>(),
            Vec::from_iter(asked),
            "one answer each"
        );
        answers.pop().map(|(_, result)| result)
    }

    fn take(&mut self, cancel_after: Option<Token>, waypoints: Vec<Waypoint>) {
        self.feeds += 1;
        let highest = self.buffer.iter().chain(&self.flown).map(|w| w.token).max();
        if let Some(last) = cancel_after {
            self.buffer.retain(|w| w.token <= last);
        }
        for waypoint in &waypoints {
            assert!(Some(waypoint.token) > highest, "a token used twice: {waypoint:?}");
        }
        self.buffer.extend(waypoints);
        assert!(self.buffer.iter().is_sorted_by(|a, b| a.token < b.token), "tokens count up");
        assert!(self.buffer.len() <= 64, "the horizon is bounded");
    }

    /// The aircraft where it is.
    pub fn state(&self) -> AircraftState {
        let altitude_amsl_m = self.altitude_amsl_m.or(self.flown.last().map(|w| w.altitude_amsl_m));
        AircraftState {
            position: self.position,
            altitude_amsl_m: altitude_amsl_m.unwrap_or(GROUND_M),
            track_deg: 90.0,
            ground_speed_mps: 25.0,
            airspeed_mps: 25.0,
            wind_east_mps: self.wind_east_mps,
            wind_north_mps: 0.0,
            battery: self.battery,
            fuel: self.fuel,
            on_ground: self.flown.is_empty(),
            engine_out: self.engine_out,
            heading_deg: None,
        }
    }

    /// The same, seen by the executor.
    pub fn report(&mut self) {
        let state = self.state();
        self.step(Input::Aircraft(state));
    }

    /// Steers to the first waypoint of the buffer, if it doesn't yet.
    pub fn steer(&mut self) {
        if let Some(front) = self.buffer.front().cloned()
            && self.flown.last().is_none_or(|w| w.token != front.token)
        {
            self.flown.push(front.clone());
            self.step(Input::Progress { current: Some(front.token) });
            // the way may have been changed on arrival
            if self.buffer.front().is_some_and(|w| w.token != front.token) {
                self.flown.pop();
                self.steer();
            }
        }
    }

    /// Flies to the waypoint steered to, and steers to the next one. False: nothing to fly.
    pub fn fly_one(&mut self) -> bool {
        self.steer();
        let Some(reached) = self.buffer.front().cloned() else { return false };
        if matches!(reached.action, Action::Loiter { .. }) {
            self.now += Time::from_secs(10);
            self.report();
            return false;
        }
        let seconds = self.position.distance_m(reached.position) / reached.airspeed_mps;
        self.now += Time::from_secs_f64(seconds);
        self.position = reached.position;
        self.report();
        self.buffer.pop_front();
        if self.buffer.is_empty() {
            assert!(reached.end_of_plan, "ran dry after {reached:?}");
            self.step(Input::Progress { current: None });
            return false;
        }
        self.steer();
        true
    }

    /// Flies until a leg is entered. Panics when the plan ends first.
    pub fn fly_to(&mut self, leg: &str) {
        self.steer();
        for _ in 0..10_000 {
            if self.leg() == leg {
                return;
            }
            assert!(self.fly_one(), "{leg} was not reached: {:?}", self.legs());
        }
        panic!("{leg} was not reached: {:?}", self.legs());
    }

    pub fn fly_to_the_end(&mut self) {
        for _ in 0..100_000 {
            if !self.fly_one() {
                assert_eq!(self.executor.status().phase, Phase::Finished);
                return;
            }
        }
        panic!("it never ends: {:?}", self.legs());
    }

    /// The leg of the waypoint steered to.
    pub fn leg(&self) -> String {
        self.executor.status().place.map_or_else(String::new, |p| p.leg.to_string())
    }

    /// Legs entered so far, `<` before one flown backwards, take-off and landing left out.
    pub fn legs(&self) -> String {
        let entered = self.events.iter().filter_map(|e| match e {
            Event::LegEntered { place } => {
                Some(format!("{}{}", if place.reverse { "<" } else { "" }, place.leg))
            }
            _ => None,
        });
        let entered: Vec<_> = entered.filter(|l| l != "to" && l != "land").collect();
        entered.join(" ")
    }
}

/// Flies a mission of some legs to its end and compares the legs entered.
pub fn check(legs: &str, entered: &str) -> Rig {
    let mut rig = Rig::started(legs);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), entered);
    rig
}
