//! One simulated flight: aircraft, guidance and a waypoint list in the place of gateway and autopilot.
//!
//! The simulation restarts at each waypoint: the aircraft is there at the instant at which it reaches it, not at the end of a step;
//! its motion is rounded (see [`Aircraft::settle`]), its state reported and its place recorded, and reports and track continue
//! from that instant. So what follows doesn't depend on how the steps before happened to fall, and [`super::Rehearsal`] can join a
//! former flight exactly.
//!
//! [`Aircraft::settle`]: aircraft::Aircraft::settle

use super::situation::{Renumbering, Situation, microseconds, seconds};
use super::{
    Advance, FlownWaypoint, LegPassage, Options, Preview, PreviewError, Scenario, Start, TrackPoint,
};
use crate::api::{
    Action, AircraftState, Answer, Command, Event, Input, Output, Phase, PlacePointer, Time, Token, Waypoint,
};
use crate::executor::Executor;
use aircraft::{Guided, Profile, Target, Wind, Winds};
use flight_plan::Program;
use std::sync::Arc;
use terrain::Terrain;

mod orders;
mod turnaround;

/// The executor gets the aircraft's state so often, microseconds.
const REPORT_EVERY_US: u64 = 500_000;
/// The callback is called so often, microseconds of simulated time.
const ADVANCE_EVERY_US: u64 = 10_000_000;
/// Waiting longer than this for nobody, microseconds.
const PATIENCE_US: u64 = 600_000_000;

/// Gets how far it is; says whether to go on.
pub(super) type Progress<'a> = &'a mut dyn FnMut(&Advance) -> bool;

/// What doesn't change in flight.
#[derive(Clone, Copy)]
pub(super) struct Circumstances<'a> {
    pub winds: Winds,
    pub scenario: &'a Scenario,
    pub options: &'a Options,
}

pub(super) struct Flight<'a> {
    given: Circumstances<'a>,
    pub at: Situation,
    out: Vec<Output>,
    /// What is over: the present passage and waypoint are not in it yet.
    pub result: Preview,
}

impl<'a> Flight<'a> {
    /// A flight in the middle.
    pub(super) fn resumed(given: Circumstances<'a>, at: Situation) -> Self {
        Self { given, at, out: Vec::new(), result: empty() }
    }

    /// Goes on with a flight under way; who holds it up (a hold, the gateway) does so no longer. `None` as in
    /// [`Situation::under_way`].
    pub(super) fn under_way(executor: Executor, given: Circumstances<'a>) -> Option<Self> {
        let triggers = given.scenario.triggers.len();
        let mut flight = Self::resumed(given, Situation::under_way(executor, triggers, given.options)?);
        flight.note_current();
        flight.report();
        flight.input(Input::GatewayControls(false));
        if flight.at.executor.status_phase() == Phase::Holding {
            flight.command(Command::Resume);
        }
        Some(flight)
    }

