//! Pure: what the FP Manager does, between the executor and the gateway. Time is an argument;
//! what has to be said to the outside comes out as [`Effect`]s. Those of one call are a turn: its
//! records are written first, as one, and synced if asked for; only then the rest is carried out.

use super::aircraft::Aircraft;
use super::alarms::Alarms;
use super::feeder::{BatchResult, Feeder};
use super::gateway_session::GatewaySession;
use super::journal::{Entry, ManagerState, Record, Reply};
use super::plan_history::PlanHistory;
use super::timeline::Timeline;
use ::aircraft::Wind;
use flight_exec::{
    AircraftState, Answer, Command, Conditions, Event, Executor, Input, Output, Phase, ProposalReport,
    Refusal, RequestId, ResolvedAct, Token,
};
use flight_plan::{Id, Problem, Program};
use service::Time;
use std::collections::VecDeque;
use std::sync::Arc;
use usal::Instance;
use usal::contract::{AutopilotKind, Feed, FeedAnswer, GatewayRequest, Join};
use wire::Convert;

/// What has to be done outside.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Feed the gateway; pass the answer to [`Manager::fed`].
    Feed(Feed),
    /// Join the gateway; pass the answer to [`Manager::joined`].
    Join(Join),
    /// Ask the gateway; pass the answer to [`Manager::requested`].
    Request(GatewayRequest),
    /// Call a service for the plan; nobody waits for the answer.
    Invoke {
        /// The service.
        service: String,
        /// Its operation.
        operation: String,
        /// The request.
        argument: serde_json::Value,
    },
    /// Publish an event.
    Event(Event),
    /// Record this, with all of the turn's records, before anything else of the turn takes effect.
    Record(Entry),
    /// Keep this plan's document before the turn is recorded.
    Keep(Arc<Program>),
    /// The turn's records have to be on the disk before anything else of the turn takes effect.
    Sync,
}

/// Answers remembered, should a request be repeated after a restart.
const REPLIES: usize = 64;
/// Longer names of requests are not remembered, bytes.
const REPLY_ID_MAX: usize = 128;

/// The FP Manager without its shell.
pub struct Manager {
    pub(super) executor: Executor,
    pub(super) feeder: Feeder,
    pub(super) gateway_session: GatewaySession,
    aircraft: Aircraft,
    pub(super) alarms: Alarms,
    pub(super) timeline: Timeline,
    pub(super) plan_history: PlanHistory,
    /// Highest token that the autopilot was seen steering to.
    pub(super) steered: Token,
    pub(super) last_request: u64,
    /// Commands that may have taken the flight elsewhere.
    pub(super) turns: u64,
    /// The time of day when it was received last, seconds since 1970.
    day: Option<(Time, i64)>,
    /// The autopilot, as the gateway said last.
    pub(super) autopilot: Option<AutopilotKind>,
    /// As recorded last.
    pub(super) noted: ManagerState,
    pub(super) replies: VecDeque<Reply>,
    /// It goes on with a flight of an earlier process and has not joined since.
    pub(super) returning: bool,
    /// Why the flight of an earlier process could not be gone on with.
    pub(super) without_past: Option<String>,
}

impl Manager {
    /// Around an executor that has done nothing yet. Its time begins at `base`, which in simulation is zero, in
    /// flight the time since the machine was started.
    pub fn new(executor: Executor, base: Time) -> Self {
        Self {
            executor,
            feeder: Feeder::default(),
            gateway_session: GatewaySession::default(),
            aircraft: Aircraft::default(),
            alarms: Alarms::default(),
            timeline: Timeline::new(base),
            plan_history: PlanHistory::default(),
            steered: Token(0),
            last_request: 0,
            turns: 0,
            day: None,
            autopilot: None,
            noted: ManagerState::default(),
            replies: VecDeque::new(),
            returning: false,
            without_past: None,
        }
    }

    /// The executor, to be read.
    pub fn executor(&self) -> &Executor {
        &self.executor
    }

    /// The gateway takes our waypoints.
    pub fn is_joined(&self) -> bool {
        self.gateway_session.is_joined()
    }

    /// The gateway is to be asked to fly the plan on, and has not agreed yet.
    pub fn wants_resume(&self) -> bool {
        self.gateway_session.wanted() == Some(&GatewayRequest::Resume)
    }

    /// The session of the gateway that answered the last join, if it said so.
    pub fn gateway(&self) -> Option<Instance> {
        self.gateway_session.gateway()
    }

    /// The wind as it is measured (calm, as long as nothing is known), the air, the time of day, and what the autopilot takes.
    pub fn conditions(&self, now: Time) -> Conditions {
        let state = self.aircraft.state(now, self.alarms.engine_is_out());
        let wind =
            state.map_or(Wind::CALM, |s| Wind { east_mps: s.wind_east_mps, north_mps: s.wind_north_mps });
        let since_s = |then| now.saturating_sub(then).as_secs();
        let start_unix_s = self.day.map(|(then, unix_s)| unix_s.saturating_add_unsigned(since_s(then)));
        let isa_deviation_c = self.aircraft.isa_deviation_c();
        let kind = self.autopilot.as_ref();
        let landing_deg = kind.and_then(|kind| kind.landing_deg).filter(|degrees| degrees.is_finite());
        let autopilot = kind.and_then(|kind| kind.habits.as_ref()?.parse().ok());
        Conditions { wind, start_unix_s, autopilot, isa_deviation_c, landing_deg, ..Conditions::default() }
    }

