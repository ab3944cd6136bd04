//! The thread behind the links: it owns the runtime and the sessions, and turns both into channels.
//! Each link is a task of its own, so that a vehicle that can't be reached holds up no other.

use super::outlet::Outlet;
use super::{
    Call, Endpoint, LinkEvent, LinkId, LinkState, Loss, Numbered, Order, Reply, Telemetry, Wake,
    subscriptions,
};
use crate::state::{ActivePlan, Ticket};
use flight_exec::Command;
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::mpsc;
use usal::contract::{Empty, Foresee, OPERATOR, OTHER_VERSION, Stamped};
use usal::topics::{Events, FP_MANAGER, GATEWAY, Variable, fp_manager, gateway};
use usal::{CallError, Occurrence, Presence, Senders, Session, Start};
use wire::Convert;

/// A command is answered within this time, or the operator learns that it was not.
const COMMAND_TIMEOUT: Duration = Duration::from_secs(5);
/// A command that nobody took within this time of being given is dropped: what comes later comes by surprise.
const DELIVERY: Duration = Duration::from_secs(10);
/// A service says within this time what it is.
const DESCRIBE_TIMEOUT: Duration = Duration::from_secs(1);
/// A plan is checked aboard, and what changes the flight is flown ahead; a big one takes its time.
const PLAN_TIMEOUT: Duration = Duration::from_secs(30);

/// So often is looked whether others speak in the name of a service.
const LOOK: Duration = Duration::from_secs(1);

/// Serves orders until the window's end of the links is gone.
pub fn serve(endpoint: Endpoint, wake: Wake) {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build();
    match runtime {
        Ok(runtime) => runtime.block_on(orders(endpoint, wake)),
        Err(error) => tracing::error!(%error, "no threads for the links; the window works without a vehicle"),
    }
}

/// Questions on their way to a session.
type Calls = mpsc::UnboundedSender<Question>;

/// A question, and when it was asked: it may have to wait for the link.
struct Question {
    ticket: Ticket,
    call: Call,
    asked: Instant,
}

/// Hands each order to its link; waits for none of them.
async fn orders(mut endpoint: Endpoint, wake: Wake) {
    let mut links: HashMap<LinkId, Calls> = HashMap::new();
    while let Some(order) = endpoint.orders.recv().await {
        match order {
            Order::Connect { link, endpoint: at, vehicle } => {
                links.retain(|_, calls| !calls.is_closed());
                let messages = endpoint.messages.clone();
                let outlet = Outlet::new(link, vehicle, messages, wake.clone());
                let (calls, questions) = mpsc::unbounded_channel();
                links.insert(link, calls);
                tokio::spawn(run(at, questions, outlet));
            }
            // its task ends when nobody can ask it anything any more
            Order::Disconnect { link } => drop(links.remove(&link)),
            Order::Call { link, ticket, call } => {
                if let Some(calls) = links.get(&link) {
                    // the task ends only after its last question
                    let _ = calls.send(Question { ticket, call, asked: Instant::now() });
                }
            }
        }
    }
}

/// A link from its beginning to its end.
async fn run(endpoint: String, mut questions: mpsc::UnboundedReceiver<Question>, outlet: Outlet) {
    outlet.send(LinkEvent::Link(LinkState::Connecting(endpoint.clone()))).await;
    match connect(&endpoint, &outlet).await {
        Ok(mut open) => {
            while let Some(question) = questions.recv().await {
                open.ask(question, &outlet);
            }
            // not before every listener has fallen silent: what it receives would come from a closed link
            open.tasks.shutdown().await;
        }
        Err(error) => {
            outlet.send(LinkEvent::Link(LinkState::Failed(error.to_string()))).await;
            while let Some(Question { ticket, .. }) = questions.recv().await {
                let result = Err("there is no link: connect first".to_owned());
                outlet.send(LinkEvent::Answer { ticket, result }).await;
            }
        }
    }
    outlet.send(LinkEvent::Link(LinkState::Off)).await;
}

async fn connect(endpoint: &str, outlet: &Outlet) -> Result<Open, usal::SessionError> {
    let session =
        Session::open(usal::Config::client(outlet.vehicle.as_str(), endpoint).named(OPERATOR)).await?;
    let mut open = Open { session, tasks: tokio::task::JoinSet::new() };
    for spec in usal::spec::SERVICES {
        for said in spec.says {
            subscriptions::subscribe(&mut open, spec.name, said, outlet)?;
        }
    }
    open.watch(endpoint, outlet)?;
    Ok(open)
}

