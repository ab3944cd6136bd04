//! Everything that a vehicle's services publish, as it came: for a recorder.

use crate::contract::{self, Key, Kind};
use crate::event::{MEMORY, RECOVERY_TIMEOUT, Start, emitted_us, unix_us};
use crate::health::Health;
use crate::session::Session;
use crate::{Format, SessionError};
use std::sync::Arc;
use zenoh::Wait;
use zenoh::pubsub::Subscriber;
use zenoh::sample::{Sample, SampleKind};
use zenoh_ext::{AdvancedSubscriber, AdvancedSubscriberBuilderExt, HistoryConfig, RecoveryConfig};

/// Something that was published.
#[derive(Debug, Clone, PartialEq)]
pub enum Raw {
    /// A variable's value or an event.
    Sample {
        /// Whose, of which kind, and its name.
        key: Key,
        /// How the payload is written.
        format: Format,
        /// The payload, which nobody has looked into.
        payload: Vec<u8>,
    },
    /// Events of some stream were lost for good.
    Gap {
        /// So many.
        missed: u64,
    },
}

/// Receives everything, until dropped.
pub struct Everything {
    _variables: Subscriber<()>,
    _events: AdvancedSubscriber<()>,
    _session: Session,
}

impl Session {
    /// Follows every variable and every stream of events of the vehicle, whoever publishes them, now or later. `take` is
    /// called from a network thread and must return at once.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn follow_everything(
        &self,
        start: Start,
        take: impl Fn(Raw) + Send + Sync + 'static,
    ) -> Result<Everything, SessionError> {
        let inlet = Arc::new(Inlet {
            take,
            health: self.inner.health.clone(),
            from_us: if start == Start::Now { unix_us() } else { 0 },
        });
        let (values, events, gaps) = (inlet.clone(), inlet.clone(), inlet);
        let variables = self
            .inner
            .zenoh
            .declare_subscriber(contract::every_name(self.vehicle(), Kind::Variable)?)
            .callback(move |sample| values.sample(&sample))
            .wait()
            .map_err(SessionError::network)?;
        let events = self
            .inner
            .zenoh
            .declare_subscriber(contract::every_name(self.vehicle(), Kind::Event)?)
            .callback(move |sample| {
                if emitted_us(&sample) >= events.from_us {
                    events.sample(&sample);
                }
            })
            .recovery(RecoveryConfig::default().heartbeat())
            .query_timeout(RECOVERY_TIMEOUT)
            .history(HistoryConfig::default().detect_late_publishers().max_samples(MEMORY))
            .wait()
            .map_err(SessionError::network)?;
        events
            .sample_miss_listener()
            .callback(move |miss| (gaps.take)(Raw::Gap { missed: miss.nb().into() }))
            .background()
            .wait()
            .map_err(SessionError::network)?;
        Ok(Everything { _variables: variables, _events: events, _session: self.clone() })
    }
}

struct Inlet<F> {
    take: F,
    health: Arc<Health>,
    /// Earlier events are of no interest, microseconds since 1970.
    from_us: u64,
}

impl<F: Fn(Raw)> Inlet<F> {
    fn sample(&self, sample: &Sample) {
        if sample.kind() == SampleKind::Delete {
            return;
        }
        let text = sample.key_expr().as_str();
        match text.parse::<Key>() {
            Err(error) => self.health.undecodable(text, &error.to_string()),
            Ok(key) => (self.take)(Raw::Sample {
                format: Format::of(sample.encoding()),
                payload: sample.payload().to_bytes().into_owned(),
                key,
            }),
        }
    }
}
