//! A flood of telemetry: 30,000 messages a second for ten seconds over UDP, one a datagram and then ten a datagram, into a whole
//! gateway. Prints how many came (goal: all) and how long an operator's commands took meanwhile (goal: below 100 ms).
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a bench ends where it can't go on")]

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::*;
use onboard_agent::{gateway, shutdown};
use std::net::{TcpListener, UdpSocket};
use std::time::{Duration, Instant};
use usal::contract::{GatewayRequest, LatLon, SafeRunway};
use usal::{Config, Session, VariableSubscriber, topics};

/// Messages of a millisecond.
const A_MS: usize = 30;
const SECONDS: u64 = 10;
/// A command is given this often.
const COMMANDS: Duration = Duration::from_millis(100);
const PATIENCE: Duration = Duration::from_secs(10);

fn main() {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    for batch in [1, 10] {
        runtime.block_on(flood(batch));
    }
}

async fn flood(batch: usize) {
    let (trigger, shutdown) = shutdown();
    let endpoint = format!("tcp/{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap());
    let link = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let autopilot = format!("udp:{link}").parse().unwrap();
    let gateway = tokio::spawn(gateway::run(gateway::Config::new("bench", &endpoint, autopilot), shutdown));
    let session = Session::open(Config::client("bench", &endpoint).named("operator")).await.unwrap();
    let mut links = session.follow(topics::gateway::LINKS).unwrap();
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(&link).unwrap();
    let mut sequence = 0;
    let before = settled(&mut links, &socket, &mut sequence).await;
    let sender = std::thread::spawn(move || (send(&socket, batch, &mut sequence), socket, sequence));
    let mut times = command_while(&session, || !sender.is_finished()).await;
    let (sent, socket, mut sequence) = sender.join().unwrap();
    let after = settled(&mut links, &socket, &mut sequence).await;
    // the heartbeats of the settling are counted as well
    let (came, lost) = (after.0 - before.0, after.1 - before.1);
    println!(
        "{batch:2} a datagram: {sent} messages in {SECONDS} s, {came} came with those around them, {lost} were lost"
    );
    report(&mut times);
    // asked once, it would stay for an aircraft that is no longer heard
    trigger.insist();
    let _ = gateway.await;
}

/// Messages that came and that were lost, once nothing more is under way.
async fn settled(
    links: &mut VariableSubscriber<usal::contract::AutopilotLinks>,
    socket: &UdpSocket,
    sequence: &mut u8,
) -> (u64, u64) {
    let mut last = None;
    loop {
        socket.send(&frame(sequence, &heartbeat())).unwrap();
        let said =
            tokio::time::timeout(PATIENCE, links.changed()).await.expect("the links are told of").unwrap();
        let Some(link) = said.stamped.value.links.first() else { continue };
        // a heartbeat for each time that it is said
        let now = (link.received, link.lost);
        let is_quiet = last.is_some_and(|(received, _)| now.0 > 0 && now.0 <= received + 5);
        if is_quiet {
            return now;
        }
        last = Some(now);
    }
}

/// The flood; how many messages it had.
fn send(socket: &UdpSocket, batch: usize, sequence: &mut u8) -> usize {
    let (begun, mut sent) = (Instant::now(), 0);
    for ms in 0..SECONDS * 1000 {
        for _ in 0..A_MS / batch {
            let datagram: Vec<u8> = (0..batch).flat_map(|_| frame(sequence, &place(sent as u32))).collect();
            // a full buffer of this side is not the gateway's loss
            while socket.send(&datagram).is_err() {
                std::thread::yield_now();
            }
            sent += batch;
        }
        if ms % 500 == 0 {
            socket.send(&frame(sequence, &heartbeat())).unwrap();
            sent += 1;
        }
        let due = begun + Duration::from_millis(ms + 1);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    sent
}

/// How long each command took while it goes on.
async fn command_while(session: &Session, goes_on: impl Fn() -> bool) -> Vec<Duration> {
    let mut times = vec![];
    while goes_on() {
        let request = GatewayRequest::SetRunways { runways: vec![runway()] };
        let asked = Instant::now();
        session.call(topics::gateway::REQUEST, &request, PATIENCE).await.unwrap();
        times.push(asked.elapsed());
        tokio::time::sleep(COMMANDS).await;
    }
    times
}

fn report(times: &mut [Duration]) {
    times.sort_unstable();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e3;
    let (count, most) = (times.len(), at(1.0));
    println!(
        "   {count} commands meanwhile: p50 {:.1} ms  p95 {:.1} ms  at most {most:.1} ms",
        at(0.5),
        at(0.95)
    );
}

fn runway() -> SafeRunway {
    SafeRunway {
        id: "R05".into(),
        threshold: LatLon::new(36.319, -84.173),
        elevation_amsl_m: 349.0,
        heading_deg: 52.0,
        length_m: 600.0,
        priority: 1,
    }
}

fn heartbeat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_FIXED_WING,
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        ..HEARTBEAT_DATA::default()
    })
}

fn place(time_boot_ms: u32) -> MavMessage {
    MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
        time_boot_ms,
        lat: 363_190_000,
        lon: -841_730_000,
        alt: 450_000,
        relative_alt: 100_000,
        vx: 2200,
        ..GLOBAL_POSITION_INT_DATA::default()
    })
}

fn frame(sequence: &mut u8, message: &MavMessage) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(280);
    let header = MavHeader { system_id: 1, component_id: 1, sequence: *sequence };
    *sequence = sequence.wrapping_add(1);
    mavlink::write_v2_msg(&mut bytes, header, message).unwrap();
    bytes
}
