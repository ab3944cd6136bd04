//! The thread behind the links: it owns the runtime and the sessions, and turns both into channels.
//! Each link is a task of its own, so that a vehicle that can't be reached holds up no other.

use super::senders::Senders;
use super::{
    Call, Endpoint, LinkEvent, LinkId, LinkMessage, LinkState, Loss, Numbered, Order, Reply, Telemetry, Wake,
    subscriptions,
};
use crate::state::{ActivePlan, Ticket, VehicleName};
use flight_exec::Command;
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tokio::sync::mpsc;
use usal::contract::{Empty, Foresee, OPERATOR, OTHER_VERSION, Stamped};
use usal::topics::{Events, FP_MANAGER, GATEWAY, Variable, fp_manager, gateway};
use usal::{CallError, Gate, Occurrence, Presence, Session, Start};
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

/// Where a link's messages go.
#[derive(Clone)]
pub(super) struct Outlet {
    link: LinkId,
    vehicle: VehicleName,
    messages: mpsc::Sender<LinkMessage>,
    /// Values left out since the last that found room.
    left_out: Arc<AtomicU64>,
    /// The agent is of another version: what it says may mean something else, and is left out.
    is_foreign: Arc<AtomicBool>,
    /// Who speaks as which service.
    senders: Arc<Senders>,
    wake: Wake,
}

impl Outlet {
    /// Lets in what comes from the session that is this service.
    fn gate(&self, service: &'static str) -> Gate {
        let senders = self.senders.clone();
        Arc::new(move |from| senders.counts(service, from, Instant::now()))
    }

    async fn report_strangers(&self) {
        for (service, count) in self.senders.take_strange() {
            self.send(LinkEvent::Strangers { service, count }).await;
        }
    }

    /// Waits for room: answers and events are never lost here.
    async fn send(&self, event: LinkEvent) {
        // the window may be gone: nobody receives it
        let _ = self.messages.send(self.message(event)).await;
        (self.wake)();
    }

    fn is_foreign(&self) -> bool {
        self.is_foreign.load(Ordering::Relaxed)
    }

    /// A value; where there is no room for it, it is counted, and the next one is newer anyway.
    fn value(&self, telemetry: Telemetry) {
        if self.is_foreign() {
            return;
        }
        if self.report_left_out().is_err() || self.try_send(LinkEvent::Telemetry(telemetry)).is_err() {
            self.left_out.fetch_add(1, Ordering::Relaxed);
        }
        (self.wake)();
    }

    fn report_left_out(&self) -> Result<(), ()> {
        let count = self.left_out.swap(0, Ordering::Relaxed);
        if count == 0 {
            return Ok(());
        }
        self.try_send(LinkEvent::Lost(Loss::Values(count))).inspect_err(|()| {
            self.left_out.fetch_add(count, Ordering::Relaxed);
        })
    }

    fn try_send(&self, event: LinkEvent) -> Result<(), ()> {
        self.messages.try_send(self.message(event)).map_err(drop)
    }

    fn message(&self, event: LinkEvent) -> LinkMessage {
        LinkMessage { link: self.link, vehicle: self.vehicle.clone(), event }
    }
}

