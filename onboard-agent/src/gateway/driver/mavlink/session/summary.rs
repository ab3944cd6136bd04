//! A summary (`HIGH_LATENCY2`) in the place of heartbeats.

use super::{Session, SessionEvent, Shown};
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::HIGH_LATENCY2_DATA;
use std::time::Duration;

/// A mode of its heartbeats is newer than that of a summary for so long.
pub(super) const BEATS_FOR: Duration = Duration::from_secs(5);
/// A summary takes no longer than this by satellite; one that is older yet is of an autopilot that started anew, ms.
const MOST_LATE_MS: u32 = 120_000;

/// Its last heartbeat.
#[derive(Debug)]
pub(super) struct Beat {
    /// When it came.
    pub at: Time,
    /// It was armed.
    pub armed: bool,
    /// The autopilot's clock as it was known then, ms.
    pub clock_ms: u32,
}

impl Beat {
    /// The summary was made before it, and has only come later.
    fn is_newer_than(&self, summary: &HIGH_LATENCY2_DATA) -> bool {
        let older_ms = self.clock_ms.saturating_sub(summary.timestamp);
        (1..=MOST_LATE_MS).contains(&older_ms)
    }
}

impl Session {
    /// Over such a link no heartbeats may come; whether it is armed only they say.
    pub(super) fn on_summary(
        &mut self,
        now: Time,
        summary: &HIGH_LATENCY2_DATA,
        events: &mut Vec<SessionEvent>,
    ) {
        let is_late = |beat: &&Beat| now.saturating_sub(beat.at) >= BEATS_FOR;
        let beat = self.beat.as_ref().filter(is_late).filter(|beat| !beat.is_newer_than(summary));
        let Some(&Beat { armed, .. }) = beat else { return };
        let mode = (self.manner.summary.mode)(summary.custom_mode);
        events.push(SessionEvent::Mode(mode));
        self.shown(now, Shown::Mode(mode, armed), events);
    }
}
