//! Sessions over loopback: what each primitive promises, with the faults that threaten it.
#![cfg(test)]

mod common;

use common::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use usal::contract::*;
use usal::topics::{self, fp_manager, gateway};
use usal::{CallError, Config, Occurrence, Session, SessionError, Start};
use zenoh::bytes::Encoding;

fn air(airspeed_mps: f64) -> Air {
    Air { airspeed_mps, wind_east_mps: 0.0, wind_north_mps: 0.0, pressure_hpa: 1000.0, temperature_c: 15.0 }
}

fn low(waypoints: usize) -> TimedGatewayEvent {
    Stamped { time_s: 0.0, validity_s: 1.0, value: GatewayEvent::BufferLow { waypoints, seconds: 1.0 } }
}

/// The numbers of the events up to `last`; panics at a gap.
async fn numbers(events: &mut usal::EventSubscriber<TimedGatewayEvent>, last: usize) -> Vec<usize> {
    let mut seen = Vec::new();
    while seen.last() != Some(&last) {
        match within(events.recv()).await.expect("session open") {
            Occurrence::Event { event, .. } => match event.value {
                GatewayEvent::BufferLow { waypoints, .. } => seen.push(waypoints),
                other => panic!("{other:?}"),
            },
            Occurrence::Gap { missed } => panic!("{missed} events lost after {seen:?}"),
        }
    }
    seen
}

#[tokio::test(flavor = "multi_thread")]
async fn late_joiner_gets_the_last_value() {
    let net = Net::open().await;
    let publisher = net.hub.publish(gateway::AIR).unwrap();
    publisher.set(1.0, 2.0, &air(20.0));
    publisher.set(2.0, 2.0, &air(21.0));
    let late = net.client().await;
    let mut subscriber = late.follow(gateway::AIR).unwrap();
    let received = within(subscriber.changed()).await.unwrap();
    assert_eq!(received.stamped, Stamped { time_s: 2.0, validity_s: 2.0, value: air(21.0) });
    assert!(received.age() < DEADLINE);
}

/// A publisher that is so slow, or a machine, that the network gives up on the first question.
#[tokio::test(flavor = "multi_thread")]
async fn last_value_that_was_not_told_in_time_is_asked_for_again() {
    let net = Net::open().await;
    let slow = outside_client(&net.endpoint).await;
    let key = "legwork/uav1/gateway/variable/air";
    let queries = slow.declare_queryable(key).await.unwrap();
    let _token =
        slow.liveliness().declare_token("legwork/uav1/gateway/liveliness/variable.air").await.unwrap();
    let mut subscriber = net.client().await.follow(gateway::AIR).unwrap();
    let unanswered = within(queries.recv_async()).await.unwrap();
    let second = within(queries.recv_async()).await.unwrap();
    let json = br#"{"time_s": 1, "validity_s": 1, "value": {"airspeed_mps": 21, "wind_east_mps": 0, "wind_north_mps": 0,
        "pressure_hpa": 1000, "temperature_c": 15}}"#;
    second.reply(key, json.as_slice()).encoding(Encoding::APPLICATION_JSON).await.unwrap();
    drop(second);
    assert_eq!(within(subscriber.changed()).await.unwrap().stamped.value, air(21.0));
    drop(unanswered);
}

#[tokio::test(flavor = "multi_thread")]
async fn variables_pass_from_client_to_client_through_the_hub() {
    let net = Net::open().await;
    let (a, b) = (net.client().await, net.client().await);
    let mut subscriber = b.follow(fp_manager::HEARTBEAT).unwrap();
    let publisher = a.publish(fp_manager::HEARTBEAT).unwrap();
    for count in 1..=20 {
        publisher.set(0.0, 1.0, &Heartbeat { count, plan: None });
    }
    until(async || subscriber.changed().await.unwrap().stamped.value.count == 20).await;
    assert_eq!(subscriber.latest().unwrap().stamped.value.count, 20);
    assert!(subscriber.take_new().is_none());
}

