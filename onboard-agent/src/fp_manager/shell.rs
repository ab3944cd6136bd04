//! Shell: the one loop that owns the session, the clock and the disk.

use super::Config;
use super::background_review::BackgroundReview;
use super::command_review::{Asked, CommandReview, Verdict};
use super::journal::JournalHandle;
use super::manager::{Effect, Manager, OPERATOR};
use super::pending::{Answered, Pending};
use super::proposals::{ProposalReview, Sight, good_for_now, looked_at};
use super::publish::{self, Publishers};
use super::recording::open;
use crate::clock::{Clock, Time};
use crate::{Shutdown, single_instance};
use anyhow::Context;
use flight_exec::{Command, Event, Refusal};
use flight_plan::{Problem, Program};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::Instant;
use usal::contract::{
    self, Air, Empty, GatewayStatus, Gps, Navigation, PlanDocument, Position, Power, ProposalReport, Propose,
    TimedGatewayEvent,
};
use usal::topics::{self, FP_MANAGER, GATEWAY, fp_manager, gateway};
use usal::{
    Announcement, CallError, Description, EventSubscriber, Incoming, Occurrence, Participant, Presence,
    Server, Session, Start, VariableSubscriber,
};
use wire::Convert;

/// The gateway answers at once or not at all, wall-clock.
const CALL_TIMEOUT: Duration = Duration::from_millis(1500);
/// In lockstep, answers on their way are waited for so long (wall-clock) before time goes on.
const ANSWER_PATIENCE: Duration = Duration::from_secs(2);
/// Exchanges with the gateway within one step of time.
const EXCHANGES_MAX: usize = 16;

/// What is asked of us.
struct Services {
    propose: Server<Propose, ProposalReport>,
    command: Server<contract::Command, Empty>,
    plan: Server<Empty, PlanDocument>,
    describe: Server<Empty, Description>,
    _announcement: Announcement,
}

enum Call {
    Propose(Incoming<Propose, ProposalReport>),
    Command(Incoming<contract::Command, Empty>),
    Plan(Incoming<Empty, PlanDocument>),
    Describe(Incoming<Empty, Description>),
}

impl Services {
    fn new(session: &Session) -> anyhow::Result<Self> {
        Ok(Self {
            propose: session.serve(fp_manager::PROPOSE)?,
            command: session.serve(fp_manager::COMMAND)?,
            plan: session.serve(fp_manager::PLAN_DOCUMENT)?,
            describe: session.serve_description(topics::FP_MANAGER)?,
            _announcement: session.announce(FP_MANAGER)?,
        })
    }

    /// The next call; `None` when the session is closed. May be cancelled.
    async fn next(&mut self) -> Option<Call> {
        Some(tokio::select! {
            call = self.command.recv() => Call::Command(call?),
            call = self.propose.recv() => Call::Propose(call?),
            call = self.plan.recv() => Call::Plan(call?),
            call = self.describe.recv() => Call::Describe(call?),
        })
    }
}

/// What we hear of the gateway.
struct Subscriptions {
    position: VariableSubscriber<Position>,
    air: VariableSubscriber<Air>,
    power: VariableSubscriber<Power>,
    gps: VariableSubscriber<Gps>,
    navigation: VariableSubscriber<Navigation>,
    state: VariableSubscriber<GatewayStatus>,
    events: EventSubscriber<TimedGatewayEvent>,
    presence: Presence,
    gateway_there: bool,
}

impl Subscriptions {
    fn new(session: &Session) -> anyhow::Result<Self> {
        Ok(Self {
            position: session.follow(gateway::POSITION)?,
            air: session.follow(gateway::AIR)?,
            power: session.follow(gateway::POWER)?,
            gps: session.follow(gateway::GPS)?,
            navigation: session.follow(gateway::NAVIGATION)?,
            state: session.follow(gateway::STATE)?,
            // old progress and old alarms are of no interest to one who comes back
            events: session.listen(gateway::EVENTS, Start::Now)?,
            presence: session.presence()?,
            gateway_there: false,
        })
    }
}

pub(super) struct Shell {
    config: Config,
    session: Session,
    pub(super) clock: Clock,
    pub(super) manager: Manager,
    pub(super) journal: Option<JournalHandle>,
    pub(super) publishers: Publishers,
    pending: Pending,
    proposal_review: ProposalReview,
    command_review: CommandReview,
    background_review: BackgroundReview,
}

