//! The demo from end to end, as its user starts it: exit status and report.
#![cfg(test)]

use std::path::Path;
use std::process::{Command, Output};

/// Runs `legwork demo --headless` on a plan of the assets.
fn demo(plan: &str, report: &Path) -> Output {
    demo_on("arduplane", plan, report)
}

/// The same on an autopilot.
fn demo_on(autopilot: &str, plan: &str, report: &Path) -> Output {
    let plan = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/plans").join(plan);
    Command::new(env!("CARGO_BIN_EXE_legwork"))
        .args(["demo", "--headless", "--autopilot", autopilot, "--plan"])
        .arg(plan)
        .arg("--report")
        .arg(report)
        .env_remove("RUST_LOG")
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_flight_as_planned_succeeds_and_leaves_its_report() {
    let folder = tempfile::tempdir().unwrap();
    let run = demo("square.xml", folder.path());
    let (out, err) = (text(&run.stdout), text(&run.stderr));
    assert_eq!(run.status.code(), Some(0), "{out}\n{err}");
    assert!(out.contains("The mission was flown as planned."), "{out}");
    assert!(!err.contains("zenoh"), "log noise before the user: {err}");
    for file in ["report.html", "report.md", "legs.csv", "events.jsonl"] {
        assert!(std::fs::metadata(folder.path().join(file)).unwrap().len() > 100, "{file}");
    }
    recording_is_whole(&folder.path().join("recordings"));
    for picture in ["map.png", "profile.png"] {
        let bytes = std::fs::read(folder.path().join(picture)).unwrap();
        assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000, "{picture}: {} bytes", bytes.len());
    }
    let legs = std::fs::read_to_string(folder.path().join("legs.csv")).unwrap();
    for leg in ["take-off", "side1", "side2", "side3", "side4", "land"] {
        assert!(legs.lines().any(|line| line.starts_with(leg)), "{leg} is missing:\n{legs}");
    }
    is_as_previewed(&legs);
}

/// All legs together took the previewed time within 3 %, and TF legs, with their corners, are within 5 m of the previewed path.
fn is_as_previewed(legs: &str) {
    let rows: Vec<Vec<&str>> = legs.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|head| *head == name).unwrap();
    let number = |row: &[&str], name: &str| row[column(name)].parse::<f64>().unwrap();
    let sum = |name: &str| rows[1..].iter().map(|row| number(row, name)).sum::<f64>();
    let (flown_s, previewed_s) = (sum("time_s"), sum("planned_time_s"));
    assert!((flown_s / previewed_s - 1.0).abs() < 0.03, "{flown_s} s, previewed {previewed_s} s:\n{legs}");
    for row in rows[1..].iter().filter(|row| row[column("type")] == "TF") {
        assert!(number(row, "cross_track_max_m") < 5.0, "{row:?}");
    }
}

#[test]
fn px4_flies_the_same_plan_as_planned() {
    let folder = tempfile::tempdir().unwrap();
    let run = demo_on("px4", "square.xml", folder.path());
    let (out, err) = (text(&run.stdout), text(&run.stderr));
    assert_eq!(run.status.code(), Some(0), "{out}\n{err}");
    assert!(out.contains("The mission was flown as planned."), "{out}");
}

/// One file, whole for `legwork log --check`, with what the report was made from.
fn recording_is_whole(folder: &Path) {
    let files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    let recordings: Vec<_> = files.iter().filter(|f| f.extension().is_some_and(|e| e == "mcap")).collect();
    let [recording] = recordings[..] else { panic!("{files:?}") };
    let run =
        Command::new(env!("CARGO_BIN_EXE_legwork")).args(["log", "--check"]).arg(recording).output().unwrap();
    let listed = text(&run.stdout);
    assert_eq!(run.status.code(), Some(0), "{listed}\n{}", text(&run.stderr));
    for channel in [
        "simulator/variable/truth",
        "fp-manager/event/events",
        "fp-manager/invocation/plan",
        "gateway/variable/position",
    ] {
        assert!(listed.contains(&format!("legwork/demo/{channel}")), "{channel} is missing:\n{listed}");
    }
}

#[test]
fn each_flight_of_a_plan_has_its_times_its_way_and_its_energy_in_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let run = demo("../docs/fragments/flights.xml", folder.path());
    let (out, err) = (text(&run.stdout), text(&run.stderr));
    assert_eq!(run.status.code(), Some(0), "{out}\n{err}");
    assert!(out.contains("flight 1: begins 0:00") && out.contains("flight 2: begins "), "{out}");
    let flights = std::fs::read_to_string(folder.path().join("flights.csv")).unwrap();
    let rows: Vec<Vec<f64>> = flights
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    let [first, second] = &rows[..] else { panic!("{flights}") };
    assert!(second[1] > first[1] + first[2], "it begins after the first one has ended:\n{flights}");
    for row in &rows {
        assert!(row[2] > 200.0 && row[3] > 5000.0 && row[4] > 1000.0 && row[5] > 0.1, "{flights}");
    }
    let report = std::fs::read_to_string(folder.path().join("report.md")).unwrap();
    assert!(report.contains("## Legs of flight 2") && report.contains("side8"), "{report}");
}

#[test]
fn report_folder_that_cannot_be_made_fails_and_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("taken");
    std::fs::write(&file, "").unwrap();
    let run = demo("square.xml", &file);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("choose another with --report"), "{}", text(&run.stderr));
}

#[test]
fn plan_with_errors_is_not_flown() {
    let folder = tempfile::tempdir().unwrap();
    let report = folder.path().join("report");
    let run = demo("bad/too-steep.xml", &report);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("can't be flown"), "{}", text(&run.stderr));
    assert!(!report.exists(), "a report of a flight that never was");
}
