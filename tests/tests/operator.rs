//! What an operator does with the real agent: checks its configuration, asks the doctor, runs it under systemd, ends it in flight.
#![cfg(test)]

use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;
use system_tests::binaries::{Program, path};
use system_tests::logs::Logs;
use system_tests::rig::FIELD;
use usal::contract::{Command as PlanCommand, GatewayState, Propose};
use usal::topics::{fp_manager, gateway};
use usal::{Config, Session};

const PATIENCE: Duration = Duration::from_secs(120);

fn agent(arguments: &[&str]) -> Output {
    Command::new(path("onboard-agent").unwrap()).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn asset(name: &str) -> String {
    format!("{}/../assets/onboard-agent/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn simulator(logs: &Logs, arguments: &[&str]) -> (Program, String) {
    let arguments = [&["--tcp", "127.0.0.1:0"], arguments].concat();
    let simulator = Program::start("legwork-sim", &arguments, logs, "simulator").unwrap();
    let autopilot = format!("tcp:{}", simulator.wait_for("listening on tcp ").unwrap());
    (simulator, autopilot)
}

#[test]
fn check_config_says_all_that_is_wrong_and_nothing_of_the_example() {
    let good = agent(&["check-config", &asset("agent.toml")]);
    assert!(good.status.success(), "{}", text(&good.stderr));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("agent.toml");
    std::fs::write(&file, "vehikle = 'v'\nlisten = 7447\n").unwrap();
    let bad = agent(&["check-config", &file.display().to_string()]);
    let told = text(&bad.stderr);
    assert_eq!(bad.status.code(), Some(2));
    assert!(
        told.contains("agent.toml:1:1: ") && told.contains("`vehicle`") && told.contains("agent.toml:2:10: "),
        "{told}"
    );
}

#[test]
fn the_doctor_says_what_is_ready_and_what_to_change() {
    for (arguments, ready, told) in [
        (&["--personality", "arduplane"][..], true, "ok     autopilot: ArduPlane"),
        (
            &["--personality", "px4"],
            false,
            "to do  parameters: The autopilot's parameter MIS_TKO_LAND_REQ is 2",
        ),
        (
            &["--personality", "px4", "--param", "MIS_TKO_LAND_REQ=0"],
            true,
            "ok     parameters: MIS_TKO_LAND_REQ is 0",
        ),
    ] {
        let logs = Logs::new().unwrap();
        let (_simulator, autopilot) = simulator(&logs, &[arguments, &["--speed", "8"]].concat());
        // its position is found first
        let links: &[&str] = if ready {
            &["--autopilot", &autopilot]
        } else {
            &["--autopilot", &autopilot, "--autopilot", &autopilot]
        };
        let mut said = agent(&[&["doctor"], links].concat());
        if text(&said.stdout).contains("to do  gps") {
            said = agent(&[&["doctor"], links].concat());
        }
        let lines = text(&said.stdout);
        assert!(lines.contains(told), "{arguments:?}: {lines}{}", text(&said.stderr));
        assert_eq!(said.status.code(), Some(if ready { 0 } else { 1 }), "{arguments:?}: {lines}");
        assert_eq!(lines.contains("is ready to fly a plan."), ready, "{lines}");
        assert_eq!(lines.matches(&format!("By {autopilot}:")).count(), if ready { 0 } else { 2 }, "{lines}");
    }
}

#[test]
fn the_doctor_says_so_when_nobody_answers() {
    let silent = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let autopilot = format!("udpout:{}", silent.local_addr().unwrap());
    let said = agent(&["doctor", "--autopilot", &autopilot]);
    assert_eq!(said.status.code(), Some(1));
    assert!(text(&said.stderr).contains("nobody answers"), "{}", text(&said.stderr));
}

#[test]
fn systemd_takes_the_unit() {
    if Command::new("systemd-analyze").arg("--version").output().is_err() {
        eprintln!("NOT TESTED: there is no systemd-analyze");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let unit = folder.path().join("legwork-onboard-agent.service");
    let program = path("onboard-agent").unwrap().display().to_string();
    let as_installed = std::fs::read_to_string(asset("legwork-onboard-agent.service")).unwrap();
    std::fs::write(&unit, as_installed.replace("/usr/bin/onboard-agent", &program)).unwrap();
    let verified = Command::new("systemd-analyze").arg("verify").arg(&unit).output().unwrap();
    assert!(verified.status.success() && verified.stderr.is_empty(), "{}", text(&verified.stderr));
}

#[tokio::test(flavor = "multi_thread")]
async fn asked_to_end_in_flight_the_agent_stays_until_it_is_asked_again() {
    let (logs, state) = (Logs::new().unwrap(), tempfile::tempdir().unwrap());
    let home = format!(
        "{},{},{},{}",
        FIELD.threshold.lat_deg, FIELD.threshold.lon_deg, FIELD.elevation_m, FIELD.heading_deg
    );
    let (_simulator, autopilot) = simulator(&logs, &["--speed", "5", "--home", &home]);
    let address = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let listen = format!("tcp/{address}");
    let mut aboard = start(&logs, &autopilot, &listen, state.path());
    let session = Session::open(Config::client("test", &listen).named("operator")).await.unwrap();
    take_off(&session).await;

    aboard.ask_to_end().unwrap();
    let mut log = session.follow(gateway::POSITION).unwrap();
    tokio::time::timeout(PATIENCE, async {
        // it says so in its log, and goes on
        while !logs.ends().contains("stays until the aircraft is on the ground") {
            log.changed().await.unwrap();
        }
    })
    .await
    .expect("it says that it stays");
    log.changed().await.unwrap();
    let first = logs.ends();
    let is_json =
        |line: &str| serde_json::from_str::<serde_json::Value>(line).is_ok_and(|value| value.is_object());
    let of_agent = first.split("--- end of ").find(|part| part.contains("fp-manager")).unwrap_or_default();
    let lines: Vec<&str> = of_agent.lines().skip(2).filter(|line| !line.is_empty()).collect();
    assert!(lines.len() > 3 && lines.iter().all(|line| is_json(line)), "{of_agent}");

    aboard.ask_to_end().unwrap();
    assert!(aboard.ended().unwrap().success());
}

fn start(logs: &Logs, autopilot: &str, listen: &str, state: &Path) -> Program {
    let folder = state.display().to_string();
    let arguments = [
        "run",
        "--vehicle",
        "test",
        "--autopilot",
        autopilot,
        "--listen",
        listen,
        "--state-dir",
        &folder,
        "--log-format",
        "json",
    ];
    Program::start("onboard-agent", &arguments, logs, "agent").unwrap()
}

async fn take_off(session: &Session) {
    let (mut state, mut position) =
        (session.follow(gateway::STATE).unwrap(), session.follow(gateway::POSITION).unwrap());
    let mission = FIELD.mission(1800.0);
    let flies = async {
        while state.latest().is_none_or(|received| received.stamped.value.state != GatewayState::Stop) {
            state.changed().await.unwrap();
        }
        let request = Propose { xml: mission, seen_revision: None };
        let report = session.call(fp_manager::PROPOSE, &request, PATIENCE).await.unwrap();
        let commit = PlanCommand::Commit { hash: report.hash, entry: None };
        session.call(fp_manager::COMMAND, &commit, PATIENCE).await.unwrap();
        session.call(fp_manager::COMMAND, &PlanCommand::Start, PATIENCE).await.unwrap();
        while position.latest().is_none_or(|received| received.stamped.value.on_ground) {
            position.changed().await.unwrap();
        }
    };
    tokio::time::timeout(PATIENCE, flies).await.expect("it takes off");
}
