//! From a MAVLink frame on the autopilot's link to the gateway's `position` at a subscriber, at the pace of telemetry: at a service of
//! the vehicle, which comes to the hub's Unix socket, and at somebody who comes to the port for everybody, by TCP over loopback.
//!
//! Beside each in the same run: a bare Zenoh hop between the same two kinds of session, and the least that can be done with a frame, which
//! is to receive a datagram and to put a value of the same size on Zenoh. Prints percentiles and the ratios (goal: p50 at most 1.1 times
//! the bare hop's). Each hop comes after a pause, since that is how telemetry comes: what comes right behind another one takes half
//! the time.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a bench ends where it can't go on")]

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::*;
use onboard_agent::inside::Inside;
use onboard_agent::{Shutdown, gateway, shutdown};
use std::net::{TcpListener, UdpSocket};
use std::time::{Duration, Instant};
use tokio::sync::mpsc;
use usal::{Config, Session, topics};
use zenoh::Wait;

const WARM_UP: usize = 100;
const SAMPLES: usize = 500;
/// Above the gateway's least spacing of telemetry: every frame is published.
const PACE: Duration = Duration::from_millis(8);
/// A stamped position in CBOR has about this size, bytes.
const PAYLOAD: usize = 220;

fn main() {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let (_trigger, shutdown) = shutdown();
        let inside = [Inside::new().unwrap(), Inside::new().unwrap()];
        let [own, relayed] = inside.each_ref().map(|inside| inside.address().endpoint());
        let mut hops = [
            Measured::of("bare Zenoh hop, Unix socket", bare_hop(own, Begin::Here).await),
            Measured::of("datagram, then the same", bare_hop(relayed, Begin::Datagram).await),
            Measured::of("frame to a service", frame_hop(Way::Inside, shutdown.clone()).await),
            Measured::of("bare Zenoh hop, TCP", bare_hop(free_endpoint(), Begin::Here).await),
            Measured::of("datagram, then the same", bare_hop(free_endpoint(), Begin::Datagram).await),
            Measured::of("frame to somebody at the port", frame_hop(Way::Port, shutdown).await),
        ];
        // interleaved, so that whatever else the machine does hits all of them
        for sample in 0..WARM_UP + SAMPLES {
            for hop in &mut hops {
                hop.once(sample >= WARM_UP).await;
                tokio::time::sleep(PACE).await;
            }
        }
        for [bare, relayed, frame] in hops.map(|hop| hop.median_us()).as_chunks().0 {
            println!("p50 {:.2} x bare, {:.2} x with the datagram", frame / bare, frame / relayed);
        }
    });
}

/// A hop, and what it took.
struct Measured {
    name: &'static str,
    hop: Hop,
    took: Vec<Duration>,
}

impl Measured {
    fn of(name: &'static str, hop: Hop) -> Self {
        Self { name, hop, took: Vec::new() }
    }

    async fn once(&mut self, counts: bool) {
        let took = self.hop.once().await;
        self.took.extend(counts.then_some(took));
    }

    /// Prints percentiles; microseconds.
    fn median_us(mut self) -> f64 {
        self.took.sort_unstable();
        let at = |share: f64| self.took[((self.took.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e6;
        println!("{:30} p50 {:7.1} us  p95 {:7.1} us  p99 {:7.1} us", self.name, at(0.5), at(0.95), at(0.99));
        at(0.5)
    }
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

/// A router and its client, as hub and subscriber are, and what the router has received as a datagram.
async fn bare_hop(endpoint: String, begin: Begin) -> Hop {
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
    let put = move || {
        let _both_live = (&hub, &client);
        publisher.put(vec![7_u8; PAYLOAD]).wait().unwrap();
    };
    let send: Box<dyn FnMut()> = match begin {
        Begin::Here => Box::new(put),
        Begin::Datagram => {
            let at = tokio::net::UdpSocket::bind("127.0.0.1:0").await.unwrap();
            let socket = connected_to(&at.local_addr().unwrap().to_string());
            tokio::spawn(async move {
                let mut datagram = [0; 280];
                while at.recv(&mut datagram).await.is_ok() {
                    put();
                }
            });
            Box::new(move || _ = socket.send(&[7; 36]).unwrap())
        }
    };
    Hop { send, received }.ready().await
}

fn connected_to(address: &str) -> UdpSocket {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(address).unwrap();
    socket
}

/// Where a hop begins.
#[derive(Clone, Copy)]
enum Begin {
    /// With the value in Zenoh's hands.
    Here,
    /// With a datagram to who puts it in them.
    Datagram,
}

/// How a subscriber comes to the hub.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Inside,
    Port,
}

/// With a gateway of its own.
async fn frame_hop(way: Way, shutdown: Shutdown) -> Hop {
    let (port, link, inside) = (free_endpoint(), free_udp(), Inside::new().unwrap());
    let autopilot = format!("udp:{link}").parse().unwrap();
    let config = gateway::Config::new("bench", &port, autopilot);
    tokio::spawn(gateway::run(
        gateway::Config { inside: Some(inside.address().clone()), ..config },
        shutdown,
    ));
    let endpoint = if way == Way::Inside { inside.address().endpoint() } else { port };
    let session = Session::open(Config::client("bench", &endpoint).named("bench")).await.unwrap();
    let mut position = session.follow(topics::gateway::POSITION).unwrap();
    let (sender, received) = mpsc::channel(16);
    tokio::spawn(async move {
        while let Some(value) = position.changed().await {
            let _ = sender.try_send(value.at);
        }
    });
    let socket = connected_to(&link);
    let (mut sequence, mut frame) = (0_u8, Vec::with_capacity(280));
    let send = Box::new(move || {
        let _lives = &inside;
        // a sign of life now and then
        for message in [(sequence % 50 == 0).then(heartbeat), Some(place(sequence))].into_iter().flatten() {
            frame.clear();
            let header = MavHeader { system_id: 1, component_id: 1, sequence };
            mavlink::write_v2_msg(&mut frame, header, &message).unwrap();
            // at first it does not listen yet
            let _ = socket.send(&frame);
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
