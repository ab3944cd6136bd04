//! Counts of what went wrong on a session, and a log that bad peers cannot flood.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// At most one line of log in this time.
const LOG_INTERVAL: Duration = Duration::from_secs(1);

/// What went wrong so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct HealthCount {
    /// Payloads that could not be decoded.
    pub undecodable: u64,
    /// Events or requests dropped because nobody here took them in time.
    pub overflowed: u64,
    /// Messages that could not be sent.
    pub unsent: u64,
}

/// Counters of a session; shared by all its parts.
#[derive(Debug, Default)]
pub struct Health {
    undecodable: AtomicU64,
    overflowed: AtomicU64,
    unsent: AtomicU64,
    log: Mutex<Throttle>,
}

#[derive(Debug, Default)]
struct Throttle {
    last: Option<Instant>,
    suppressed: u64,
}

impl Health {
    /// The counts now.
    pub fn count(&self) -> HealthCount {
        HealthCount {
            undecodable: self.undecodable.load(Ordering::Relaxed),
            overflowed: self.overflowed.load(Ordering::Relaxed),
            unsent: self.unsent.load(Ordering::Relaxed),
        }
    }

    pub(crate) fn undecodable(&self, key: &str, reason: &str) {
        self.undecodable.fetch_add(1, Ordering::Relaxed);
        self.warn("ignored a payload that cannot be decoded", key, reason);
    }

    pub(crate) fn overflowed(&self, key: &str) {
        self.overflowed.fetch_add(1, Ordering::Relaxed);
        self.warn("dropped a message", key, "its receiver does not keep up");
    }

    pub(crate) fn unsent(&self, key: &str, reason: &str) {
        self.unsent.fetch_add(1, Ordering::Relaxed);
        self.warn("could not send", key, reason);
    }

    fn warn(&self, what: &str, key: &str, reason: &str) {
        let Ok(mut log) = self.log.lock() else { return };
        let now = Instant::now();
        if log.last.is_some_and(|last| now.duration_since(last) < LOG_INTERVAL) {
            log.suppressed += 1;
            return;
        }
        tracing::warn!(key, reason, more = log.suppressed, "{what}");
        *log = Throttle { last: Some(now), suppressed: 0 };
    }
}
