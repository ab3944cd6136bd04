//! The simulated clock of a lockstep flight: time goes on when every participant has acknowledged.
//!
//! Before each step the simulator sends `TIMESYNC { tc1: 0, ts1: simulated ns }` and waits for
//! `TIMESYNC { tc1: != 0, ts1: the same }`. The gateway answers when it has done what was due and every participant has
//! acknowledged its tick of the variable `clock`. So a whole flight runs as fast as the machine allows, and a stall of the
//! machine is not a stall of the flight.
//!
//! The gateway holds the [`Conductor`]; FP Manager, tests and scripts hold [`Participant`]s, which show a liveliness token.
//! A tick that is not acknowledged is repeated (a participant answers a repetition of finished work
//! at once). A participant whose token is gone is not waited for, and a live one is
//! waited for at most [`PATIENCE`] by default.
//!
//! A test or a script that joins drives time: it holds its acknowledgement until it has seen and done what it wants. The FP
//! Manager holds its own while it reviews a proposal or a command, for four of the five seconds.

use crate::contract::{ClockAck, ClockTick, Key, Kind, every_service};
use crate::session::Session;
use crate::topics::GATEWAY;
use crate::variable::PRIORITY;
use crate::{Format, SessionError, codec};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};
use tokio::sync::{Notify, watch};
use tokio::time::Instant;
use zenoh::Wait;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::CongestionControl;
use zenoh::sample::Sample;

/// How long a live participant is waited for, wall-clock.
const PATIENCE: Duration = Duration::from_secs(5);
/// A tick is repeated so often while it is not acknowledged.
const REPEAT: Duration = Duration::from_millis(200);
/// More participants than this are not waited for.
const PARTICIPANTS_MAX: usize = 64;
const TOKEN: &str = "clock";
const TICK: &str = "clock";
const ACK: &str = "clock-ack";

/// Beats the time.
pub struct Conductor {
    publisher: Publisher<'static>,
    shared: Arc<Shared>,
    tick: ClockTick,
    /// How long the present tick has been waited for, and when that was last looked at.
    waited: Duration,
    looked: Instant,
    patience: Duration,
    _acks: Subscriber<()>,
    _tokens: Subscriber<()>,
    _session: Session,
}

#[derive(Default)]
struct Shared {
    participants: Mutex<BTreeMap<String, State>>,
    changed: Notify,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct State {
    /// Must acknowledge before time goes on.
    awaited: bool,
    /// Was waited for in vain and has not been heard of since.
    late: bool,
    /// Highest tick acknowledged.
    acknowledged: u64,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<String, State>> {
        self.participants.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn token(&self, name: String, alive: bool) {
        let mut participants = self.lock();
        if !alive {
            participants.remove(&name);
        } else if participants.len() < PARTICIPANTS_MAX {
            // it has not heard of the present tick; it is asked from the next one on
            participants.insert(name, State { awaited: false, late: false, acknowledged: 0 });
        } else {
            tracing::warn!(name, "too many clock participants: this one is not waited for");
        }
        drop(participants);
        self.changed.notify_one();
    }

    fn acknowledged(&self, name: &str, count: u64) {
        if let Some(state) = self.lock().get_mut(name) {
            state.acknowledged = state.acknowledged.max(count);
            state.late = false;
        }
        self.changed.notify_one();
    }

    fn settled(&self, count: u64) -> bool {
        self.lock().values().all(|state| !state.awaited || state.acknowledged >= count)
    }
}

impl Conductor {
    /// Becomes the conductor of a vehicle's clock.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn new(session: &Session) -> Result<Self, SessionError> {
        let shared = Arc::<Shared>::default();
        let health = session.inner.health.clone();
        let from_acks = shared.clone();
        let acks = session
            .inner
            .zenoh
            .declare_subscriber(every_service(session.vehicle(), Kind::Variable, ACK)?)
            .callback(move |sample| match read_ack(&sample) {
                Ok((name, count)) => from_acks.acknowledged(&name, count),
                Err(reason) => health.undecodable(sample.key_expr().as_str(), &reason),
            })
            .wait()
            .map_err(SessionError::network)?;
        let from_tokens = shared.clone();
        let tokens = session.watch_tokens(TOKEN, move |name, alive| from_tokens.token(name, alive))?;
        Ok(Self {
            publisher: reliable(session, GATEWAY, TICK)?,
            shared,
            tick: ClockTick { count: first_count(), time_s: 0.0 },
            waited: Duration::ZERO,
            looked: Instant::now(),
            patience: PATIENCE,
            _acks: acks,
            _tokens: tokens,
            _session: session.clone(),
        })
    }

    /// Waits for participants at most so long, wall-clock, before going on without them.
    pub fn patience(mut self, patience: Duration) -> Self {
        self.patience = patience;
        self
    }

    /// Tells everybody the new simulated time, seconds.
    pub fn start(&mut self, time_s: f64) {
        self.tick = ClockTick { count: self.tick.count + 1, time_s };
        (self.waited, self.looked) = (Duration::ZERO, Instant::now());
        for state in self.shared.lock().values_mut() {
            state.awaited = !state.late;
        }
        self.publish();
    }

    /// Waits until everybody has done what was due, and returns those who were waited for in vain;
    /// they are not waited for again before they acknowledge a tick. May be cancelled and called
    /// again, so that requests can be served meanwhile.
    pub async fn settle(&mut self) -> Vec<String> {
        while !self.shared.settled(self.tick.count) {
            // a machine that stood still has waited for nobody meanwhile
            self.waited += self.looked.elapsed().min(REPEAT);
            self.looked = Instant::now();
            if self.waited >= self.patience {
                return self.drop_late();
            }
            let pause = REPEAT.min(self.patience.saturating_sub(self.waited));
            if tokio::time::timeout(pause, self.shared.changed.notified()).await.is_err() {
                self.publish();
            }
        }
        Vec::new()
    }

    /// [`Self::start`], then [`Self::settle`].
    pub async fn tick(&mut self, time_s: f64) -> Vec<String> {
        self.start(time_s);
        self.settle().await
    }

    /// Those who take part now.
    pub fn participants(&self) -> Vec<String> {
        self.shared.lock().keys().cloned().collect()
    }

    fn drop_late(&self) -> Vec<String> {
        let mut late = Vec::new();
        for (name, state) in self.shared.lock().iter_mut() {
            if state.awaited && state.acknowledged < self.tick.count {
                tracing::warn!(name, "clock participant does not acknowledge; the flight goes on without it");
                state.late = true;
                state.awaited = false;
                late.push(name.clone());
            }
        }
        late
    }

    fn publish(&self) {
        if let Err(reason) = put(&self.publisher, &self.tick) {
            tracing::warn!("clock tick: {reason}");
        }
    }
}

/// Begins where no earlier conductor was, so that a restarted one is not taken for a repetition.
fn first_count() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_micros()).unwrap_or(0)
}