    /// The time of day, seconds since 1970-01-01T00:00:00Z, as the satellites give it.
    pub fn time_of_day(&mut self, now: Time, unix_s: i64) {
        self.day = Some((now, unix_s));
    }

    /// Counts up when the flight may go elsewhere than it was to.
    pub fn turns(&self) -> u64 {
        self.turns
    }

    /// Fresh variables of the gateway; they reach the executor with the next tick.
    pub fn aircraft(&mut self) -> &mut Aircraft {
        &mut self.aircraft
    }

    /// Time has passed.
    pub fn tick(&mut self, now: Time, out: &mut Vec<Effect>) {
        self.timeline.begin(now, self.executor.last_step());
        if let Some(reason) = self.gateway_session.tick(now) {
            self.not_launched(now, reason, out);
        }
        let input = self.aircraft_state(now).map_or(Input::Tick, Input::Aircraft);
        self.step(now, input, out);
        self.send(now, out);
    }

    /// The executor's view of the aircraft, once its position is known.
    pub(super) fn aircraft_state(&self, now: Time) -> Option<AircraftState> {
        self.aircraft.state(now, self.alarms.engine_is_out())
    }

    /// A command of a person or a service; `by` is who asks, `id` the request's own name. One that was
    /// answered already is answered again, and not executed.
    ///
    /// # Errors
    /// The executor's refusal.
    pub fn command(
        &mut self,
        now: Time,
        command: Command,
        by: &str,
        id: Option<&str>,
        out: &mut Vec<Effect>,
    ) -> Result<(), Refusal> {
        let id = id.filter(|id| id.len() <= REPLY_ID_MAX).and_then(|id| reply_id(by, id, &command));
        if let Some(reply) = self.replies.iter().find(|reply| Some(&reply.id) == id.as_ref()) {
            return reply.result.clone();
        }
        let result = self.order(now, command, by, out);
        if let Some(id) = id {
            let reply = Reply { id, result: result.clone() };
            self.record(now, Record::Answered(reply.clone()), out);
            self.remember(reply);
        }
        result
    }

    pub(super) fn remember(&mut self, reply: Reply) {
        self.replies.push_back(reply);
        if self.replies.len() > REPLIES {
            self.replies.pop_front();
        }
    }

    /// A plan is put forward; `based_on` is the revision that the proposer has seen.
    ///
    /// # Errors
    /// The executor's refusal.
    pub fn propose(
        &mut self,
        now: Time,
        program: impl Into<Arc<Program>>,
        based_on: Option<u64>,
        out: &mut Vec<Effect>,
    ) -> Result<ProposalReport, Refusal> {
        let request = self.next_request();
        let (program, objections) = (program.into(), Vec::new());
        let input = Input::Propose { request, program, based_on, objections };
        match self.step(now, input, out) {
            Some(Ok(Answer::Proposal(report))) => Ok(*report),
            Some(Err(refusal)) => Err(refusal),
            Some(Ok(Answer::Done)) | None => Err(unanswered()),
        }
    }

    /// The answer to [`Effect::Feed`]; `None`: none came.
    pub fn fed(&mut self, now: Time, answer: Option<FeedAnswer>, out: &mut Vec<Effect>) {
        match self.feeder.answered(now, answer) {
            BatchResult::Taken => {}
            BatchResult::Later(why) => tracing::debug!(why, "the gateway takes waypoints later"),
            BatchResult::Unknown => self.gateway_session.lost(),
            BatchResult::Refused(first, reason) => {
                tracing::warn!(first = first.0, reason, "the gateway refused waypoints");
                self.step(now, Input::Rejected { first: first.convert(), reason }, out);
                if self.is_in_emergency() && self.executor.status_phase() == Phase::Holding {
                    // its plan can't be flown: a gateway that takes no waypoints has to bring the aircraft home
                    self.want_safe();
                }
            }
        }
        self.send(now, out);
    }

    /// Whatever becomes of the alarms.
    fn want_safe(&mut self) {
        self.gateway_session.want(GatewayRequest::Safe);
        self.alarms.safe_is_settled();
    }

    /// The take-off was not granted in time, or did not come about: the plan stands where it stood before its start.
    pub(super) fn not_launched(&mut self, now: Time, reason: String, out: &mut Vec<Effect>) {
        self.gateway_session.unwant(GatewayRequest::Launch);
        let request = GatewayRequest::Launch.name().into();
        out.push(Effect::Event(Event::NotGranted { request, reason }));
        self.step(now, Input::NotLaunched, out);
    }

    pub(super) fn is_in_emergency(&self) -> bool {
        self.executor.status().emergency.is_some()
    }

