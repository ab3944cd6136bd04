//! The simulated clock: nobody goes on before everybody has done what was due.
#![cfg(test)]

mod common;

use common::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use usal::contract::*;
use usal::topics::{fp_manager, gateway};
use usal::{Conductor, Participant, Session};

async fn conductor(hub: &Session, participants: &[&str]) -> Conductor {
    let conductor = Conductor::new(hub).unwrap();
    until(async || conductor.participants() == participants).await;
    conductor
}

#[tokio::test(flavor = "multi_thread")]
async fn time_goes_on_when_everybody_has_acknowledged() {
    let net = Net::open().await;
    let done = Arc::new(AtomicU64::new(0));
    let mut sessions = Vec::new();
    for name in ["a", "b"] {
        let session = net.client().await;
        let mut participant = Participant::join(&session, name).unwrap();
        let done = done.clone();
        sessions.push(session);
        tokio::spawn(async move {
            while let Some(tick) = participant.next().await {
                done.fetch_add(1, Ordering::SeqCst);
                participant.acknowledge(tick);
            }
        });
    }
    let mut conductor = conductor(&net.hub, &["a", "b"]).await;
    for n in 1..=500_u64 {
        assert!(within(conductor.tick(n as f64 * 0.1)).await.is_empty());
        assert_eq!(done.load(Ordering::SeqCst), 2 * n);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn nobody_there_time_goes_on_at_once() {
    let net = Net::open().await;
    let mut conductor = conductor(&net.hub, &[]).await;
    for n in 0..1000 {
        assert!(within(conductor.tick(f64::from(n))).await.is_empty());
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_was_published_before_a_tick_is_there_when_it_comes() {
    let net = Net::open().await;
    let session = net.client().await;
    let mut participant = Participant::join(&session, "a").unwrap();
    let navigation = session.follow(fp_manager::HEARTBEAT).unwrap();
    let publisher = net.hub.publish(fp_manager::HEARTBEAT).unwrap();
    let mut conductor = conductor(&net.hub, &["a"]).await;
    publisher.set(0.0, 1.0, &Heartbeat { count: 0, plan: None });
    until(async || navigation.latest().is_some()).await;
    let follower = tokio::spawn(async move {
        let mut heard = Vec::new();
        while heard.len() < 300 {
            let tick = participant.next().await.unwrap();
            heard.push((tick.time_s, navigation.latest().unwrap().stamped.time_s));
            participant.acknowledge(tick);
        }
        heard
    });
    for n in 1..=300 {
        publisher.set(f64::from(n), 1.0, &Heartbeat { count: 0, plan: None });
        within(conductor.tick(f64::from(n))).await;
    }
    for (tick, value) in within(follower).await.unwrap() {
        assert_eq!(tick, value);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn participant_may_ask_the_conductor_before_it_acknowledges() {
    let net = Net::open().await;
    let session = net.client().await;
    let mut server = net.hub.serve(gateway::REQUEST).unwrap();
    let mut participant = Participant::join(&session, "script").unwrap();
    let mut conductor = conductor(&net.hub, &["script"]).await;
    let script = tokio::spawn(async move {
        let tick = participant.next().await.unwrap();
        session.call(gateway::REQUEST, &GatewayRequest::Launch, DEADLINE).await.unwrap();
        participant.acknowledge(tick);
    });
    conductor.start(1.0);
    let served = within(async {
        let mut served = 0;
        loop {
            tokio::select! {
                late = conductor.settle() => { assert!(late.is_empty()); break served; }
                Some(incoming) = server.recv() => { served += 1; incoming.answer(Ok(Empty {})); }
            }
        }
    })
    .await;
    assert_eq!(served, 1);
    within(script).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn participant_that_dies_is_not_waited_for() {
    let net = Net::open().await;
    let session = net.client().await;
    let mut participant = Participant::join(&session, "a").unwrap();
    let mut conductor = conductor(&net.hub, &["a"]).await.patience(DEADLINE * 2);
    conductor.start(1.0);
    within(participant.next()).await.unwrap();
    session.close().await;
    drop(participant);
    assert!(within(conductor.settle()).await.is_empty());
    assert!(conductor.participants().is_empty());
}

#[tokio::test(flavor = "multi_thread")]
async fn participant_that_stalls_is_dropped_with_its_name_and_may_come_back() {
    let net = Net::open().await;
    let session = net.client().await;
    let mut participant = Participant::join(&session, "slow").unwrap();
    let mut conductor = conductor(&net.hub, &["slow"]).await.patience(Duration::from_millis(300));
    let started = Instant::now();
    assert_eq!(within(conductor.tick(1.0)).await, ["slow"]);
    assert!(started.elapsed() >= Duration::from_millis(300));
    assert!(within(conductor.tick(2.0)).await.is_empty());
    let tick = within(async {
        loop {
            let tick = participant.next().await.unwrap();
            if tick.time_s == 2.0 {
                break tick;
            }
        }
    })
    .await;
    participant.acknowledge(tick);
    let follower = tokio::spawn(async move {
        let tick = participant.next().await.unwrap();
        participant.acknowledge(tick);
    });
    until(async || conductor.tick(3.0).await.is_empty() && follower.is_finished()).await;
    within(follower).await.unwrap();
}