/// Runs the FP Manager until `shutdown`.
///
/// # Errors
/// The session or the state directory can't be had, or the plan it was started with can't be flown.
pub async fn run(config: Config, mut shutdown: Shutdown) -> anyhow::Result<()> {
    let _lock = single_instance::lock(config.state_dir.as_deref(), FP_MANAGER).await?;
    let client = usal::Config::client(&config.vehicle, &config.connect);
    let session = Session::open(client).await.context("the FP Manager's network session")?;
    let outcome = run_in(&session, config, &mut shutdown).await;
    session.close().await;
    outcome
}

async fn run_in(session: &Session, config: Config, shutdown: &mut Shutdown) -> anyhow::Result<()> {
    single_instance::expect_nobody(session, FP_MANAGER).await?;
    let (journal, past) = open(&config)?;
    let mut subscriptions = Subscriptions::new(session)?;
    let mut services = Services::new(session)?;
    let clock = match config.simulated {
        true => Clock::simulated(Participant::join(session, FP_MANAGER)?),
        false => Clock::monotonic(),
    };
    let publishers = Publishers::new(session)?;
    let session = session.clone();
    let pending = Pending::default();
    let manager = past.manager;
    let (proposal_review, command_review, background_review) =
        (ProposalReview::default(), CommandReview::default(), BackgroundReview::default());
    let mut shell = Shell {
        config,
        session,
        clock,
        manager,
        journal,
        publishers,
        pending,
        proposal_review,
        command_review,
        background_review,
    };
    let troubles = past.troubles.into_iter();
    shell.tell(troubles.map(|reason| Event::NotJournalled { reason }).collect()).await;
    shell.load_plan().await?;
    loop {
        let held_until = shell.held_until();
        tokio::select! {
            () = shutdown.requested() => break,
            beat = next_beat(&mut shell.clock, held_until) => {
                anyhow::ensure!(beat.is_some(), "the network session was closed");
                shell.beat(&mut subscriptions).await;
            }
            answered = shell.pending.next() => shell.answered(answered).await,
            occurrence = subscriptions.events.recv() => {
                shell.occurred(occurrence.context("the network session was closed")?).await;
            }
            (incoming, in_flight, looked) = shell.proposal_review.next(&mut shell.journal) => shell.looked(incoming, in_flight, looked).await,
            problems = shell.command_review.next() => shell.looked_ahead(problems).await,
            events = shell.background_review.next() => shell.tell(events).await,
            call = services.next() => shell.call(call.context("the network session was closed")?).await,
        }
    }
    shell.save_state();
    if let Some(journal) = &mut shell.journal {
        journal.done().await;
    }
    Ok(())
}

/// The next beat; in lockstep, what was asked before is looked at first.
async fn next_beat(clock: &mut Clock, held_until: Option<Instant>) -> Option<Time> {
    if let Some(until) = held_until.filter(|_| clock.is_simulated()) {
        tokio::time::sleep_until(until).await;
    }
    clock.beat().await
}

fn refusal(code: &str, reason: String) -> Refusal {
    Refusal { code: code.into(), reason }
}

impl Shell {
    /// The plan it was started with becomes the active one, unless one was restored.
    async fn load_plan(&mut self) -> anyhow::Result<()> {
        let Some(xml) = self.config.plan.take().filter(|_| self.manager.executor().program().is_none())
        else {
            return Ok(());
        };
        let program = looked_at(&xml, &self.config, &self.sight());
        let report = self.propose(program, None).await.map_err(|r| anyhow::anyhow!("the plan: {r}"))?;
        let commit = Command::Commit { hash: report.hash, entry: None };
        self.command(commit, OPERATOR, None).await.map_err(|r| anyhow::anyhow!("the plan: {r}"))
    }

    /// In lockstep, time stands until then, while something is looked at.
    fn held_until(&self) -> Option<Instant> {
        let held = [
            self.proposal_review.holds_time_until(),
            self.command_review.holds_time_until(),
            self.background_review.holds_time_until(),
        ];
        held.into_iter().flatten().min()
    }

    /// Everything due at a beat of the clock.
    async fn beat(&mut self, subscriptions: &mut Subscriptions) {
        while let Some(occurrence) = subscriptions.events.try_recv() {
            self.occurred(occurrence).await;
        }
        self.listen(subscriptions).await;
        let now = self.clock.now();
        let mut effects = Vec::new();
        self.manager.tick(now, &mut effects);
        self.perform(effects).await;
        self.look_after_journal();
        if self.clock.is_simulated() {
            self.await_answers().await;
        }
        self.publishers.due(now, self.manager.executor());
        self.clock.acknowledge();
    }

