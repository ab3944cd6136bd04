//! What the journal costs, and what it gives: microseconds for each recorded input (encoding, framing, appending to a file)
//! and for each that is synced; and milliseconds from the start of a process that comes back after a kill to its join
//! with the gateway (goal: below one second), with a full segment to replay; the same with a plan of ten thousand fixes,
//! which a restart compiles again.
#![expect(clippy::unwrap_used, reason = "a bench ends where it can't go on")]

use flight_exec::{AircraftState, Executor, Input};
use onboard_agent::fp_manager::journal::{Entry, Folder, Job, Limits, Log, Record, Writer, encode};
use onboard_agent::fp_manager::{Config, Manager};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command as Process};
use std::time::{Duration, Instant};
use usal::contract::*;
use usal::topics::{GATEWAY, fp_manager, gateway};
use usal::{Server, Session, VariablePublisher};

const PLAN: &str = include_str!("../../assets/plans/square.xml");
/// Inputs before the kill: nearly a segment, the longest replay there is.
const INPUTS: u64 = 1900;
const RESTARTS: usize = 20;
/// Fixes of the large plan (as many legs would be more than the energy lasts for).
const FIXES: usize = 10_000;

fn main() {
    let directory = tempfile::tempdir().unwrap();
    cost(&directory.path().join("cost"));
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    runtime.block_on(recovery("square", PLAN, &directory.path().join("square")));
    runtime.block_on(recovery("large", &large(), &directory.path().join("large")));
}

/// The square with very many fixes that are flown to by nobody.
fn large() -> String {
    let first = r#"<fix id="A""#;
    assert!(PLAN.contains(first));
    let fixes = (0..FIXES).map(|n| format!("<fix id=\"n{n}\" lat=\"36.{n:06}\" lon=\"-84.2\"/>\n"));
    PLAN.replace(first, &fixes.chain([first.to_owned()]).collect::<String>())
}

fn aircraft(n: u64) -> AircraftState {
    AircraftState {
        position: LatLon { lat_deg: 36.3 + n as f64 * 1e-5, lon_deg: -84.17 },
        altitude_amsl_m: 450.0,
        track_deg: 52.0,
        ground_speed_mps: 22.0,
        airspeed_mps: 22.0,
        wind_east_mps: 3.0,
        wind_north_mps: 1.0,
        battery: 0.8,
        fuel: None,
        on_ground: false,
        engine_out: false,
        heading_deg: None,
    }
}

fn turn(n: u64) -> Vec<Entry> {
    let what = Record::Input(Input::Aircraft(aircraft(n)));
    vec![Entry { at: Duration::from_millis(50 * n), what }]
}

fn cost(folder: &Path) {
    for (what, sync, count) in [("appended", false, 20_000), ("synced", true, 300)] {
        let limits = Limits { turns: u32::MAX, bytes: u64::MAX, bytes_max: u64::MAX, plans: 8 };
        let mut writer = Writer::new(Log::open(Folder::new(folder.into()), limits).0, None);
        let config = Config::new("bench", "");
        let executor = Executor::new(config.executor, config.terrain, config.profile);
        let saved = Manager::new(executor, Duration::ZERO).saved().0;
        writer.perform(Duration::ZERO, vec![Job::State(Box::new(saved), Vec::new())]);
        let (start, mut bytes) = (Instant::now(), 0);
        for n in 0..count {
            let payload = encode(&turn(n)).unwrap();
            bytes += payload.len();
            writer.perform(Duration::ZERO, vec![Job::Turn { payload, sync }]);
        }
        let each_us = start.elapsed().as_secs_f64() * 1e6 / count as f64;
        println!("{what}: {each_us:.1} us an input of {} bytes", bytes as u64 / count);
    }
}

/// A gateway that lets the FP Manager join, and nothing else.
struct Hub {
    join: Server<Join, JoinAnswer>,
    state: VariablePublisher<GatewayStatus>,
    position: VariablePublisher<Position>,
    client: Session,
    _announcement: usal::Announcement,
}