#[tokio::test(flavor = "multi_thread")]
async fn hub_absent_a_client_opens_at_once_and_connects_when_it_comes() {
    let endpoint = free_endpoint();
    let client = within(Session::open(usal::Config::client("uav1", &endpoint).named("test"))).await.unwrap();
    assert!(!client.is_connected().await, "a request would be said to be lost, though there is nobody");
    let mut subscriber = client.follow(gateway::AIR).unwrap();
    let call = client.call(gateway::REQUEST, &GatewayRequest::Hold, DEADLINE);
    let hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
    hub.publish(gateway::AIR).unwrap().set(0.0, 1.0, &air(5.0));
    let mut server = hub.serve(gateway::REQUEST).unwrap();
    within(server.recv()).await.unwrap().answer(Ok(Empty {}));
    within(call).await.unwrap();
    let publisher = hub.publish(gateway::AIR).unwrap();
    publisher.set(0.0, 1.0, &air(6.0));
    until(async || subscriber.changed().await.unwrap().stamped.value == air(6.0)).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn hub_killed_and_restarted_everybody_finds_back() {
    let endpoint = free_endpoint();
    let hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
    let (a, b) = (client(&endpoint).await, client(&endpoint).await);
    let emitter = a.emitter(gateway::EVENTS).unwrap();
    let mut events = b.listen(gateway::EVENTS, Start::Remembered).unwrap();
    let mut presence = b.presence().unwrap();
    let _alive = a.announce(topics::FP_MANAGER).unwrap();
    emitter.emit(&low(1));
    assert_eq!(numbers(&mut events, 1).await, [1]);
    until_alive(&mut presence, topics::FP_MANAGER, true).await;
    hub.close().await;
    until_alive(&mut presence, topics::FP_MANAGER, false).await;
    for n in 2..=50 {
        emitter.emit(&low(n));
    }
    let _hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
    until_alive(&mut presence, topics::FP_MANAGER, true).await;
    assert_eq!(numbers(&mut events, 50).await, (2..=50).collect::<Vec<_>>());
}

#[tokio::test(flavor = "multi_thread")]
async fn event_subscriber_beginning_now_still_misses_nothing_in_an_outage() {
    let endpoint = free_endpoint();
    let hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
    let (a, b) = (client(&endpoint).await, client(&endpoint).await);
    let emitter = a.emitter(gateway::EVENTS).unwrap();
    for n in 1..=5 {
        emitter.emit(&low(n));
    }
    let mut before = b.listen(gateway::EVENTS, Start::Remembered).unwrap();
    assert_eq!(numbers(&mut before, 5).await.len(), 5);
    let mut events = b.listen(gateway::EVENTS, Start::Now).unwrap();
    emitter.emit(&low(6));
    assert_eq!(numbers(&mut events, 6).await, [6]);
    hub.close().await;
    for n in 7..=1000 {
        emitter.emit(&low(n));
    }
    let _hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
    assert_eq!(numbers(&mut events, 1000).await, (7..=1000).collect::<Vec<_>>());
}

#[tokio::test(flavor = "multi_thread")]
async fn late_joiner_gets_the_remembered_events_in_order() {
    let net = Net::open().await;
    let emitter = net.hub.emitter(gateway::EVENTS).unwrap();
    for n in 1..=1500 {
        emitter.emit(&low(n));
    }
    let client = net.client().await;
    let mut events = client.listen(gateway::EVENTS, Start::Remembered).unwrap();
    assert_eq!(numbers(&mut events, 1500).await, (1..=1500).collect::<Vec<_>>());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_request_gets_its_answer_or_its_refusal() {
    let net = Net::open().await;
    let mut server = net.hub.serve(gateway::REQUEST).unwrap();
    let client = net.client().await;
    let service = tokio::spawn(async move {
        while let Some(incoming) = server.recv().await {
            let answer = match incoming.request {
                GatewayRequest::Hold => Ok(Empty {}),
                _ => Err(Refusal { code: "not-now".into(), reason: "land first".into() }),
            };
            incoming.answer(answer);
        }
    });
    assert_eq!(within(client.call(gateway::REQUEST, &GatewayRequest::Hold, DEADLINE)).await, Ok(Empty {}));
    let refused = within(client.call(gateway::REQUEST, &GatewayRequest::Launch, DEADLINE)).await.unwrap_err();
    assert_eq!(refused.to_string(), "not-now: land first");
    service.abort();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_request_says_who_asks_if_its_session_has_a_name() {
    let net = Net::open().await;
    let mut server = net.hub.serve(gateway::REQUEST).unwrap();
    let mut describe = net.hub.serve_description(topics::GATEWAY).unwrap();
    let config = usal::Config::client("uav1", &net.endpoint);
    let named = within(Session::open(config.clone().named("fire-watch"))).await.unwrap();
    let _call = named.call(gateway::REQUEST, &GatewayRequest::Hold, DEADLINE);
    let incoming = within(server.recv()).await.unwrap();
    assert_eq!(incoming.from(), Some("fire-watch"));
    assert!(incoming.id().is_some());
    let nameless = within(Session::open(config.clone())).await.unwrap();
    let _call = nameless.call(topics::describe(topics::GATEWAY), &Empty {}, DEADLINE);
    assert_eq!(within(describe.recv()).await.unwrap().from(), None);
    let refused = within(nameless.call(gateway::REQUEST, &GatewayRequest::Hold, DEADLINE)).await;
    assert!(matches!(&refused, Err(CallError::Refused(r)) if r.code == "anonymous"), "{refused:?}");
    assert!(server.try_recv().is_none(), "who may not ask does not reach the service");
    assert!(within(Session::open(config.named("a;id=1"))).await.is_err());
}

#[tokio::test(flavor = "multi_thread")]
async fn who_asks_and_in_which_version_is_looked_at_before_the_request() {
    let net = Net::open().await;
    let (executed, service) = counting(&net);
    let mut plan = net.hub.serve(fp_manager::PLAN_DOCUMENT).unwrap();
    let reader = tokio::spawn(async move {
        while let Some(incoming) = plan.recv().await {
            incoming.answer(Ok(PlanDocument::default()));
        }
    });
    let outside = outside_client(&net.endpoint).await;
    // (parameters, code of the refusal of a request and of a question for the plan; empty: taken)
    let cases = [
        ("", "anonymous", ""),
        ("from=anonymous", "anonymous", ""),
        ("from=", "bad-name", "bad-name"),
        ("from=a b", "bad-name", "bad-name"),
        ("from=camera", "", ""),
        ("from=camera;version=1", "", ""),
        ("from=camera;version=2", "version", "version"),
        ("version=2", "version", "version"),
        ("from=camera;version=one", "version", "version"),
        ("from=camera;version=", "version", "version"),
    ];
    let mut taken = 0;
    for (parameters, changing, reading) in cases {
        let (json, hold) = (Encoding::APPLICATION_JSON, br#"{"request":"hold"}"#);
        let asked = ask_with(&outside, "gateway", "request", parameters, hold, json.clone()).await;
        let read = ask_with(&outside, "fp-manager", "plan", parameters, b"", json).await;
        for (answer, code) in [(asked, changing), (read, reading)] {
            let told = answer.err().unwrap_or_default();
            assert_eq!(told.is_empty(), code.is_empty(), "{parameters}: {told}");
            assert!(told.contains(code), "{parameters}: {told}");
        }
        taken += usize::from(changing.is_empty());
        assert_eq!(executed.load(Ordering::SeqCst), taken, "{parameters}");
    }
    service.abort();
    reader.abort();
}

#[tokio::test(flavor = "multi_thread")]
async fn silent_service_the_caller_hears_of_it_at_the_deadline() {
    let net = Net::open().await;
    let mut server = net.hub.serve(gateway::REQUEST).unwrap();
    let client = net.client().await;
    let started = Instant::now();
    let call = client.call(gateway::REQUEST, &GatewayRequest::Hold, Duration::from_millis(300));
    let held = within(server.recv()).await.unwrap();
    let result = within(call).await;
    assert!(matches!(result, Err(CallError::Timeout { .. })), "{result:?}");
    assert!(started.elapsed() >= Duration::from_millis(300));
    drop(held);
}

#[tokio::test(flavor = "multi_thread")]
async fn absent_service_is_said_to_be_unreachable() {
    let net = Net::open().await;
    let client = net.client().await;
    let mut call = client.call(fp_manager::COMMAND, &Command::Start, Duration::from_secs(4));
    let result = loop {
        match call.try_take() {
            Some(result) => break result,
            None => tokio::task::yield_now().await,
        }
    };
    assert!(matches!(result, Err(CallError::Unreachable { .. })), "{result:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn request_whose_deadline_has_passed_is_not_executed() {
    let net = Net::open().await;
    let mut server = net.hub.serve(gateway::REQUEST).unwrap();
    let client = net.client().await;
    let missed =
        within(client.call(gateway::REQUEST, &GatewayRequest::Launch, Duration::from_millis(500))).await;
    assert!(missed.is_err());
    let call = client.call(gateway::REQUEST, &GatewayRequest::Hold, DEADLINE);
    let incoming = within(server.recv()).await.unwrap();
    assert_eq!(incoming.request, GatewayRequest::Hold);
    incoming.answer(Ok(Empty {}));
    within(call).await.unwrap();
}

/// A service that does whatever it is asked, and how often it did.
fn counting(net: &Net) -> (Arc<AtomicUsize>, tokio::task::JoinHandle<()>) {
    let mut server = net.hub.serve(gateway::REQUEST).unwrap();
    let executed = Arc::new(AtomicUsize::new(0));
    let count = executed.clone();
    let service = tokio::spawn(async move {
        while let Some(incoming) = server.recv().await {
            count.fetch_add(1, Ordering::SeqCst);
            incoming.answer(Ok(Empty {}));
        }
    });
    (executed, service)
}

#[tokio::test(flavor = "multi_thread")]
async fn repeated_request_ids_are_executed_once() {
    let net = Net::open().await;
    let (executed, service) = counting(&net);
    let outside = outside_client(&net.endpoint).await;
    for (id, total) in [("7", 1), ("7", 1), ("8", 2), ("7", 2)] {
        let reply =
            ask(&outside, "gateway", "request", id, br#"{"request":"hold"}"#, Encoding::APPLICATION_JSON)
                .await;
        assert_eq!(reply.unwrap(), "{}");
        assert_eq!(executed.load(Ordering::SeqCst), total, "id {id}");
    }
    for n in 0..600 {
        ask(
            &outside,
            "gateway",
            "request",
            &format!("n{n}"),
            br#"{"request":"hold"}"#,
            Encoding::APPLICATION_JSON,
        )
        .await
        .unwrap();
    }
    assert_eq!(executed.load(Ordering::SeqCst), 602);
    service.abort();
}

#[tokio::test(flavor = "multi_thread")]
async fn clients_that_use_the_same_ids_get_their_own_answers() {
    let net = Net::open().await;
    let (executed, service) = counting(&net);
    let outside = outside_client(&net.endpoint).await;
    let [hold, resume] = [br#"{"request":"hold"}"#.as_slice(), br#"{"request":"resume"}"#];
    // (id and asker, what, executed in all)
    let cases = [
        ("1;from=a", hold, 1),
        ("1;from=b", hold, 2),
        ("1;from=b", resume, 3),
        ("1", resume, 4),
        ("1;from=a", hold, 4),
    ];
    for (id, payload, total) in cases {
        ask(&outside, "gateway", "request", id, payload, Encoding::APPLICATION_JSON).await.unwrap();
        assert_eq!(executed.load(Ordering::SeqCst), total, "{id}");
    }
    service.abort();
}

#[tokio::test(flavor = "multi_thread")]
async fn refused_as_busy_or_expired_it_can_be_sent_again_under_the_same_id() {
    for code in ["busy", "expired"] {
        let net = Net::open().await;
        let mut server = net.hub.serve(gateway::REQUEST).unwrap();
        let service = tokio::spawn(async move {
            let refusal = Refusal { code: code.into(), reason: "not now".into() };
            server.recv().await.unwrap().answer(Err(refusal));
            server.recv().await.unwrap().answer(Ok(Empty {}));
            // the third time it is answered from memory
            server
        });
        let outside = outside_client(&net.endpoint).await;
        let payload = br#"{"request":"hold"}"#;
        let ask = || ask(&outside, "gateway", "request", "1", payload, Encoding::APPLICATION_JSON);
        assert!(ask().await.unwrap_err().contains(code));
        for _ in 0..2 {
            assert_eq!(ask().await.unwrap(), "{}");
        }
        drop(service.await.unwrap());
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn request_given_up_by_the_service_is_answered_all_the_same() {
    let net = Net::open().await;
    let mut server = net.hub.serve(gateway::REQUEST).unwrap();
    let client = net.client().await;
    let call = client.call(gateway::REQUEST, &GatewayRequest::Hold, DEADLINE);
    drop(within(server.recv()).await.unwrap());
    match within(call).await {
        Err(CallError::Refused(refusal)) => assert_eq!(refusal.code, "unanswered"),
        other => panic!("{other:?}"),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn more_requests_than_fit_are_refused_as_busy() {
    let net = Net::open().await;
    let _server = net.hub.serve(gateway::REQUEST).unwrap();
    let client = net.client().await;
    let calls: Vec<_> = (0..80)
        .map(|_| client.call(gateway::REQUEST, &GatewayRequest::Hold, Duration::from_secs(2)))
        .collect();
    let mut busy = 0;
    for call in calls {
        if let Err(CallError::Refused(refusal)) = within(call).await {
            assert_eq!(refusal.code, "busy");
            busy += 1;
        }
    }
    assert_eq!(busy, 80 - 64);
}

#[tokio::test(flavor = "multi_thread")]
async fn refused_request_is_in_the_books_under_the_name_it_gave() {
    let net = Net::open().await;
    let (sender, mut books) = tokio::sync::mpsc::unbounded_channel();
    net.hub.audit(move |audited| drop(sender.send(audited)));
    let mut server = net.hub.serve(gateway::REQUEST).unwrap();
    let outside = outside_client(&net.endpoint).await;
    let (endless, cut) = ("ü".repeat(1000), "ü".repeat(64));
    // (parameters, who asked by the books, why it was refused)
    let cases = [
        ("", None, "anonymous"),
        ("from=anonymous", None, "anonymous"),
        ("from=", Some(""), "bad-name"),
        ("from=../operator", Some("../operator"), "bad-name"),
        (&format!("from={endless}"), Some(&*cut), "bad-name"),
        ("from=camera;version=2", Some("camera"), "version"),
        ("from=a b;version=2", Some("a b"), "version"),
    ];
    for (parameters, caller, code) in cases {
        let hold = br#"{"request":"hold"}"#;
        let json = Encoding::APPLICATION_JSON;
        ask_with(&outside, "gateway", "request", parameters, hold, json).await.unwrap_err();
        let audited = within(books.recv()).await.unwrap();
        assert_eq!(audited.caller.as_deref(), caller, "{parameters}");
        assert_eq!((audited.invocation.as_str(), audited.accepted), ("request", false), "{parameters}");
        assert_eq!(audited.answer.to_json()["code"], code, "{parameters}");
        assert_eq!(audited.request.to_json()["request"], "hold", "{parameters}");
    }
    assert!(
        books.try_recv().is_err() && server.try_recv().is_none(),
        "each is told once, and executed never"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn garbage_request_is_refused_with_what_is_wrong() {
    let net = Net::open().await;
    let _server = net.hub.serve(fp_manager::COMMAND).unwrap();
    let outside = outside_client(&net.endpoint).await;
    let cases: [(&[u8], Encoding); 4] = [
        (br#"{"command":"explode"}"#, Encoding::APPLICATION_JSON),
        (b"{", Encoding::APPLICATION_JSON),
        (b"\xff\xff\xff", Encoding::APPLICATION_CBOR),
        (b"", Encoding::ZENOH_BYTES),
    ];
    for (payload, encoding) in cases {
        let refusal =
            ask(&outside, "fp-manager", "command", "", payload, encoding.clone()).await.unwrap_err();
        assert!(refusal.contains("bad-request"), "{refusal}");
    }
    assert_eq!(net.hub.health().undecodable, 4);
}

#[tokio::test(flavor = "multi_thread")]
async fn garbage_payload_is_counted_and_ignored() {
    let net = Net::open().await;
    let outside = outside_client(&net.endpoint).await;
    let mut subscriber = net.hub.follow(gateway::AIR).unwrap();
    let mut events = net.hub.listen(gateway::EVENTS, Start::Now).unwrap();
    put(&outside, "gateway/variable/air", b"\x00garbage", Encoding::APPLICATION_CBOR).await;
    put(&outside, "gateway/variable/air", b"[]", Encoding::APPLICATION_JSON).await;
    put(&outside, "gateway/event/events", b"nonsense", Encoding::TEXT_PLAIN).await;
    let good = serde_json::to_vec(&Stamped { time_s: 0.0, validity_s: 1.0, value: air(9.0) }).unwrap();
    put(&outside, "gateway/variable/air", &good, Encoding::APPLICATION_JSON).await;
    assert_eq!(within(subscriber.changed()).await.unwrap().stamped.value, air(9.0));
    until(async || net.hub.health().undecodable == 3).await;
    let lost = within(events.recv()).await;
    assert_eq!(lost, Some(Occurrence::Gap { missed: 1 }), "an event that nobody can read is lost");
    assert!(events.try_recv().is_none());
}

#[tokio::test(flavor = "multi_thread")]
async fn describe_answers_in_json_to_anyone() {
    let net = Net::open().await;
    let mut server = net.hub.serve_description(topics::GATEWAY).unwrap();
    let service = tokio::spawn(async move {
        while let Some(incoming) = server.recv().await {
            incoming.answer(Ok(usal::spec::GATEWAY.describe()));
        }
    });
    let outside = outside_client(&net.endpoint).await;
    let text = ask(&outside, "gateway", "describe", "", b"", Encoding::APPLICATION_JSON).await.unwrap();
    let description: usal::Description = serde_json::from_str(&text).unwrap();
    assert_eq!(description, usal::spec::GATEWAY.describe());
    service.abort();
}

#[tokio::test(flavor = "multi_thread")]
async fn service_that_dies_is_gone_from_the_presence() {
    let net = Net::open().await;
    let mut presence = net.hub.presence().unwrap();
    let client = net.client().await;
    let alive = client.announce(topics::FP_MANAGER).unwrap();
    until_alive(&mut presence, topics::FP_MANAGER, true).await;
    let first = presence.arrival(topics::FP_MANAGER);
    drop(alive);
    until_alive(&mut presence, topics::FP_MANAGER, false).await;
    assert_eq!(presence.arrival(topics::FP_MANAGER), None);
    let _again = client.announce(topics::FP_MANAGER).unwrap();
    until_alive(&mut presence, topics::FP_MANAGER, true).await;
    assert!(presence.arrival(topics::FP_MANAGER) > first, "another one came");
}

#[tokio::test(flavor = "multi_thread")]
async fn vehicles_do_not_hear_each_other() {
    let net = Net::open().await;
    let other = Session::open(usal::Config::client("uav2", &net.endpoint)).await.unwrap();
    let own = net.client().await;
    let mut own_air = own.follow(gateway::AIR).unwrap();
    let other_air = other.follow(gateway::AIR).unwrap();
    net.hub.publish(gateway::AIR).unwrap().set(0.0, 1.0, &air(1.0));
    let publisher = net.hub.publish(gateway::AIR).unwrap();
    publisher.set(0.0, 1.0, &air(2.0));
    until(async || own_air.changed().await.unwrap().stamped.value == air(2.0)).await;
    assert!(other_air.latest().is_none());
}

#[tokio::test(flavor = "multi_thread")]
async fn unusable_names_and_endpoints_are_refused_with_advice() {
    let bad_name = Session::open(usal::Config::client("uav/1", "tcp/127.0.0.1:1")).await;
    assert!(matches!(bad_name, Err(SessionError::Key(_))), "{bad_name:?}");
    let bad_endpoint = Session::open(usal::Config::hub("uav1", "nonsense")).await;
    assert!(matches!(bad_endpoint, Err(SessionError::Endpoint { .. })), "{bad_endpoint:?}");
    let net = Net::open().await;
    let taken = Session::open(usal::Config::hub("uav1", &net.endpoint)).await.unwrap_err().to_string();
    assert!(taken.contains("nothing else listens"), "{taken}");
}

#[test]
fn single_threaded_runtime_is_refused_instead_of_panicking() {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let result = runtime.block_on(Session::open(usal::Config::client("uav1", "tcp/127.0.0.1:1")));
    assert!(matches!(result, Err(SessionError::Runtime)));
}

/// A client that makes use of everything, busy until its session closes.
async fn busy(endpoint: &str) -> Session {
    let session = Session::open(Config::client("uav1", endpoint)).await.unwrap();
    let publisher = session.publish(fp_manager::HEARTBEAT).unwrap();
    let emitter = session.emitter(gateway::EVENTS).unwrap();
    let variable = session.follow(fp_manager::HEARTBEAT).unwrap();
    let mut events = session.listen(gateway::EVENTS, Start::Remembered).unwrap();
    let (announced, presence) = (session.announce("busy").unwrap(), session.presence().unwrap());
    tokio::spawn(async move {
        let _held = (variable, announced, presence);
        for count in 0.. {
            publisher.set(0.0, 1.0, &Heartbeat { count, plan: None });
            emitter.emit(&low(1));
            let next = tokio::time::timeout(Duration::from_millis(1), events.recv()).await;
            if next.is_ok_and(|event| event.is_none()) {
                return;
            }
        }
    });
    session
}

#[tokio::test(flavor = "multi_thread")]
async fn closing_is_quick_whoever_comes_late_and_whoever_goes_first() {
    for (hub_late, hub_first) in [(false, false), (false, true), (true, false), (true, true)] {
        let endpoint = free_endpoint();
        let early = if hub_late { Some(busy(&endpoint).await) } else { None };
        let hub = Session::open(Config::hub("uav1", &endpoint)).await.unwrap();
        let mut sessions = vec![busy(&endpoint).await];
        sessions.extend(early);
        for session in &sessions {
            until(async || session.is_connected().await).await;
        }
        sessions.insert(if hub_first { 0 } else { sessions.len() }, hub);
        let started = Instant::now();
        for session in sessions {
            session.close().await;
        }
        // a single one that hung would take two seconds
        assert!(started.elapsed() < Duration::from_millis(1900), "late {hub_late}, first {hub_first}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_published_and_asked_says_which_session_it_is_of() {
    let net = Net::open().await;
    let (a, b) = (net.client().await, net.client().await);
    let mut air_of = b.follow(gateway::AIR).unwrap();
    let mut events = b.listen(gateway::EVENTS, Start::Remembered).unwrap();
    let publisher = a.publish(gateway::AIR).unwrap();
    publisher.set(0.0, 1.0, &air(5.0));
    let emitter = a.emitter(gateway::EVENTS).unwrap();
    emitter.emit(&low(1));
    let value = within(air_of.changed()).await.unwrap();
    assert_eq!(value.from, Some(a.instance()));
    let Some(Occurrence::Event { from, .. }) = within(events.recv()).await else { panic!("an event") };
    assert_eq!(from, Some(a.instance()));
    // who comes late and asks for the last value
    let late = net.client().await.follow(gateway::AIR).unwrap();
    until(async || late.latest().is_some_and(|value| value.from == Some(a.instance()))).await;
    let mut server = a.serve(gateway::REQUEST).unwrap();
    let call = b.call(gateway::REQUEST, &GatewayRequest::Hold, DEADLINE);
    let incoming = within(server.recv()).await.unwrap();
    assert_eq!((incoming.instance(), incoming.served_by()), (Some(b.instance()), a.instance()));
    incoming.answer(Ok(Empty {}));
    within(call).await.unwrap();
    // a stranger's plain put
    let stranger = outside_client(&net.endpoint).await;
    let json = br#"{"time_s": 1, "validity_s": 1, "value": {"count": 7, "plan": null}}"#;
    let mut heartbeat = b.follow(fp_manager::HEARTBEAT).unwrap();
    until(async || {
        put(&stranger, "fp-manager/variable/heartbeat", json, Encoding::APPLICATION_JSON).await;
        tokio::time::timeout(Duration::from_millis(100), heartbeat.changed()).await.is_ok()
    })
    .await;
    assert_ne!(heartbeat.latest().unwrap().from, Some(a.instance()));
}

/// It may have been done: to say that it was dropped would be a lie.
#[tokio::test(flavor = "multi_thread")]
async fn connection_lost_while_a_request_is_out_leaves_it_in_doubt() {
    let endpoint = free_endpoint();
    let hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
    let client = client(&endpoint).await;
    let mut server = hub.serve(gateway::REQUEST).unwrap();
    let call = client.call_within(gateway::REQUEST, &GatewayRequest::Hold, Duration::from_secs(2), DEADLINE);
    let taken = within(server.recv()).await.unwrap();
    hub.close().await;
    let error = within(call).await.unwrap_err();
    assert!(matches!(error, CallError::Lost { .. }), "{error:?}");
    drop(taken);
}

/// Who says nothing on a connection locks nobody out for long.
#[tokio::test(flavor = "multi_thread")]
async fn idle_connections_keep_nobody_from_connecting() {
    let net = Net::open().await;
    let address = net.endpoint.trim_start_matches("tcp/").to_owned();
    let idle: Vec<_> = (0..150).map(|_| std::net::TcpStream::connect(&address).unwrap()).collect();
    let _server = net.hub.serve(gateway::REQUEST).unwrap();
    let begun = std::time::Instant::now();
    let client = net.client().await;
    assert!(client.is_connected().await && begun.elapsed() < Duration::from_secs(8), "{:?}", begun.elapsed());
    drop(idle);
}