    /// In lockstep the network takes no time: what was asked at this instant is answered at it.
    async fn await_answers(&mut self) {
        for _ in 0..EXCHANGES_MAX {
            if self.pending.is_empty() {
                return;
            }
            match tokio::time::timeout(ANSWER_PATIENCE, self.pending.next()).await {
                Ok(answered) => self.answered(answered).await,
                Err(_) => return,
            }
        }
    }

    /// Fresh variables of the gateway.
    async fn listen(&mut self, subscriptions: &mut Subscriptions) {
        let now = self.clock.now();
        let mut effects = Vec::new();
        let aircraft = self.manager.aircraft();
        subscriptions.position.take_new().iter().for_each(|r| aircraft.position(r.stamped.value));
        subscriptions.air.take_new().iter().for_each(|r| aircraft.air(r.stamped.value));
        subscriptions.power.take_new().iter().for_each(|r| aircraft.power(r.stamped.value));
        let unix_s = subscriptions.gps.take_new().and_then(|r| r.stamped.value.unix_s);
        unix_s.into_iter().for_each(|unix_s| self.manager.time_of_day(now, unix_s));
        let there = subscriptions.presence.is_alive(GATEWAY);
        if there && !subscriptions.gateway_there {
            self.manager.gateway_appeared(now, &mut effects);
        }
        subscriptions.gateway_there = there;
        if let Some(received) = subscriptions.state.take_new() {
            self.manager.gateway_status(now, &received.stamped.value, &mut effects);
        }
        if let Some(received) = subscriptions.navigation.take_new() {
            self.manager.navigation(now, &received.stamped.value, &mut effects);
        }
        self.perform(effects).await;
    }

    async fn occurred(&mut self, occurrence: Occurrence<TimedGatewayEvent>) {
        let mut effects = Vec::new();
        match occurrence {
            Occurrence::Event { event, .. } => {
                self.manager.gateway_event(self.clock.now(), event.value, &mut effects)
            }
            Occurrence::Gap { missed } => self.manager.events_lost(self.clock.now(), missed, &mut effects),
        }
        self.perform(effects).await;
    }

    async fn answered(&mut self, answered: Answered) {
        let now = self.clock.now();
        let mut effects = Vec::new();
        match answered {
            Answered::Feed(answer) => self.manager.fed(now, told(answer, "feed"), &mut effects),
            Answered::Join(answer) => self.manager.joined(now, told(answer, "join"), &mut effects),
            Answered::Request(request, answer) => {
                let answer = answer.map(drop).map_err(|e| e.to_string());
                self.manager.requested(now, &request, answer, &mut effects);
            }
        }
        self.perform(effects).await;
    }

    async fn call(&mut self, call: Call) {
        match call {
            Call::Describe(incoming) => incoming.answer(Ok(usal::fp_manager_description())),
            Call::Plan(incoming) => incoming.answer(Ok(self.document())),
            Call::Propose(incoming) => self.proposed(incoming).await,
            Call::Command(incoming) => {
                let id = incoming.id().map(str::to_owned);
                let by = incoming.from().unwrap_or(OPERATOR).to_owned();
                let (command, reply) = incoming.split();
                let reply =
                    |answer: Result<(), Refusal>| reply(answer.map(|()| Empty {}).map_err(Convert::convert));
                self.asked(Asked { command: command.convert(), by, id, reply: Box::new(reply) }).await;
            }
        }
        self.publishers.hurry();
        if !self.clock.is_simulated() {
            self.publishers.due(self.clock.now(), self.manager.executor());
        }
    }

    async fn proposed(&mut self, incoming: Incoming<Propose, ProposalReport>) {
        let revision = self.manager.executor().status().revision;
        if incoming.request.seen_revision.is_some_and(|seen| seen != revision) {
            let reason = format!("the plan is at revision {revision} by now: look at it, then propose again");
            return incoming.answer(Err(refusal("stale-revision", reason).convert()));
        }
        let sight = self.sight();
        self.proposal_review.take(incoming, &self.config, sight);
    }

    /// What a plan put forward now is looked at for.
    fn sight(&self) -> Sight {
        let flight = Some(self.manager.executor()).filter(|executor| executor.is_under_way());
        Sight { conditions: self.manager.conditions(self.clock.now()), flight: flight.cloned() }
    }

