//! Keeps what happens in a flight: for the report, and as a log of JSON lines.

use crate::report::TrackPoint;
use anyhow::Context;
use flight_exec::Event;
use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use usal::contract::{FpManagerEvent, GatewayEvent, GatewayState, Stamped};
use wire::Convert;

/// Everything that was heard.
pub struct Recorder {
    /// Where the aircraft really was.
    pub points: Vec<TrackPoint>,
    /// What the executor told, with its time, seconds.
    pub events: Vec<(f64, Event)>,
    /// The gateway's states, in order.
    pub states: Vec<GatewayState>,
    /// Refused waypoints and patterns, and lost events.
    pub refusals: Vec<String>,
    log: Option<BufWriter<File>>,
}

impl Recorder {
    /// A recorder whose log is `path`.
    ///
    /// # Errors
    /// The file can't be made.
    pub fn new(path: &Path) -> anyhow::Result<Self> {
        let file = File::create(path).with_context(|| {
            format!("can't write {}: choose another folder with --report", path.display())
        })?;
        Ok(Self {
            points: Vec::new(),
            events: Vec::new(),
            states: Vec::new(),
            refusals: Vec::new(),
            log: Some(BufWriter::new(file)),
        })
    }

    /// A value of a variable or an event, as it came in.
    pub fn log<T: Serialize>(&mut self, topic: &str, stamped: &Stamped<T>) {
        let Some(log) = &mut self.log else { return };
        let line = serde_json::json!({"time_s": stamped.time_s, "topic": topic, "value": stamped.value});
        if let Err(error) = writeln!(log, "{line}") {
            tracing::warn!(%error, "the log can't be written any more, the flight goes on");
            self.log = None;
        }
    }

    /// The executor told something: what it was.
    pub fn plan_event(&mut self, stamped: FpManagerEvent) -> &Event {
        self.log("fp-manager/events", &stamped);
        let event: Event = stamped.value.convert();
        match &event {
            Event::WaypointsRejected { reason, .. } | Event::PatternRefused { reason, .. } => {
                self.refusals.push(reason.clone());
            }
            _ => {}
        }
        &self.events.push_mut((stamped.time_s, event)).1
    }

    /// The gateway told something.
    pub fn gateway_event(&mut self, stamped: &Stamped<GatewayEvent>) {
        self.log("gateway/events", stamped);
        if let GatewayEvent::StateChanged { to, .. } = &stamped.value {
            self.states.push(*to);
        }
    }

    /// Writes out what is still in memory.
    pub fn flush(&mut self) {
        if let Some(Err(error)) = self.log.as_mut().map(Write::flush) {
            tracing::warn!(%error, "the end of the log could not be written");
        }
    }
}
