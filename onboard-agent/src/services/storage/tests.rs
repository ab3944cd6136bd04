//! The recorder over a real network, and killed for real.

use super::*;
use recording::{Ending, scan};
use service::shutdown;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;
use usal::contract::{GatewayEvent, LatLon, Position, Stamped};
use usal::topics::gateway;
use usal::{Config as SessionConfig, Session};

/// Longer than anything takes on a slow machine.
const DEADLINE: Duration = Duration::from_secs(60);
/// Names the folder that a killed process records into.
const FOLDER: &str = "LEGWORK_TEST_RECORDER";

fn free_endpoint() -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    format!("tcp/{}", listener.local_addr().unwrap())
}

/// Messages of each channel of a recording, and how it ends.
fn counts(path: &Path) -> (BTreeMap<String, u64>, Ending) {
    let contents = scan(std::fs::File::open(path).unwrap(), &mut |_| {}).unwrap();
    (contents.channels.into_values().map(|c| (c.topic, c.messages)).collect(), contents.ending)
}

fn recordings(folder: &Path) -> Vec<PathBuf> {
    disk::stored(folder).unwrap().into_iter().map(|s| folder.join(s.name)).collect()
}

async fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let deadline = Instant::now() + DEADLINE;
    while !holds() {
        assert!(Instant::now() < deadline, "{what}");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

fn position(second: u32) -> Position {
    Position {
        position: LatLon { lat_deg: 36.3 + f64::from(second) * 1e-3, lon_deg: -84.2 },
        altitude_amsl_m: 500.0,
        altitude_home_m: 150.0,
        velocity_north_mps: 0.0,
        velocity_east_mps: 0.0,
        velocity_down_mps: 0.0,
        track_deg: 0.0,
        ground_speed_mps: 0.0,
        on_ground: false,
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn everything_that_is_said_is_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let endpoint = free_endpoint();
    let hub = Session::open(SessionConfig::hub("uav1", &endpoint).named("gateway")).await.unwrap();
    let positions = hub.publish(gateway::POSITION).unwrap();
    let events = hub.emitter(gateway::EVENTS).unwrap();
    let (trigger, end) = shutdown();
    let monitor = Monitor::default();
    let config = Config::new("uav1", &endpoint, folder.path().into());
    let running = tokio::spawn(run(config, monitor.clone(), end));
    until("it has begun", || monitor.inlet().is_some()).await;
    let key = "legwork/uav1/gateway/event/events";
    let emit = |n: u32| {
        let value = GatewayEvent::AlarmCleared { id: n.to_string() };
        events.emit(&Stamped { time_s: f64::from(n), validity_s: 1.0, value });
    };
    // the first one by itself: in a burst, one could take the place of those before it while these are still asked for
    emit(0);
    until("the first event comes in", || monitor.events(key) == 1).await;
    (1..100).for_each(emit);
    let mut second = 0;
    until("positions and events come in", || {
        second += 1;
        positions.set(f64::from(second), 1.0, &position(second));
        monitor.events(key) == 100
            && monitor.inlet().is_some_and(|inlet| inlet.progress().status.messages > 120)
    })
    .await;
    trigger.shut_down();
    running.await.unwrap().unwrap();
    let (counts, ending) = counts(&recordings(folder.path())[0]);
    assert_eq!(ending, Ending::Finished);
    assert_eq!(counts[key], 100, "no event is lost");
    assert!(
        counts["foxglove/uav1/location"] > 0 && counts["legwork/uav1/gateway/variable/position"] > 0,
        "{counts:?}"
    );
}

#[test]
fn torn_recordings_are_mended_at_the_next_start() {
    let folder = tempfile::tempdir().unwrap();
    let writer = |folder: &Path| {
        let limits = Limits { quota_bytes: 1 << 30, reserve_bytes: 0 };
        Writer::start(folder, recording::Config::new("uav1"), limits, Vec::new(), false).unwrap()
    };
    let first = writer(folder.path());
    first.inlet().say("legwork/uav1/a/variable/b".into(), Payload::Json(b"1".to_vec()));
    let path = first.close().files.remove(0);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 9]).unwrap();
    let second = writer(folder.path());
    mend::begin(folder.path(), second.inlet());
    let deadline = Instant::now() + DEADLINE;
    while counts(&path).1 != Ending::Finished {
        assert!(Instant::now() < deadline, "it is mended");
        std::thread::yield_now();
    }
    assert_eq!(counts(&path).0["legwork/uav1/a/variable/b"], 1);
}

/// Not a test: what the next one kills. Says a number every millisecond, and tells which was said.
#[test]
fn says_numbers_where_it_is_told_to() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let limits = Limits { quota_bytes: 1 << 30, reserve_bytes: 0 };
    let writer =
        Writer::start(Path::new(&folder), recording::Config::new("uav1"), limits, Vec::new(), false).unwrap();
    let (inlet, began) = (writer.inlet(), Instant::now());
    for number in 0u64.. {
        let at = began.elapsed().as_millis();
        let text = format!("{{\"number\":{number},\"at_ms\":{at}}}");
        inlet.say("legwork/uav1/counter/variable/count".into(), Payload::Json(text.into()));
        println!("said at {at} ms");
        std::thread::park_timeout(Duration::from_millis(1));
    }
}

/// SIGKILL, at times that differ. How much is lost depends on the machine's load, too: the best of them shows the promise. More of them: `LEGWORK_KILLS=200`.
#[test]
fn killed_processes_leave_readable_files() {
    let kills: usize = std::env::var("LEGWORK_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(5);
    let mut lost_ms = Vec::new();
    // 113 is prime: the kills come at all ages of a chunk
    for lines in (0..kills).map(|kill| 20 + 113 * kill % 500) {
        let folder = tempfile::tempdir().unwrap();
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "services::storage::tests::says_numbers_where_it_is_told_to", "--nocapture"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let said = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let mut times =
            said.filter_map(|line| line.strip_suffix(" ms")?.split(' ').next_back()?.parse::<u64>().ok());
        let last_read = times.by_ref().nth(lines).unwrap();
        child.kill().unwrap();
        child.wait().unwrap();
        let last_said = times.last().unwrap_or(last_read);
        let mut recorded = Vec::new();
        for path in recordings(folder.path()) {
            let file = std::fs::File::open(path).unwrap();
            // killed before the first chunk was due: nothing was written yet
            let is_empty = file.metadata().unwrap().len() == 0;
            let contents = scan(file, &mut |m| {
                let value: serde_json::Value = serde_json::from_slice(m.data).unwrap();
                recorded.push((value["number"].as_u64().unwrap(), value["at_ms"].as_u64().unwrap()));
            });
            assert!(is_empty || matches!(contents.unwrap().ending, Ending::Torn { .. }));
        }
        assert!(recorded.iter().zip(0..).all(|((number, _), index)| *number == index), "no gap");
        lost_ms.push(last_said - recorded.last().map_or(0, |(_, at)| *at));
    }
    assert!(lost_ms.iter().min().is_some_and(|least| *least <= 100), "{lost_ms:?}");
    assert!(lost_ms.iter().all(|lost| *lost <= 5000), "{lost_ms:?}");
    let late = lost_ms.iter().filter(|lost| **lost > 100).count();
    println!("{late} of {kills} kills lost more than 100 ms, {:?} at most", lost_ms.iter().max());
}
