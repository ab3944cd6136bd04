//! From a MAVLink frame on the autopilot's link to the gateway's `position` at a subscriber, over
//! loopback, beside a bare Zenoh hop between the same two kinds of session in the same run. Prints
//! percentiles and the ratio (goal: p50 at most 1.1 times the bare hop's).
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a bench ends where it can't go on")]

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::*;
use onboard_agent::{gateway, shutdown};
use std::net::{TcpListener, UdpSocket};
use std::time::{Duration, Instant};
use tokio::sync::mpsc;
use usal::{Config, Session, topics};

const WARM_UP: usize = 100;
const SAMPLES: usize = 1000;
/// Above the gateway's least spacing of telemetry: every frame is published.
const PACE: Duration = Duration::from_millis(8);
/// A stamped position in CBOR has about this size, bytes.
const PAYLOAD: usize = 220;

fn main() {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let (_trigger, shutdown) = shutdown();
        let (endpoint, link) = (free_endpoint(), free_udp());
        let autopilot = format!("udp:{link}").parse().unwrap();
        tokio::spawn(gateway::run(gateway::Config::new("bench", &endpoint, autopilot), shutdown));
        let mut bare = bare_hop().await;
        let mut frame = frame_hop(&endpoint, &link).await;
        let (mut bares, mut frames) = (Vec::new(), Vec::new());
        // interleaved, so that whatever else the machine does hits both
        for sample in 0..WARM_UP + SAMPLES {
            let taken = (bare.once().await, frame.once().await);
            if sample >= WARM_UP {
                bares.push(taken.0);
                frames.push(taken.1);
            }
            tokio::time::sleep(PACE).await;
        }
        let bare_us = report("bare zenoh hop", &mut bares);
        let frame_us = report("MAVLink frame to subscriber", &mut frames);
        println!("p50 {:.2} x bare", frame_us / bare_us);
    });
}

fn free_endpoint() -> String {
    format!("tcp/{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap())
}

fn free_udp() -> String {
    UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string()
}

/// Something that sends, and something that has received.
struct Hop {
    send: Box<dyn FnMut()>,
    received: mpsc::Receiver<Instant>,
}

impl Hop {
    async fn once(&mut self) -> Duration {
        let sent = Instant::now();
        (self.send)();
        let received = tokio::time::timeout(Duration::from_secs(10), self.received.recv()).await;
        received.expect("within ten seconds").unwrap() - sent
    }

    /// Sends until the other side receives.
    async fn ready(mut self) -> Self {
        loop {
            (self.send)();
            if tokio::time::timeout(Duration::from_millis(50), self.received.recv()).await.is_ok() {
                break;
            }
        }
        tokio::time::sleep(Duration::from_millis(200)).await;
        while self.received.try_recv().is_ok() {}
        self
    }
}

fn zenoh_config(mode: &str, place: &str, endpoint: &str) -> zenoh::Config {
    let mut config = zenoh::Config::default();
    config.insert_json5("mode", &format!("{mode:?}")).unwrap();
    config.insert_json5(place, &format!("[{endpoint:?}]")).unwrap();
    config.insert_json5("scouting/multicast/enabled", "false").unwrap();
    config
}

/// A router and its client, as hub and subscriber are.
async fn bare_hop() -> Hop {
    use zenoh::Wait;
    let endpoint = free_endpoint();
    let hub = zenoh::open(zenoh_config("router", "listen/endpoints", &endpoint)).await.unwrap();
    let client = zenoh::open(zenoh_config("client", "connect/endpoints", &endpoint)).await.unwrap();
    let (sender, received) = mpsc::channel(16);
    client
        .declare_subscriber("bench/bare")
        .callback(move |sample| {
            if !sample.payload().is_empty() {
                let _ = sender.try_send(Instant::now());
            }
        })
        .background()
        .await
        .unwrap();
    let publisher = hub.declare_publisher("bench/bare").await.unwrap();
    let send = Box::new(move || {
        let _both_live = (&hub, &client);
        publisher.put(vec![7_u8; PAYLOAD]).wait().unwrap();
    });
    Hop { send, received }.ready().await
}

async fn frame_hop(endpoint: &str, link: &str) -> Hop {
    let session = Session::open(Config::client("bench", endpoint).named("bench")).await.unwrap();
    let mut position = session.follow(topics::gateway::POSITION).unwrap();
    let (sender, received) = mpsc::channel(16);
    tokio::spawn(async move {
        while let Some(value) = position.changed().await {
            let _ = sender.try_send(value.at);
        }
    });
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(link).unwrap();
    let (mut sequence, mut frame) = (0_u8, Vec::with_capacity(280));
    let send = Box::new(move || {
        // a sign of life now and then
        for message in [(sequence % 50 == 0).then(heartbeat), Some(place(sequence))].into_iter().flatten() {
            frame.clear();
            let header = MavHeader { system_id: 1, component_id: 1, sequence };
            mavlink::write_v2_msg(&mut frame, header, &message).unwrap();
            socket.send(&frame).unwrap();
        }
        sequence = sequence.wrapping_add(1);
    });
    Hop { send, received }.ready().await
}

fn heartbeat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_FIXED_WING,
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        ..HEARTBEAT_DATA::default()
    })
}

fn place(step: u8) -> MavMessage {
    MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
        lat: 363_190_000 + i32::from(step),
        lon: -841_730_000,
        alt: 450_000,
        relative_alt: 100_000,
        vx: 2200,
        ..GLOBAL_POSITION_INT_DATA::default()
    })
}

fn report(name: &str, times: &mut [Duration]) -> f64 {
    times.sort_unstable();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e6;
    println!("{name:28} p50 {:7.1} us  p95 {:7.1} us  p99 {:7.1} us", at(0.5), at(0.95), at(0.99));
    at(0.5)
}
