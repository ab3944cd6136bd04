//! Events: facts that must not be lost. Reliable, in order, once; a link outage is made up for
//! from the publisher's memory, and what cannot be made up for is told as a gap.

use crate::contract::Kind;
use crate::instance::anybody;
use crate::session::{Inner, Session};
use crate::topics::Events;
use crate::variable::{PRIORITY, Untyped};
use crate::{Format, Gate, Instance, SessionError, codec};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Weak};
use std::time::{Duration, SystemTime};
use tokio::sync::mpsc;
use zenoh::Wait;
use zenoh::qos::CongestionControl;
use zenoh::sample::{Sample, SampleKind};
use zenoh_ext::{
    AdvancedPublisher, AdvancedPublisherBuilderExt, AdvancedSubscriber, AdvancedSubscriberBuilderExt,
    CacheConfig, HistoryConfig, Miss, MissDetectionConfig, RecoveryConfig,
};

/// Events that a publisher remembers for those who missed them.
pub(crate) const MEMORY: usize = 2048;
/// Events that a subscriber may leave lying before the newest are dropped (and told as a gap).
const QUEUE: usize = 4096;
/// A subscriber that missed the last event of a burst learns of it after this time.
const HEARTBEAT: Duration = Duration::from_millis(250);
/// How long a subscriber waits for what it missed.
pub(crate) const RECOVERY_TIMEOUT: Duration = Duration::from_secs(2);

/// Where a subscriber begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// With everything that the publisher still remembers.
    Remembered,
    /// With what happens from now on, by the clocks of the two machines: for services aboard.
    Now,
}

/// What a subscriber gets.
#[derive(Debug, Clone, PartialEq)]
pub enum Occurrence<T> {
    /// It happened.
    Event {
        /// The publisher's number of it: counts up by one.
        sequence: u32,
        /// Whose event it is, if the publisher says so.
        from: Option<Instance>,
        /// What.
        event: T,
    },
    /// Events were lost for good: ask for the state instead.
    Gap {
        /// So many.
        missed: u64,
    },
}

/// Publishes events.
pub struct EventPublisher<T> {
    session: Session,
    publisher: AdvancedPublisher<'static>,
    _type: PhantomData<fn(&T)>,
}

impl<T: Serialize> EventPublisher<T> {
    /// Publishes an event. Does not wait for anybody: who cannot take it now gets it from memory.
    pub fn emit(&self, event: &T) {
        self.put(event);
    }
}

impl EventPublisher<Untyped> {
    /// As [`EventPublisher::emit`], of an event of the stream's type.
    pub fn emit_any<T: Serialize>(&self, event: &T) {
        self.put(event);
    }
}

impl<T> EventPublisher<T> {
    fn put<E: Serialize>(&self, event: &E) {
        let key = self.publisher.key_expr().as_str();
        match codec::encode(event, Format::Cbor) {
            Err(reason) => self.session.inner.health.unsent(key, &reason),
            Ok(bytes) => {
                let emitted = unix_us().to_le_bytes();
                if let Err(e) = self.publisher.put(bytes).attachment(emitted).wait() {
                    self.session.inner.health.unsent(key, &e.to_string());
                }
            }
        }
    }
}

/// Receives events.
pub struct EventSubscriber<T> {
    receiver: mpsc::Receiver<Occurrence<T>>,
    _subscriber: AdvancedSubscriber<()>,
    _session: Session,
}

impl<T> EventSubscriber<T> {
    /// Waits for the next; `None` when the session is closed.
    pub async fn recv(&mut self) -> Option<Occurrence<T>> {
        self.receiver.recv().await
    }

    /// The next, if it is there. Does not block.
    pub fn try_recv(&mut self) -> Option<Occurrence<T>> {
        self.receiver.try_recv().ok()
    }
}

