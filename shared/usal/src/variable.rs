//! Variables: periodic data, the latest value wins, late joiners get the last one.
//!
//! A publisher answers queries on its own key with the last value and shows a liveliness token;
//! a subscriber that sees the token asks once. So a plain Zenoh client gets the last value by
//! an ordinary `get`, and a restarted publisher or hub heals by itself.

use crate::contract::Kind;
use crate::contract::Stamped;
use crate::instance::anybody;
use crate::session::{Inner, Session};
use crate::topics::Variable;
use crate::{Format, Gate, Instance, SessionError, codec};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};
use tokio::sync::watch;
use zenoh::Wait;
use zenoh::bytes::ZBytes;
use zenoh::handlers::CallbackDrop;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::{ConsolidationMode, Query, Queryable, Reply};
use zenoh::sample::{Sample, SampleKind, SourceInfo};

/// One priority for all that must stay in order on a connection: variables, events, requests
/// and the simulated clock.
pub(crate) const PRIORITY: Priority = Priority::RealTime;

/// How long a late joiner waits for the last value.
const QUERY_TIMEOUT: Duration = Duration::from_secs(2);
/// How often it asks again, and the pause before, if it reached nobody.
const QUERY_ATTEMPTS: u32 = 40;
const QUERY_PAUSE: Duration = Duration::from_millis(50);
/// Answer of a publisher that has published nothing so far: what it does publish comes by itself.
const NO_VALUE: &str = "no value yet";

type Last = Arc<Mutex<Option<(ZBytes, SourceInfo)>>>;

/// Publishes a variable.
pub struct VariablePublisher<T> {
    session: Session,
    publisher: Publisher<'static>,
    /// Values published so far.
    count: AtomicU32,
    last: Last,
    _queryable: Queryable<()>,
    _token: LivelinessToken,
    _type: PhantomData<fn(&T)>,
}

/// Of a publisher whose values are typed one by one, where they are published.
#[derive(Debug, Clone, Copy)]
pub enum Untyped {}

impl<T: Serialize> VariablePublisher<T> {
    /// Publishes a value that was true at `time_s` (source time, seconds) and may be believed for
    /// `validity_s` seconds. Never blocks: under congestion it is dropped, as the next one is
    /// newer anyway.
    pub fn set(&self, time_s: f64, validity_s: f64, value: &T) {
        self.put(time_s, validity_s, value);
    }
}

impl VariablePublisher<Untyped> {
    /// As [`VariablePublisher::set`], of a value of the variable's type.
    pub fn set_any<T: Serialize>(&self, time_s: f64, validity_s: f64, value: &T) {
        self.put(time_s, validity_s, value);
    }
}

impl<T> VariablePublisher<T> {
    fn put<V: Serialize>(&self, time_s: f64, validity_s: f64, value: &V) {
        let key = self.publisher.key_expr().as_str();
        let bytes = match codec::encode(&Stamped { time_s, validity_s, value }, Format::Cbor) {
            Ok(bytes) => ZBytes::from(bytes),
            Err(reason) => return self.session.inner.health.unsent(key, &reason),
        };
        let source = SourceInfo::new(self.publisher.id(), self.count.fetch_add(1, Ordering::Relaxed));
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some((bytes.clone(), source.clone()));
        if let Err(e) = self.publisher.put(bytes).source_info(source).wait() {
            self.session.inner.health.unsent(key, &e.to_string());
        }
    }
}

/// A value as it came in.
#[derive(Debug, Clone, PartialEq)]
pub struct Received<T> {
    /// The value with its source time.
    pub stamped: Stamped<T>,
    /// When it came in.
    pub at: Instant,
    /// Whose value it is, if the publisher says so.
    pub from: Option<Instance>,
}

impl<T> Received<T> {
    /// Wall-clock time since it came in.
    pub fn age(&self) -> Duration {
        self.at.elapsed()
    }
}

/// Receives a variable; holds the latest value.
pub struct VariableSubscriber<T> {
    receiver: watch::Receiver<Option<Arc<Received<T>>>>,
    _subscriber: Subscriber<()>,
    _publishers: Subscriber<()>,
    _session: Session,
}

impl<T> VariableSubscriber<T> {
    /// The latest value, if there ever was one. Does not block.
    pub fn latest(&self) -> Option<Arc<Received<T>>> {
        self.receiver.borrow().clone()
    }