    /// What leads to where nobody has looked is looked at first.
    async fn asked(&mut self, asked: Asked) {
        if self.command_review.concern(&asked, &self.manager) {
            self.command_review.take(asked);
            return self.look_on().await;
        }
        self.give(asked).await;
    }

    async fn give(&mut self, asked: Asked) {
        let Asked { command, by, id, reply } = asked;
        let answer = self.command(command, &by, id.as_deref()).await;
        reply(answer);
    }

    /// The command that was the first to wait has been looked at.
    async fn looked_ahead(&mut self, problems: Vec<Problem>) {
        match self.command_review.decide(&problems, &self.manager) {
            Some(Verdict::Give(asked)) => self.give(asked).await,
            Some(Verdict::Refuse(asked, refusal)) => (asked.reply)(Err(refusal)),
            Some(Verdict::Again) | None => {}
        }
        self.look_on().await;
        self.publishers.hurry();
    }

    /// Goes on with what waits for a look.
    async fn look_on(&mut self) {
        while let Some(asked) = self.command_review.begin(&self.manager, self.clock.now()) {
            self.give(asked).await;
        }
    }

    /// A proposal has been looked at. The executor sees to it that the plan it was made for is still the one being flown.
    async fn looked(
        &mut self,
        incoming: Incoming<Propose, ProposalReport>,
        in_flight: bool,
        looked: Result<Arc<Program>, Refusal>,
    ) {
        let looked =
            looked.and_then(|program| good_for_now(in_flight, self.manager.executor()).map(|()| program));
        let answer = self.propose(looked, incoming.request.seen_revision).await;
        incoming.answer(answer.convert());
    }

    async fn propose(
        &mut self,
        program: Result<Arc<Program>, Refusal>,
        based_on: Option<u64>,
    ) -> Result<flight_exec::ProposalReport, Refusal> {
        let mut effects = Vec::new();
        let report = self.manager.propose(self.clock.now(), program?, based_on, &mut effects);
        self.perform(effects).await;
        report
    }

    async fn command(&mut self, command: Command, by: &str, id: Option<&str>) -> Result<(), Refusal> {
        let executor = self.manager.executor();
        let before = executor.takes_its_own_way(&command).then(|| executor.clone());
        let mut effects = Vec::new();
        let answer = self.manager.command(self.clock.now(), command, by, id, &mut effects);
        if let (Ok(()), Some(before)) = (&answer, before) {
            let after = self.manager.executor().clone();
            let conditions = self.manager.conditions(self.clock.now());
            self.background_review.look(move || flight_exec::review_turn(&before, &after, conditions));
        }
        self.perform(effects).await;
        answer
    }

    fn document(&self) -> PlanDocument {
        let executor = self.manager.executor();
        let xml = executor.program().map(|p| flight_plan::write(&p.plan)).unwrap_or_default();
        PlanDocument { info: publish::plan_info(executor), xml }
    }

    async fn tell(&mut self, events: Vec<Event>) {
        self.perform(events.into_iter().map(Effect::Event).collect()).await;
    }

    async fn perform(&mut self, effects: Vec<Effect>) {
        let effects = self.record(effects).await;
        let now = self.clock.now();
        for effect in effects {
            match effect {
                Effect::Event(event) => {
                    self.publishers.event(now, event);
                    self.publishers.hurry();
                }
                Effect::Feed(feed) => {
                    self.pending.feed = Some(self.session.call(gateway::FEED, &feed, CALL_TIMEOUT))
                }
                Effect::Join(join) => {
                    self.pending.join = Some(self.session.call(gateway::JOIN, &join, CALL_TIMEOUT))
                }
                Effect::Request(request) => {
                    let call = self.session.call(gateway::REQUEST, &request, CALL_TIMEOUT);
                    self.pending.request = Some((request, call));
                }
                Effect::Invoke { service, operation, argument } => {
                    let call = self.session.call_named::<_, serde_json::Value>(
                        &service,
                        &operation,
                        &argument,
                        CALL_TIMEOUT,
                    );
                    tokio::spawn(async move {
                        told(call.await, &format!("the plan's call of {service}/{operation}"));
                    });
                }
                Effect::Record(_) | Effect::Keep(_) | Effect::Sync => {}
            }
        }
    }
}

/// An answer, or nothing and a line in the log.
fn told<A>(answer: Result<A, CallError>, what: &str) -> Option<A> {
    answer.inspect_err(|error| tracing::warn!("{what}: {error}")).ok()
}