fn read_ack(sample: &Sample) -> Result<(String, u64), String> {
    let key: Key = sample.key_expr().as_str().parse().map_err(|e: crate::KeyError| e.to_string())?;
    let ack: ClockAck = codec::decode(sample.payload(), sample.encoding())?;
    Ok((key.service, ack.count))
}

fn reliable(session: &Session, service: &str, name: &str) -> Result<Publisher<'static>, SessionError> {
    let key = session.key(service, Kind::Variable, name)?.to_string();
    session
        .inner
        .zenoh
        .declare_publisher(key)
        .encoding(Format::Cbor.encoding())
        .congestion_control(CongestionControl::Block)
        .priority(PRIORITY)
        .express(true)
        .wait()
        .map_err(SessionError::network)
}

fn put<T: serde::Serialize>(publisher: &Publisher<'static>, value: &T) -> Result<(), String> {
    let bytes = codec::encode(value, Format::Cbor)?;
    publisher.put(bytes).wait().map_err(|e| e.to_string())
}

/// Takes part in the simulated time.
pub struct Participant {
    ticks: watch::Receiver<Option<ClockTick>>,
    answer: Arc<Answer>,
    _subscriber: Subscriber<()>,
    _token: LivelinessToken,
    _session: Session,
}

struct Answer {
    publisher: Publisher<'static>,
    /// The last tick acknowledged.
    done: Mutex<Option<u64>>,
}

impl Answer {
    fn send(&self, count: u64) {
        if let Err(reason) = put(&self.publisher, &ClockAck { count }) {
            tracing::warn!("clock acknowledgement: {reason}");
        }
    }
}

impl Participant {
    /// Joins under a name of its own. Every tick from now on must be acknowledged.
    ///
    /// # Errors
    /// [`SessionError`] for a bad name or on a closed session.
    pub fn join(session: &Session, name: &str) -> Result<Self, SessionError> {
        let answer = Arc::new(Answer { publisher: reliable(session, name, ACK)?, done: Mutex::default() });
        let (sender, ticks) = watch::channel(None);
        let (answers, health) = (answer.clone(), session.inner.health.clone());
        let subscriber = session
            .inner
            .zenoh
            .declare_subscriber(session.key(GATEWAY, Kind::Variable, TICK)?.to_string())
            .callback(move |sample| match codec::decode::<ClockTick>(sample.payload(), sample.encoding()) {
                Ok(tick) => heard(&sender, &answers, tick),
                Err(reason) => health.undecodable(sample.key_expr().as_str(), &reason),
            })
            .wait()
            .map_err(SessionError::network)?;
        // after the subscriber: who is waited for hears the ticks
        let token = session.token(name, TOKEN)?;
        Ok(Self { ticks, answer, _subscriber: subscriber, _token: token, _session: session.clone() })
    }

    /// Waits for the next tick; `None` when the session is closed.
    pub async fn next(&mut self) -> Option<ClockTick> {
        loop {
            self.ticks.changed().await.ok()?;
            if let Some(tick) = *self.ticks.borrow_and_update() {
                return Some(tick);
            }
        }
    }

    /// Says that everything due at this tick has been done.
    pub fn acknowledge(&self, tick: ClockTick) {
        *self.answer.done.lock().unwrap_or_else(PoisonError::into_inner) = Some(tick.count);
        self.answer.send(tick.count);
    }
}

fn heard(sender: &watch::Sender<Option<ClockTick>>, answer: &Answer, tick: ClockTick) {
    let done = *answer.done.lock().unwrap_or_else(PoisonError::into_inner);
    if done == Some(tick.count) {
        return answer.send(tick.count);
    }
    sender.send_if_modified(|held| {
        let new = held.is_none_or(|held| held.count != tick.count);
        *held = Some(tick);
        new
    });
}