    /// The latest value if it came in after the last call of this or [`Self::changed`]. Does not
    /// block.
    pub fn take_new(&mut self) -> Option<Arc<Received<T>>> {
        match self.receiver.has_changed() {
            Ok(true) => self.receiver.borrow_and_update().clone(),
            _ => None,
        }
    }

    /// Waits for a value that was not seen before; `None` when the session is closed.
    pub async fn changed(&mut self) -> Option<Arc<Received<T>>> {
        self.receiver.changed().await.ok()?;
        self.receiver.borrow_and_update().clone()
    }
}

impl Session {
    /// Publishes a variable.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn publish<T: Serialize>(&self, variable: Variable<T>) -> Result<VariablePublisher<T>, SessionError> {
        self.publish_named(variable.service, variable.name)
    }

    /// As [`Session::publish`], of a variable that is only known by its names.
    ///
    /// # Errors
    /// [`SessionError`] for a bad name or on a closed session.
    pub fn publish_untyped(
        &self,
        service: &str,
        name: &str,
    ) -> Result<VariablePublisher<Untyped>, SessionError> {
        self.publish_named(service, name)
    }

    pub(crate) fn publish_named<T>(
        &self,
        service: &str,
        name: &str,
    ) -> Result<VariablePublisher<T>, SessionError> {
        let key = self.key(service, Kind::Variable, name)?.to_string();
        let token = self.key(service, Kind::Liveliness, &token_name(name))?.to_string();
        let publisher = self
            .inner
            .zenoh
            .declare_publisher(key.clone())
            .encoding(Format::Cbor.encoding())
            .congestion_control(CongestionControl::Drop)
            .priority(PRIORITY)
            .wait()
            .map_err(SessionError::network)?;
        let last = Last::default();
        let answers = last.clone();
        let queryable = self
            .inner
            .zenoh
            .declare_queryable(key)
            .callback(move |query| answer_last(&query, &answers))
            .wait()
            .map_err(SessionError::network)?;
        // after the queryable: who sees the token can ask
        let token =
            self.inner.zenoh.liveliness().declare_token(token).wait().map_err(SessionError::network)?;
        Ok(VariablePublisher {
            session: self.clone(),
            publisher,
            count: AtomicU32::new(0),
            last,
            _queryable: queryable,
            _token: token,
            _type: PhantomData,
        })
    }

    /// Follows a variable, whoever publishes it, now or later.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn follow<T>(&self, variable: Variable<T>) -> Result<VariableSubscriber<T>, SessionError>
    where
        T: DeserializeOwned + Send + Sync + 'static,
    {
        self.follow_from(variable, anybody())
    }

    /// As [`Session::follow`], of whom the gate lets in.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn follow_from<T>(
        &self,
        variable: Variable<T>,
        gate: Gate,
    ) -> Result<VariableSubscriber<T>, SessionError>
    where
        T: DeserializeOwned + Send + Sync + 'static,
    {
        self.follow_named(variable.service, variable.name, gate)
    }

    pub(crate) fn follow_named<T>(
        &self,
        service: &str,
        name: &str,
        gate: Gate,
    ) -> Result<VariableSubscriber<T>, SessionError>
    where
        T: DeserializeOwned + Send + Sync + 'static,
    {
        let key = self.key(service, Kind::Variable, name)?.to_string();
        let token = self.key(service, Kind::Liveliness, &token_name(name))?.to_string();
        let (sender, receiver) = watch::channel(None);
        let cell = Arc::new(Held { sender, gate });
        let inner = Arc::downgrade(&self.inner);
        let (live_inner, live) = (inner.clone(), cell.clone());
        let subscriber = self
            .inner
            .zenoh
            .declare_subscriber(key.clone())
            .callback(move |sample| accept(&live_inner, &live, &sample, None))
            .wait()
            .map_err(SessionError::network)?;
        let publishers = self
            .inner
            .zenoh
            .liveliness()
            .declare_subscriber(token)
            .history(true)
            .callback(move |sample| {
                if sample.kind() == SampleKind::Put {
                    ask_last(&inner, &key, &cell, QUERY_ATTEMPTS);
                }
            })
            .wait()
            .map_err(SessionError::network)?;
        Ok(VariableSubscriber {
            receiver,
            _subscriber: subscriber,
            _publishers: publishers,
            _session: self.clone(),
        })
    }
}

