//! Shell: the one loop that owns the session, the clock and the disk.

use super::Config;
use super::manager::{Effect, Manager};
use super::publish::{self, Publishers};
use super::store::{self, Saved, Store};
use crate::Shutdown;
use crate::clock::Clock;
use anyhow::Context;
use flight_exec::Executor;
use flight_plan::{Problem, Program};
use std::sync::Arc;
use std::time::Duration;
use usal::contract::*;
use usal::topics::{self, FP_MANAGER, GATEWAY, fp_manager, gateway};
use usal::{
    Announcement, CallError, Description, EventSubscriber, Incoming, Occurrence, Participant, PendingCall,
    Presence, Server, Session, Start, VariableSubscriber,
};

/// The gateway answers at once or not at all, wall-clock.
const CALL_TIMEOUT: Duration = Duration::from_millis(1500);
/// An accepted plan is on disk before its acceptance is told, unless that takes longer.
const DISK_PATIENCE: Duration = Duration::from_millis(500);
/// In lockstep, answers on their way are waited for so long (wall-clock) before time goes on.
const ANSWER_PATIENCE: Duration = Duration::from_secs(2);
/// Exchanges with the gateway within one step of time.
const EXCHANGES_MAX: usize = 16;
/// Problems listed in a refusal.
const PROBLEMS_MAX: usize = 20;

/// What is asked of us.
struct Services {
    propose: Server<Propose, ProposalReport>,
    command: Server<Command, Empty>,
    plan: Server<Empty, PlanDocument>,
    describe: Server<Empty, Description>,
    _announcement: Announcement,
}

enum Call {
    Propose(Incoming<Propose, ProposalReport>),
    Command(Incoming<Command, Empty>),
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
struct Ears {
    position: VariableSubscriber<Position>,
    air: VariableSubscriber<Air>,
    power: VariableSubscriber<Power>,
    navigation: VariableSubscriber<Navigation>,
    state: VariableSubscriber<GatewayStatus>,
    events: EventSubscriber<TimedGatewayEvent>,
    presence: Presence,
    gateway_there: bool,
}

impl Ears {
    fn new(session: &Session) -> anyhow::Result<Self> {
        Ok(Self {
            position: session.follow(gateway::POSITION)?,
            air: session.follow(gateway::AIR)?,
            power: session.follow(gateway::POWER)?,
            navigation: session.follow(gateway::NAVIGATION)?,
            state: session.follow(gateway::STATE)?,
            // old progress and old alarms are of no interest to one who comes back
            events: session.listen(gateway::EVENTS, Start::Now)?,
            presence: session.presence()?,
            gateway_there: false,
        })
    }
}

/// What we asked the gateway.
#[derive(Default)]
struct Pending {
    feed: Option<PendingCall<FeedAnswer>>,
    join: Option<PendingCall<JoinAnswer>>,
    request: Option<(GatewayRequest, PendingCall<Empty>)>,
}

enum Answered {
    Feed(Result<FeedAnswer, CallError>),
    Join(Result<JoinAnswer, CallError>),
    Request(GatewayRequest, Result<Empty, CallError>),
}

impl Pending {
    fn is_empty(&self) -> bool {
        self.feed.is_none() && self.join.is_none() && self.request.is_none()
    }

