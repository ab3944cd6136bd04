//! Links over a hub on this machine.

use super::*;
use crate::link::LinkMessage;

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(60);

fn gps(time_s: f64) -> Telemetry {
    let value = usal::contract::Gps { fix_3d: true, satellites: Some(9), hdop: 1.0, unix_s: None };
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

/// From when it was given, however long it waited for its link.
#[test]
fn a_command_may_be_taken_for_ten_seconds() {
    let asked = Instant::now();
    let after = |seconds| left(asked, asked + Duration::from_secs(seconds));
    assert_eq!([0, 4, 9].map(after), [10, 6, 1].map(|left| Some(Duration::from_secs(left))));
    assert_eq!([10, 11, 3600].map(after), [None; 3]);
}

/// A command with the far end absent is told to be dropped, and is never done when it comes after all; nor is one that waited so long
/// for its link.
#[tokio::test(flavor = "multi_thread")]
async fn a_command_that_nobody_took_is_dropped_and_never_done_later() {
    let endpoint = free_endpoint();
    let (orders, mut window, _thread) = served();
    let link = LinkId(1);
    orders.send(Order::Connect { link, endpoint: endpoint.clone(), vehicle: "uav1".into() }).unwrap();
    let commit = Command::Commit { hash: "0badc0de".into(), entry: None };
    orders.send(Order::Call { link, ticket: Ticket(1), call: Call::Plan(commit) }).unwrap();
    let told = answer_to(Ticket(1), &mut window).await.unwrap_err();
    assert!(told.contains("dropped"), "{told}");

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
        orders.send(Order::Call { link, ticket: Ticket(ticket), call: Call::Plan(Command::Hold) }).unwrap();
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
        let message = tokio::time::timeout(PATIENCE, window.recv()).await;
        match message.expect("an answer").unwrap().event {
            LinkEvent::Answer { ticket: of, result } if of == ticket => return result,
            _ => {}
        }
    }
}

fn outlet() -> (Outlet, mpsc::Receiver<LinkMessage>) {
    let (messages, window) = mpsc::channel(100);
    let outlet = Outlet::new(LinkId(1), "uav1".into(), messages, Arc::new(|| {}));
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
    let plan = hub.publish(Variable::<serde_json::Value>::new(FP_MANAGER, fp_manager::PLAN.name)).unwrap();
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
    async fn start(config: usal::Config) -> Self {
        let session = Session::open(config).await.unwrap();
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

fn connected(event: &LinkEvent) -> Option<()> {
    matches!(event, LinkEvent::Link(LinkState::Connected(_))).then_some(())
}

fn gone(event: &LinkEvent) -> Option<()> {
    matches!(event, LinkEvent::Services(alive) if !alive.contains(GATEWAY)).then_some(())
}

/// The gateway is the hub: with it the connection ends.
#[tokio::test(flavor = "multi_thread")]
async fn a_gateway_that_starts_anew_is_believed_from_its_first_value_on() {
    let endpoint = free_endpoint();
    let first = Process::start(usal::Config::hub("uav1", &endpoint)).await;
    let (outlet, mut window) = outlet();
    let _open = connect(&endpoint, &outlet).await.unwrap();
    until(&mut window, connected).await;
    first.says(1.0);
    assert_eq!(until(&mut window, time_of).await.0, 1.0);
    first.session.close().await;
    drop(first);
    until(&mut window, gone).await;
    let second = Process::start(usal::Config::hub("uav1", &endpoint)).await;
    second.says(2.0);
    assert_eq!(until(&mut window, time_of).await.0, 2.0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stranger_is_told_and_not_believed_and_a_new_process_is() {
    let (_hub, endpoint) = hub().await;
    let first = Process::start(usal::Config::client("uav1", &endpoint)).await;
    let (outlet, mut window) = outlet();
    let _open = connect(&endpoint, &outlet).await.unwrap();
    until(&mut window, connected).await;
    first.says(1.0);
    assert_eq!(until(&mut window, time_of).await.0, 1.0);

    let stranger = Session::open(usal::Config::client("uav1", &endpoint)).await.unwrap();
    let forged = stranger.publish(gateway::GPS).unwrap();
    let value = usal::contract::Gps { fix_3d: false, satellites: Some(0), hdop: 99.0, unix_s: None };
    forged.set(1e9, 2.0, &value);
    let told = |event: &LinkEvent| match event {
        LinkEvent::Strangers { service, count } => Some((*service, *count)),
        _ => None,
    };
    assert_eq!(until(&mut window, told).await, ((GATEWAY, 1), vec![]));
    first.says(2.0);
    assert_eq!(until(&mut window, time_of).await.0, 2.0);

    first.session.close().await;
    until(&mut window, gone).await;
    let second = Process::start(usal::Config::client("uav1", &endpoint)).await;
    second.says(3.0);
    assert_eq!(until(&mut window, time_of).await.0, 3.0, "its first value is taken");
}

#[test]
fn values_without_room_are_counted_and_told_when_there_is_room() {
    let (messages, mut window) = mpsc::channel(3);
    let wake: Wake = Arc::new(|| {});
    let outlet = Outlet::new(LinkId(4), "uav1".into(), messages, wake);
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
    outlet.set_foreign(true);
    outlet.value(gps(11.0));
    assert!(window.try_recv().is_err(), "what an agent of another version says is not understood");
}