    /// Begins a flight. `watched`: what is read of the plan is taken down.
    pub(super) fn new(
        program: &Arc<Program>,
        profile: &Profile,
        terrain: &Arc<dyn Terrain>,
        start: Start,
        given: Circumstances<'a>,
        watched: bool,
    ) -> Result<Self, PreviewError> {
        let triggers = given.scenario.triggers.len();
        let mut at = Situation::new(program, profile, terrain, start, triggers, given.options)?;
        at.executor.watch(watched);
        let mut flight = Self::resumed(given, at);
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

    /// Flies until a waypoint is reached at which a leg begins; false: it is over before.
    pub(super) fn on_to_the_next_leg(&mut self, progress: Progress) -> Result<bool, PreviewError> {
        let step_us = microseconds(self.given.options.step_s.clamp(0.02, 0.2));
        while !self.is_over() {
            if self.at.executor.grounded().is_some() {
                self.turn_around()?;
                return Ok(true);
            }
            let next = self.at.buffer.get(1).map(|waypoint| self.at.target(waypoint));
            let guided = self.at.guidance.step(self.at.aircraft.state(), next.as_ref());
            if guided.reached && !self.at.buffer.is_empty() {
                // one that was begun between waypoints is no place to go on from: it began earlier
                self.at.entered = false;
                self.reached(&guided, step_us)?;
                if self.at.entered {
                    return Ok(true);
                }
            } else if !self.attend(progress)? {
                self.move_on(step_us, &guided);
            }
        }
        Ok(false)
    }

    /// Flies to the end, or until a command of the scenario is refused. Unlike with [`Self::flown`] a flight that ends too early
    /// is there up to its end.
    pub(super) fn flown_as_far_as_possible(mut self) -> (Preview, Option<PreviewError>) {
        let error = loop {
            match self.on_to_the_next_leg(&mut |_| true) {
                Ok(true) if self.result.refusals.is_empty() => {}
                Ok(_) => break None,
                Err(error) => break Some(error),
            }
        };
        self.close();
        (self.result, error)
    }

    pub(super) fn flown(self, progress: Progress) -> Result<Preview, PreviewError> {
        match self.flown_on(progress) {
            (flown, None) => Ok(flown),
            (_, Some(error)) => Err(error),
        }
    }

    /// As [`Self::flown`]; a flight that ends too early is there up to its end, with the reason.
    pub(super) fn flown_on(mut self, progress: Progress) -> (Preview, Option<PreviewError>) {
        let error = loop {
            match self.on_to_the_next_leg(progress) {
                Ok(true) => {}
                Ok(false) => break None,
                Err(error) => break Some(error),
            }
        };
        self.close();
        (self.result, error)
    }

    fn is_over(&self) -> bool {
        self.at.executor.status_phase() == Phase::Finished || self.at.ended
    }

    /// What is due by now; true: the executor got an input, and may have changed the path.
    fn attend(&mut self, progress: Progress) -> Result<bool, PreviewError> {
        let now_us = self.at.now_us;
        if now_us >= self.at.due.advance_us {
            self.at.due.advance_us = now_us + ADVANCE_EVERY_US;
            if !progress(&self.advance()) {
                return Err(PreviewError::Cancelled);
            }
        }
        if now_us >= self.at.due.track_us {
            self.record();
        }
        if now_us < self.at.due.report_us {
            return Ok(false);
        }
        self.report();
        self.fire();
        self.check_limits()?;
        Ok(true)
    }

    /// The flight is over: what is under way is closed.
    pub(super) fn close(&mut self) {
        self.record();
        self.close_waypoint();
        self.close_passage();
        let (battery, result) = (self.at.aircraft.battery(), &mut self.result);
        result.time_s = self.at.time_s();
        result.distance_m = self.at.distance_m;
        result.energy_j = self.at.used_in_all_j();
        result.battery_left = battery.share();
        result.landed = self.at.aircraft.state().on_ground;
        let fired = self.at.fired.iter().enumerate();
        result.not_fired = fired.filter(|(_, fired)| !**fired).map(|(i, _)| i).collect();
    }

    /// Where the aircraft is.
    fn wind(&self) -> Wind {
        self.given.winds.at(self.at.aircraft.state().altitude_amsl_m)
    }

    /// One step of dynamics.
    fn move_on(&mut self, step_us: u64, guided: &Guided) {
        let step_s = seconds(step_us);
        let wind = self.wind();
        self.at.aircraft.step(step_s, &guided.demand, &wind);
        self.at.distance_m += self.at.aircraft.state().ground_speed_mps() * step_s;
        self.pass(self.at.now_us + step_us);
    }

    fn pass(&mut self, now_us: u64) {
        self.at.now_us = now_us;
        let now_s = self.at.time_s();
        self.at.moment.time_s = now_s;
        self.at.moment.in_leg_s = self.at.passage.as_ref().map_or(0.0, |passage| now_s - passage.start_s);
    }

    /// The aircraft is at its waypoint, or was within the last step.
    fn reached(&mut self, guided: &Guided, step_us: u64) -> Result<(), PreviewError> {
        if let Some(place) = self.at.climb_out() {
            self.at.guidance.direct(self.at.aircraft.state(), place);
            return Ok(());
        }
        let since_us = self.at.now_us.saturating_sub(self.at.stepped_us).min(step_us);
        let late_us = microseconds(guided.late_s).min(since_us);
        self.at.distance_m -= self.at.aircraft.state().ground_speed_mps() * seconds(late_us);
        self.pass(self.at.now_us - late_us);
        let wind = self.wind();
        self.at.aircraft.settle(seconds(late_us), &wind);
        let reached = self.at.buffer.front().map(|waypoint| waypoint.token);
        self.report();
        // the report may have led elsewhere
        if self.at.buffer.front().map(|waypoint| waypoint.token) != reached {
            return self.check_limits();
        }
        self.at.buffer.pop_front();
        self.at.moment.waypoints += 1;
        if let Some(passage) = &mut self.at.passage {
            passage.waypoints += 1;
        }
        let next = self.at.buffer.front().cloned();
        if let Some(waypoint) = &next {
            let target = self.at.target_between(waypoint, self.at.buffer.get(1));
            self.at.guidance.proceed(self.at.aircraft.state(), target);
        }
        self.input(Input::Progress { current: next.as_ref().map(|w| w.token) });
        self.note_current();
        self.record();
        self.fire();
        self.check_limits()
    }

    /// Takes down the waypoint now steered to, once.
    fn note_current(&mut self) {
        let Some(waypoint) = self.at.buffer.front() else { return };
        if self.at.steered.as_ref().is_some_and(|w| w.waypoint.token == waypoint.token) {
            return;
        }
        let waypoint = waypoint.clone();
        self.close_waypoint();
        let (passage, from_s) = (self.at.passage_index(), self.at.time_s());
        self.at.steered = Some(FlownWaypoint { waypoint, passage, from_s, replaced: false });
    }

    fn close_waypoint(&mut self) {
        if let Some(mut steered) = self.at.steered.take() {
            steered.waypoint.token = Token(self.at.renumbering.token(steered.waypoint.token.0));
            self.result.waypoints.push(steered);
            self.at.waypoints += 1;
        }
    }

    fn report(&mut self) {
        let (state, wind) = (self.at.aircraft.state(), self.wind());
        let state = AircraftState {
            position: state.position,
            altitude_amsl_m: state.altitude_amsl_m,
            track_deg: state.track_deg(),
            ground_speed_mps: state.ground_speed_mps(),
            airspeed_mps: state.airspeed_mps,
            wind_east_mps: wind.east_mps,
            wind_north_mps: wind.north_mps,
            battery: self.at.aircraft.battery().share(),
            fuel: None,
            on_ground: state.on_ground,
            engine_out: !self.at.aircraft.engine().healthy,
            heading_deg: None,
        };
        let waits = matches!(self.at.executor.status_phase(), Phase::Holding | Phase::AwaitingDecision);
        let since_us = self.at.now_us - self.at.stepped_us;
        self.at.waiting_us = if waits { self.at.waiting_us + since_us } else { 0 };
        self.at.due.report_us = self.at.now_us + REPORT_EVERY_US;
        self.input(Input::Aircraft(state));
    }

    fn input(&mut self, input: Input) {
        self.at.stepped_us = self.at.now_us;
        let now = Time::from_micros(self.at.now_us);
        let mut out = std::mem::take(&mut self.out);
        self.at.executor.step(now, input, &mut out);
        for output in out.drain(..) {
            self.heed(output);
        }
        self.out = out;
    }

    fn heed(&mut self, output: Output) {
        match output {
            Output::Feed { cancel_after, waypoints } => self.take_feed(cancel_after, waypoints),
            Output::Hold | Output::Safe => self.hold(),
            Output::Answer { result: Err(refusal), .. } => {
                self.result.refusals.push((self.at.time_s(), refusal));
            }
            Output::Answer { result: Ok(Answer::Proposal(report)), .. } => {
                self.result.proposals.push((self.at.time_s(), *report));
            }
            // an action is reported by its event as well
            Output::Answer { .. } | Output::Act { .. } => {}
            Output::Event(event) => {
                if let Event::LegEntered { place } = &event {
                    self.enter(place.clone());
                }
                let event = renumbered(event, self.at.renumbering);
                self.result.events.push((self.at.time_s(), event));
            }
        }
    }

    fn take_feed(&mut self, cancel_after: Option<Token>, waypoints: Vec<Waypoint>) {
        let steered_to = self.at.buffer.front().map(|w| w.token);
        if let Some(last) = cancel_after {
            self.at.buffer.retain(|w| w.token <= last);
        }
        self.at.buffer.extend(waypoints);
        let now = self.at.buffer.front().map(|w| w.token);
        if now == steered_to {
            return;
        }
        if steered_to.is_some()
            && let Some(flown) = &mut self.at.steered
        {
            flown.replaced = true;
        }
        if let Some(waypoint) = self.at.buffer.front() {
            let first = self.at.target(waypoint);
            self.at.guidance.direct(self.at.aircraft.state(), first);
            self.input(Input::Progress { current: now });
            self.note_current();
        }
    }

    fn hold(&mut self) {
        let state = self.at.aircraft.state();
        let here = Target {
            position: state.position,
            altitude_amsl_m: state.altitude_amsl_m,
            airspeed_mps: self.at.aircraft.profile().cruise_airspeed_mps,
            action: aircraft::Action::Loiter { radius_m: 0.0 },
            fly_over: false,
            acceptance_m: None,
        };
        self.at.buffer.clear();
        self.at.guidance.direct(state, here);
    }

    fn enter(&mut self, place: PlacePointer) {
        self.close_passage();
        self.at.entered = true;
        self.at.moment.place = Some(place.clone());
        self.at.moment.in_leg_s = 0.0;
        self.at.moment.waypoints = 0;
        self.at.passage = Some(LegPassage {
            place,
            start_s: self.at.time_s(),
            end_s: self.at.time_s(),
            // what was flown and used before it; made a difference when it ends
            distance_m: self.at.distance_m,
            energy_j: self.at.used_j(),
            waypoints: 0,
        });
    }

    fn close_passage(&mut self) {
        let Some(mut passage) = self.at.passage.take() else { return };
        passage.end_s = self.at.time_s();
        passage.distance_m = self.at.distance_m - passage.distance_m;
        passage.energy_j = self.at.used_j() - passage.energy_j;
        self.result.legs.push(passage);
        self.at.passages += 1;
    }

    fn record(&mut self) {
        self.at.due.track_us = self.at.now_us + microseconds(self.given.options.track_every_s);
        let state = self.at.aircraft.state();
        let innermost = self.at.moment.place.as_ref().and_then(|p| p.iterations.last());
        self.result.track.push(TrackPoint {
            time_s: self.at.time_s(),
            position: state.position,
            altitude_amsl_m: state.altitude_amsl_m,
            airspeed_mps: state.airspeed_mps,
            passage: self.at.passage_index(),
            iteration: innermost.map_or(0, |i| i.iteration),
        });
    }

    fn check_limits(&mut self) -> Result<(), PreviewError> {
        if let Some(error) = self.at.exceeded(self.given.options) {
            return Err(error);
        }
        if self.at.waiting_us > PATIENCE_US && self.at.fired.iter().all(|fired| *fired) {
            return Err(PreviewError::Waiting { seconds: self.at.time_s(), leg: self.at.leg() });
        }
        Ok(())
    }

    fn advance(&self) -> Advance {
        Advance {
            time_s: self.at.time_s(),
            place: self.at.moment.place.clone(),
            waypoints: self.at.waypoints,
        }
    }
}

/// The number of a passage as a flight from the start would count it.
fn renumbered(mut event: Event, by: Renumbering) -> Event {
    if let Event::ActionDone { passage, .. } | Event::ActionRefused { passage, .. } = &mut event {
        *passage = by.passage(*passage);
    }
    event
}

/// No flight at all.
pub(super) fn empty() -> Preview {
    Preview {
        track: Vec::new(),
        waypoints: Vec::new(),
        events: Vec::new(),
        refusals: Vec::new(),
        proposals: Vec::new(),
        legs: Vec::new(),
        stops: Vec::new(),
        not_fired: Vec::new(),
        time_s: 0.0,
        distance_m: 0.0,
        energy_j: 0.0,
        battery_left: 1.0,
        landed: false,
    }
}

/// What the guidance steers to.
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
            acceptance_m: None,
        }
    }
}
