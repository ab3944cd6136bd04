//! One simulated flight: aircraft, guidance and a waypoint list in the place of gateway and autopilot.

use super::scenario::{Act, Moment};
use super::{
    Advance, FlownWaypoint, LegPassage, Options, Preview, PreviewError, Scenario, Start, TrackPoint,
};
use crate::api::{
    Action, AircraftState, Answer, Command, Event, Input, Output, Phase, PlacePointer, RequestId, Time,
    Waypoint,
};
use crate::executor::Executor;
use aircraft::{Aircraft, Guidance, Profile, Target, Wind};
use flight_plan::{Id, Program};
use std::collections::VecDeque;
use std::sync::Arc;
use terrain::Terrain;

/// The executor hears about the aircraft so often, seconds.
const REPORT_EVERY_S: f64 = 0.5;
/// The callback is called so often, seconds of simulated time.
const ADVANCE_EVERY_S: f64 = 10.0;
/// Waiting longer than this for nobody, seconds.
const PATIENCE_S: f64 = 600.0;

pub(super) struct Flight<'a> {
    executor: Executor,
    aircraft: Aircraft,
    guidance: Guidance,
    wind: Wind,
    buffer: VecDeque<Waypoint>,
    out: Vec<Output>,
    scenario: &'a Scenario,
    fired: Vec<bool>,
    options: &'a Options,
    moment: Moment,
    steps: u64,
    waiting_s: f64,
    requests: u64,
    /// The scenario says so.
    ended: bool,
    result: Preview,
}

impl<'a> Flight<'a> {
    pub(super) fn new(
        program: &Arc<Program>,
        profile: &Profile,
        terrain: &Arc<dyn Terrain>,
        wind: Wind,
        start: Start,
        scenario: &'a Scenario,
        options: &'a Options,
    ) -> Result<Self, PreviewError> {
        let aircraft = placed(program, profile, start)?;
        let mut flight = Self {
            executor: Executor::new(options.config.clone(), terrain.clone(), profile.clone()),
            aircraft,
            guidance: Guidance::new(profile.clone()),
            wind,
            buffer: VecDeque::new(),
            out: Vec::new(),
            scenario,
            fired: vec![false; scenario.triggers.len()],
            options,
            moment: Moment::default(),
            steps: 0,
            waiting_s: 0.0,
            requests: 0,
            ended: false,
            result: empty(),
        };
        flight.start(program)?;
        Ok(flight)
    }

    fn start(&mut self, program: &Arc<Program>) -> Result<(), PreviewError> {
        self.report();
        self.update(program, None);
        self.command(Command::Start);
        match self.result.refusals.pop() {
            Some((_, refusal)) => Err(PreviewError::Refused(refusal)),
            None => Ok(()),
        }
    }

    pub(super) fn fly(&mut self, progress: &mut dyn FnMut(&Advance) -> bool) -> Result<(), PreviewError> {
        let step_s = self.options.step_s.clamp(0.02, 0.2);
        let every = |seconds: f64| ((seconds / step_s).round() as u64).max(1);
        let (report, track) = (every(REPORT_EVERY_S), every(self.options.track_every_s));
        let advance = every(ADVANCE_EVERY_S);
        while self.executor.status_phase() != Phase::Finished && !self.ended {
            if self.steps.is_multiple_of(track) {
                self.record();
            }
            if self.steps.is_multiple_of(report) {
                self.report();
                self.fire();
                self.check_limits(REPORT_EVERY_S)?;
            }
            if self.steps.is_multiple_of(advance) && !progress(&self.advance()) {
                return Err(PreviewError::Cancelled);
            }
            self.move_on(step_s);
        }
        self.record();
        Ok(())
    }

    pub(super) fn finished(mut self) -> Preview {
        self.close_passage();
        let battery = self.aircraft.battery();
        self.result.time_s = self.moment.time_s;
        self.result.energy_j = battery.capacity_j - battery.energy_left_j;
        self.result.battery_left = battery.share();
        self.result.landed = self.aircraft.state().on_ground;
        let fired = self.fired.iter().enumerate();
        self.result.not_fired = fired.filter(|(_, fired)| !**fired).map(|(i, _)| i).collect();
        self.result
    }

    /// One step of guidance and dynamics.
    fn move_on(&mut self, step_s: f64) {
        let next = self.buffer.get(1).map(Target::from);
        let guided = self.guidance.step(self.aircraft.state(), next.as_ref());
        if guided.reached && !self.buffer.is_empty() {
            self.reached();
        } else {
            self.aircraft.step(step_s, &guided.demand, &self.wind);
            self.steps += 1;
            self.moment.time_s = self.steps as f64 * step_s;
            let moved_m = self.aircraft.state().ground_speed_mps() * step_s;
            self.result.distance_m += moved_m;
        }
    }