    /// The answer to [`Effect::Request`].
    pub fn requested(
        &mut self,
        now: Time,
        request: &GatewayRequest,
        answer: Result<(), String>,
        out: &mut Vec<Effect>,
    ) {
        if *request == GatewayRequest::Safe && answer.is_ok() {
            self.alarms.safe_is_settled();
        }
        if let Some(reason) = self.gateway_session.requested(now, request, answer) {
            out.push(Effect::Event(Event::NotGranted { request: request.name().into(), reason }));
        }
        self.send(now, out);
    }

    pub(super) fn progress(&mut self, now: Time, current: Token, out: &mut Vec<Effect>) {
        if current > self.steered && current <= self.executor.last_token() {
            self.step(now, Input::Progress { current: Some(current) }, out);
        }
    }

    pub(super) fn next_request(&mut self) -> RequestId {
        self.last_request += 1;
        RequestId(self.last_request)
    }

    /// Records an input, steps the executor with it and passes on what it wants; its answer, if there is one.
    /// What makes it want something is synced first.
    pub(super) fn step(
        &mut self,
        now: Time,
        input: Input,
        out: &mut Vec<Effect>,
    ) -> Option<Result<Answer, Refusal>> {
        let at = self.timeline.at(now, self.executor.last_step());
        self.count(&input);
        if let Input::Propose { program, .. } = &input {
            out.push(Effect::Keep(program.clone()));
        }
        out.push(Effect::Record(Entry { at, what: recorded(&input) }));
        let mut outputs = Vec::new();
        self.executor.step(at, input, &mut outputs);
        if !outputs.is_empty() {
            out.push(Effect::Sync);
        }
        let mut answer = None;
        for output in outputs {
            match output {
                Output::Feed { cancel_after, waypoints } => {
                    let (cancel_after, waypoints) = (cancel_after.convert(), waypoints.convert());
                    self.feeder.push(Feed { cancel_after, waypoints });
                }
                Output::Hold => self.gateway_session.want(GatewayRequest::Hold),
                Output::Safe => self.want_safe(),
                Output::Event(event) => self.happened(event, out),
                Output::Answer { result, .. } => answer = Some(result),
                Output::Act { leg, passage, act } => out.extend(invocation(leg, passage, act)),
            }
        }
        answer
    }

    pub(super) fn record(&mut self, now: Time, what: Record, out: &mut Vec<Effect>) {
        let at = self.timeline.at(now, self.executor.last_step());
        out.extend([Effect::Record(Entry { at, what }), Effect::Sync]);
    }

    fn happened(&mut self, event: Event, out: &mut Vec<Effect>) {
        if let Event::PhaseChanged { phase: Phase::Flying | Phase::AwaitingDecision } = event {
            self.gateway_session.flies_on();
        }
        if matches!(event, Event::PlanActivated { .. }) {
            self.want_runways();
        }
        out.push(Effect::Event(event));
    }

    /// Sends what is due: first the join, then waypoints, then what wants them to be there.
    pub(super) fn send(&mut self, now: Time, out: &mut Vec<Effect>) {
        self.note(now, out);
        if self.gateway_session.should_join(now) {
            out.push(Effect::Join(self.presentation()));
        }
        if !self.gateway_session.is_joined() {
            out.extend(self.gateway_session.request_back(now).map(Effect::Request));
            return;
        }
        if let Some(feed) = self.feeder.send(now) {
            out.push(Effect::Feed(feed));
        }
        if let Some(request) = self.gateway_session.request(now, self.feeder.is_idle()) {
            out.push(Effect::Request(request));
        }
    }
}

/// The call that an act asks for. The other acts are published as events, for the services that do them.
fn invocation(leg: Id, passage: u64, act: ResolvedAct) -> Option<Effect> {
    let ResolvedAct::Invoke { service, operation, argument } = act else { return None };
    let text = if argument.is_empty() { "null" } else { &argument };
    Some(match serde_json::from_str(text) {
        Ok(argument) => Effect::Invoke { service, operation, argument },
        Err(error) => {
            let reason = format!("the argument for {service}/{operation} is no JSON: {error}");
            Effect::Event(Event::ActionRefused { leg, passage, reason })
        }
    })
}

/// An input as it is recorded.
fn recorded(input: &Input) -> Record {
    match input {
        Input::Propose { request, program, based_on, objections } => Record::Propose {
            request: *request,
            plan: program.hash().clone(),
            based_on: *based_on,
            forbidden: objections.iter().any(Problem::is_error),
        },
        other => Record::Input(other.clone()),
    }
}

/// By which a command is known when it is repeated: who asks, the request's own name, and what is asked. Two clients may
/// well use the same names.
fn reply_id(by: &str, id: &str, command: &Command) -> Option<String> {
    let mut asked = Vec::new();
    ciborium::into_writer(command, &mut asked).ok()?;
    Some(format!("{by}/{id}/{:08x}", crc32fast::hash(&asked)))
}

pub(super) fn unanswered() -> Refusal {
    Refusal {
        code: "unanswered".into(),
        reason: "the executor gave no answer; look at the log and try again".into(),
    }
}