impl Hub {
    async fn open(endpoint: &str) -> Self {
        let session = Session::open(usal::Config::hub("bench", endpoint)).await.unwrap();
        Self {
            join: session.serve(gateway::JOIN).unwrap(),
            state: session.publish(gateway::STATE).unwrap(),
            position: session.publish(gateway::POSITION).unwrap(),
            _announcement: session.announce(GATEWAY).unwrap(),
            client: Session::open(usal::Config::client("bench", endpoint).named("bench")).await.unwrap(),
        }
    }

    fn publish(&self, n: u64) {
        let status = GatewayStatus {
            state: GatewayState::Stop,
            cause: "bench".into(),
            armed: false,
            autopilot: None,
            unfit: None,
            autopilot_mode: "AUTO".into(),
            autopilot_age_s: 0.0,
            fp_manager: None,
            fp_manager_age_s: None,
            waits_for_height_m: None,
            circle: None,
            safe_return_in_s: None,
            alarms: Vec::new(),
        };
        self.state.set(n as f64, 60.0, &status);
        let position = Position {
            position: aircraft(n).position,
            altitude_amsl_m: 450.0,
            altitude_home_m: 100.0,
            velocity_north_mps: 22.0,
            velocity_east_mps: 0.0,
            velocity_down_mps: 0.0,
            track_deg: 0.0,
            ground_speed_mps: 22.0,
            on_ground: true,
        };
        self.position.set(n as f64, 60.0, &position);
    }

    async fn joined(&mut self) -> Token {
        let incoming = self.join.recv().await.unwrap();
        let last_token = incoming.request.last_token;
        let highest = last_token;
        let (reason, current, last) = (String::new(), None, None);
        incoming.answer(Ok(JoinAnswer {
            instance: None,
            accepted: true,
            reason,
            waits: false,
            current,
            last,
            highest,
            finished: false,
        }));
        last_token
    }
}

fn start(endpoint: &str, folder: &Path) -> Child {
    let mut process = Process::new(env!("CARGO_BIN_EXE_onboard-agent"));
    process.args(["fp-manager", "--vehicle", "bench", "--connect", endpoint, "--state-dir"]).arg(folder);
    process.env("RUST_LOG", "error").spawn().unwrap()
}

async fn recovery(what: &str, plan: &str, folder: &Path) {
    let endpoint = format!("tcp/{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap());
    let mut hub = Hub::open(&endpoint).await;
    hub.publish(0);
    let mut process = start(&endpoint, folder);
    hub.joined().await;
    let propose = Propose { xml: plan.into(), seen_revision: None };
    let patience = Duration::from_secs(600);
    let report = hub.client.call(fp_manager::PROPOSE, &propose, patience).await.unwrap();
    let commit = Command::Commit { hash: report.hash, entry: None };
    hub.client.call(fp_manager::COMMAND, &commit, patience).await.unwrap();
    // a refused command is an input like any other, and quicker than waiting for the clock
    for _ in 0..INPUTS {
        let _ = hub.client.call(fp_manager::COMMAND, &Command::Resume, patience).await;
    }
    let mut times = Vec::new();
    for restart in 0..RESTARTS {
        process.kill().unwrap();
        process.wait().unwrap();
        hub.publish(restart as u64);
        let started = Instant::now();
        process = start(&endpoint, folder);
        hub.joined().await;
        times.push(started.elapsed().as_secs_f64() * 1e3);
    }
    process.kill().unwrap();
    process.wait().unwrap();
    println!(
        "{what}, {} KiB: first restart (replays {INPUTS} inputs) to join: {:.0} ms",
        plan.len() / 1024,
        times[0]
    );
    times.sort_by(f64::total_cmp);
    println!(
        "{what}: process start to join: p50 {:.0} ms, worst of {RESTARTS} {:.0} ms",
        times[RESTARTS / 2],
        times[RESTARTS - 1]
    );
}
