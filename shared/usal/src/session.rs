//! A session: one vehicle's services, over explicit endpoints.

use crate::audit::{AuditHook, Audited};
use crate::contract::{Key, KeyError, Kind};
use crate::health::{Health, HealthCount};
use crate::stand_in::StandIn;
use crate::{Instance, SessionError};
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;
use tokio::runtime::{Handle, RuntimeFlavor};
use tokio::time::Instant;
use zenoh::Wait;
use zenoh::session::ZenohId;

/// Where a vehicle's hub listens unless told otherwise: this machine only.
pub const DEFAULT_ENDPOINT: &str = "tcp/127.0.0.1:7447";

/// A hub that is there answers within this time.
const PRESENT_HUB: Duration = Duration::from_secs(1);

/// Whatever the network does, a session is closed within this time. (Zenoh itself gives up after
/// ten seconds.)
const CLOSE_WITHIN: Duration = Duration::from_secs(2);

/// How often it is looked whether a connection is gone.
const LOOK_AGAIN: Duration = Duration::from_millis(2);

/// Called, from a network thread, whenever something has been received; must return at once.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// How a session takes part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Role {
    /// Everybody else connects here (the gateway).
    Hub {
        /// Endpoint, `tcp/host:port` or `unixsock-stream//path`.
        listen: String,
    },
    /// Connects to the hub, now or as soon as it is there, again and again.
    Client {
        /// Endpoint, `tcp/host:port` or `unixsock-stream//path`.
        connect: String,
    },
}

/// What a session is opened with.
#[derive(Clone)]
pub struct Config {
    /// The vehicle's name, a key segment.
    pub vehicle: String,
    /// Hub or client.
    pub role: Role,
    /// Who asks, told with every request: a service's name, `operator` for people. `None`: anonymous, who may only read.
    pub name: Option<String>,
    /// For windows: repaint.
    pub wake: Option<Wake>,
}

impl Config {
    /// The hub's.
    pub fn hub(vehicle: &str, listen: &str) -> Self {
        Self::new(vehicle, Role::Hub { listen: listen.into() })
    }

    /// Everybody else's.
    pub fn client(vehicle: &str, connect: &str) -> Self {
        Self::new(vehicle, Role::Client { connect: connect.into() })
    }

    fn new(vehicle: &str, role: Role) -> Self {
        Self { vehicle: vehicle.into(), role, name: None, wake: None }
    }

    /// With the name under which it asks: a key segment, like a service's.
    pub fn named(mut self, name: &str) -> Self {
        self.name = Some(name.into());
        self
    }

    /// With a function that is called when something has been received.
    pub fn wake(mut self, wake: Wake) -> Self {
        self.wake = Some(wake);
        self
    }
}

impl fmt::Debug for Config {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Config")
            .field("vehicle", &self.vehicle)
            .field("role", &self.role)
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

/// A way to all services of a vehicle; cheap to clone. Publishers, subscribers and servers made
/// from it keep it open.
#[derive(Clone)]
pub struct Session {
    pub(crate) inner: Arc<Inner>,
}

pub(crate) struct Inner {
    pub(crate) zenoh: zenoh::Session,
    pub(crate) vehicle: String,
    pub(crate) name: Option<String>,
    pub(crate) health: Arc<Health>,
    pub(crate) runtime: Handle,
    pub(crate) wake: Wake,
    pub(crate) audit: Arc<OnceLock<AuditHook>>,
    instance: Instance,
    requests: AtomicU64,
}

impl Inner {
    /// As [`Session::is_connected`].
    pub(crate) fn is_connected(&self) -> bool {
        let info = self.zenoh.info();
        info.routers_zid().wait().next().is_some() || info.peers_zid().wait().next().is_some()
    }
}

impl fmt::Debug for Session {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Session").field("vehicle", &self.inner.vehicle).finish_non_exhaustive()
    }
}

impl Session {
    /// Opens a session. A client returns at once even if its hub is absent, and connects when
    /// it comes.
    ///
    /// # Errors
    /// [`SessionError`] if the vehicle's name, its own or the endpoint is not usable, or outside of a
    /// multi-threaded tokio runtime.
    pub async fn open(config: Config) -> Result<Self, SessionError> {
        let name = config.name.as_deref().unwrap_or("session");
        Key::new(&config.vehicle, name, Kind::Liveliness, "alive")?;
        let runtime = Handle::try_current().map_err(|_| SessionError::Runtime)?;
        if runtime.runtime_flavor() == RuntimeFlavor::CurrentThread {
            return Err(SessionError::Runtime);
        }
        let zenoh = open_zenoh(&config.role).await?;
        let instance = Instance::of(&zenoh);
        Ok(Self {
            inner: Arc::new(Inner {
                zenoh,
                vehicle: config.vehicle,
                name: config.name,
                health: Arc::default(),
                runtime,
                wake: config.wake.unwrap_or_else(|| Arc::new(|| {})),
                audit: Arc::default(),
                instance,
                requests: AtomicU64::new(1),
            }),
        })
    }

    /// The vehicle it speaks for.
    pub fn vehicle(&self) -> &str {
        &self.inner.vehicle
    }

