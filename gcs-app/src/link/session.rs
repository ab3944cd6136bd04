//! The thread behind the link: it owns the runtime and the session, and turns both into channels.

use super::{Call, Endpoint, LinkEvent, LinkState, Order, Reply, Telemetry, Wake};
use crate::state::{ActivePlan, Ticket};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;
use usal::contract::{Command, Empty, Stamped};
use usal::topics::{FP_MANAGER, GATEWAY, Variable, fp_manager, gateway};
use usal::{CallError, Occurrence, Session, Start};

/// A command is answered within this time, or the operator learns that it was not.
const COMMAND_TIMEOUT: Duration = Duration::from_secs(5);
/// A plan is checked aboard, and what changes the flight is flown ahead; a big one takes its time.
const PLAN_TIMEOUT: Duration = Duration::from_secs(30);

/// Serves orders until the window's end of the link is gone.
pub fn serve(endpoint: Endpoint, wake: Wake) {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build();
    match runtime {
        Ok(runtime) => runtime.block_on(orders(endpoint, wake)),
        Err(error) => tracing::error!(%error, "no threads for the link; the window works without a vehicle"),
    }
}

/// Where news go.
#[derive(Clone)]
struct Outlet {
    news: mpsc::Sender<LinkEvent>,
    wake: Wake,
}

impl Outlet {
    /// Waits for room: answers and events are never lost.
    async fn tell(&self, news: LinkEvent) {
        // the window may be gone: nobody to tell
        let _ = self.news.send(news).await;
        (self.wake)();
    }
    /// A value; the next one is newer anyway.
    fn value(&self, heard: Telemetry) {
        let _ = self.news.try_send(LinkEvent::Telemetry(heard));
        (self.wake)();
    }
}

/// A session and the tasks that listen on it; they end with it.
struct Open {
    session: Session,
    tasks: tokio::task::JoinSet<()>,
}

async fn orders(mut endpoint: Endpoint, wake: Wake) {
    let outlet = Outlet { news: endpoint.news, wake };
    let mut open: Option<Open> = None;
    while let Some(order) = endpoint.orders.recv().await {
        match order {
            Order::Connect { endpoint, vehicle } => {
                open = None;
                outlet.tell(LinkEvent::Link(LinkState::Connecting(endpoint.clone()))).await;
                match connect(&endpoint, &vehicle, &outlet).await {
                    Ok(session) => open = Some(session),
                    Err(error) => outlet.tell(LinkEvent::Link(LinkState::Failed(error.to_string()))).await,
                }
            }
            Order::Disconnect => {
                open = None;
                outlet.tell(LinkEvent::Link(LinkState::Off)).await;
            }
            Order::Call { ticket, call } => match &mut open {
                Some(open) => {
                    let (session, outlet) = (open.session.clone(), outlet.clone());
                    open.tasks.spawn(async move { answer(&session, ticket, call, &outlet).await });
                    // tasks that are done are let go
                    while open.tasks.try_join_next().is_some() {}
                }
                None => {
                    let result = Err("there is no link: connect first".to_owned());
                    outlet.tell(LinkEvent::Answer { ticket, result }).await;
                }
            },
        }
    }
}

async fn connect(endpoint: &str, vehicle: &str, outlet: &Outlet) -> Result<Open, usal::SessionError> {
    let session = Session::open(usal::Config::client(vehicle, endpoint)).await?;
    let mut open = Open { session, tasks: tokio::task::JoinSet::new() };
    open.follow(gateway::POSITION, Telemetry::Position, outlet)?;
    open.follow(gateway::ATTITUDE, Telemetry::Attitude, outlet)?;
    open.follow(gateway::AIR, Telemetry::Air, outlet)?;
    open.follow(gateway::GPS, Telemetry::Gps, outlet)?;
    open.follow(gateway::ENGINE, Telemetry::Engine, outlet)?;
    open.follow(gateway::POWER, Telemetry::Power, outlet)?;
    open.follow(gateway::NAVIGATION, Telemetry::Navigation, outlet)?;
    open.follow(gateway::STATE, Telemetry::Gateway, outlet)?;
    open.follow(fp_manager::STATUS, |status| Telemetry::Status(Box::new(status)), outlet)?;
    open.follow(fp_manager::AHEAD, Telemetry::Ahead, outlet)?;
    open.follow(fp_manager::VARIABLES, Telemetry::Variables, outlet)?;
    open.listen(outlet)?;
    open.watch(endpoint, outlet)?;
    Ok(open)
}