    fn reached(&mut self) {
        self.buffer.pop_front();
        self.moment.waypoints += 1;
        if let Some(passage) = self.result.legs.last_mut() {
            passage.waypoints += 1;
        }
        let next = self.buffer.front().cloned();
        if let Some(waypoint) = &next {
            self.guidance.proceed(self.aircraft.state(), Target::from(waypoint));
        }
        self.tell(Input::Progress { current: next.as_ref().map(|w| w.token) });
        self.note_current();
        self.fire();
    }

    /// Keeps the waypoint now steered to, once.
    fn note_current(&mut self) {
        let Some(waypoint) = self.buffer.front() else { return };
        if self.result.waypoints.last().is_some_and(|w| w.waypoint.token == waypoint.token) {
            return;
        }
        let passage = self.result.legs.len().checked_sub(1);
        let (waypoint, from_s) = (waypoint.clone(), self.moment.time_s);
        self.result.waypoints.push(FlownWaypoint { waypoint, passage, from_s, replaced: false });
    }

    fn report(&mut self) {
        let state = self.aircraft.state();
        let state = AircraftState {
            position: state.position,
            altitude_amsl_m: state.altitude_amsl_m,
            track_deg: state.track_deg(),
            ground_speed_mps: state.ground_speed_mps(),
            airspeed_mps: state.airspeed_mps,
            wind_east_mps: self.wind.east_mps,
            wind_north_mps: self.wind.north_mps,
            battery: self.aircraft.battery().share(),
            on_ground: state.on_ground,
        };
        self.tell(Input::Aircraft(state));
    }

    fn tell(&mut self, input: Input) {
        let now = Time::from_secs_f64(self.moment.time_s);
        let mut out = std::mem::take(&mut self.out);
        self.executor.step(now, input, &mut out);
        for output in out.drain(..) {
            self.heed(output);
        }
        self.out = out;
    }

    fn heed(&mut self, output: Output) {
        match output {
            Output::Feed { cancel_after, waypoints } => self.take_feed(cancel_after, waypoints),
            Output::Hold => self.hold(),
            Output::Answer { result: Err(refusal), .. } => {
                self.result.refusals.push((self.moment.time_s, refusal));
            }
            Output::Answer { result: Ok(Answer::Proposal(report)), .. } => {
                self.result.proposals.push((self.moment.time_s, *report));
            }
            // an action is told by its event as well
            Output::Answer { .. } | Output::Act { .. } => {}
            Output::Event(event) => {
                if let Event::LegEntered { place } = &event {
                    self.enter(place.clone());
                }
                self.result.events.push((self.moment.time_s, event));
            }
        }
    }

    fn take_feed(&mut self, cancel_after: Option<crate::api::Token>, waypoints: Vec<Waypoint>) {
        let steered_to = self.buffer.front().map(|w| w.token);
        if let Some(last) = cancel_after {
            self.buffer.retain(|w| w.token <= last);
        }
        self.buffer.extend(waypoints);
        let now = self.buffer.front().map(|w| w.token);
        if now == steered_to {
            return;
        }
        if steered_to.is_some()
            && let Some(flown) = self.result.waypoints.last_mut()
        {
            flown.replaced = true;
        }
        if let Some(waypoint) = self.buffer.front() {
            let first = Target::from(waypoint);
            self.guidance.direct(self.aircraft.state(), first);
            self.tell(Input::Progress { current: now });
            self.note_current();
        }
    }

    fn hold(&mut self) {
        let state = self.aircraft.state();
        let here = Target {
            position: state.position,
            altitude_amsl_m: state.altitude_amsl_m,
            airspeed_mps: self.aircraft.profile().cruise_airspeed_mps,
            action: aircraft::Action::Loiter { radius_m: 0.0 },
            fly_over: false,
        };
        self.buffer.clear();
        self.guidance.direct(state, here);
    }

    fn enter(&mut self, place: PlacePointer) {
        self.close_passage();
        self.moment.place = Some(place.clone());
        self.moment.waypoints = 0;
        let battery = self.aircraft.battery();
        self.result.legs.push(LegPassage {
            place,
            start_s: self.moment.time_s,
            end_s: self.moment.time_s,
            // what was flown and used before it; made a difference when it ends
            distance_m: self.result.distance_m,
            energy_j: battery.capacity_j - battery.energy_left_j,
            waypoints: 0,
        });
    }

    fn close_passage(&mut self) {
        let battery = self.aircraft.battery();
        let used_j = battery.capacity_j - battery.energy_left_j;
        if let Some(passage) = self.result.legs.last_mut() {
            passage.end_s = self.moment.time_s;
            passage.distance_m = self.result.distance_m - passage.distance_m;
            passage.energy_j = used_j - passage.energy_j;
        }
    }

