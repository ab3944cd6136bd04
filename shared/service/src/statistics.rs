//! What a service did, for its log.

use std::time::{Duration, Instant};

/// Told so often.
const PERIOD: Duration = Duration::from_secs(60);

/// Counts since the start.
#[derive(Debug)]
pub(crate) struct Statistics {
    pub(crate) steps: u64,
    pub(crate) events: u64,
    pub(crate) answers: u64,
    /// The longest that a step and what it led to took, wall-clock.
    pub(crate) longest: Duration,
    told: Instant,
}

impl Default for Statistics {
    fn default() -> Self {
        Self { steps: 0, events: 0, answers: 0, longest: Duration::ZERO, told: Instant::now() }
    }
}

impl Statistics {
    pub(crate) fn step(&mut self, took: Duration) {
        self.steps += 1;
        self.longest = self.longest.max(took);
    }

    /// Once a minute.
    pub(crate) fn tell_sometimes(&mut self, service: &str) {
        if self.told.elapsed() >= PERIOD {
            self.tell(service);
        }
    }

    pub(crate) fn tell(&mut self, service: &str) {
        self.told = Instant::now();
        let Self { steps, events, answers, longest, .. } = self;
        tracing::debug!(steps, events, answers, longest_ms = longest.as_millis(), "{service}");
    }
}
