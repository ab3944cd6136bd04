//! Shell: the one loop that owns the link, the session, the clock and the disk.

use super::config::Config;
use super::core::{Answer, Input, Settings};
use super::driver::{self, FromLink};
use super::order::Time;
use super::publish::Publishers;
use super::station::Station;
use super::store::Store;
use crate::{Shutdown, single_instance};
use anyhow::Context;
use autopilot_link::{Event, Link, Outbox};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::time::{Interval, MissedTickBehavior, interval};
use usal::contract::{Empty, Feed, FeedAnswer, GatewayRequest, Heartbeat, Join, JoinAnswer, Refusal};
use usal::topics::{self, fp_manager, gateway};
use usal::{Announcement, Conductor, Description, Incoming, Received, Server, Session, VariableSubscriber};

/// The core is stepped at least so often.
const TICK: Duration = Duration::from_millis(50);
/// A simulator that asks for no step for so long is spoken to, and missed after the second time.
const STEP_LATE: Duration = Duration::from_millis(500);
const STEP_MISSED: Duration = Duration::from_secs(5);
/// Telemetry is published no closer than this in simulation, where seconds are short.
const SIMULATED_SPACING: Duration = Duration::from_millis(200);
/// And in flight, where it follows the autopilot's own rates.
const SPACING: Duration = Duration::from_millis(5);

/// What comes over the network.
enum Call {
    Feed(Incoming<Feed, FeedAnswer>),
    Join(Incoming<Join, JoinAnswer>),
    Request(Incoming<GatewayRequest, Empty>),
    Describe(Incoming<Empty, Description>),
    Heartbeat(Arc<Received<Heartbeat>>),
    Closed,
}

/// What the gateway serves and listens to.
struct Services {
    feed: Server<Feed, FeedAnswer>,
    join: Server<Join, JoinAnswer>,
    request: Server<GatewayRequest, Empty>,
    describe: Server<Empty, Description>,
    heartbeat: VariableSubscriber<Heartbeat>,
    _announcement: Announcement,
}

impl Services {
    fn new(session: &Session) -> anyhow::Result<Self> {
        Ok(Self {
            feed: session.serve(gateway::FEED)?,
            join: session.serve(gateway::JOIN)?,
            request: session.serve(gateway::REQUEST)?,
            describe: session.serve_description(topics::GATEWAY)?,
            heartbeat: session.follow(fp_manager::HEARTBEAT)?,
            _announcement: session.announce(topics::GATEWAY)?,
        })
    }

    /// The next call. Can be cancelled without loss.
    async fn next(&mut self) -> Call {
        tokio::select! {
            v = self.heartbeat.changed() => v.map_or(Call::Closed, Call::Heartbeat),
            v = self.join.recv() => v.map_or(Call::Closed, Call::Join),
            v = self.feed.recv() => v.map_or(Call::Closed, Call::Feed),
            v = self.request.recv() => v.map_or(Call::Closed, Call::Request),
            v = self.describe.recv() => v.map_or(Call::Closed, Call::Describe),
        }
    }

    /// A call that is there already.
    fn waiting(&mut self) -> Option<Call> {
        let heartbeat = self.heartbeat.take_new().map(Call::Heartbeat);
        heartbeat
            .or_else(|| self.join.try_recv().map(Call::Join))
            .or_else(|| self.feed.try_recv().map(Call::Feed))
            .or_else(|| self.request.try_recv().map(Call::Request))
            .or_else(|| self.describe.try_recv().map(Call::Describe))
    }
}

/// What time it is.
struct Clock {
    simulated: bool,
    start: Instant,
    step: Time,
    stepped: Instant,
    complained: bool,
}

impl Clock {
    fn now(&self) -> Time {
        if self.simulated { self.step } else { self.start.elapsed() }
    }
}

struct Shell {
    station: Station,
    link: Link,
    outbox: Outbox,
    publishers: Publishers,
    store: Store,
    clock: Clock,
}

/// Runs the gateway until `shutdown`: the session is the vehicle's hub.
///
/// # Errors
/// If the session or the link's own socket can't be had.
pub async fn run(config: Config, mut shutdown: Shutdown) -> anyhow::Result<()> {
    let _lock = single_instance::lock(config.state_dir.as_deref(), topics::GATEWAY).await?;
    let hub = usal::Config::hub(&config.vehicle, &config.listen);
    let session = Session::open(hub).await.context("the gateway's network session")?;
    let outcome = run_in(&session, config, &mut shutdown).await;
    session.close().await;
    outcome
}

async fn run_in(session: &Session, config: Config, shutdown: &mut Shutdown) -> anyhow::Result<()> {
    let mut services = Services::new(session)?;
    let mut conductor = if config.simulated { Some(Conductor::new(session)?) } else { None };
    let mut shell = Shell::new(session, config).await?;
    let (mut ticks, mut received) = (ticks(), Vec::new());
    loop {
        tokio::select! {
            () = shutdown.requested() => break,
            event = shell.link.next(&mut received, |datagram| shell.station.recognises(datagram)) => {
                shell.station.receive(from_link(event, &received));
                while let Some(step_ns) = shell.station.process(shell.clock.now()) {
                    shell.step(step_ns, &mut services, conductor.as_mut()).await;
                }
            }
            call = services.next() => {
                if matches!(call, Call::Closed) {
                    anyhow::bail!("the network session was closed");
                }
                shell.call(call).await;
            }
            _ = ticks.tick() => shell.tick().await,
        }
        shell.flush();
    }
    shell.store.finish().await;
    Ok(())
}