    fn record(&mut self) {
        let state = self.aircraft.state();
        let innermost = self.moment.place.as_ref().and_then(|p| p.iterations.last());
        self.result.track.push(TrackPoint {
            time_s: self.moment.time_s,
            position: state.position,
            altitude_amsl_m: state.altitude_amsl_m,
            airspeed_mps: state.airspeed_mps,
            passage: self.result.legs.len().checked_sub(1),
            iteration: innermost.map_or(0, |i| i.iteration),
        });
    }

    /// Triggers whose time has come.
    fn fire(&mut self) {
        for index in 0..self.fired.len() {
            let Some(trigger) = self.scenario.triggers.get(index) else { continue };
            let due = self.fired.get(index) == Some(&false) && trigger.at.is_now(&self.moment);
            if !due {
                continue;
            }
            if let Some(fired) = self.fired.get_mut(index) {
                *fired = true;
            }
            for act in &trigger.then {
                match act {
                    Act::Command(command) => self.command(command.clone()),
                    Act::Update { program, entry } => self.update(program, entry.clone()),
                    Act::Propose { program } => self.propose(program),
                    Act::End => self.ended = true,
                }
            }
        }
    }

    fn update(&mut self, program: &Arc<Program>, entry: Option<Id>) {
        self.propose(program);
        self.command(Command::Commit { hash: program.hash.clone(), entry });
    }

    fn propose(&mut self, program: &Arc<Program>) {
        self.requests += 1;
        let request = RequestId(self.requests);
        self.tell(Input::Propose {
            request,
            program: program.clone(),
            based_on: None,
            objections: Vec::new(),
        });
    }

    fn command(&mut self, command: Command) {
        self.requests += 1;
        let request = RequestId(self.requests);
        self.tell(Input::Command { request, by: "operator".into(), command });
    }

    fn check_limits(&mut self, since_s: f64) -> Result<(), PreviewError> {
        let (seconds, leg) = (self.moment.time_s, self.current_leg());
        if seconds > self.options.most_s {
            return Err(PreviewError::TooLong { seconds, leg });
        }
        if self.result.waypoints.len() > self.options.most_waypoints {
            return Err(PreviewError::TooManyWaypoints { waypoints: self.options.most_waypoints, leg });
        }
        if self.aircraft.battery().energy_left_j <= 0.0 {
            return Err(PreviewError::OutOfEnergy { seconds, leg });
        }
        let waits = matches!(self.executor.status_phase(), Phase::Holding | Phase::AwaitingDecision);
        self.waiting_s = if waits { self.waiting_s + since_s } else { 0.0 };
        if self.waiting_s > PATIENCE_S && self.fired.iter().all(|fired| *fired) {
            return Err(PreviewError::Waiting { seconds, leg });
        }
        Ok(())
    }

    fn current_leg(&self) -> Id {
        self.moment.place.as_ref().map_or_else(|| Id::new("start"), |p| p.leg.clone())
    }

    fn advance(&self) -> Advance {
        Advance {
            time_s: self.moment.time_s,
            place: self.moment.place.clone(),
            waypoints: self.result.waypoints.len(),
        }
    }
}

fn empty() -> Preview {
    Preview {
        track: Vec::new(),
        waypoints: Vec::new(),
        events: Vec::new(),
        refusals: Vec::new(),
        proposals: Vec::new(),
        legs: Vec::new(),
        not_fired: Vec::new(),
        time_s: 0.0,
        distance_m: 0.0,
        energy_j: 0.0,
        battery_left: 1.0,
        landed: false,
    }
}

fn placed(program: &Program, profile: &Profile, start: Start) -> Result<Aircraft, PreviewError> {
    match start {
        Start::InFlight { position, altitude_amsl_m, heading_deg } => {
            Ok(Aircraft::in_flight(profile.clone(), position, altitude_amsl_m, heading_deg))
        }
        Start::Runway => {
            let runway = program.plan.home().ok_or(PreviewError::NoStart)?;
            let (elevation_m, heading_deg) = (runway.elevation_amsl_m, runway.heading_deg);
            Ok(Aircraft::on_runway(profile.clone(), runway.threshold, elevation_m, heading_deg))
        }
    }
}

/// What the guidance is told to steer to.
impl From<&Waypoint> for Target {
    fn from(waypoint: &Waypoint) -> Self {
        Target {
            position: waypoint.position,
            altitude_amsl_m: waypoint.altitude_amsl_m,
            airspeed_mps: waypoint.airspeed_mps,
            action: match waypoint.action {
                Action::TakeOff { heading_deg } => aircraft::Action::TakeOff { heading_deg },
                Action::Fly => aircraft::Action::Fly,
                Action::Loiter { radius_m } => aircraft::Action::Loiter { radius_m },
                Action::Land { heading_deg } => aircraft::Action::Land { heading_deg },
            },
            fly_over: waypoint.fly_over,
        }
    }
}
