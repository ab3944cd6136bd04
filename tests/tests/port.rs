//! The port that everybody reaches, with the real programs: who floods it locks nobody out.
#![cfg(test)]

use std::net::TcpStream;
use std::process::Command;
use std::time::{Duration, Instant};
use system_tests::binaries::Program;
use system_tests::logs::Logs;
use usal::contract::{Empty, GatewayStatus};
use usal::topics::{self, gateway};
use usal::{Config, Presence, Session, VariableSubscriber};

/// Connections that say nothing, all from one address.
const IDLE: usize = 300;
/// A new ground station is served within this time.
const SERVED: Duration = Duration::from_secs(2);
/// Anything else that has to happen.
const PATIENCE: Duration = Duration::from_secs(60);

struct Aboard {
    agent: Program,
    address: String,
    _simulator: Program,
    _state: tempfile::TempDir,
    _logs: Logs,
}

fn aboard() -> anyhow::Result<Aboard> {
    let (logs, state) = (Logs::new()?, tempfile::tempdir()?);
    let simulator = Program::start("legwork-sim", &["--tcp", "127.0.0.1:0"], &logs, "simulator")?;
    let autopilot = format!("tcp:{}", simulator.wait_for("listening on tcp ")?);
    let address = std::net::TcpListener::bind("127.0.0.1:0")?.local_addr()?.to_string();
    let (listen, folder) = (format!("tcp/{address}"), state.path().display().to_string());
    let arguments =
        ["run", "--vehicle", "test", "--autopilot", &autopilot, "--listen", &listen, "--state-dir", &folder];
    let agent = Program::start("onboard-agent", &arguments, &logs, "agent")?;
    Ok(Aboard { agent, address, _simulator: simulator, _state: state, _logs: logs })
}

impl Drop for Aboard {
    fn drop(&mut self) {
        // its children end with it
        let ended = self.agent.ask_to_end().and_then(|()| self.agent.ended());
        assert!(ended.is_ok() || std::thread::panicking(), "{ended:?}");
    }
}

async fn ground_station(address: &str) -> Session {
    let config = Config::client("test", &format!("tcp/{address}")).named("operator");
    Session::open(config).await.unwrap()
}

async fn in_time(what: &str, happens: impl Future<Output = ()>) {
    tokio::time::timeout(PATIENCE, happens).await.unwrap_or_else(|_| panic!("never: {what}"));
}

async fn is_there(presence: &mut Presence, there: bool) {
    while presence.is_alive(topics::FP_MANAGER) != there {
        presence.changed().await.unwrap();
    }
}

async fn is_flooded(state: &mut VariableSubscriber<GatewayStatus>, flooded: bool) {
    let told = |status: &GatewayStatus| status.alarms.iter().any(|alarm| alarm.id == "port-flooded");
    while state.latest().is_none_or(|received| told(&received.stamped.value) != flooded) {
        state.changed().await.unwrap();
    }
}

/// SIGKILL for the FP Manager among the agent's children.
fn kill_fp_manager(agent: &Program) {
    let threads = std::fs::read_dir(format!("/proc/{}/task", agent.id())).unwrap().flatten();
    let children = threads.filter_map(|thread| std::fs::read_to_string(thread.path().join("children")).ok());
    let children: Vec<String> =
        children.flat_map(|ids| ids.split_whitespace().map(str::to_owned).collect::<Vec<_>>()).collect();
    let is_fp_manager = |id: &&String| {
        let line = std::fs::read_to_string(format!("/proc/{id}/cmdline")).unwrap_or_default();
        line.split('\0').nth(1) == Some(topics::FP_MANAGER)
    };
    let fp_manager = children.iter().find(is_fp_manager).expect("there is an FP Manager");
    assert!(Command::new("kill").args(["-KILL", fp_manager]).status().unwrap().success());
}

#[tokio::test(flavor = "multi_thread")]
async fn idle_connections_lock_out_neither_a_ground_station_nor_a_restarted_service() {
    let aboard = aboard().unwrap();
    let first = ground_station(&aboard.address).await;
    let (mut presence, mut state) = (first.presence().unwrap(), first.follow(gateway::STATE).unwrap());
    in_time("the FP Manager is there", is_there(&mut presence, true)).await;
    let idle: Vec<_> = (0..IDLE).map(|_| TcpStream::connect(&aboard.address).unwrap()).collect();
    in_time("the alarm", is_flooded(&mut state, true)).await;

    let began = Instant::now();
    let second = ground_station(&aboard.address).await;
    let described = second.call(topics::describe(topics::GATEWAY), &Empty {}, PATIENCE).await.unwrap();
    assert_eq!(described.service, topics::GATEWAY);
    assert!(began.elapsed() < SERVED, "{:?}", began.elapsed());

    kill_fp_manager(&aboard.agent);
    in_time("the FP Manager is gone", is_there(&mut presence, false)).await;
    let more: Vec<_> = (0..IDLE).map(|_| TcpStream::connect(&aboard.address).unwrap()).collect();
    in_time("the FP Manager is back", is_there(&mut presence, true)).await;

    drop((idle, more));
    in_time("the end of the alarm", is_flooded(&mut state, false)).await;
}
