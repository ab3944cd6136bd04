//! Pure: what the FP Manager does, between the executor and the gateway. Time is an argument;
//! what has to be said to the outside comes out as [`Effect`]s.

use super::aircraft::Aircraft;
use super::alarms::Alarms;
use super::feeder::{Fate, Feeder};
use super::liaison::Liaison;
use super::runways::safe_runways;
use crate::clock::Time;
use flight_exec::{Answer, Executor, Input, Output, Phase, RequestId, Token};
use flight_plan::Program;
use std::collections::BTreeSet;
use std::sync::Arc;
use usal::contract::*;

/// What has to be done outside.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Feed the gateway; tell [`Manager::fed`] the answer.
    Feed(Feed),
    /// Join the gateway; tell [`Manager::joined`] the answer.
    Join(Join),
    /// Ask the gateway; tell [`Manager::requested`] the answer.
    Request(GatewayRequest),
    /// Publish an event.
    Event(PlanEvent),
    /// Something changed that must survive this process.
    Save,
}

/// The FP Manager without its shell.
pub struct Manager {
    executor: Executor,
    feeder: Feeder,
    liaison: Liaison,
    aircraft: Aircraft,
    alarms: Alarms,
    /// Highest token that the autopilot was seen steering to.
    steered: Token,
    last_request: u64,
}

impl Manager {
    /// Around an executor, fresh or restored; `launch_wanted`: a take-off was ordered and not confirmed.
    pub fn new(executor: Executor, launch_wanted: bool) -> Self {
        let mut liaison = Liaison::default();
        if launch_wanted {
            liaison.want(GatewayRequest::Launch);
        }
        Self {
            executor,
            feeder: Feeder::default(),
            liaison,
            aircraft: Aircraft::default(),
            alarms: Alarms::default(),
            steered: Token(0),
            last_request: 0,
        }
    }

    /// With the alarms that were answered before a restart.
    pub fn having_answered(self, alarms: BTreeSet<String>) -> Self {
        Self { alarms: Alarms::restored(alarms), ..self }
    }

    /// Identifiers of the alarms that were answered.
    pub fn answered_alarms(&self) -> &BTreeSet<String> {
        self.alarms.answered()
    }

    /// The executor, to be looked at.
    pub fn executor(&self) -> &Executor {
        &self.executor
    }

    /// A take-off was ordered and is not confirmed yet.
    pub fn is_launch_wanted(&self) -> bool {
        self.liaison.wanted() == Some(&GatewayRequest::Launch)
    }

    /// The gateway takes our waypoints.
    pub fn is_joined(&self) -> bool {
        self.liaison.is_joined()
    }

    /// Fresh variables of the gateway; they reach the executor with the next tick.
    pub fn aircraft(&mut self) -> &mut Aircraft {
        &mut self.aircraft
    }

    /// Time has passed.
    pub fn tick(&mut self, now: Time, out: &mut Vec<Effect>) {
        let input = self.aircraft.state().map_or(Input::Tick, Input::Aircraft);
        self.step(now, input, out);
        self.send(now, out);
    }

    /// A command of a person or a service.
    ///
    /// # Errors
    /// The executor's refusal.
    pub fn command(&mut self, now: Time, command: Command, out: &mut Vec<Effect>) -> Result<(), Refusal> {
        let starts = command == Command::Start;
        let request = self.next_request();
        let answer = self.step(now, Input::Command { request, command }, out);
        answer.unwrap_or_else(|| Err(unanswered())).map(drop)?;
        if starts {
            self.liaison.want(GatewayRequest::Launch);
        }
        out.push(Effect::Save);
        self.send(now, out);
        Ok(())
    }

    /// A plan is put forward.
    ///
    /// # Errors
    /// The executor's refusal.
    pub fn propose(
        &mut self,
        now: Time,
        program: Program,
        out: &mut Vec<Effect>,
    ) -> Result<ProposalReport, Refusal> {
        let request = self.next_request();
        match self.step(now, Input::Propose { request, program: Arc::new(program) }, out) {
            Some(Ok(Answer::Proposal(report))) => Ok(*report),
            Some(Err(refusal)) => Err(refusal),
            Some(Ok(Answer::Done)) | None => Err(unanswered()),
        }
    }

