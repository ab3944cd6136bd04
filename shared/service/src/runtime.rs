//! The one loop that owns a service's session, clock, queues and disk.

use crate::board::Board;
use crate::clock::Clock;
use crate::folder::{self, Folder};
use crate::statistics::Statistics;
use crate::wiring::{Port, Ports};
use crate::{Adapter, Never, NoAdapter, Out, Service, Shutdown, Tasks, Time, Wiring};
use crate::{audit, logging, single_instance};
use anyhow::Context;
use std::collections::BTreeMap;
use std::future::Future;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::Notify;
use tokio::task::{JoinHandle, JoinSet};
use usal::{
    Announcement, Conductor, EventPublisher, Everything, Kind, Participant, Raw, Role, Session, SessionError,
    Spec, Start, Untyped,
};

/// In lockstep, answers on their way are waited for so long (wall-clock) before time goes on.
const ANSWER_PATIENCE: Duration = Duration::from_secs(2);
/// Exchanges with other services within one step of time.
const EXCHANGES_MAX: usize = 16;
/// After so many inputs from the network, the clock is looked at.
const INPUTS_MAX: usize = 256;

/// Whose time it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Timing {
    /// The machine's.
    Machine,
    /// The simulator's, in lockstep: time stands until this service has done what is due.
    Follows,
    /// The simulator's, which this service tells to the others ([`Out::lead_time_to`]).
    Leads,
}

/// What a service is run with.
#[derive(Debug, Clone)]
pub struct Config {
    /// The vehicle's name, part of every key.
    pub vehicle: String,
    /// The vehicle's hub, or a client of it.
    pub role: Role,
    /// The service's folder, which no other instance may use; `None`: nothing is kept.
    pub state_dir: Option<PathBuf>,
    /// Whose time it is.
    pub timing: Timing,
}

impl Config {
    /// A client of the vehicle's hub, on the machine's time, which keeps nothing.
    pub fn client(vehicle: &str, connect: &str) -> Self {
        let role = Role::Client { connect: connect.into() };
        Self { vehicle: vehicle.into(), role, state_dir: None, timing: Timing::Machine }
    }
}

/// What a service finds when it begins.
#[derive(Debug)]
pub struct Beginning {
    state_dir: Option<PathBuf>,
    session: Session,
}

impl Beginning {
    /// What an earlier process kept in a file, as `read` understands it. A file that it doesn't understand is set aside.
    pub fn load<T, E: std::fmt::Display>(
        &self,
        name: &str,
        read: impl FnOnce(&[u8]) -> Result<T, E>,
    ) -> Option<T> {
        folder::load(self.state_dir.as_deref()?, name, read)
    }

    /// Follows every variable and every event of the vehicle; `take` is called from a network thread and must return at
    /// once.
    ///
    /// # Errors
    /// The session is closed.
    pub fn follow_everything(
        &self,
        start: Start,
        take: impl Fn(Raw) + Send + Sync + 'static,
    ) -> Result<Everything, SessionError> {
        self.session.follow_everything(start, take)
    }
}

/// Runs a service that knows only the network, until `shutdown`.
///
/// # Errors
/// As [`run`].
pub async fn run_alone<S: Service<Output = Never>>(
    config: Config,
    service: S,
    shutdown: Shutdown,
) -> anyhow::Result<()> {
    run(config, shutdown, async move |_: Beginning| Ok((service, NoAdapter))).await
}

/// Runs a service and its adapter, which `make` makes when nobody else has the folder, until `shutdown`.
///
/// # Errors
/// Another instance runs ([`crate::AlreadyRunning`]), the session can't be had or is closed, or the service can't be made or fails.
pub async fn run<S, A, M, F>(config: Config, mut shutdown: Shutdown, make: M) -> anyhow::Result<()>
where
    S: Service,
    A: Adapter<S>,
    M: FnOnce(Beginning) -> F,
    F: Future<Output = anyhow::Result<(S, A)>>,
{
    let spec = S::SPEC;
    let _lock = single_instance::lock(config.state_dir.as_deref(), spec.name).await?;
    let notify = Arc::<Notify>::default();
    let wake = notify.clone();
    let session_config = usal::Config {
        vehicle: config.vehicle.clone(),
        role: config.role.clone(),
        name: Some(spec.name.into()),
        wake: Some(Arc::new(move || wake.notify_one())),
    };
    let session = Session::open(session_config)
        .await
        .with_context(|| format!("the network session of the service `{}`", spec.name))?;
    let outcome = run_in(&session, config, notify, &mut shutdown, make).await;
    session.close().await;
    outcome
}