/// A session and the tasks that listen on it; they end with it.
pub(super) struct Open {
    session: Session,
    tasks: tokio::task::JoinSet<()>,
}

impl Open {
    /// A variable: its latest value.
    pub(super) fn follow<T>(
        &mut self,
        variable: Variable<T>,
        telemetry: impl Fn(Stamped<T>) -> Telemetry + Send + 'static,
        outlet: &Outlet,
    ) -> Result<(), usal::SessionError>
    where
        T: serde::de::DeserializeOwned + Clone + Send + Sync + 'static,
    {
        let gate = outlet.gate(variable.service);
        let mut subscriber = self.session.follow_from(variable, gate)?;
        let outlet = outlet.clone();
        self.tasks.spawn(async move {
            while let Some(received) = subscriber.changed().await {
                outlet.value(telemetry(received.stamped.clone()));
            }
        });
        Ok(())
    }

    /// A stream of events: each is passed on with its number, a gap with its size.
    pub(super) fn listen<T>(
        &mut self,
        events: Events<Stamped<T>>,
        telemetry: impl Fn(Numbered<T>) -> Telemetry + Send + 'static,
        outlet: &Outlet,
    ) -> Result<(), usal::SessionError>
    where
        T: serde::de::DeserializeOwned + Send + 'static,
    {
        let gate = outlet.gate(events.service);
        let mut subscriber = self.session.listen_from(events, Start::Remembered, gate)?;
        let outlet = outlet.clone();
        self.tasks.spawn(async move {
            while let Some(occurrence) = subscriber.recv().await {
                if outlet.is_foreign() {
                    continue;
                }
                outlet
                    .send(match occurrence {
                        Occurrence::Event { sequence, event, .. } => {
                            LinkEvent::Telemetry(telemetry(Numbered { sequence, event }))
                        }
                        Occurrence::Gap { missed } => LinkEvent::Lost(Loss::Events(missed)),
                    })
                    .await;
            }
        });
        Ok(())
    }

    /// Reports whether the vehicle's services are there, and speak our version.
    fn watch(&mut self, endpoint: &str, outlet: &Outlet) -> Result<(), usal::SessionError> {
        self.watch_departures(outlet)?;
        let mut presence = self.session.presence()?;
        let (session, endpoint, outlet) = (self.session.clone(), endpoint.to_owned(), outlet.clone());
        self.tasks.spawn(async move {
            let mut services = Some(presence.services());
            while let Some(alive) = services {
                let state = link_state(&session, &alive, &endpoint, &outlet.senders).await;
                outlet.set_foreign(matches!(state, LinkState::Failed(_)));
                outlet.send(LinkEvent::Services(alive.clone())).await;
                outlet.send(LinkEvent::Link(state)).await;
                describe_others(&session, &alive, &outlet.senders).await;
                services = next(&mut presence, &outlet).await;
            }
        });
        Ok(())
    }

    /// Notes at once who goes, also while the others are being asked: who comes back may be another session.
    fn watch_departures(&mut self, outlet: &Outlet) -> Result<(), usal::SessionError> {
        let mut presence = self.session.presence()?;
        let senders = outlet.senders.clone();
        self.tasks.spawn(async move {
            while let Some(alive) = presence.changed().await {
                senders.alive(&alive);
            }
        });
        Ok(())
    }

    /// Asks, and passes the answer on when it comes.
    fn ask(&mut self, question: Question, outlet: &Outlet) {
        let (session, outlet) = (self.session.clone(), outlet.clone());
        self.tasks.spawn(async move { answer(&session, question, &outlet).await });
        // tasks that are done are let go
        while self.tasks.try_join_next().is_some() {}
    }
}

/// Who is there, once that has changed or has to be asked again; until then strangers are told.
async fn next(presence: &mut Presence, outlet: &Outlet) -> Option<Arc<BTreeSet<String>>> {
    loop {
        tokio::select! {
            changed = presence.changed() => return changed,
            () = tokio::time::sleep(LOOK) => outlet.report_strangers().await,
        }
        if outlet.senders.take_doubt(Instant::now()) {
            return Some(presence.services());
        }
    }
}