impl Open {
    fn follow<T>(
        &mut self,
        variable: Variable<T>,
        heard: fn(Stamped<T>) -> Telemetry,
        outlet: &Outlet,
    ) -> Result<(), usal::SessionError>
    where
        T: serde::de::DeserializeOwned + Clone + Send + Sync + 'static,
    {
        let mut subscriber = self.session.follow(variable)?;
        let outlet = outlet.clone();
        self.tasks.spawn(async move {
            while let Some(received) = subscriber.changed().await {
                outlet.value(heard(received.stamped.clone()));
            }
        });
        Ok(())
    }

    fn listen(&mut self, outlet: &Outlet) -> Result<(), usal::SessionError> {
        let mut plan_events = self.session.listen(fp_manager::EVENTS, Start::Remembered)?;
        let mut gateway_events = self.session.listen(gateway::EVENTS, Start::Remembered)?;
        let (plan_outlet, gateway_outlet) = (outlet.clone(), outlet.clone());
        self.tasks.spawn(async move {
            while let Some(occurrence) = plan_events.recv().await {
                if let Occurrence::Event { event, .. } = occurrence {
                    plan_outlet.tell(LinkEvent::Telemetry(Telemetry::PlanEvent(event))).await;
                }
            }
        });
        self.tasks.spawn(async move {
            while let Some(occurrence) = gateway_events.recv().await {
                if let Occurrence::Event { event, .. } = occurrence {
                    gateway_outlet.tell(LinkEvent::Telemetry(Telemetry::GatewayEvent(event.value))).await;
                }
            }
        });
        Ok(())
    }

    /// Tells whether the vehicle's services are there.
    fn watch(&mut self, endpoint: &str, outlet: &Outlet) -> Result<(), usal::SessionError> {
        let mut presence = self.session.presence()?;
        let (endpoint, outlet) = (endpoint.to_owned(), outlet.clone());
        self.tasks.spawn(async move {
            let mut services = Some(presence.services());
            while let Some(alive) = services {
                let there = [GATEWAY, FP_MANAGER].iter().any(|s| alive.contains(*s));
                let state = if there { LinkState::Connected } else { LinkState::Connecting };
                outlet.tell(LinkEvent::Link(state(endpoint.clone()))).await;
                services = presence.changed().await;
            }
        });
        Ok(())
    }
}

async fn answer(session: &Session, ticket: Ticket, call: Call, outlet: &Outlet) {
    let result = ask(session, call).await.map_err(|error| match error {
        CallError::Refused(refusal) => refusal.reason,
        other => other.to_string(),
    });
    outlet.tell(LinkEvent::Answer { ticket, result }).await;
}

/// What may have to be looked at first is not answered at once.
fn timeout(command: &Command) -> Duration {
    match command {
        Command::SetVariable { .. } | Command::Commit { .. } => PLAN_TIMEOUT,
        _ => COMMAND_TIMEOUT,
    }
}

async fn ask(session: &Session, call: Call) -> Result<Reply, CallError> {
    match call {
        Call::Propose(proposal) => {
            let report = session.call(fp_manager::PROPOSE, &proposal, PLAN_TIMEOUT).await?;
            Ok(Reply::Proposal(Box::new(report)))
        }
        Call::Plan(command) => {
            session.call(fp_manager::COMMAND, &command, timeout(&command)).await.map(|_| Reply::Done)
        }
        Call::Gateway(request) => {
            session.call(gateway::REQUEST, &request, COMMAND_TIMEOUT).await.map(|_| Reply::Done)
        }
        Call::PlanAboard => {
            let document = session.call(fp_manager::PLAN_DOCUMENT, &Empty {}, PLAN_TIMEOUT).await?;
            Ok(Reply::Plan(document.info.hash.map(|hash| ActivePlan {
                hash: hash.into(),
                plan: Arc::new(flight_plan::read(document.xml.as_bytes()).plan),
            })))
        }
    }
}