async fn run_in<S, A, M, F>(
    session: &Session,
    config: Config,
    notify: Arc<Notify>,
    shutdown: &mut Shutdown,
    make: M,
) -> anyhow::Result<()>
where
    S: Service,
    A: Adapter<S>,
    M: FnOnce(Beginning) -> F,
    F: Future<Output = anyhow::Result<(S, A)>>,
{
    if matches!(config.role, Role::Client { .. }) {
        single_instance::expect_nobody(session, S::SPEC.name).await?;
    }
    let beginning = Beginning { state_dir: config.state_dir.clone(), session: session.clone() };
    let (service, adapter) = make(beginning).await?;
    let folder = Folder::new(config.state_dir);
    let mut runtime = Runtime::open(session, service, adapter, config.timing, folder, notify)?;
    let outcome = runtime.turn_until(shutdown).await;
    runtime.end().await;
    outcome
}

struct Runtime<S: Service, A> {
    service: S,
    adapter: A,
    session: Session,
    clock: Clock,
    notify: Arc<Notify>,
    wiring: Wiring<S::Input>,
    ports: Ports<S::Input>,
    board: Board,
    emitters: BTreeMap<&'static str, EventPublisher<Untyped>>,
    folder: Folder,
    tasks: Tasks<S::Input>,
    /// Questions to others on their way.
    calls: JoinSet<S::Input>,
    statistics: Statistics,
    /// When the simulated time was led on last, wall-clock.
    led: Instant,
    failed: Option<anyhow::Error>,
    _books: Books,
    _announcement: Announcement,
}

/// The tasks that keep the books; they end with the service.
struct Books(Vec<JoinHandle<()>>);

impl Drop for Books {
    fn drop(&mut self) {
        self.0.iter().for_each(JoinHandle::abort);
    }
}

/// What comes next.
enum Next<I> {
    Shutdown,
    Beat(Option<Time>),
    Network,
    Input(I),
}

impl<S: Service, A: Adapter<S>> Runtime<S, A> {
    fn open(
        session: &Session,
        service: S,
        adapter: A,
        timing: Timing,
        folder: Folder,
        notify: Arc<Notify>,
    ) -> anyhow::Result<Self> {
        let spec = S::SPEC;
        let mut wiring = Wiring::default();
        S::wire(&mut wiring);
        check(&spec, &wiring)?;
        let board = Board::open(&spec, timing != Timing::Machine, session)?;
        let emitted = spec.says.iter().filter(|said| said.kind == Kind::Event);
        let emitters = emitted.map(|said| Ok((said.name, session.emitter_untyped(spec.name, said.name)?)));
        let emitters = emitters.collect::<Result<_, SessionError>>()?;
        let ports = Ports::open(&mut wiring, describe(&spec, session)?, session)?;
        // who sees it can ask
        let announcement = session.announce(spec.name)?;
        // who is waited for hears all that is said at a tick
        let clock = clock(session, spec.name, timing)?;
        let books = audit::start(session, spec.name, clock.reader())?;
        let lines = logging::start(session, spec.name, clock.reader())?;
        Ok(Self {
            service,
            adapter,
            session: session.clone(),
            clock,
            notify,
            wiring,
            ports,
            board,
            emitters,
            folder,
            tasks: Tasks::default(),
            calls: JoinSet::new(),
            statistics: Statistics::default(),
            led: Instant::now(),
            failed: None,
            _books: Books([Some(books), lines].into_iter().flatten().collect()),
            _announcement: announcement,
        })
    }

    async fn turn_until(&mut self, shutdown: &mut Shutdown) -> anyhow::Result<()> {
        if let Some(input) = self.wiring.started.as_ref().map(|started| started()) {
            self.step(input).await;
        }
        loop {
            if let Some(error) = self.failed.take() {
                return Err(error);
            }
            match self.next(shutdown).await {
                Next::Shutdown => return Ok(()),
                Next::Beat(None) => anyhow::bail!("the network session was closed"),
                Next::Beat(Some(_)) => self.beat().await?,
                Next::Network => self.network().await,
                Next::Input(input) => self.happened(input).await,
            }
        }
    }