    /// The next answer; never, if nothing was asked. May be cancelled.
    async fn next(&mut self) -> Answered {
        async fn answer<A>(call: Option<&mut PendingCall<A>>) -> Result<A, CallError> {
            match call {
                Some(call) => call.await,
                None => std::future::pending().await,
            }
        }
        let answered = tokio::select! {
            a = answer(self.join.as_mut()) => Answered::Join(a),
            a = answer(self.feed.as_mut()) => Answered::Feed(a),
            a = answer(self.request.as_mut().map(|(_, call)| call)) => {
                let request = self.request.as_ref().map_or(GatewayRequest::Hold, |(r, _)| r.clone());
                Answered::Request(request, a)
            }
        };
        match &answered {
            Answered::Feed(_) => self.feed = None,
            Answered::Join(_) => self.join = None,
            Answered::Request(..) => self.request = None,
        }
        answered
    }
}

struct Shell {
    config: Config,
    session: Session,
    clock: Clock,
    manager: Manager,
    store: Option<Store>,
    publishers: Publishers,
    pending: Pending,
}

/// Runs the FP Manager until `shutdown`.
///
/// # Errors
/// The session or the state directory can't be had, or the plan it was started with can't be flown.
pub async fn run(config: Config, mut shutdown: Shutdown) -> anyhow::Result<()> {
    let client = usal::Config::client(&config.vehicle, &config.connect);
    let session = Session::open(client).await.context("the FP Manager's network session")?;
    let outcome = run_in(&session, config, &mut shutdown).await;
    session.close().await;
    outcome
}

async fn run_in(session: &Session, config: Config, shutdown: &mut Shutdown) -> anyhow::Result<()> {
    let (store, manager) = open(&config)?;
    let mut ears = Ears::new(session)?;
    let mut services = Services::new(session)?;
    let clock = match config.simulated {
        true => Clock::simulated(Participant::join(session, FP_MANAGER)?),
        false => Clock::monotonic(),
    };
    let publishers = Publishers::new(session)?;
    let session = session.clone();
    let mut shell = Shell { config, session, clock, manager, store, publishers, pending: Pending::default() };
    shell.load_plan()?;
    loop {
        tokio::select! {
            () = shutdown.requested() => break,
            beat = shell.clock.beat() => {
                anyhow::ensure!(beat.is_some(), "the network session was closed");
                shell.beat(&mut ears).await;
            }
            answered = shell.pending.next() => shell.answered(answered),
            occurrence = ears.events.recv() => {
                shell.occurred(occurrence.context("the network session was closed")?);
            }
            call = services.next() => shell.call(call.context("the network session was closed")?).await,
        }
    }
    shell.save();
    shell.flush_disk().await;
    Ok(())
}

/// The store and what it remembers.
fn open(config: &Config) -> anyhow::Result<(Option<Store>, Manager)> {
    let fresh = || Executor::new(config.executor.clone(), config.terrain.clone(), config.profile.clone());
    let Some(directory) = &config.state_dir else { return Ok((None, Manager::new(fresh(), false))) };
    let (store, saved) = Store::open(directory)?;
    let Some(saved) = saved else { return Ok((Some(store), Manager::new(fresh(), false))) };
    let (launch_wanted, answered_alarms) = (saved.launch_wanted, saved.answered_alarms.clone());
    let manager = match restore(config, saved) {
        Ok(executor) => {
            tracing::info!(phase = ?executor.status_phase(), "going on where the last FP Manager was");
            Manager::new(executor, launch_wanted).having_answered(answered_alarms)
        }
        Err(error) => {
            store::set_aside(&store::file(directory), &format!("{error:#}"));
            Manager::new(fresh(), false)
        }
    };
    Ok((Some(store), manager))
}

fn restore(config: &Config, saved: Saved) -> anyhow::Result<Executor> {
    let compiled = saved.plan.map(|xml| compile(&xml, config)).transpose();
    let program = compiled.map_err(|problems| anyhow::anyhow!("its plan: {}", listed(&problems)))?;
    let (settings, terrain) = (config.executor.clone(), config.terrain.clone());
    Ok(Executor::restore(settings, terrain, config.profile.clone(), program.map(Arc::new), saved.snapshot)?)
}

fn compile(xml: &str, config: &Config) -> Result<Program, Vec<Problem>> {
    flight_plan::compile_document(xml.as_bytes(), &config.profile, config.terrain.as_ref())
}

fn listed(problems: &[Problem]) -> String {
    let errors = problems.iter().filter(|p| p.is_error());
    let mut told: Vec<String> = errors.clone().take(PROBLEMS_MAX).map(ToString::to_string).collect();
    let more = errors.count().saturating_sub(PROBLEMS_MAX);
    if more > 0 {
        told.push(format!("and {more} more"));
    }
    told.join("; ")
}

fn refusal(code: &str, reason: String) -> Refusal {
    Refusal { code: code.into(), reason }
}

impl Shell {
    /// The plan it was started with becomes the active one, unless one was restored.
    fn load_plan(&mut self) -> anyhow::Result<()> {
        let Some(xml) = self.config.plan.take().filter(|_| self.manager.executor().program().is_none())
        else {
            return Ok(());
        };
        let report = self
            .propose(&Propose { xml, seen_revision: None })
            .map_err(|r| anyhow::anyhow!("the plan: {r}"))?;
        let commit = Command::Commit { hash: report.hash, entry: None };
        self.command(commit).map_err(|r| anyhow::anyhow!("the plan: {r}"))
    }