    /// The gateway's buffer and place, as it publishes them.
    pub fn navigation(&mut self, now: Time, navigation: &Navigation, out: &mut Vec<Effect>) {
        if let Some(current) = navigation.current {
            self.progress(now, current, out);
        }
        if navigation.room > self.feeder.waiting() {
            self.feeder.hurry();
        }
        self.send(now, out);
    }

    /// The gateway's state, as it publishes it.
    pub fn gateway_status(&mut self, now: Time, status: &GatewayStatus, out: &mut Vec<Effect>) {
        let controlled = self.liaison.is_controlled();
        self.liaison.state(now, status.state);
        if !controlled && self.liaison.is_controlled() {
            self.feeder.clear();
            self.step(now, Input::GatewayControls(true), out);
        }
        if self.liaison.is_joined() {
            for cause in self.alarms.listed(&status.alarms) {
                self.emergency(now, cause, out);
            }
        }
        self.send(now, out);
    }

    /// Something happened at the gateway.
    pub fn gateway_event(&mut self, now: Time, event: GatewayEvent, out: &mut Vec<Effect>) {
        match event {
            GatewayEvent::Progress { current: Some(current) } => self.progress(now, current, out),
            // while waypoints are on their way it is not the end
            GatewayEvent::Progress { current: None } if self.feeder.is_idle() => {
                self.step(now, Input::Progress { current: None }, out);
                out.push(Effect::Save);
            }
            GatewayEvent::AlarmRaised(alarm) => {
                if let Some(cause) = self.alarms.raised(&alarm) {
                    self.emergency(now, cause, out);
                }
            }
            GatewayEvent::AlarmCleared { id } => self.alarms.cleared(&id),
            GatewayEvent::BufferLow { .. } => self.feeder.hurry(),
            _ => {}
        }
        self.send(now, out);
    }

    /// An alarm of the gateway asks for an emergency plan.
    fn emergency(&mut self, now: Time, cause: Cause, out: &mut Vec<Effect>) {
        tracing::warn!(?cause, "alarm of the gateway: emergency");
        if let Err(refusal) = self.command(now, Command::Emergency { cause, plan: None }, out) {
            tracing::warn!(?cause, "no emergency plan flown: {refusal}");
        }
        out.push(Effect::Save);
    }

    /// The gateway appeared: it has to be joined (again).
    pub fn gateway_appeared(&mut self, now: Time, out: &mut Vec<Effect>) {
        self.liaison.lost();
        self.send(now, out);
    }

    /// The answer to [`Effect::Feed`]; `None`: none came.
    pub fn fed(&mut self, now: Time, answer: Option<FeedAnswer>, out: &mut Vec<Effect>) {
        match self.feeder.answered(now, answer) {
            Fate::Taken => {}
            Fate::Later(why) => tracing::debug!(why, "the gateway takes waypoints later"),
            Fate::Unknown => self.liaison.lost(),
            Fate::Refused(first, reason) => {
                tracing::warn!(first = first.0, reason, "the gateway refused waypoints");
                self.step(now, Input::Rejected { first, reason }, out);
            }
        }
        self.send(now, out);
    }

    /// The answer to [`Effect::Request`].
    pub fn requested(
        &mut self,
        now: Time,
        request: &GatewayRequest,
        answer: Result<(), String>,
        out: &mut Vec<Effect>,
    ) {
        if let Some(reason) = self.liaison.requested(now, request, answer) {
            out.push(Effect::Event(PlanEvent::NotGranted { request: request.name().into(), reason }));
        }
        out.push(Effect::Save);
        self.send(now, out);
    }

