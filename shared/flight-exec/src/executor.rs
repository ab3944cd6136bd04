//! The virtual machine: inputs in, outputs out, time as an argument.
//!
//! What it remembers is in the parts of [`crate::flight`], each the only writer of its fields. Here an input is dispatched to them, and
//! what concerns several of them is put in order.

mod acting;
mod commands;
mod emergency;
mod gliding;
mod go_around;
mod plan_before;
mod progress;
mod proposal;
mod refresh;
mod replan;
mod setup;
mod snapshot;
mod standing;
mod status;
mod trial;
mod update;

pub use snapshot::{RestoreError, Snapshot};

use crate::api::{Answer, Input, Output, Phase, Refusal, RequestId, Time, Token, Waypoint};
use crate::flight::{Flight, Life, PathAhead, refusal};
use crate::layout::path::PathState;
use crate::layout::world::{World, seconds_between};
use crate::value::Config;
use aircraft::Profile;
use flight_plan::{Program, Variables};
use plan_before::PlanBefore;
use setup::Setup;
use std::sync::Arc;
use terrain::Terrain;

/// The executor: flies a plan by handing out waypoints a bounded way ahead.
#[derive(Clone)]
pub struct Executor {
    setup: Setup,
    proposed: Option<Arc<Program>>,
    plan_before: Option<Box<PlanBefore>>,
    life: Life,
    flight: Flight,
    last_step: Option<Time>,
}

impl Executor {
    /// An executor without a plan.
    pub fn new(config: Config, terrain: Arc<dyn Terrain>, profile: Profile) -> Self {
        let setup = Setup { config, terrain, profile, program: Arc::default(), seen: None };
        let (life, flight) = (Life::default(), Flight::default());
        Self { setup, proposed: None, plan_before: None, life, flight, last_step: None }
    }

    /// One thing happened at `now`; what has to be done about it is appended to `out`.
    pub fn step(&mut self, now: Time, input: Input, out: &mut Vec<Output>) {
        self.advance_clock(now);
        self.weigh_plan_before(&input);
        let before = out.len();
        match input {
            Input::Tick => {}
            Input::Aircraft(state) if state.is_sound() => self.aircraft_reported(state, out),
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
            Input::NotLaunched => self.not_launched(out),
            Input::Rejected { first, reason } => self.rejected(first, reason, out),
            Input::GatewayControls(controls) => self.gateway_controls(controls, out),
        }
        self.do_what_is_due(out);
        // what is done once is not to be done again by going back
        if out.iter().skip(before).any(|output| matches!(output, Output::Act { .. })) {
            self.forget_plan_before();
        }
    }

    /// When to call [`Executor::step`] with a tick, if nothing else happens before.
    pub fn deadline(&self) -> Option<Time> {
        let due_s = if self.is_flying() { self.due_s() } else { f64::INFINITY };
        let wait_s = (due_s - self.life.clock.now_s()).max(0.0);
        let last = self.last_step?;
        wait_s.is_finite().then(|| last + Time::from_secs_f64(wait_s.min(3600.0)))
    }

    /// When something is due by itself while it flies, by its own clock; infinity: never.
    fn due_s(&self) -> f64 {
        let clock = &self.life.clock;
        let review = self.flight.horizon.has_provisional_choices().then(|| clock.review_due_s());
        let wait = self.flight.overrides.wait().map(|wait| wait.due_s());
        let all = [review, clock.refresh_due_s(), wait, self.next_action_s()];
        all.into_iter().flatten().fold(f64::INFINITY, f64::min)
    }

    /// The active plan.
    pub fn program(&self) -> Option<&Arc<Program>> {
        // whatever was compiled has a stage
        Some(&self.setup.program).filter(|program| !program.plan.stages.is_empty())
    }

    /// The plan that was proposed last and may be committed.
    pub fn proposed(&self) -> Option<&Arc<Program>> {
        self.proposed.as_ref()
    }

    /// Present values of the plan's variables.
    pub fn variables(&self) -> &Variables {
        self.life.values.current()
    }

    /// Waypoints issued and not flown yet, the current one first.
    pub fn ahead(&self) -> impl Iterator<Item = &Waypoint> {
        self.flight.horizon.iter().map(|h| &h.waypoint)
    }