    /// Everything due at a beat of the clock.
    async fn beat(&mut self, ears: &mut Ears) {
        while let Some(occurrence) = ears.events.try_recv() {
            self.occurred(occurrence);
        }
        self.listen(ears);
        let now = self.clock.now();
        let mut effects = Vec::new();
        self.manager.tick(now, &mut effects);
        self.perform(effects);
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
                Ok(answered) => self.answered(answered),
                Err(_) => return,
            }
        }
    }

    /// Fresh variables of the gateway.
    fn listen(&mut self, ears: &mut Ears) {
        let now = self.clock.now();
        let mut effects = Vec::new();
        let aircraft = self.manager.aircraft();
        ears.position.take_new().iter().for_each(|r| aircraft.position(r.stamped.value));
        ears.air.take_new().iter().for_each(|r| aircraft.air(r.stamped.value));
        ears.power.take_new().iter().for_each(|r| aircraft.power(r.stamped.value));
        let there = ears.presence.is_alive(GATEWAY);
        if there && !ears.gateway_there {
            self.manager.gateway_appeared(now, &mut effects);
        }
        ears.gateway_there = there;
        if let Some(received) = ears.state.take_new() {
            self.manager.gateway_status(now, &received.stamped.value, &mut effects);
        }
        if let Some(received) = ears.navigation.take_new() {
            self.manager.navigation(now, &received.stamped.value, &mut effects);
        }
        self.perform(effects);
    }

    fn occurred(&mut self, occurrence: Occurrence<TimedGatewayEvent>) {
        let mut effects = Vec::new();
        match occurrence {
            Occurrence::Event { event, .. } => {
                self.manager.gateway_event(self.clock.now(), event.value, &mut effects)
            }
            Occurrence::Gap { missed } => tracing::warn!(missed, "events of the gateway were lost"),
        }
        self.perform(effects);
    }

    fn answered(&mut self, answered: Answered) {
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
        self.perform(effects);
    }

    async fn call(&mut self, call: Call) {
        match call {
            Call::Describe(incoming) => incoming.answer(Ok(usal::fp_manager_description())),
            Call::Plan(incoming) => incoming.answer(Ok(self.document())),
            Call::Propose(incoming) => {
                let answer = self.propose(&incoming.request);
                incoming.answer(answer);
            }
            Call::Command(incoming) => {
                let (command, reply) = incoming.split();
                let lasting = matches!(command, Command::Commit { .. } | Command::Start);
                let answer = self.command(command);
                if lasting && answer.is_ok() {
                    self.flush_disk().await;
                }
                reply(answer.map(|()| Empty {}));
            }
        }
        self.publishers.hurry();
        if !self.clock.is_simulated() {
            self.publishers.due(self.clock.now(), self.manager.executor());
        }
    }

    fn propose(&mut self, propose: &Propose) -> Result<ProposalReport, Refusal> {
        let revision = self.manager.executor().status().revision;
        if propose.seen_revision.is_some_and(|seen| seen != revision) {
            let reason = format!("the plan is at revision {revision} by now: look at it, then propose again");
            return Err(refusal("stale-revision", reason));
        }
        let program = compile(&propose.xml, &self.config).map_err(|p| refusal("plan-errors", listed(&p)))?;
        let mut effects = Vec::new();
        let report = self.manager.propose(self.clock.now(), program, &mut effects);
        self.perform(effects);
        report
    }

    fn command(&mut self, command: Command) -> Result<(), Refusal> {
        let mut effects = Vec::new();
        let answer = self.manager.command(self.clock.now(), command, &mut effects);
        self.perform(effects);
        answer
    }

    fn document(&self) -> PlanDocument {
        let executor = self.manager.executor();
        let xml = executor.program().map(|p| flight_plan::write(&p.plan)).unwrap_or_default();
        PlanDocument { info: publish::plan_info(executor), xml }
    }

    fn perform(&mut self, effects: Vec<Effect>) {
        if effects.contains(&Effect::Save) {
            self.save();
        }
        let now = self.clock.now();
        for effect in effects {
            match effect {
                Effect::Save => {}
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
            }
        }
    }

    fn save(&mut self) {
        let Some(store) = &mut self.store else { return };
        let executor = self.manager.executor();
        store.save(Saved {
            plan: executor.program().map(|p| flight_plan::write(&p.plan).into()),
            snapshot: executor.snapshot(),
            launch_wanted: self.manager.is_launch_wanted(),
            answered_alarms: self.manager.answered_alarms().clone(),
        });
    }

    async fn flush_disk(&mut self) {
        if let Some(store) = &mut self.store {
            store.flushed(DISK_PATIENCE).await;
        }
    }
}

/// An answer, or nothing and a line in the log.
fn told<A>(answer: Result<A, CallError>, what: &str) -> Option<A> {
    answer.inspect_err(|error| tracing::warn!("{what}: {error}")).ok()
}