fn ticks() -> Interval {
    let mut ticks = interval(TICK);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    ticks
}

/// What an event of the link means to a driver. That a connection broke means nothing: it is made again.
fn from_link(event: Event, received: &[u8]) -> FromLink<'_> {
    match event {
        Event::Connected(_) | Event::Gone(_) => FromLink::Connected,
        Event::Stream(_) => FromLink::Stream(received),
        Event::Datagram(_) => FromLink::Datagram(received),
    }
}

impl Shell {
    async fn new(session: &Session, config: Config) -> anyhow::Result<Self> {
        let store = Store::new(config.state_dir);
        let restored = store.load();
        let settings = Settings { vehicle: config.vehicle, profile: config.profile, terrain: config.terrain };
        let spacing = if config.simulated { SIMULATED_SPACING } else { SPACING };
        let link = Link::open(&config.autopilot).await;
        let link = link.with_context(|| format!("the autopilot's link {}", config.autopilot))?;
        if let Some(at) = link.local_address() {
            tracing::info!(%at, "listening for the autopilot");
        }
        let now = Instant::now();
        Ok(Self {
            station: Station::new(settings, restored, driver::for_autopilot(config.simulated)),
            link,
            outbox: Outbox::default(),
            publishers: Publishers::new(session, spacing)?,
            store,
            clock: Clock {
                simulated: config.simulated,
                start: now,
                step: Time::ZERO,
                stepped: now,
                complained: false,
            },
        })
    }

    /// One step of a simulated flight: everything due at its time, here and at every participant,
    /// then the answer.
    async fn step(&mut self, step_ns: i64, services: &mut Services, conductor: Option<&mut Conductor>) {
        // a simulator that was started anew begins at zero: time never goes back
        let step = Duration::from_nanos(u64::try_from(step_ns).unwrap_or(0));
        self.clock.step = self.clock.step.max(step);
        self.clock.stepped = Instant::now();
        self.clock.complained = false;
        self.station.tick(self.clock.now());
        self.flush();
        if let Some(conductor) = conductor {
            conductor.start(self.clock.now().as_secs_f64());
            loop {
                tokio::select! {
                    biased;
                    call = services.next() => self.call(call).await,
                    _ = conductor.settle() => break,
                }
                self.flush();
            }
        }
        while let Some(call) = services.waiting() {
            self.call(call).await;
        }
        self.station.tick(self.clock.now());
        self.flush();
        self.keep().await;
        self.station.answer_step(step_ns);
        self.flush();
    }

    async fn call(&mut self, call: Call) {
        let now = self.clock.now();
        let station = &mut self.station;
        match call {
            Call::Feed(incoming) => {
                let (feed, answer) = incoming.split();
                answer(match station.ask(now, |id| Input::Feed(id, feed)) {
                    Some(Answer::Feed(fed)) => Ok(fed),
                    _ => Err(unanswered()),
                });
            }
            Call::Join(incoming) => {
                let (join, answer) = incoming.split();
                answer(match station.ask(now, |id| Input::Join(id, join)) {
                    Some(Answer::Join(joined)) => Ok(joined),
                    _ => Err(unanswered()),
                });
            }
            Call::Request(incoming) => {
                let (request, answer) = incoming.split();
                tracing::info!(?request, "request");
                let outcome = station.ask(now, |id| Input::Request(id, request));
                // what was accepted survives a crash; the orders that it leads to do not wait for the disk
                self.flush();
                self.store.settle().await;
                answer(match outcome {
                    Some(Answer::Request(Ok(()))) => Ok(Empty {}),
                    Some(Answer::Request(Err(reason))) => Err(Refusal { code: "refused".into(), reason }),
                    _ => Err(unanswered()),
                });
            }
            Call::Describe(incoming) => incoming.answer(Ok(usal::spec::GATEWAY.describe())),
            Call::Heartbeat(received) => {
                let Heartbeat { count, plan } = received.stamped.value.clone();
                station.input(now, Input::Heartbeat { count, plan });
            }
            Call::Closed => {}
        }
    }

    /// Sends and publishes what there is.
    fn flush(&mut self) {
        self.outbox.clear();
        self.station.send(&mut self.outbox);
        self.link.send_all(&self.outbox);
        let events = self.station.take_events();
        self.publishers.tell(self.clock.now(), self.station.gateway(), events);
        if let Some(snapshot) = self.station.take_snapshot() {
            self.store.save(snapshot);
        }
    }

    /// Goes on with writing, and tells the core when that fails or succeeds again.
    async fn keep(&mut self) {
        if self.store.wants_again() {
            self.store.save(self.station.gateway().snapshot());
        }
        self.store.work().await;
        if let Some(stored) = self.store.news() {
            self.station.input(self.clock.now(), Input::Stored(stored));
        }
    }

    /// Wall-clock time passed.
    async fn tick(&mut self) {
        self.keep().await;
        if !self.clock.simulated {
            return self.station.tick(self.clock.now());
        }
        let late = self.clock.stepped.elapsed();
        if late > STEP_LATE {
            self.station.hello();
        }
        if late > STEP_MISSED && !self.clock.complained {
            self.clock.complained = true;
            tracing::warn!(
                "the simulator asks for no steps; start it with --lockstep, or this gateway without --simulated"
            );
        }
    }
}

fn unanswered() -> Refusal {
    Refusal { code: "unanswered".into(), reason: "The gateway could not answer; try again.".into() }
}
