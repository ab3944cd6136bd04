//! What can't be written to standard output is a failure of the command.
#![cfg(test)]
#![cfg(target_os = "linux")]

use std::fs::File;
use std::process::{Command, Stdio};

#[test]
fn full_disk_behind_standard_output_is_exit_status_2() {
    // the last one says where it listens, and would run on
    for words in ["--help", "--version", "--tcp 127.0.0.1:0"] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let run = Command::new(env!("CARGO_BIN_EXE_legwork-sim"))
            .args(words.split(' '))
            .stdin(Stdio::null())
            .stdout(full)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{words}: {said}");
        assert!(said.contains("standard output can't be written"), "{words}: {said}");
    }
}