/// Asks a service what it is; who answers speaks as it from now on. Of two FP Managers the other one may be the first to answer: which
/// of them it is the gateway says.
async fn describe(session: &Session, service: &'static str, senders: &Senders) -> Result<(), CallError> {
    let (_, by) = session.describe(service, DESCRIBE_TIMEOUT).await?;
    if service != FP_MANAGER {
        senders.described(service, by, Instant::now());
    }
    Ok(())
}

/// Asks those services on which the link does not depend.
async fn describe_others(session: &Session, alive: &BTreeSet<String>, senders: &Senders) {
    let others = usal::spec::SERVICES.iter().map(|spec| spec.name);
    for service in others.filter(|name| ![GATEWAY, FP_MANAGER].contains(name) && alive.contains(*name)) {
        // one that is slow to describe itself may speak well otherwise
        let _ = describe(session, service, senders).await;
    }
}

/// How far the session has come, with these services there.
async fn link_state(
    session: &Session,
    alive: &BTreeSet<String>,
    endpoint: &str,
    senders: &Senders,
) -> LinkState {
    let mut state = LinkState::Connecting(endpoint.to_owned());
    for service in [GATEWAY, FP_MANAGER] {
        if !alive.contains(service) {
            continue;
        }
        state = LinkState::Connected(endpoint.to_owned());
        match describe(session, service, senders).await {
            Err(CallError::Refused(refusal)) if refusal.code == OTHER_VERSION => {
                return LinkState::Failed(format!(
                    "The agent's {service} is not of this ground station's version: {}",
                    refusal.reason
                ));
            }
            // a service that is slow to describe itself may speak well otherwise
            Ok(()) | Err(_) => {}
        }
    }
    state
}

async fn answer(session: &Session, question: Question, outlet: &Outlet) {
    let Question { ticket, call, asked } = question;
    let result = match left(asked, Instant::now()) {
        None => Err(dropped(asked)),
        Some(left) => ask(session, call, left).await.map_err(|error| unanswered(error, asked)),
    };
    outlet.send(LinkEvent::Answer { ticket, result }).await;
}

/// How much longer somebody may take a command that was given then; `None`: it is dropped.
fn left(asked: Instant, now: Instant) -> Option<Duration> {
    let left = DELIVERY.saturating_sub(now.saturating_duration_since(asked));
    (!left.is_zero()).then_some(left)
}

/// Why there is no good answer, for people.
fn unanswered(error: CallError, asked: Instant) -> String {
    match error {
        CallError::Refused(refusal) => refusal.reason,
        CallError::Unreachable { .. } => dropped(asked),
        CallError::Lost { .. } => {
            "the connection was lost before the answer came, so it may have been done or not: look at the \
                                   vehicle's state before you give it again"
                .into()
        }
        other => other.to_string(),
    }
}

fn dropped(asked: Instant) -> String {
    let seconds = asked.elapsed().as_secs_f64();
    format!(
        "nobody took it for {seconds:.0} s, so it was dropped and will not be done: check the link, then give it again"
    )
}

/// What may have to be reviewed first is not answered at once.
fn timeout(command: &Command) -> Duration {
    match command {
        Command::SetVariable { .. } | Command::Commit { .. } => PLAN_TIMEOUT,
        _ => COMMAND_TIMEOUT,
    }
}

/// Asks; who doesn't take it within `delivery` does not do it.
async fn ask(session: &Session, call: Call, delivery: Duration) -> Result<Reply, CallError> {
    match call {
        Call::Propose(proposal) => {
            let report = session.call_within(fp_manager::PROPOSE, &proposal, delivery, PLAN_TIMEOUT).await?;
            Ok(Reply::Proposal(Box::new(report.convert())))
        }
        Call::Plan(command) => {
            let timeout = timeout(&command);
            let answer = session.call_within(fp_manager::COMMAND, &command.convert(), delivery, timeout);
            answer.await.map(|_| Reply::Done)
        }
        Call::Gateway(request) => {
            let answer = session.call_within(gateway::REQUEST, &request, delivery, COMMAND_TIMEOUT);
            answer.await.map(|_| Reply::Done)
        }
        Call::Foresee(command) => {
            let foresee = Foresee { command: command.convert() };
            let answer = session.call_within(fp_manager::FORESEE, &foresee, delivery, PLAN_TIMEOUT);
            Ok(Reply::Foresight(Box::new(answer.await?.convert())))
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

#[cfg(test)]
mod tests;