    async fn next(&mut self, shutdown: &mut Shutdown) -> Next<S::Input> {
        let held_until = self.tasks.holds_time_until();
        tokio::select! {
            () = shutdown.requested() => Next::Shutdown,
            beat = next_beat(&mut self.clock, held_until) => Next::Beat(beat),
            () = self.notify.notified() => Next::Network,
            input = self.adapter.next() => Next::Input(input),
            input = self.tasks.next() => Next::Input(input),
            Some(Ok(input)) = self.calls.join_next() => Next::Input(input),
        }
    }

    /// What the network brought.
    async fn network(&mut self) {
        for _ in 0..INPUTS_MAX {
            match self.ports.prompt() {
                // only an adapter's input leads the time
                Some(input) => drop(self.step(input).await),
                None => return,
            }
            self.publish_at_once();
        }
        self.notify.notify_one();
    }

    async fn happened(&mut self, input: S::Input) {
        let mut time = self.step(input).await;
        while let Some(led_to) = time {
            time = self.lead(led_to).await;
        }
        self.publish_at_once();
    }

    /// Everything due at a beat of the clock.
    async fn beat(&mut self) -> anyhow::Result<()> {
        anyhow::ensure!(!self.session.is_closed(), "the network session was closed");
        self.network().await;
        if matches!(self.clock, Clock::Leads(_)) {
            self.wait().await;
        } else {
            self.sample().await;
            self.tick().await;
        }
        if matches!(self.clock, Clock::Follows(_)) {
            self.await_answers().await;
        }
        self.publish();
        self.look_after_folder().await;
        self.statistics.tell_sometimes(S::SPEC.name);
        self.clock.acknowledge();
        Ok(())
    }

    async fn sample(&mut self) {
        for input in self.ports.sampled() {
            self.step(input).await;
        }
    }

    /// The simulated time that is led from here stands still.
    async fn wait(&mut self) {
        let waited = self.led.elapsed();
        if let Some(input) = self.wiring.waiting.as_ref().map(|waiting| waiting(waited)) {
            self.step(input).await;
        }
    }

    async fn tick(&mut self) {
        if let Some(input) = self.wiring.tick.as_ref().map(|tick| tick()) {
            self.step(input).await;
        }
    }

    /// In lockstep the network takes no time: what was asked at this instant is answered at it.
    async fn await_answers(&mut self) {
        for _ in 0..EXCHANGES_MAX {
            match tokio::time::timeout(ANSWER_PATIENCE, self.calls.join_next()).await {
                Ok(Some(Ok(input))) => drop(self.step(input).await),
                Ok(None | Some(Err(_))) | Err(_) => return,
            }
        }
    }

    /// One step of the simulated time that is led from here: everything due, here and at everybody who takes part.
    async fn lead(&mut self, time: Time) -> Option<Time> {
        if self.clock.lead(time).is_none() {
            tracing::error!("this service doesn't lead the time");
            return None;
        }
        self.led = Instant::now();
        self.sample().await;
        self.tick().await;
        self.publish();
        let now_s = self.clock.now().as_secs_f64();
        if let Some(conductor) = self.clock.lead(time) {
            conductor.start(now_s);
        }
        while let Some(conductor) = self.clock.lead(time) {
            let notify = self.notify.clone();
            let settled = tokio::select! {
                biased;
                () = notify.notified() => false,
                _ = conductor.settle() => true,
            };
            self.network().await;
            self.publish();
            if settled {
                break;
            }
        }
        self.sample().await;
        self.tick().await;
        self.publish();
        self.look_after_folder().await;
        let input = self.wiring.stepped.as_ref().map(|stepped| stepped(time))?;
        self.step(input).await
    }

    /// A step of the service, and all it leads to.
    async fn step(&mut self, input: S::Input) -> Option<Time> {
        let begun = Instant::now();
        let mut out = Out::new(self.clock.now());
        self.service.step(self.clock.now(), input, &mut out);
        let leads_to = out.leads_to;
        self.carry_out(out).await;
        self.tasks.look();
        self.statistics.step(begun.elapsed());
        leads_to
    }