    /// Which session it is: for others that of what it publishes and asks.
    pub fn instance(&self) -> Instance {
        self.inner.instance
    }

    /// What went wrong so far.
    pub fn health(&self) -> HealthCount {
        self.inner.health.count()
    }

    /// Whether it has a connection now: a client to its hub, a hub to anybody.
    pub async fn is_connected(&self) -> bool {
        self.inner.is_connected()
    }

    /// Whether it has been closed: nothing will come any more.
    pub fn is_closed(&self) -> bool {
        self.inner.zenoh.is_closed()
    }

    /// Has every answer that a server of this session gives from now on told to `hook`, which must return at once.
    /// Only the first hook counts.
    pub fn audit(&self, hook: impl Fn(Audited) + Send + Sync + 'static) {
        if self.inner.audit.set(Box::new(hook)).is_err() {
            tracing::debug!("the session's answers are told to somebody already");
        }
    }

    /// Ends the session for all its clones and parts; returns within two seconds.
    pub async fn close(&self) {
        match tokio::time::timeout(CLOSE_WITHIN, self.inner.zenoh.close()).await {
            Ok(Ok(())) => {}
            Ok(Err(e)) => tracing::debug!("closing the session: {e}"),
            Err(_) => tracing::warn!("the session does not close in time and is left alone"),
        }
    }

    pub(crate) fn key(&self, service: &str, kind: Kind, name: &str) -> Result<Key, KeyError> {
        Key::new(&self.inner.vehicle, service, kind, name)
    }

    /// A request id that nobody else uses.
    pub(crate) fn request_id(&self) -> String {
        format!("{}-{}", self.inner.instance, self.inner.requests.fetch_add(1, Ordering::Relaxed))
    }
}

async fn open_zenoh(role: &Role) -> Result<zenoh::Session, SessionError> {
    let (mode, endpoint) = match role {
        Role::Hub { listen } => ("router", listen),
        Role::Client { connect } => ("client", connect),
    };
    let bad = |e: zenoh::Error| SessionError::Endpoint { endpoint: endpoint.clone(), reason: e.to_string() };
    if mode == "router" {
        let config = zenoh_config(mode, &[endpoint.as_str()], &[]).map_err(bad)?;
        return zenoh::open(config).await.map_err(bad);
    }
    let config = zenoh_config(mode, &[], &[endpoint.as_str()]).map_err(bad)?;
    match tokio::time::timeout(PRESENT_HUB, zenoh::open(config)).await {
        Ok(Ok(session)) => Ok(session),
        Ok(Err(_)) | Err(_) => open_without_hub(endpoint).await.map_err(bad),
    }
}

async fn open_without_hub(endpoint: &str) -> zenoh::Result<zenoh::Session> {
    let stand_in = StandIn::open().await?;
    let (session, router) =
        (zenoh::open(zenoh_config("client", &[], &[endpoint, stand_in.endpoint()])?).await, stand_in.id());
    stand_in.close().await?;
    let session = session?;
    until_gone(&session, router).await;
    Ok(session)
}

/// Waits until a session knows that a router is gone. What was asked before would be told to be in doubt ([`crate::CallError::Lost`]),
/// though nobody was there to do it.
async fn until_gone(session: &zenoh::Session, router: ZenohId) {
    let until = Instant::now() + CLOSE_WITHIN;
    while session.info().routers_zid().await.any(|id| id == router) && Instant::now() < until {
        tokio::time::sleep(LOOK_AGAIN).await;
    }
}

/// No multicast, no gossip: only the endpoints given. The hub is a router, which forwards between
/// the others; these are clients. (Found by trying 1.10: two peers of the same router do not hear
/// each other; among routers, one that comes within 0.1 s of another's going is never told what
/// is there.)
pub(crate) fn zenoh_config(mode: &str, listen: &[&str], connect: &[&str]) -> zenoh::Result<zenoh::Config> {
    let mut config = zenoh::Config::default();
    let values = [
        ("mode", serde_json::json!(mode)),
        ("listen/endpoints", serde_json::json!(listen)),
        ("connect/endpoints", serde_json::json!(connect)),
        ("connect/timeout_ms", serde_json::json!(0)),
        (
            "connect/retry",
            serde_json::json!({"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 1.5}),
        ),
        ("scouting/multicast/enabled", serde_json::json!(false)),
        ("scouting/gossip/enabled", serde_json::json!(false)),
        ("scouting/delay", serde_json::json!(0)),
        ("open/return_conditions/connect_scouted", serde_json::json!(false)),
        // connections that say nothing are closed soon, and room is left for those that do
        ("transport/unicast/accept_timeout", serde_json::json!(2000)),
        ("transport/unicast/accept_pending", serde_json::json!(500)),
        // a frozen peer is noticed after two seconds instead of ten
        ("transport/link/tx/lease", serde_json::json!(2000)),
        // payloads carry their own time
        ("timestamping/enabled", serde_json::json!(false)),
        // a peer that takes nothing for a second is dropped instead of holding up the sender for five
        ("transport/link/tx/queue/congestion_control/block/wait_before_close", serde_json::json!(1_000_000)),
    ];
    for (path, value) in values {
        config.insert_json5(path, &value.to_string())?;
    }
    Ok(config)
}
