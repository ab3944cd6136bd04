//! The whole gateway over sockets: simulator, link, session.

use super::other_autopilot::{self, Glider};
use crate::gateway::{Address, Config, run, tlog};
use crate::services::storage::Limits;
use autopilot_link::frame::{Sender, encode_payload};
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::path::Path;
use std::time::{Duration, Instant};
use usal::Session;
use usal::contract::{GatewayRequest, GatewayState, LatLon, SafeRunway};
use usal::topics::gateway;

fn free_endpoint() -> String {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    format!("tcp/127.0.0.1:{port}")
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_lockstep_simulator_is_seen_on_the_network_and_time_runs_fast() {
    let sim = sim::spawn(sim::Config { lockstep: true, speed: 0.0, ..sim::Config::default() }).unwrap();
    let autopilot: Address = format!("tcp:{}", sim.address()).parse().unwrap();
    let listen = free_endpoint();
    let (trigger, shutdown) = crate::shutdown();
    let config = Config { simulated: true, ..Config::new("test", &listen, autopilot) };
    let task = tokio::spawn(run(config, shutdown));
    let session = Session::open(usal::Config::client("test", &listen).named("test")).await.unwrap();
    let mut state = session.follow(gateway::STATE).unwrap();
    let wait = async {
        loop {
            let status = state.changed().await.unwrap();
            if status.stamped.value.state == GatewayState::Stop && status.stamped.time_s > 20.0 {
                return status.stamped.time_s;
            }
        }
    };
    let begun_s = tokio::time::timeout(Duration::from_secs(60), wait)
        .await
        .expect("the gateway receives the simulator");
    let (begun, mut now_s) = (Instant::now(), begun_s);
    while now_s < begun_s + 100.0 {
        let next = tokio::time::timeout(Duration::from_secs(20), state.changed()).await.unwrap().unwrap();
        now_s = next.stamped.time_s;
    }
    let steps_per_s = (now_s - begun_s) * 10.0 / begun.elapsed().as_secs_f64();
    println!("{steps_per_s:.0} lockstep steps a second");
    assert!(steps_per_s > 50.0, "{steps_per_s}");
    trigger.shut_down();
    tokio::time::timeout(Duration::from_secs(10), task).await.unwrap().unwrap().unwrap();
    sim.stop();
}

/// The driver of the configuration says whose datagrams are the autopilot's and what they mean.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_autopilot_of_another_driver_is_seen_on_the_network() {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let listen = free_endpoint();
    let (trigger, shutdown) = crate::shutdown();
    let config = Config {
        driver: other_autopilot::REGISTRATION,
        ..Config::new("test", &listen, format!("udp:{port}").parse().unwrap())
    };
    let task = tokio::spawn(run(config, shutdown));
    let session = Session::open(usal::Config::client("test", &listen).named("test")).await.unwrap();
    let mut state = session.follow(gateway::STATE).unwrap();
    let mut glider = Glider::default();
    let wait = async {
        loop {
            // a datagram that comes too early is lost
            glider.step();
            let lines = format!("GLIDER 1\n{}", std::mem::take(&mut glider.out));
            socket.send_to(lines.as_bytes(), port).unwrap();
            let next = tokio::time::timeout(Duration::from_millis(100), state.changed()).await;
            if let Ok(Some(status)) = next
                && status.stamped.value.autopilot_mode == "manual"
                // it never says whether it stands: that is believed after a while
                && status.stamped.value.state != GatewayState::Off
            {
                return status.stamped.value.state;
            }
        }
    };
    let seen =
        tokio::time::timeout(Duration::from_secs(60), wait).await.expect("the gateway sees the glider");
    assert_eq!(seen, GatewayState::Stop);
    trigger.shut_down();
    tokio::time::timeout(Duration::from_secs(10), task).await.unwrap().unwrap().unwrap();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn killed_after_an_answer_what_was_accepted_is_on_the_disk() {
    let directory = tempfile::tempdir().unwrap();
    let listen = free_endpoint();
    let (trigger, shutdown) = crate::shutdown();
    let state_dir = Some(directory.path().to_owned());
    let config = Config { state_dir, ..Config::new("test", &listen, "udp:127.0.0.1:0".parse().unwrap()) };
    let task = tokio::spawn(run(config, shutdown));
    let session = Session::open(usal::Config::client("test", &listen).named("test")).await.unwrap();
    for id in ["A", "B", "C", "D"] {
        let runway = SafeRunway {
            id: id.into(),
            threshold: LatLon::new(36.3190, -84.1730),
            elevation_amsl_m: 349.0,
            heading_deg: 52.0,
            length_m: 600.0,
            priority: 1,
        };
        let request = GatewayRequest::SetRunways { runways: vec![runway] };
        session.call(gateway::REQUEST, &request, Duration::from_secs(60)).await.unwrap();
        let stored = std::fs::read_to_string(directory.path().join("gateway.json")).unwrap();
        assert!(stored.contains(&format!("\"id\":\"{id}\"")), "{id}: {stored}");
    }
    trigger.shut_down();
    tokio::time::timeout(Duration::from_secs(10), task).await.unwrap().unwrap().unwrap();
}

/// A flight over two links is logged, and the log is played to another gateway.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn two_links_are_logged_and_a_log_that_is_played_can_not_be_commanded() {
    let directory = tempfile::tempdir().unwrap();
    let link = sim::Link::Udp(SocketAddr::from(([127, 0, 0, 1], 0)));
    let sim = sim::spawn(sim::Config { link, ..sim::Config::default() }).unwrap();
    let autopilot: Address = format!("udpout:{}", sim.address()).parse().unwrap();
    let limits = Limits { quota_bytes: 100 << 20, reserve_bytes: 0 };
    let log = tlog::Config { folder: directory.path().into(), limits, vehicle: "test".into() };
    let listen = free_endpoint();
    let usual = Config::new("test", &listen, autopilot.clone());
    let (trigger, shutdown) = crate::shutdown();
    let config = Config { autopilots: vec![autopilot.clone(), autopilot], tlog: Some(log), ..usual };
    let task = tokio::spawn(run(config, shutdown));
    let session = Session::open(usal::Config::client("test", &listen).named("test")).await.unwrap();
    let mut links = session.follow(gateway::LINKS).unwrap();
    let both = async {
        while !links.changed().await.unwrap().stamped.value.links.iter().all(|link| link.received > 100) {}
    };
    tokio::time::timeout(Duration::from_secs(60), both)
        .await
        .expect("the autopilot is heard over both links");
    trigger.shut_down();
    tokio::time::timeout(Duration::from_secs(10), task).await.unwrap().unwrap().unwrap();
    sim.stop();
    drop(session);
    replay(directory.path()).await;
    replay_of_a_flight(directory.path()).await;
}

