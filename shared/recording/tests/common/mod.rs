//! What the tests of the recorder share: a disk in memory, and frames.
#![allow(dead_code, reason = "each test uses a part of it")]

use recording::{Config, Frame, Input, Output, Payload, Recorder, Report};
use std::time::Duration;

/// 2025-11-23T08:00:00Z.
pub const UNIX: Duration = Duration::from_secs(1_763_884_800);

pub fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// A recorder and the disk in memory that does what it says.
pub struct Rig {
    pub recorder: Recorder,
    pub files: Vec<(String, Vec<u8>)>,
    pub finished: usize,
    pub reports: Vec<Report>,
    /// When bytes were appended to the last file, and how many it has since.
    pub appended: Vec<(Duration, usize)>,
    /// The disk does nothing any more.
    pub broken: bool,
    /// Files of this name are there already.
    pub taken: Vec<String>,
}

impl Rig {
    pub fn new(config: Config) -> Self {
        let mut rig = Self {
            recorder: Recorder::new(config),
            files: Vec::new(),
            finished: 0,
            reports: Vec::new(),
            appended: Vec::new(),
            broken: false,
            taken: Vec::new(),
        };
        rig.step(Duration::ZERO, Input::Clock(UNIX));
        rig
    }

    pub fn step(&mut self, now: Duration, input: Input) {
        let mut out = Vec::new();
        self.recorder.step(now, input, &mut out);
        for output in out {
            match output {
                Output::Tell(report) => self.reports.push(report),
                _ if self.broken => {
                    return self.step(now, Input::Failed { why: "no space left".into(), is_taken: false });
                }
                Output::Begin { name } if self.taken.contains(&name) => {
                    return self.step(now, Input::Failed { why: "it exists".into(), is_taken: true });
                }
                Output::Begin { name } => {
                    assert!(self.files.iter().all(|(known, _)| *known != name), "{name} twice");
                    self.files.push((name, Vec::new()));
                    self.appended.clear();
                }
                Output::Append { bytes } => {
                    let file = &mut self.files.last_mut().expect("a file").1;
                    file.extend(bytes);
                    self.appended.push((now, file.len()));
                }
                Output::Finish => self.finished += 1,
            }
        }
    }

    /// Lets time pass: whatever is due until then is done when it is.
    pub fn until(&mut self, now: Duration) {
        while let Some(deadline) = self.recorder.deadline().filter(|deadline| *deadline <= now) {
            self.step(deadline, Input::Wake);
        }
    }

    pub fn frame(&mut self, now: Duration, frame: Frame) {
        self.until(now);
        self.step(now, Input::Frame(frame));
    }
}

/// A payload as the services send it.
pub fn cbor(value: &serde_json::Value) -> Payload {
    let mut bytes = Vec::new();
    ciborium::into_writer(value, &mut bytes).expect("CBOR");
    Payload::Cbor(bytes)
}

pub fn frame(key: &str, at: Duration, value: &serde_json::Value) -> Frame {
    Frame { key: key.into(), at, payload: cbor(value) }
}

pub fn position(at: Duration) -> Frame {
    let value = serde_json::json!({
        "time_s": at.as_secs_f64(),
        "validity_s": 1.0,
        "value": {
            "position": {"lat_deg": 36.3 + at.as_secs_f64() * 1e-5, "lon_deg": -84.2},
            "altitude_amsl_m": 500.0, "altitude_home_m": 150.0, "velocity_north_mps": 1.0, "velocity_east_mps": 25.0,
            "velocity_down_mps": 0.0, "track_deg": 88.0, "ground_speed_mps": 25.0, "on_ground": false,
        },
    });
    frame("legwork/uav1/gateway/variable/position", at, &value)
}

/// A variable of which every message says its number.
pub fn numbered(vehicle: &str, number: u64, at: Duration) -> Frame {
    let value =
        serde_json::json!({"time_s": at.as_secs_f64(), "validity_s": 1.0, "value": {"number": number}});
    frame(&format!("legwork/{vehicle}/counter/variable/count"), at, &value)
}
