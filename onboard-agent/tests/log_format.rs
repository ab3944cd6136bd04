//! What the programs log as JSON is JSON for whatever collects it, line by line.
#![cfg(test)]
#![cfg(unix)]

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};

/// The agent, with all of its services; ended when dropped.
struct Agent(Child);

impl Agent {
    /// Nobody is at the other end of its link.
    fn start(state: &std::path::Path) -> Self {
        let hub = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let child = Command::new(env!("CARGO_BIN_EXE_onboard-agent"))
            .args(["run", "--vehicle", "test", "--autopilot", "tcp:127.0.0.1:9", "--log-format", "json"])
            .args(["--listen", &format!("tcp/{hub}"), "--state-dir"])
            .arg(state)
            .env_remove("RUST_LOG")
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn();
        Self(child.unwrap())
    }

    /// On the ground it ends when it is asked to.
    fn ask_to_end(&self) {
        let asked = Command::new("kill").args(["-TERM", &self.0.id().to_string()]).status();
        assert!(asked.unwrap().success());
    }
}

impl Drop for Agent {
    fn drop(&mut self) {
        // it may have ended
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// What the gateway says of a link that nobody answers.
const NO_LINK: &str = "no connection to the autopilot";
/// Nobody waits for more lines than this.
const ENOUGH: usize = 100;

#[test]
fn every_line_of_the_log_is_an_object_with_time_level_message_and_fields() {
    let state = tempfile::tempdir().unwrap();
    let mut agent = Agent::start(state.path());
    let log = BufReader::new(agent.0.stderr.take().unwrap());
    let (mut lines, mut is_asked): (Vec<Value>, bool) = (Vec::new(), false);
    for line in log.lines() {
        let line = line.unwrap();
        lines.push(serde_json::from_str(&line).unwrap_or_else(|why| panic!("{why}: {line}")));
        // the supervisor and a service, which is a process of its own, have spoken
        if !is_asked && (has_said_enough(&lines) || lines.len() == ENOUGH) {
            agent.ask_to_end();
            is_asked = true;
        }
    }
    assert!(agent.0.wait().unwrap().success());
    for line in &lines {
        let text = |key: &str| line[key].as_str().unwrap_or_else(|| panic!("no {key}: {line}"));
        assert!(is_utc(text("timestamp")), "{line}");
        assert!(["ERROR", "WARN", "INFO"].contains(&text("level")), "{line}");
        assert!(!text("message").is_empty() && !text("target").is_empty(), "{line}");
    }
    assert!(has_said_enough(&lines), "{lines:?}");
    assert!(of(&lines, " started").all(|line| line["pid"].is_u64()), "a number is a number");
    assert!(of(&lines, NO_LINK).all(|line| line["to"] == "127.0.0.1:9" && line["level"] == "WARN"));
}

/// All three services have started, and one has said something itself.
fn has_said_enough(lines: &[Value]) -> bool {
    of(lines, " started").count() == 3 && of(lines, NO_LINK).next().is_some()
}

/// The lines with these words in their message.
fn of<'a>(lines: &'a [Value], words: &'static str) -> impl Iterator<Item = &'a Value> {
    lines.iter().filter(move |line| line["message"].as_str().is_some_and(|message| message.contains(words)))
}

/// `2026-11-28T17:35:31.123456Z`.
fn is_utc(time: &str) -> bool {
    let shape: String = time.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect();
    shape.starts_with("0000-00-00T00:00:00.0") && shape.ends_with("0Z")
}
