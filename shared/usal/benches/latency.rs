//! One hop over loopback: ours (typed, CBOR, last value or sequence numbers) beside bare Zenoh
//! between the same two kinds of session in the same run. Prints percentiles and the ratio.
#![expect(clippy::unwrap_used, reason = "a bench ends where it can't go on")]

use std::net::TcpListener;
use std::time::{Duration, Instant};
use tokio::sync::mpsc;
use usal::contract::{Air, GatewayEvent, GatewayRequest, Stamped, TimedGatewayEvent};
use usal::topics::gateway;
use usal::{Config, Occurrence, Session, Start};

const WARM_UP: usize = 200;
const SAMPLES: usize = 2000;
/// A hop each millisecond: latency, not throughput.
const PACE: Duration = Duration::from_millis(1);

fn main() {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let endpoint = format!("tcp/{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap());
        let hub = Session::open(Config::hub("bench", &endpoint)).await.unwrap();
        let client = Session::open(Config::client("bench", &endpoint).named("bench")).await.unwrap();
        // interleaved, so that whatever else the machine does hits both
        let mut bare = bare_hop(&endpoint).await;
        let mut variable = variable_hop(&hub, &client).await;
        let mut event = event_hop(&hub, &client).await;
        let (mut bares, mut variables, mut events) = (Vec::new(), Vec::new(), Vec::new());
        for sample in 0..WARM_UP + SAMPLES {
            let taken = [bare.once().await, variable.once().await, event.once().await];
            if sample >= WARM_UP {
                bares.push(taken[0]);
                variables.push(taken[1]);
                events.push(taken[2]);
            }
            tokio::time::sleep(PACE).await;
        }
        let bare_us = report("bare zenoh hop", &mut bares, None);
        report("usal variable hop", &mut variables, Some(bare_us));
        report("usal event hop", &mut events, Some(bare_us));
        call_round_trip(&hub, &client).await;
    });
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
        self.received.recv().await.unwrap() - sent
    }

    /// Sends until the other side hears.
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

fn zenoh_config(listen: Option<&str>, connect: Option<&str>) -> zenoh::Config {
    let mut config = zenoh::Config::default();
    let list =
        |endpoint: Option<&str>| serde_json::to_string(&endpoint.into_iter().collect::<Vec<_>>()).unwrap();
    config.insert_json5("listen/endpoints", &list(listen)).unwrap();
    config.insert_json5("connect/endpoints", &list(connect)).unwrap();
    config.insert_json5("scouting/multicast/enabled", "false").unwrap();
    config
}

/// Two peers as Zenoh makes them, a payload of the same size.
async fn bare_hop(_: &str) -> Hop {
    use zenoh::Wait;
    let endpoint = format!("tcp/{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap());
    let a = zenoh::open(zenoh_config(Some(&endpoint), None)).await.unwrap();
    let b = zenoh::open(zenoh_config(None, Some(&endpoint))).await.unwrap();
    let (sender, received) = mpsc::channel(16);
    b.declare_subscriber("bench/bare")
        .callback(move |sample| {
            let bytes = sample.payload().to_bytes();
            if !bytes.is_empty() {
                let _ = sender.try_send(Instant::now());
            }
        })
        .background()
        .await
        .unwrap();
    let publisher = a.declare_publisher("bench/bare").await.unwrap();
    let payload = vec![7_u8; 120];
    let send = Box::new(move || {
        let _both_live = (&a, &b);
        publisher.put(payload.clone()).wait().unwrap();
    });
    Hop { send, received }.ready().await
}

async fn variable_hop(hub: &Session, client: &Session) -> Hop {
    let publisher = hub.publish(gateway::AIR).unwrap();
    let mut subscriber = client.follow(gateway::AIR).unwrap();
    let (sender, received) = mpsc::channel(16);
    tokio::spawn(async move {
        while let Some(value) = subscriber.changed().await {
            let _ = sender.try_send(value.at);
        }
    });
    let air = Air {
        airspeed_mps: 22.5,
        wind_east_mps: 1.25,
        wind_north_mps: -3.5,
        pressure_hpa: 985.2,
        temperature_c: 11.5,
    };
    let mut time_s = 0.0;
    let send = Box::new(move || {
        time_s += 0.1;
        publisher.set(time_s, 1.0, &air);
    });
    Hop { send, received }.ready().await
}

async fn event_hop(hub: &Session, client: &Session) -> Hop {
    let emitter = hub.emitter(gateway::EVENTS).unwrap();
    let mut events = client.listen(gateway::EVENTS, Start::Now).unwrap();
    let (sender, received) = mpsc::channel(16);
    tokio::spawn(async move {
        while let Some(Occurrence::Event { .. }) = events.recv().await {
            let _ = sender.try_send(Instant::now());
        }
    });
    let event: TimedGatewayEvent = Stamped {
        time_s: 1.5,
        validity_s: 1.0,
        value: GatewayEvent::BufferLow { waypoints: 2, seconds: 7.5 },
    };
    Hop { send: Box::new(move || emitter.emit(&event)), received }.ready().await
}

async fn call_round_trip(hub: &Session, client: &Session) {
    let mut server = hub.serve(gateway::REQUEST).unwrap();
    tokio::spawn(async move {
        while let Some(incoming) = server.recv().await {
            incoming.answer(Ok(usal::contract::Empty {}));
        }
    });
    let mut times = Vec::new();
    for sample in 0..WARM_UP + SAMPLES {
        let started = Instant::now();
        client.call(gateway::REQUEST, &GatewayRequest::Hold, Duration::from_secs(5)).await.unwrap();
        if sample >= WARM_UP {
            times.push(started.elapsed());
        }
    }
    report("usal invocation, there and back", &mut times, None);
}

fn report(name: &str, times: &mut [Duration], bare_us: Option<f64>) -> f64 {
    times.sort_unstable();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e6;
    let p50 = at(0.5);
    let ratio = bare_us.map_or(String::new(), |bare| format!("  p50 {:.2} x bare", p50 / bare));
    println!("{name:34} p50 {p50:7.1} us  p95 {:7.1} us  p99 {:7.1} us{ratio}", at(0.95), at(0.99));
    p50
}