    /// Highest token used so far.
    pub fn last_token(&self) -> Token {
        self.life.numbers.token()
    }

    /// When it was last stepped, if ever.
    pub fn last_step(&self) -> Option<Time> {
        self.last_step
    }

    /// Goes on numbering after a token that the gateway has seen (its memory may be longer than a snapshot's).
    pub fn number_after(&mut self, highest: Token) {
        self.life.numbers.token_used(highest);
    }

    fn advance_clock(&mut self, now: Time) {
        if let Some(last) = self.last_step {
            self.life.clock.advance(seconds_between(last, now));
        }
        self.last_step = Some(self.last_step.map_or(now, |last| last.max(now)));
    }

    fn answer(&self, request: RequestId, result: Result<(), Refusal>, out: &mut Vec<Output>) {
        out.push(Output::Answer { request, result: result.map(|()| Answer::Done) });
    }

    /// What is due after every input.
    fn do_what_is_due(&mut self, out: &mut Vec<Output>) {
        if !self.is_flying() {
            return;
        }
        self.act_on_the_way(out);
        if self.flight.overrides.wait().is_some_and(|wait| self.life.clock.is_due(wait.due_s())) {
            self.end_wait(out);
        }
        if self.life.clock.refresh_due_s().is_some_and(|due_s| self.life.clock.is_due(due_s)) {
            self.refresh(out);
        }
        let reviews = self.life.clock.is_due(self.life.clock.review_due_s());
        if reviews {
            self.life.clock.review_in(self.setup.config.review_s);
            self.reevaluate_choices(out);
        }
        self.fill(out);
        self.attend_questions(reviews, out);
    }

    /// A plan is being flown, and where the aircraft is is known: what is ahead of it can be reviewed.
    pub fn is_under_way(&self) -> bool {
        self.is_flying() && self.life.aircraft().is_some()
    }

    /// Between start and finish, holding or not.
    pub(crate) fn is_flying(&self) -> bool {
        self.life.mode.is_flying()
    }

    fn flying_program(&self) -> Result<Arc<Program>, Refusal> {
        if self.is_flying() {
            return Ok(self.setup.program.clone());
        }
        if self.life.mode.is_grounded() {
            let reason = "the aircraft stands between two flights of the plan: start the next one first";
            return Err(refusal("not-flying", reason));
        }
        Err(refusal("not-flying", "no plan is being flown: commit a plan and start it first"))
    }

    /// What is changed now must wait to be fed.
    pub(crate) fn is_muted(&self) -> bool {
        self.life.mode.is_muted()
    }

    fn enter_phase(&mut self, phase: Phase, out: &mut Vec<Output>) {
        self.life.mode.enter(phase, out);
    }

    /// The world as the cursor sees it.
    pub fn world(&self) -> World<'_> {
        let decisions = self.flight.questions.decisions();
        let Flight { overrides, emergencies, .. } = &self.flight;
        World { decisions, ..self.setup.world(&self.life, overrides, emergencies) }
    }

    /// The path ahead, measured from the aircraft.
    fn path_ahead(&self) -> PathAhead<'_> {
        self.setup.path_ahead(&self.life, &self.flight.horizon)
    }

    /// The aircraft as the end of the path that it has flown; before its first report, standing at home.
    pub fn here(&self) -> PathState {
        let path = self.path_ahead();
        self.setup.here(path.aircraft, path.distance_flown_m(), path.time_flown_s())
    }

    /// Asks for decisions that came into the horizon, and now and then for those that are due soon beyond it.
    fn attend_questions(&mut self, looks_ahead: bool, out: &mut Vec<Output>) {
        if !looks_ahead && !self.flight.horizon.has_forks() {
            return;
        }
        let Self { setup, life, flight: Flight { questions, horizon, overrides, emergencies, .. }, .. } =
            self;
        let (path, world) = (setup.path_ahead(life, horizon), setup.world(life, overrides, emergencies));
        questions.attend(&path, &world, out);
        if looks_ahead {
            questions.ask_ahead(&path, &world, out);
        }
    }
}