fn token_name(variable: &str) -> String {
    format!("variable.{variable}")
}

fn answer_last(query: &Query, last: &Last) {
    let last = last.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let sent = match last {
        Some((bytes, source)) => {
            let reply = query.reply(query.key_expr().clone(), bytes).source_info(source);
            reply.encoding(Format::Cbor.encoding()).wait()
        }
        None => query.reply_err(NO_VALUE).wait(),
    };
    if let Err(e) = sent {
        tracing::debug!("answering with the last value: {e}");
    }
}

/// The latest value of those who count.
struct Held<T> {
    sender: watch::Sender<Option<Arc<Received<T>>>>,
    gate: Gate,
}

impl<T> Held<T> {
    /// Somebody waits for a value, and none came in since.
    fn is_wanted_since(&self, asked: Instant) -> bool {
        let has_come = |received: &Arc<Received<T>>| received.at >= asked;
        !self.sender.is_closed() && !self.sender.borrow().as_ref().is_some_and(has_come)
    }
}

type Cell<T> = Arc<Held<T>>;

/// Asks the publisher for its last value; an answer is good only while nothing newer came in.
/// Repeated while nobody is reached: a token is seen up to 0.1 s before the way to its owner is known.
fn ask_last<T>(inner: &Weak<Inner>, key: &str, cell: &Cell<T>, attempts_left: u32)
where
    T: DeserializeOwned + Send + Sync + 'static,
{
    let Some(session) = inner.upgrade() else { return };
    let asked = Instant::now();
    let answered = Arc::new(AtomicBool::new(false));
    let callback = {
        let (inner, cell, answered) = (inner.clone(), cell.clone(), answered.clone());
        // Zenoh itself replies with an error once the time is up: nobody was reached then
        move |reply: Reply| match reply.result() {
            Ok(sample) => {
                answered.store(true, Ordering::Relaxed);
                accept(&inner, &cell, sample, Some(asked));
            }
            Err(error) if *error.payload().to_bytes() == *NO_VALUE.as_bytes() => {
                answered.store(true, Ordering::Relaxed);
            }
            Err(_) => {}
        }
    };
    let drop = {
        let (inner, key, cell) = (inner.clone(), key.to_owned(), cell.clone());
        move || {
            if !answered.load(Ordering::Relaxed) && attempts_left > 0 && cell.is_wanted_since(asked) {
                ask_again(inner.clone(), key.clone(), cell.clone(), attempts_left - 1);
            }
        }
    };
    let query = session
        .zenoh
        .get(key)
        .consolidation(ConsolidationMode::None)
        .timeout(QUERY_TIMEOUT)
        .priority(PRIORITY)
        .with(CallbackDrop { callback, drop });
    if let Err(e) = query.wait() {
        session.health.unsent(key, &e.to_string());
    }
}

fn ask_again<T>(inner: Weak<Inner>, key: String, cell: Cell<T>, attempts_left: u32)
where
    T: DeserializeOwned + Send + Sync + 'static,
{
    let Some(session) = inner.upgrade() else { return };
    session.runtime.spawn(async move {
        tokio::time::sleep(QUERY_PAUSE).await;
        ask_last(&inner, &key, &cell, attempts_left);
    });
}

fn accept<T>(inner: &Weak<Inner>, cell: &Cell<T>, sample: &Sample, asked: Option<Instant>)
where
    T: DeserializeOwned + Send + Sync + 'static,
{
    let Some(inner) = inner.upgrade() else { return };
    let from = Instance::behind(sample.source_info());
    if sample.kind() == SampleKind::Delete || !(cell.gate)(from) {
        return;
    }
    match codec::decode::<Stamped<T>>(sample.payload(), sample.encoding()) {
        Err(reason) => inner.health.undecodable(sample.key_expr().as_str(), &reason),
        Ok(stamped) => {
            let received = Arc::new(Received { stamped, at: Instant::now(), from });
            let changed = cell.sender.send_if_modified(|held| {
                let newer = |held: &Arc<Received<T>>| asked.is_some_and(|asked| held.at >= asked);
                if held.as_ref().is_some_and(newer) {
                    return false;
                }
                *held = Some(received);
                true
            });
            if changed {
                (inner.wake)();
            }
        }
    }
}
