//! What can't be written is a failure of the command, and leaves nothing behind that looks like a result.
#![cfg(test)]
#![cfg(target_os = "linux")]

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn plan() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/plans/square.xml")
}

fn full_disk() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

/// `legwork WORDS`, with `PLAN` for a plan and `OUT` for a folder.
fn legwork(words: &str, folder: &Path, stdout: Stdio) -> Output {
    let word = |word: &str| match word {
        "PLAN" => plan().into_os_string(),
        _ => word.replace("OUT", &folder.display().to_string()).into(),
    };
    Command::new(env!("CARGO_BIN_EXE_legwork"))
        .args(words.split(' ').map(word))
        .stdout(stdout)
        .stderr(Stdio::piped())
        .output()
        .unwrap()
}

/// A recording without a message is listed, too.
fn empty_recording(folder: &Path) {
    std::fs::write(folder.join("flight.mcap"), b"no recording").unwrap();
}

#[test]
fn full_disk_behind_standard_output_is_exit_status_2() {
    let folder = tempfile::tempdir().unwrap();
    empty_recording(folder.path());
    for words in [
        "check --quick PLAN",
        "check --quick --json PLAN",
        "expand --anyway PLAN",
        "expand --anyway --json PLAN",
        "convert PLAN - --to xml",
        "convert --anyway PLAN - --to gpx",
        "preview --anyway PLAN --out OUT/preview",
        "preview --anyway PLAN --json --diagram OUT/diagram.png",
        "diff PLAN PLAN",
        "diff --json PLAN PLAN",
        "log OUT/flight.mcap",
        "log --json OUT/flight.mcap",
        "--help",
        "--version",
        "help check",
        "check --help",
    ] {
        let run = legwork(words, folder.path(), full_disk());
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{words}: {said}");
        assert!(said.contains("standard output can't be written"), "{words}: {said}");
    }
}

#[test]
fn reader_that_has_gone_away_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    for words in ["check --quick PLAN", "convert PLAN - --to xml", "--help"] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let run = legwork(words, folder.path(), writer.into());
        assert_eq!(run.status.code(), Some(0), "{words}: {}", String::from_utf8_lossy(&run.stderr));
    }
}

#[test]
fn preview_that_can_not_be_written_whole_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("preview");
    std::fs::create_dir_all(out.join("report.html")).unwrap();
    let run = legwork("preview --anyway --force PLAN --out OUT/preview", folder.path(), Stdio::piped());
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(run.status.code() == Some(2) && said.contains("report.html"), "{said}");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1, "something is left");
}
