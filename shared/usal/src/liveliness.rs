//! Who is there: each service shows a token as long as it lives.

use crate::contract::{Key, Kind, every_service};
use crate::session::Session;
use crate::{KeyError, SessionError};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use zenoh::Wait;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::sample::SampleKind;

/// Names beyond this are not remembered: no vehicle has so many services.
const SERVICES_MAX: usize = 256;
const ALIVE: &str = "alive";
/// A hub that is there says who is, within this time.
const ASK_TIMEOUT: Duration = Duration::from_millis(500);

/// Shows that a service is there, until dropped.
pub struct Announcement {
    _token: LivelinessToken,
    _session: Session,
}

/// Who is there.
#[derive(Default)]
struct Here {
    services: Arc<BTreeSet<String>>,
    /// The number of each one's coming, of all that came.
    arrivals: BTreeMap<String, u64>,
    came: u64,
}

impl Here {
    fn comes(&mut self, service: String) {
        if self.services.len() < SERVICES_MAX && Arc::make_mut(&mut self.services).insert(service.clone()) {
            self.came += 1;
            self.arrivals.insert(service, self.came);
        }
    }

    fn goes(&mut self, service: &str) {
        Arc::make_mut(&mut self.services).remove(service);
        self.arrivals.remove(service);
    }
}

/// Which services are there.
pub struct Presence {
    receiver: watch::Receiver<Here>,
    _subscriber: Subscriber<()>,
    _session: Session,
}

impl Presence {
    /// The services that are alive now. Does not block.
    pub fn services(&self) -> Arc<BTreeSet<String>> {
        self.receiver.borrow().services.clone()
    }

    /// Whether this one is. Does not block.
    pub fn is_alive(&self, service: &str) -> bool {
        self.receiver.borrow().services.contains(service)
    }

    /// The number of this one's coming, while it is there: who looks only now and then sees by it that another one came for the one that
    /// was there. Does not block.
    pub fn arrival(&self, service: &str) -> Option<u64> {
        self.receiver.borrow().arrivals.get(service).copied()
    }

    /// Waits for somebody to come or go; `None` when the session is closed.
    pub async fn changed(&mut self) -> Option<Arc<BTreeSet<String>>> {
        self.receiver.changed().await.ok()?;
        Some(self.receiver.borrow_and_update().services.clone())
    }
}

impl Session {
    /// Shows that a service is there. Call it after its publishers and servers are made.
    ///
    /// # Errors
    /// [`SessionError`] for a bad name or on a closed session.
    pub fn announce(&self, service: &str) -> Result<Announcement, SessionError> {
        let token = self.token(service, ALIVE)?;
        Ok(Announcement { _token: token, _session: self.clone() })
    }

    /// Whether anybody shows this service now, as far as the hub is there to say.
    ///
    /// # Errors
    /// [`SessionError`] for a bad name or on a closed session.
    pub async fn is_announced(&self, service: &str) -> Result<bool, SessionError> {
        let key = self.key(service, Kind::Liveliness, ALIVE)?.to_string();
        let asked = self.inner.zenoh.liveliness().get(key).timeout(ASK_TIMEOUT).await;
        let replies = asked.map_err(SessionError::network)?;
        while let Ok(reply) = replies.recv_async().await {
            if reply.result().is_ok() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Watches who is there.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn presence(&self) -> Result<Presence, SessionError> {
        let (sender, receiver) = watch::channel(Here::default());
        let inner = Arc::downgrade(&self.inner);
        let subscriber = self.watch_tokens(ALIVE, move |service, alive| {
            sender.send_modify(|here| if alive { here.comes(service) } else { here.goes(&service) });
            if let Some(inner) = inner.upgrade() {
                (inner.wake)();
            }
        })?;
        Ok(Presence { receiver, _subscriber: subscriber, _session: self.clone() })
    }

    pub(crate) fn token(&self, service: &str, name: &str) -> Result<LivelinessToken, SessionError> {
        let key = self.key(service, Kind::Liveliness, name)?.to_string();
        self.inner.zenoh.liveliness().declare_token(key).wait().map_err(SessionError::network)
    }

    /// Calls back with the service whose token of this name came or went; those that are there
    /// already come first.
    pub(crate) fn watch_tokens(
        &self,
        name: &str,
        changed: impl Fn(String, bool) + Send + Sync + 'static,
    ) -> Result<Subscriber<()>, SessionError> {
        let pattern = every_service(&self.inner.vehicle, Kind::Liveliness, name)?;
        self.inner
            .zenoh
            .liveliness()
            .declare_subscriber(pattern)
            .history(true)
            .callback(move |sample| {
                let key: Result<Key, KeyError> = sample.key_expr().as_str().parse();
                if let Ok(key) = key {
                    changed(key.service, sample.kind() == SampleKind::Put);
                }
            })
            .wait()
            .map_err(SessionError::network)
    }
}