    /// The answer to [`Effect::Join`]; `None`: none came.
    pub fn joined(&mut self, now: Time, answer: Option<JoinAnswer>, out: &mut Vec<Effect>) {
        let Some(answer) = self.liaison.joined(now, answer) else { return };
        self.want_runways();
        self.alarms.joined();
        self.feeder.settle(answer.highest);
        self.executor.number_after(answer.highest);
        if let Some(current) = answer.current {
            self.progress(now, current, out);
        }
        let flying =
            matches!(self.executor.status_phase(), Phase::Flying | Phase::AwaitingDecision | Phase::Holding);
        if flying {
            self.agree(now, &answer, out);
        } else {
            self.step(now, Input::GatewayControls(false), out);
        }
        self.send(now, out);
    }

    /// After a join in flight: the gateway must have what we believe it has. Waypoints that it
    /// took and has no more, while the aircraft stands, have been flown: nothing is flown twice.
    fn agree(&mut self, now: Time, answer: &JoinAnswer, out: &mut Vec<Effect>) {
        let ours = self.executor.ahead().last().map(|w| w.token);
        let taken = self.executor.ahead().next().is_some_and(|w| w.token <= answer.highest);
        if self.liaison.is_on_ground() && answer.last.is_none() && taken {
            self.liaison.unwant_launch();
            self.step(now, Input::Progress { current: None }, out);
        } else if self.liaison.take_controlled() || (ours != answer.last && self.feeder.is_idle()) {
            self.feeder.clear();
            // having given control back, the executor sends everything ahead anew
            self.step(now, Input::GatewayControls(true), out);
            self.step(now, Input::GatewayControls(false), out);
        }
    }

    fn progress(&mut self, now: Time, current: Token, out: &mut Vec<Effect>) {
        if current > self.steered && current <= self.executor.last_token() {
            self.steered = current;
            self.step(now, Input::Progress { current: Some(current) }, out);
            out.push(Effect::Save);
        }
    }

    fn next_request(&mut self) -> RequestId {
        self.last_request += 1;
        RequestId(self.last_request)
    }

    /// Steps the executor and passes on what it wants; its answer, if there is one.
    fn step(&mut self, now: Time, input: Input, out: &mut Vec<Effect>) -> Option<Result<Answer, Refusal>> {
        let mut outputs = Vec::new();
        self.executor.step(now, input, &mut outputs);
        let mut answer = None;
        for output in outputs {
            match output {
                Output::Feed { cancel_after, waypoints } => {
                    self.feeder.push(Feed { cancel_after, waypoints });
                    out.push(Effect::Save);
                }
                Output::Hold => self.liaison.want(GatewayRequest::Hold),
                Output::Event(event) => self.happened(event, out),
                Output::Answer { result, .. } => answer = Some(result),
            }
        }
        answer
    }

    fn happened(&mut self, event: PlanEvent, out: &mut Vec<Effect>) {
        if let PlanEvent::PhaseChanged { phase: Phase::Flying | Phase::AwaitingDecision } = event {
            self.liaison.flies_on();
        }
        if matches!(event, PlanEvent::PlanActivated { .. }) {
            self.want_runways();
        }
        out.push(Effect::Event(event));
        out.push(Effect::Save);
    }

    /// The gateway should know the plan's runways. A plan without any leaves it those it has.
    fn want_runways(&mut self) {
        let runways = self.executor.program().map(|p| safe_runways(&p.plan)).unwrap_or_default();
        if !runways.is_empty() {
            self.liaison.want_runways(runways);
        }
    }

    /// Sends what is due: first the join, then waypoints, then what wants them to be there.
    fn send(&mut self, now: Time, out: &mut Vec<Effect>) {
        if self.liaison.should_join(now) {
            out.push(Effect::Join(Join {
                plan: self.executor.program().map(|p| p.hash.to_string()),
                last_token: self.executor.last_token(),
            }));
        }
        if !self.liaison.is_joined() {
            return;
        }
        if let Some(feed) = self.feeder.send(now) {
            out.push(Effect::Feed(feed));
        }
        if let Some(request) = self.liaison.request(now, self.feeder.is_idle()) {
            out.push(Effect::Request(request));
        }
    }
}

fn unanswered() -> Refusal {
    Refusal {
        code: "unanswered".into(),
        reason: "the executor gave no answer; look at the log and try again".into(),
    }
}
