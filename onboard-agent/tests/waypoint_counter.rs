//! The example of a service of one's own, over loopback.
#![cfg(test)]

#[path = "../examples/waypoint_counter.rs"]
#[allow(dead_code, reason = "its `main` is for who runs the example")]
mod waypoint_counter;

use service::{Config, audit, run_alone, shutdown};
use std::time::Duration;
use usal::contract::{Empty, GatewayEvent, Stamped, Token};
use usal::topics::gateway;
use usal::{Occurrence, Session, Start};
use waypoint_counter::{HOW_MANY, WaypointCounter};

/// Longer than anything takes on a slow machine.
const DEADLINE: Duration = Duration::from_secs(30);

async fn within<F: Future>(future: F) -> F::Output {
    tokio::time::timeout(DEADLINE, future).await.expect("in time")
}

#[tokio::test(flavor = "multi_thread")]
async fn waypoints_flown_are_counted_and_the_question_is_answered() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let endpoint = format!("tcp/{}", listener.local_addr().unwrap());
    drop(listener);
    let hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
    let (trigger, shutdown) = shutdown();
    let task =
        tokio::spawn(run_alone(Config::client("uav1", &endpoint), WaypointCounter::default(), shutdown));
    let client = Session::open(usal::Config::client("uav1", &endpoint).named("tester")).await.unwrap();
    let how_many = async || within(client.call(HOW_MANY, &Empty {}, DEADLINE)).await.unwrap();
    assert_eq!(how_many().await, 0);
    let events = hub.emitter(gateway::EVENTS).unwrap();
    for token in 1..=5 {
        let value = GatewayEvent::Progress { current: Some(Token(token)), taken: Token(5) };
        events.emit(&Stamped { time_s: 0.0, validity_s: 1.0, value });
    }
    within(async { while how_many().await < 5 {} }).await;
    assert_eq!(how_many().await, 5);
    // who says no name may read
    let nameless = Session::open(usal::Config::client("uav1", &endpoint)).await.unwrap();
    assert_eq!(within(nameless.call(HOW_MANY, &Empty {}, DEADLINE)).await, Ok(5));
    // named to the hub, and it keeps the books
    assert!(hub.is_announced("waypoint-counter").await.unwrap());
    let mut trail = client.listen(audit("waypoint-counter"), Start::Remembered).unwrap();
    let Occurrence::Event { event, .. } = within(trail.recv()).await.unwrap() else { panic!("a gap") };
    assert_eq!(event.value.caller.as_deref(), Some("tester"));
    trigger.shut_down();
    within(task).await.unwrap().unwrap();
}
