//! What comes over the network, on its way into the recording.

use super::writer::Inlet;
use recording::Payload;
use schemars::{JsonSchema, schema_for};
use service::{Audit, Beginning, LogLine};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;
use usal::contract::{ClockTick, Stamped};
use usal::topics::GATEWAY;
use usal::{Everything, Format, Key, Kind, Raw, Start};

/// Streams of events that are counted; no vehicle has so many.
const STREAMS_MAX: usize = 256;

/// How far the recording is, for others in this process; cheap to clone.
#[derive(Clone, Default)]
pub struct Monitor(Arc<State>);

#[derive(Default)]
struct State {
    inlet: OnceLock<Inlet>,
    /// Events of each stream, by key.
    events: Mutex<HashMap<String, u64>>,
}

impl Monitor {
    /// Where to put what is to be recorded besides; `None` before the recording begins.
    pub fn inlet(&self) -> Option<Inlet> {
        self.0.inlet.get().cloned()
    }

    /// Events of a stream that are in the recording or on their way into it.
    pub fn events(&self, key: &str) -> u64 {
        self.0.events.lock().unwrap_or_else(PoisonError::into_inner).get(key).copied().unwrap_or_default()
    }

    pub(super) fn begin(&self, inlet: Inlet) {
        // a second recording of the same process is nobody's but its own
        let _ = self.0.inlet.set(inlet);
    }

    fn event(&self, key: &str) {
        let mut events = self.0.events.lock().unwrap_or_else(PoisonError::into_inner);
        let has_room = events.len() < STREAMS_MAX;
        match events.get_mut(key) {
            Some(count) => *count += 1,
            None if has_room => drop(events.insert(key.to_owned(), 1)),
            None => {}
        }
    }
}

/// Follows everything of the vehicle, with the events that its services still remember.
///
/// # Errors
/// The session is closed.
pub fn everything(beginning: &Beginning, inlet: Inlet, monitor: &Monitor) -> anyhow::Result<Everything> {
    let monitor = monitor.clone();
    Ok(beginning.follow_everything(Start::Remembered, move |raw| take(raw, &inlet, &monitor))?)
}

/// From the network's thread into the queue.
fn take(raw: Raw, inlet: &Inlet, monitor: &Monitor) {
    let (key, format, payload) = match raw {
        Raw::Gap { missed } => return inlet.missed(missed),
        Raw::Sample { key, format, payload } => (key, format, payload),
    };
    if key.kind == Kind::Variable && key.service == GATEWAY && key.name == "clock" {
        tick(&payload, format, inlet);
    }
    let name = key.to_string();
    if key.kind == Kind::Event {
        monitor.event(&name);
    }
    inlet.say(
        name,
        match format {
            Format::Cbor => Payload::Cbor(payload),
            Format::Json => Payload::Json(payload),
        },
    );
}

fn tick(payload: &[u8], format: Format, inlet: &Inlet) {
    let tick: Option<ClockTick> = match format {
        Format::Cbor => ciborium::from_reader(payload).ok(),
        Format::Json => serde_json::from_slice(payload).ok(),
    };
    if let Some(time) = tick.and_then(|tick| Duration::try_from_secs_f64(tick.time_s).ok()) {
        inlet.simulated_time(time);
    }
}

/// The key of the plan's document: that of the invocation which gives it.
pub fn document_key(vehicle: &str, service: &str, name: &str) -> Option<String> {
    Key::new(vehicle, service, Kind::Invocation, name).ok().map(|key| key.to_string())
}

/// JSON Schema of the events `audit` of every service.
pub fn audit_schema() -> serde_json::Value {
    schema::<Stamped<Audit>>()
}

/// JSON Schema of the events `log` of every service.
pub fn log_schema() -> serde_json::Value {
    schema::<Stamped<LogLine>>()
}

fn schema<T: JsonSchema>() -> serde_json::Value {
    schema_for!(T).to_value()
}