/// Hands each order to its link; waits for none of them.
async fn orders(mut endpoint: Endpoint, wake: Wake) {
    let mut links: HashMap<LinkId, Calls> = HashMap::new();
    while let Some(order) = endpoint.orders.recv().await {
        match order {
            Order::Connect { link, endpoint: at, vehicle } => {
                links.retain(|_, calls| !calls.is_closed());
                let messages = endpoint.messages.clone();
                let outlet = Outlet {
                    link,
                    vehicle,
                    messages,
                    left_out: Arc::default(),
                    is_foreign: Arc::default(),
                    senders: Arc::default(),
                    wake: wake.clone(),
                };
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
                outlet.is_foreign.store(matches!(state, LinkState::Failed(_)), Ordering::Relaxed);
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
        if outlet.senders.is_doubtful(Instant::now()) {
            return Some(presence.services());
        }
    }
}

/// Asks a service what it is; who answers speaks as it from now on.
async fn describe(session: &Session, service: &'static str, senders: &Senders) -> Result<(), CallError> {
    let (_, by) = session.describe(service, DESCRIBE_TIMEOUT).await?;
    senders.described(service, by, Instant::now());
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
    let left = DELIVERY.saturating_sub(asked.elapsed());
    let result = match left.is_zero() {
        true => Err(dropped(asked)),
        false => ask(session, call, left).await.map_err(|error| unanswered(error, asked)),
    };
    outlet.send(LinkEvent::Answer { ticket, result }).await;
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
mod tests {
    use super::*;

    fn gps(time_s: f64) -> Telemetry {
        let value = usal::contract::Gps { fix_3d: true, satellites: 9, hdop: 1.0, unix_s: None };
        Telemetry::Gps(Stamped { time_s, validity_s: 2.0, value })
    }

    #[test]
    fn only_what_nobody_took_is_said_to_be_dropped() {
        let name = || "legwork/uav1/fp-manager/invocation/command".to_owned();
        let said = |error| unanswered(error, Instant::now());
        assert!(said(CallError::Unreachable { name: name() }).contains("will not be done"));
        let lost = said(CallError::Lost { name: name() });
        assert!(lost.contains("may have been done or not") && !lost.contains("legwork/"), "{lost}");
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn an_agent_of_another_version_is_told_as_a_failed_link() {
        let (hub, endpoint) = hub().await;
        let mut describe = hub.serve_description(GATEWAY).unwrap();
        let agent = tokio::spawn(async move {
            let refusals = [usal::contract::check_version(Some("2")), Ok(())];
            for checked in refusals {
                let incoming = describe.recv().await.unwrap();
                incoming.answer(checked.map(|()| usal::spec::GATEWAY.describe()));
            }
        });
        let client = Session::open(usal::Config::client("uav1", &endpoint).named(OPERATOR)).await.unwrap();
        let senders = Senders::default();
        let nobody = link_state(&client, &BTreeSet::new(), "there", &senders).await;
        assert_eq!(nobody, LinkState::Connecting("there".into()));
        let alive = BTreeSet::from([GATEWAY.to_owned()]);
        let refused = link_state(&client, &alive, "there", &senders).await;
        assert!(matches!(&refused, LinkState::Failed(why) if why.contains("version 2")), "{refused:?}");
        let connected = link_state(&client, &alive, "there", &senders).await;
        assert_eq!(connected, LinkState::Connected("there".into()));
        let (hub, other) = (Some(hub.instance()), Some(client.instance()));
        let counts = |from| senders.counts(GATEWAY, from, Instant::now());
        assert!(counts(hub) && !counts(other), "who described the gateway is the gateway");
        agent.await.unwrap();
    }

    /// A command with the far end absent is told to be dropped after ten seconds, and is never done when it comes after all; nor is one
    /// that waited so long for its link.
    #[tokio::test(flavor = "multi_thread")]
    async fn a_command_that_nobody_took_is_dropped_and_never_done_later() {
        let endpoint = free_endpoint();
        let (orders, mut window, _thread) = served();
        let link = LinkId(1);
        orders.send(Order::Connect { link, endpoint: endpoint.clone(), vehicle: "uav1".into() }).unwrap();
        let commit = Command::Commit { hash: "0badc0de".into(), entry: None };
        orders.send(Order::Call { link, ticket: Ticket(1), call: Call::Plan(commit) }).unwrap();
        let begun = Instant::now();
        let told = answer_to(Ticket(1), &mut window).await.unwrap_err();
        assert!(told.contains("dropped") && begun.elapsed() < DELIVERY + Duration::from_secs(1), "{told}");

        let hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
        let mut commands = hub.serve(fp_manager::COMMAND).unwrap();
        let taken = tokio::spawn(async move {
            let incoming = commands.recv().await.unwrap();
            let taken = incoming.request.clone();
            incoming.answer(Ok(Empty {}));
            taken
        });
        let mut ticket = 2;
        loop {
            // the link finds its hub when it tries again
            orders
                .send(Order::Call { link, ticket: Ticket(ticket), call: Call::Plan(Command::Hold) })
                .unwrap();
            if answer_to(Ticket(ticket), &mut window).await.is_ok() {
                break;
            }
            ticket += 1;
        }
        assert_eq!(taken.await.unwrap(), usal::contract::Command::Hold, "the commit is not done by surprise");
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn a_command_that_waited_too_long_for_its_link_is_not_sent() {
        let (hub, endpoint) = hub().await;
        let mut commands = hub.serve(fp_manager::COMMAND).unwrap();
        let (outlet, mut window) = outlet();
        let open = connect(&endpoint, &outlet).await.unwrap();
        let Some(asked) = Instant::now().checked_sub(DELIVERY) else { return };
        let question = Question { ticket: Ticket(1), call: Call::Plan(Command::Hold), asked };
        answer(&open.session, question, &outlet).await;
        assert!(answer_to(Ticket(1), &mut window).await.unwrap_err().contains("dropped"));
        assert!(commands.try_recv().is_none());
    }

    /// The thread of the links, and the window's end of its channels.
    fn served() -> (mpsc::UnboundedSender<Order>, mpsc::Receiver<LinkMessage>, std::thread::JoinHandle<()>) {
        let (sender, orders) = mpsc::unbounded_channel();
        let (messages, window) = mpsc::channel(1000);
        let endpoint = Endpoint { orders, messages };
        (sender, window, std::thread::spawn(move || serve(endpoint, Arc::new(|| {}))))
    }

    async fn answer_to(ticket: Ticket, window: &mut mpsc::Receiver<LinkMessage>) -> Result<Reply, String> {
        loop {
            match window.recv().await.unwrap().event {
                LinkEvent::Answer { ticket: of, result } if of == ticket => return result,
                _ => {}
            }
        }
    }

    fn outlet() -> (Outlet, mpsc::Receiver<LinkMessage>) {
        let (messages, window) = mpsc::channel(100);
        let outlet = Outlet {
            link: LinkId(1),
            vehicle: VehicleName::from("uav1"),
            messages,
            left_out: Arc::default(),
            is_foreign: Arc::default(),
            senders: Arc::default(),
            wake: Arc::new(|| {}),
        };
        (outlet, window)
    }

    fn free_endpoint() -> String {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        format!("tcp/{}", listener.local_addr().unwrap())
    }

    /// A session of the vehicle's, and where it listens.
    async fn hub() -> (Session, String) {
        let endpoint = free_endpoint();
        (Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap(), endpoint)
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn a_variable_without_a_place_of_its_own_comes_as_plain_rows() {
        let (hub, endpoint) = hub().await;
        let plan =
            hub.publish(Variable::<serde_json::Value>::new(FP_MANAGER, fp_manager::PLAN.name)).unwrap();
        plan.set(1.0, 3.0, &serde_json::json!({"name": "Fire watch"}));
        let (outlet, mut window) = outlet();
        let _open = connect(&endpoint, &outlet).await.unwrap();
        let told = tokio::time::timeout(Duration::from_secs(10), async {
            loop {
                if let LinkEvent::Telemetry(Telemetry::Plain(plain)) = window.recv().await.unwrap().event {
                    return plain;
                }
            }
        });
        let plain = told.await.unwrap();
        assert_eq!((plain.service, plain.name), (FP_MANAGER, "plan"));
        assert_eq!(plain.rows.value, [("name".to_owned(), "Fire watch".to_owned())]);
    }

    /// A process of the gateway: a session that is described, and publishes.
    struct Process {
        session: Session,
        gps: usal::VariablePublisher<usal::contract::Gps>,
        _alive: usal::Announcement,
    }

    impl Process {
        async fn start(endpoint: &str) -> Self {
            let session = Session::open(usal::Config::client("uav1", endpoint)).await.unwrap();
            let mut describe = session.serve_description(GATEWAY).unwrap();
            tokio::spawn(async move {
                while let Some(incoming) = describe.recv().await {
                    incoming.answer(Ok(usal::spec::GATEWAY.describe()));
                }
            });
            let gps = session.publish(gateway::GPS).unwrap();
            let _alive = session.announce(GATEWAY).unwrap();
            Self { session, gps, _alive }
        }

        fn says(&self, time_s: f64) {
            let Telemetry::Gps(gps) = gps(time_s) else { return };
            self.gps.set(gps.time_s, gps.validity_s, &gps.value);
        }
    }

    /// The first message that is looked for; and when the values were true that came before it.
    async fn until<T>(
        window: &mut mpsc::Receiver<LinkMessage>,
        mut is_it: impl FnMut(&LinkEvent) -> Option<T>,
    ) -> (T, Vec<f64>) {
        let mut heard = Vec::new();
        let found = tokio::time::timeout(Duration::from_secs(20), async {
            loop {
                let event = window.recv().await.unwrap().event;
                if let Some(found) = is_it(&event) {
                    return found;
                }
                if let LinkEvent::Telemetry(Telemetry::Gps(gps)) = event {
                    heard.push(gps.time_s);
                }
            }
        });
        (found.await.unwrap(), heard)
    }

    fn time_of(event: &LinkEvent) -> Option<f64> {
        match event {
            LinkEvent::Telemetry(Telemetry::Gps(gps)) => Some(gps.time_s),
            _ => None,
        }
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn a_stranger_is_told_and_not_believed_and_a_new_process_is() {
        let (_hub, endpoint) = hub().await;
        let first = Process::start(&endpoint).await;
        let (outlet, mut window) = outlet();
        let _open = connect(&endpoint, &outlet).await.unwrap();
        let connected =
            |event: &LinkEvent| matches!(event, LinkEvent::Link(LinkState::Connected(_))).then_some(());
        until(&mut window, connected).await;
        first.says(1.0);
        assert_eq!(until(&mut window, time_of).await.0, 1.0);

        let stranger = Session::open(usal::Config::client("uav1", &endpoint)).await.unwrap();
        let forged = stranger.publish(gateway::GPS).unwrap();
        let value = usal::contract::Gps { fix_3d: false, satellites: 0, hdop: 99.0, unix_s: None };
        forged.set(1e9, 2.0, &value);
        let told = |event: &LinkEvent| match event {
            LinkEvent::Strangers { service, count } => Some((*service, *count)),
            _ => None,
        };
        assert_eq!(until(&mut window, told).await, ((GATEWAY, 1), vec![]));
        first.says(2.0);
        assert_eq!(until(&mut window, time_of).await.0, 2.0);

        first.session.close().await;
        let gone = |event: &LinkEvent| match event {
            LinkEvent::Services(alive) => (!alive.contains(GATEWAY)).then_some(()),
            _ => None,
        };
        until(&mut window, gone).await;
        let second = Process::start(&endpoint).await;
        second.says(3.0);
        assert_eq!(until(&mut window, time_of).await.0, 3.0, "its first value is taken");
    }

    #[test]
    fn values_without_room_are_counted_and_told_when_there_is_room() {
        let (messages, mut window) = mpsc::channel(3);
        let wake: Wake = Arc::new(|| {});
        let (link, vehicle) = (LinkId(4), VehicleName::from("uav1"));
        let (left_out, is_foreign, senders) = Default::default();
        let outlet = Outlet { link, vehicle, messages, left_out, is_foreign, senders, wake };
        for i in 0..10 {
            outlet.value(gps(f64::from(i)));
        }
        for _ in 0..3 {
            assert!(matches!(window.try_recv().map(|m| m.event), Ok(LinkEvent::Telemetry(_))));
        }
        outlet.value(gps(10.0));
        let told = window.try_recv().map(|m| (m.link, m.event));
        assert!(matches!(told, Ok((LinkId(4), LinkEvent::Lost(Loss::Values(7))))), "{told:?}");
        assert!(matches!(window.try_recv().map(|m| m.event), Ok(LinkEvent::Telemetry(_))));
        outlet.is_foreign.store(true, Ordering::Relaxed);
        outlet.value(gps(11.0));
        assert!(window.try_recv().is_err(), "what an agent of another version says is not understood");
    }
}
