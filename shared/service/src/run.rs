//! Running a service from its beginning to its end.

use crate::folder::{self, Folder};
use crate::runtime::Runtime;
use crate::{Adapter, Never, NoAdapter, Service, Shutdown, single_instance};
use anyhow::Context;
use std::future::Future;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::Notify;
use usal::{Everything, Raw, Role, Session, SessionError, Start};

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
