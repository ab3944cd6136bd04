//! The virtual machine: inputs in, outputs out, time as an argument.

pub(crate) mod actions;
mod commands;
mod emergency;
mod progress;
mod proposal;
pub(crate) mod questions;
mod refresh;
mod replan;
pub(crate) mod snapshot;
pub(crate) mod state;
mod status;
mod update;

pub use snapshot::{RestoreError, Snapshot};

use crate::api::{Answer, Event, Input, Output, Phase, Refusal, RequestId, Time, Token};
use crate::executor::state::State;
use crate::layout::path::{Level, PathEnd, PathState, distance_m};
use crate::layout::stretch::IssuedWaypoint;
use crate::layout::world::{ReadSet, World};
use crate::value::Config;
use aircraft::Profile;
use flight_plan::{AltitudeReference, FlightState, Program, Variables};
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// The executor: flies a plan by handing out waypoints a bounded way ahead.
#[derive(Clone)]
pub struct Executor {
    pub(crate) config: Config,
    pub(crate) terrain: Arc<dyn Terrain>,
    pub(crate) profile: Profile,
    /// [`Program::default`]: there is none.
    pub(crate) program: Arc<Program>,
    pub(crate) proposed: Option<Arc<Program>>,
    pub(crate) state: State,
    pub(crate) last_step: Option<Time>,
    /// What has been read of the plan, for who wants to know (see [`ReadSet`]).
    pub(crate) seen: Option<ReadSet>,
}

/// A refusal.
pub(crate) fn refusal(code: &str, reason: impl Into<String>) -> Refusal {
    Refusal { code: code.into(), reason: reason.into() }
}

impl Executor {
    /// An executor without a plan.
    pub fn new(config: Config, terrain: Arc<dyn Terrain>, profile: Profile) -> Self {
        let state = State::default();
        Self {
            config,
            terrain,
            profile,
            program: Arc::default(),
            proposed: None,
            state,
            last_step: None,
            seen: None,
        }
    }

    /// One thing happened at `now`; what has to be done about it is appended to `out`.
    pub fn step(&mut self, now: Time, input: Input, out: &mut Vec<Output>) {
        self.advance_clock(now);
        match input {
            Input::Tick => {}
            Input::Aircraft(state) if state.is_sound() => self.state.aircraft = Some(state),
            // numbers that are none: the last sound report counts on
            Input::Aircraft(_) => {}
            Input::Propose { request, program, based_on, objections } => {
                let result = self.propose(&program, based_on, objections);
                out.push(Output::Answer { request, result });
            }
            Input::Command { request, by, command } => {
                let result = self.command(command, &by, out);
                self.answer(request, result, out);
            }
            Input::Progress { current } => self.progress(current, out),
            Input::Landed => self.landed(out),
            Input::Rejected { first, reason } => self.rejected(first, reason, out),
            Input::GatewayControls(controls) => self.gateway_controls(controls, out),
        }
        self.look_after(out);
    }

    /// When to call [`Executor::step`] with a tick, if nothing else happens before.
    pub fn deadline(&self) -> Option<Time> {
        let review = (self.is_flying() && self.has_provisional_choices()).then_some(self.state.review_due_s);
        let refresh = self.state.refresh_due_s.filter(|_| self.is_flying());
        let wait = self.state.wait.filter(|_| self.is_flying()).map(|w| w.due_s);
        let action = if self.is_flying() { self.next_action_s() } else { None };
        let due_s = [review, refresh, wait, action].into_iter().flatten().fold(f64::INFINITY, f64::min);
        let wait_s = (due_s - self.state.clock_s).max(0.0);
        let last = self.last_step?;
        wait_s.is_finite().then(|| last + Time::from_secs_f64(wait_s.min(3600.0)))
    }

    /// The active plan.
    pub fn program(&self) -> Option<&Arc<Program>> {
        // whatever was compiled has a stage
        Some(&self.program).filter(|program| !program.plan.stages.is_empty())
    }

    /// The plan that was proposed last and may be committed.
    pub fn proposed(&self) -> Option<&Arc<Program>> {
        self.proposed.as_ref()
    }