impl Session {
    /// Publishes a stream of events.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn emitter<T: Serialize>(&self, events: Events<T>) -> Result<EventPublisher<T>, SessionError> {
        self.emitter_named(events.service, events.name)
    }

    /// As [`Session::emitter`], of a stream that is only known by its names.
    ///
    /// # Errors
    /// [`SessionError`] for a bad name or on a closed session.
    pub fn emitter_untyped(
        &self,
        service: &str,
        name: &str,
    ) -> Result<EventPublisher<Untyped>, SessionError> {
        self.emitter_named(service, name)
    }

    fn emitter_named<T>(&self, service: &str, name: &str) -> Result<EventPublisher<T>, SessionError> {
        let key = self.key(service, Kind::Event, name)?.to_string();
        let publisher = self
            .inner
            .zenoh
            .declare_publisher(key)
            .encoding(Format::Cbor.encoding())
            .congestion_control(CongestionControl::Drop)
            .priority(PRIORITY)
            .cache(CacheConfig::default().max_samples(MEMORY))
            .sample_miss_detection(MissDetectionConfig::default().heartbeat(HEARTBEAT))
            .publisher_detection()
            .wait()
            .map_err(SessionError::network)?;
        Ok(EventPublisher { session: self.clone(), publisher, _type: PhantomData })
    }

    /// Listens to a stream of events, whoever publishes it, now or later.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn listen<T>(&self, events: Events<T>, start: Start) -> Result<EventSubscriber<T>, SessionError>
    where
        T: DeserializeOwned + Send + 'static,
    {
        self.listen_from(events, start, anybody())
    }

    /// As [`Session::listen`], to whom the gate lets in.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn listen_from<T>(
        &self,
        events: Events<T>,
        start: Start,
        gate: Gate,
    ) -> Result<EventSubscriber<T>, SessionError>
    where
        T: DeserializeOwned + Send + 'static,
    {
        let key = self.key(events.service, Kind::Event, events.name)?.to_string();
        let (sender, receiver) = mpsc::channel(QUEUE);
        let inlet = Arc::new(Inlet {
            inner: Arc::downgrade(&self.inner),
            sender,
            dropped: AtomicU64::new(0),
            from_us: if start == Start::Now { unix_us() } else { 0 },
            gate,
        });
        let samples = inlet.clone();
        let subscriber = self
            .inner
            .zenoh
            .declare_subscriber(key)
            .callback(move |sample| samples.sample(&sample))
            .recovery(RecoveryConfig::default().heartbeat())
            .query_timeout(RECOVERY_TIMEOUT)
            .history(HistoryConfig::default().detect_late_publishers().max_samples(MEMORY))
            .wait()
            .map_err(SessionError::network)?;
        subscriber
            .sample_miss_listener()
            .callback(move |miss| inlet.missed(&miss))
            .background()
            .wait()
            .map_err(SessionError::network)?;
        Ok(EventSubscriber { receiver, _subscriber: subscriber, _session: self.clone() })
    }
}

/// The network side of a subscriber's queue.
struct Inlet<T> {
    inner: Weak<Inner>,
    sender: mpsc::Sender<Occurrence<T>>,
    /// Dropped since the last that found room.
    dropped: AtomicU64,
    /// Earlier events are of no interest, microseconds since 1970.
    from_us: u64,
    gate: Gate,
}

/// Microseconds since 1970.
pub(crate) fn unix_us() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_micros()).unwrap_or(u64::MAX)
}

/// When an event was emitted; a stranger's carries no time and counts as new.
pub(crate) fn emitted_us(sample: &Sample) -> u64 {
    let bytes = sample.attachment().and_then(|a| a.to_bytes().as_ref().try_into().ok());
    bytes.map_or(u64::MAX, u64::from_le_bytes)
}

impl<T: DeserializeOwned> Inlet<T> {
    fn sample(&self, sample: &Sample) {
        let from = Instance::behind(sample.source_info());
        let is_old = emitted_us(sample) < self.from_us;
        if sample.kind() == SampleKind::Delete || is_old || !(self.gate)(from) {
            return;
        }
        // a stranger's plain put has no number
        let sequence = sample.source_info().map_or(0, |info| info.source_sn());
        match codec::decode(sample.payload(), sample.encoding()) {
            Ok(event) => self.push(Occurrence::Event { sequence, from, event }),
            Err(reason) => {
                if let Some(inner) = self.inner.upgrade() {
                    inner.health.undecodable(sample.key_expr().as_str(), &reason);
                }
                // something happened, and nobody here knows what
                self.push(Occurrence::Gap { missed: 1 });
            }
        }
    }

    fn missed(&self, miss: &Miss) {
        if (self.gate)(Some(Instance::of_entity(miss.source()))) {
            self.push(Occurrence::Gap { missed: miss.nb().into() });
        }
    }

    fn push(&self, occurrence: Occurrence<T>) {
        let Some(inner) = self.inner.upgrade() else { return };
        if self.report_dropped().is_err() || self.sender.try_send(occurrence).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
            inner.health.overflowed("event queue");
        }
        (inner.wake)();
    }

    fn report_dropped(&self) -> Result<(), ()> {
        let missed = self.dropped.load(Ordering::Relaxed);
        if missed > 0 {
            self.sender.try_send(Occurrence::Gap { missed }).map_err(|_| ())?;
            self.dropped.fetch_sub(missed, Ordering::Relaxed);
        }
        Ok(())
    }
}