    async fn carry_out(&mut self, mut out: Out<S::Input, S::Output>) {
        let leaves = out.leaves();
        if !out.own.is_empty() {
            let outputs = std::mem::take(&mut out.own);
            self.adapter.perform(self.clock.now(), outputs, leaves, &mut self.tasks).await;
        }
        if !(out.events.is_empty() && out.answers.is_empty()) {
            self.board.hurry();
        }
        self.statistics.events += out.events.len() as u64;
        self.statistics.answers += out.answers.len() as u64;
        for emission in &out.events {
            match self.emitters.get(emission.name) {
                Some(emitter) => emission.by(emitter),
                None => tracing::error!("`{}` isn't in the service's declaration", emission.name),
            }
        }
        for question in out.questions {
            self.calls.spawn(question(&self.session));
        }
        for question in out.unasked {
            tokio::spawn(question(&self.session));
        }
        out.work.into_iter().for_each(|work| self.tasks.wait(work));
        if !out.answers.is_empty() {
            // who has its answer sees what it did
            self.publish_at_once();
        }
        self.keep(out.kept, out.wait_for_disk).await;
        out.answers.into_iter().for_each(|answer| answer());
        self.failed = self.failed.take().or(out.failed);
    }

    async fn keep(&mut self, kept: Vec<crate::out::Kept>, wait: bool) {
        for file in kept {
            self.folder.keep(file.name, file.bytes);
        }
        if wait {
            self.folder.settle().await;
        }
    }

    /// Goes on with writing, and tells the service when that fails or succeeds again.
    async fn look_after_folder(&mut self) {
        self.folder.work().await;
        if let Some(kept) = self.folder.news()
            && let Some(input) = self.wiring.kept.as_ref().map(|input| input(kept))
        {
            self.step(input).await;
        }
    }

    /// Who follows the simulator's time shows its variables at its beats, so that a flight is the same each time.
    fn publish_at_once(&mut self) {
        if !matches!(self.clock, Clock::Follows(_)) {
            self.publish();
        }
    }

    fn publish(&mut self) {
        let now = self.clock.now();
        self.board.begin(now);
        self.service.publish(now, &mut self.board);
        self.board.end();
    }

    async fn end(&mut self) {
        if let Some(input) = self.wiring.ended.as_ref().map(|ended| ended()) {
            self.step(input).await;
        }
        self.adapter.finish().await;
        self.folder.finish().await;
        self.statistics.tell(S::SPEC.name);
    }
}

/// The next beat; in lockstep, work that is under way is waited for first.
async fn next_beat(clock: &mut Clock, held_until: Option<tokio::time::Instant>) -> Option<Time> {
    if let Some(until) = held_until.filter(|_| matches!(clock, Clock::Follows(_))) {
        tokio::time::sleep_until(until).await;
    }
    clock.beat().await
}

fn clock(session: &Session, name: &str, timing: Timing) -> Result<Clock, SessionError> {
    Ok(match timing {
        Timing::Machine => Clock::machine(),
        Timing::Follows => Clock::follows(Participant::join(session, name)?),
        Timing::Leads => Clock::leads(Conductor::new(session)?),
    })
}

/// Answers `describe`.
fn describe<I: 'static>(spec: &Spec, session: &Session) -> Result<Port<I>, SessionError> {
    let mut server = session.serve_description(spec.name)?;
    let description = spec.describe();
    Ok(Box::new(move || {
        while let Some(incoming) = server.try_recv() {
            incoming.answer(Ok(description.clone()));
        }
        None
    }))
}

/// What is declared is served, and nothing else.
fn check<I>(spec: &Spec, wiring: &Wiring<I>) -> anyhow::Result<()> {
    let declared = spec.says.iter().filter(|said| said.kind == Kind::Invocation).map(|said| said.name);
    let (mut declared, mut served): (Vec<_>, Vec<_>) = (declared.collect(), wiring.served.clone());
    declared.sort_unstable();
    served.sort_unstable();
    anyhow::ensure!(
        declared == served,
        "the service `{}` declares the invocations {declared:?} and serves {served:?}",
        spec.name
    );
    Ok(())
}