    /// Present values of the plan's variables.
    pub fn variables(&self) -> &Variables {
        &self.state.variables
    }

    /// Waypoints issued and not flown yet, the current one first.
    pub fn ahead(&self) -> impl Iterator<Item = &crate::api::Waypoint> {
        self.state.issued.iter().map(|h| &h.waypoint)
    }

    /// Highest token used so far.
    pub fn last_token(&self) -> Token {
        Token(self.state.last_token)
    }

    /// When it was last stepped, if ever.
    pub fn last_step(&self) -> Option<Time> {
        self.last_step
    }

    /// Goes on numbering after a token that the gateway has seen (its memory may be longer than a snapshot's).
    pub fn number_after(&mut self, highest: Token) {
        self.state.last_token = self.state.last_token.max(highest.0);
    }

    fn advance_clock(&mut self, now: Time) {
        if let Some(last) = self.last_step {
            self.state.clock_s += crate::layout::world::seconds_between(last, now);
        }
        self.last_step = Some(self.last_step.map_or(now, |last| last.max(now)));
    }

    fn answer(&self, request: RequestId, result: Result<(), Refusal>, out: &mut Vec<Output>) {
        out.push(Output::Answer { request, result: result.map(|()| Answer::Done) });
    }

    /// What is due after every input.
    fn look_after(&mut self, out: &mut Vec<Output>) {
        if !self.is_flying() {
            return;
        }
        // a deadline rounded to nanoseconds is not to be missed by one
        let by_now_s = self.state.clock_s + 1e-6;
        self.act_on_the_way(out);
        if let Some(wait) = self.state.wait.filter(|wait| wait.due_s <= by_now_s) {
            self.end_wait(wait, out);
        }
        if self.state.refresh_due_s.is_some_and(|due| due <= by_now_s) {
            self.refresh(out);
        }
        let reviews = self.state.review_due_s <= by_now_s;
        if reviews {
            self.state.review_due_s = self.state.clock_s + self.config.review_s;
            self.reevaluate_choices(out);
        }
        self.fill(out);
        self.attend_decisions(out);
        if reviews {
            self.look_ahead(out);
        }
    }

    /// A plan is being flown, and where the aircraft is is known: what is ahead of it can be looked at.
    pub fn is_under_way(&self) -> bool {
        self.is_flying() && self.state.aircraft.is_some()
    }

    /// Between start and finish, holding or not.
    pub(crate) fn is_flying(&self) -> bool {
        matches!(self.state.phase, Phase::Flying | Phase::Holding | Phase::AwaitingDecision)
    }

    pub(crate) fn flying_program(&self) -> Result<Arc<Program>, Refusal> {
        if self.is_flying() {
            return Ok(self.program.clone());
        }
        Err(refusal("not-flying", "no plan is being flown: commit a plan and start it first"))
    }

    /// What is changed now must wait to be fed.
    pub(crate) fn is_muted(&self) -> bool {
        self.state.phase == Phase::Holding || self.state.gateway_controls
    }

    pub(crate) fn enter_phase(&mut self, phase: Phase, out: &mut Vec<Output>) {
        if self.state.phase != phase {
            self.state.phase = phase;
            out.push(Output::Event(Event::PhaseChanged { phase }));
        }
    }