/// What was flown when the log was made needs nobody now, and is nothing to go on with.
async fn replay_of_a_flight(folder: &Path) {
    let autopilot = Sender { system: 1, component: 1 };
    // HEARTBEAT of an armed ArduPlane in AUTO, EXTENDED_SYS_STATE in the air
    let (beat, in_air) = ((0, &[10, 0, 0, 0, 1, 3, 0x81, 4, 3][..]), (245, &[0, 2][..]));
    let mut log = vec![];
    for (at, (id, payload)) in (0_u8..).zip([beat, in_air, beat, in_air]) {
        let frame = encode_payload(autopilot, at, id, payload);
        autopilot_link::tlog::received(1_000_000 + 10_000 * u64::from(at), 0, &frame, &mut log);
    }
    let (file, state_dir) = (folder.join("flight.tlog"), folder.join("state"));
    std::fs::write(&file, log).unwrap();
    let listen = free_endpoint();
    let (trigger, shutdown) = crate::shutdown();
    let config = Config::new("test", &listen, format!("tlog:{}", file.display()).parse().unwrap());
    let task = tokio::spawn(run(Config { state_dir: Some(state_dir.clone()), ..config }, shutdown));
    let session = Session::open(usal::Config::client("test", &listen).named("test")).await.unwrap();
    let mut vehicle = session.follow(gateway::LINKS).unwrap();
    let heard = async {
        while !vehicle.changed().await.unwrap().stamped.value.links.iter().all(|link| link.received >= 4) {}
    };
    tokio::time::timeout(Duration::from_secs(60), heard).await.expect("the log is played");
    trigger.shut_down();
    tokio::time::timeout(Duration::from_secs(10), task).await.unwrap().unwrap().unwrap();
    assert!(!state_dir.join("gateway.json").exists(), "nothing of a log is flown after a restart");
}

async fn replay(folder: &Path) {
    let file = std::fs::read_dir(folder).unwrap().next().unwrap().unwrap().path();
    let listen = free_endpoint();
    let (trigger, shutdown) = crate::shutdown();
    let address = format!("tlog:{}", file.display()).parse().unwrap();
    let task = tokio::spawn(run(Config::new("test", &listen, address), shutdown));
    let session = Session::open(usal::Config::client("test", &listen).named("test")).await.unwrap();
    let mut state = session.follow(gateway::STATE).unwrap();
    let heard = async {
        loop {
            let status = state.changed().await.unwrap().stamped.value.clone();
            if status.state == GatewayState::Stop {
                return status;
            }
        }
    };
    let status = tokio::time::timeout(Duration::from_secs(60), heard).await.expect("the log is played");
    assert!(status.alarms.iter().any(|alarm| alarm.id == "replay"), "{status:?}");
    let refused = session.call(gateway::REQUEST, &GatewayRequest::Safe, Duration::from_secs(20)).await;
    assert!(format!("{refused:?}").contains("replay"), "{refused:?}");
    trigger.shut_down();
    tokio::time::timeout(Duration::from_secs(10), task).await.unwrap().unwrap().unwrap();
}
