//! What can't be written to standard output is a failure of the command.
#![cfg(test)]
#![cfg(target_os = "linux")]

use std::ffi::OsString;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};

#[test]
fn full_disk_behind_standard_output_is_exit_status_2() {
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/onboard-agent/agent.toml");
    for words in ["--help", "--version", "help describe", "describe", "check-config CONFIG"] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let word =
            |word: &str| -> OsString { if word == "CONFIG" { config.clone().into() } else { word.into() } };
        let run = Command::new(env!("CARGO_BIN_EXE_onboard-agent"))
            .args(words.split(' ').map(word))
            .stdout(full)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{words}: {said}");
        assert!(said.contains("standard output can't be written"), "{words}: {said}");
    }
}