    /// The world as the cursor sees it.
    pub fn world(&self) -> World<'_> {
        World {
            program: &self.program,
            config: &self.config,
            profile: &self.profile,
            terrain: self.terrain.as_ref(),
            variables: &self.state.variables,
            flight: self.flight_state(),
            decisions: &self.state.decisions,
            released: self.state.released,
            waited: self.state.waited,
            counts: &self.state.counts,
            arriving: false,
            looking_ahead: false,
            seen: self.seen.as_ref(),
        }
    }

    fn flight_state(&self) -> FlightState {
        let time_s = self.state.started_s.map_or(0.0, |s| self.state.clock_s - s);
        let Some(a) = &self.state.aircraft else {
            return FlightState { time_s, ..FlightState::on_ground(self.home()) };
        };
        FlightState {
            iteration: 0,
            time_s,
            altitude_amsl_m: a.altitude_amsl_m,
            airspeed_mps: a.airspeed_mps,
            battery: a.battery,
            // an electric aircraft has its energy nowhere else
            fuel: a.fuel.unwrap_or(a.battery),
            wind_mps: a.wind_east_mps.hypot(a.wind_north_mps),
            position: a.position,
        }
    }

    fn home(&self) -> LatLon {
        let home = self.program.plan.home();
        home.map_or(LatLon::new(0.0, 0.0), |r| r.threshold)
    }

    /// The aircraft as the end of the path that it has flown; before its first report, standing at home.
    pub fn here(&self) -> PathState {
        let runway = self.program.plan.home();
        let aircraft = self.state.aircraft.as_ref();
        let elevation_m = runway.map_or(0.0, |r| r.elevation_amsl_m);
        let altitude_m = aircraft.map_or(elevation_m, |a| a.altitude_amsl_m);
        let course_deg = aircraft.map_or(runway.map_or(0.0, |r| r.heading_deg), |a| a.track_deg);
        PathState {
            last: PathEnd {
                position: aircraft.map_or_else(|| self.home(), |a| a.position),
                level: Level { metres: altitude_m, reference: AltitudeReference::Amsl },
                airspeed_mps: self.profile.cruise_airspeed_mps,
                fly_over: false,
            },
            course_deg,
            predicted_amsl_m: altitude_m,
            commanded_amsl_m: altitude_m,
            distance_m: self.way_made_m(),
            time_s: self.time_made_s(),
        }
    }

    /// From the aircraft to the waypoint it steers to, metres.
    pub(crate) fn to_current_m(&self) -> f64 {
        match (self.state.issued.front(), &self.state.aircraft) {
            (Some(front), Some(a)) => distance_m(a.position, front.waypoint.position),
            _ => 0.0,
        }
    }

    /// Path length where the aircraft is, metres; never less than where the way to the current waypoint begins, however far the
    /// aircraft was brought away from it.
    pub(crate) fn way_made_m(&self) -> f64 {
        let on_the_way = |h: &IssuedWaypoint| {
            let begun_m = h.before.end_of_path().distance_m;
            (h.end_m - self.to_be_flown_m()).max(begun_m)
        };
        let tail = || self.state.tail.as_ref().map(|t| t.end_of_path().distance_m);
        self.state.issued.front().map(on_the_way).or_else(tail).unwrap_or(0.0)
    }

    /// Flying time of the path where the aircraft is, seconds; likewise.
    pub(crate) fn time_made_s(&self) -> f64 {
        let on_the_way = |h: &IssuedWaypoint| {
            let left_s = self.to_be_flown_m() / h.waypoint.airspeed_mps.max(1.0);
            (h.end_s - left_s).max(h.before.end_of_path().time_s)
        };
        let tail = || self.state.tail.as_ref().map(|t| t.end_of_path().time_s);
        self.state.issued.front().map(on_the_way).or_else(tail).unwrap_or(0.0)
    }

    /// From where the path is left or gone on with to the waypoint steered to, metres: in a hold that is where it was given, wherever
    /// the aircraft has drifted since.
    fn to_be_flown_m(&self) -> f64 {
        let held_at = self.state.held_at.filter(|_| self.state.phase == Phase::Holding);
        let front = self.state.issued.front();
        front.zip(held_at).map_or_else(|| self.to_current_m(), |(h, at)| distance_m(at, h.waypoint.position))
    }

    /// Path from the aircraft to a path length ahead, metres; never negative.
    pub(crate) fn path_left_m(&self, at_m: f64) -> f64 {
        let beyond = self.state.issued.front().filter(|front| at_m > front.before.path.distance_m);
        beyond.map_or(0.0, |front| (self.to_current_m() + at_m - front.end_m).max(0.0))
    }

    fn has_provisional_choices(&self) -> bool {
        self.state.tail_has_choices || self.state.issued.iter().any(|h| !h.choices.is_empty())
    }
}
