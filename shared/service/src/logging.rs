//! The log: on standard error for people, and as events of the service for who records them.

use crate::clock::Reader;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{EnvFilter, Layer};
use usal::contract::Stamped;
use usal::topics::Events;
use usal::{EventPublisher, Session, SessionError};

/// Lines that may wait for being published.
const QUEUE: usize = 1024;
/// After so many lines there is a pause: a flood of them is dropped here and doesn't take the network from the flight.
const BURST: u32 = 64;
const PAUSE: Duration = Duration::from_millis(50);
/// Longer lines are cut, bytes.
const LINE_MAX: usize = 1024;
/// Whose lines aren't published: they would tell of their own publishing.
const OWN: &[&str] = &["zenoh", "usal"];

/// A line of a service's log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct LogLine {
    /// `ERROR`, `WARN` or `INFO`.
    pub level: String,
    /// Module that wrote it.
    pub target: String,
    /// What it says.
    pub message: String,
    /// Lines so far that were dropped, because there were too many at once.
    pub dropped: u64,
}

/// A service's log.
pub const fn log(service: &'static str) -> Events<Stamped<LogLine>> {
    Events::new(service, "log")
}

/// The lines of this process; its first service publishes them.
static LINES: OnceLock<Mutex<Option<mpsc::Receiver<LogLine>>>> = OnceLock::new();

/// How the log is written to standard error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// For people.
    Text,
    /// A JSON object a line.
    Json,
}

/// Has the process log to standard error and to its first service; `RUST_LOG` says what, else `filter` does.
pub fn init(filter: &str, format: Format) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(filter));
    let (sender, receiver) = mpsc::channel(QUEUE);
    let told = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
    let told = match format {
        Format::Text => told.boxed(),
        Format::Json => told.json().flatten_event(true).boxed(),
    };
    let tap = Tap { sender, dropped: AtomicU64::new(0) };
    let set = tracing_subscriber::registry().with(filter).with(told).with(tap).try_init();
    if set.is_ok() {
        LINES.get_or_init(|| Mutex::new(Some(receiver)));
    }
}

/// Publishes the lines of this process until aborted, unless another service of it does.
pub(crate) fn start(
    session: &Session,
    service: &'static str,
    clock: Reader,
) -> Result<Option<JoinHandle<()>>, SessionError> {
    let lines = LINES.get().and_then(|lines| lines.lock().unwrap_or_else(PoisonError::into_inner).take());
    let Some(lines) = lines else { return Ok(None) };
    let publisher = session.emitter(log(service))?;
    Ok(Some(tokio::spawn(publish(publisher, lines, clock))))
}

async fn publish(
    publisher: EventPublisher<Stamped<LogLine>>,
    mut lines: mpsc::Receiver<LogLine>,
    clock: Reader,
) {
    let mut published = 0_u32;
    while let Some(value) = lines.recv().await {
        published += 1;
        if published.is_multiple_of(BURST) {
            tokio::time::sleep(PAUSE).await;
        }
        publisher.emit(&Stamped { time_s: clock.now().as_secs_f64(), validity_s: f64::MAX, value });
    }
}

/// Takes lines without waiting for anybody.
struct Tap {
    sender: mpsc::Sender<LogLine>,
    dropped: AtomicU64,
}

impl<S: Subscriber> Layer<S> for Tap {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let metadata = event.metadata();
        let target = metadata.target();
        if *metadata.level() > Level::INFO || OWN.iter().any(|own| target.starts_with(own)) {
            return;
        }
        let Ok(room) = self.sender.try_reserve() else {
            self.dropped.fetch_add(1, Ordering::Relaxed);
            return;
        };
        let mut line = Line(String::new());
        event.record(&mut line);
        room.send(LogLine {
            level: metadata.level().to_string(),
            target: target.to_owned(),
            message: line.0,
            dropped: self.dropped.load(Ordering::Relaxed),
        });
    }
}

/// A line as it is put together: the message, then the fields.
struct Line(String);

impl Visit for Line {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        let separator = if self.0.is_empty() { "" } else { " " };
        let mut rest = Cut(&mut self.0);
        // what is too long is cut
        let _ = match field.name() {
            "message" => write!(rest, "{separator}{value:?}"),
            name => write!(rest, "{separator}{name}={value:?}"),
        };
    }
}

/// Writes up to the longest line, whatever is written.
struct Cut<'a>(&'a mut String);

impl Write for Cut<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let room = LINE_MAX.saturating_sub(self.0.len());
        let end = text.floor_char_boundary(room.min(text.len()));
        self.0.push_str(text.get(..end).unwrap_or_default());
        if end < text.len() { Err(fmt::Error) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_taken_cut_and_dropped_when_nobody_takes_them() {
        let (sender, mut lines) = mpsc::channel(2);
        let tap = Tap { sender, dropped: AtomicU64::new(0) };
        tracing::subscriber::with_default(tracing_subscriber::registry().with(tap), || {
            tracing::info!(count = 7, "first");
            tracing::debug!("not for others");
            tracing::warn!("ä{}", "x".repeat(5000));
            tracing::info!("dropped");
            tracing::info!("dropped too");
            let first = lines.try_recv().unwrap();
            assert_eq!((&*first.level, &*first.message, first.dropped), ("INFO", "first count=7", 0));
            assert_eq!(lines.try_recv().unwrap().message.len(), LINE_MAX);
            tracing::error!("last");
            assert_eq!(lines.try_recv().unwrap().dropped, 2);
        });
    }
}
