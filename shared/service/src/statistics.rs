//! What a service did, for its log.

use std::time::{Duration, Instant};
use usal::HealthCount;

/// Told so often.
const PERIOD: Duration = Duration::from_secs(60);

/// Counts since the start.
#[derive(Debug)]
pub(crate) struct Statistics {
    pub(crate) steps: u64,
    pub(crate) events: u64,
    pub(crate) answers: u64,
    /// Messages in the name of services that it follows, of others than those that it hears.
    pub(crate) strange: u64,
    /// The longest that a step and what it led to took, wall-clock.
    pub(crate) longest: Duration,
    told: Instant,
}

impl Default for Statistics {
    fn default() -> Self {
        Self { steps: 0, events: 0, answers: 0, strange: 0, longest: Duration::ZERO, told: Instant::now() }
    }
}

impl Statistics {
    pub(crate) fn step(&mut self, took: Duration) {
        self.steps += 1;
        self.longest = self.longest.max(took);
    }

    /// Once a minute.
    pub(crate) fn tell_sometimes(&mut self, service: &str, health: impl FnOnce() -> HealthCount) {
        if self.told.elapsed() >= PERIOD {
            self.tell(service, health());
        }
    }

    /// With what went wrong on the network; each of that is a warning of its own, but they are limited.
    pub(crate) fn tell(&mut self, service: &str, health: HealthCount) {
        self.told = Instant::now();
        let Self { steps, events, answers, strange, longest, .. } = self;
        let HealthCount { undecodable, overflowed, unsent } = health;
        let longest_ms = longest.as_millis();
        tracing::debug!(
            steps,
            events,
            answers,
            strange,
            longest_ms,
            undecodable,
            overflowed,
            unsent,
            "{service}"
        );
    }
}
