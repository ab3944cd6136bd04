//! What of a conversation is only told in the log.

use super::Session;
use crate::gateway::order::Time;
use std::time::Duration;

/// It is told at most this often.
const LOG_EVERY: Duration = Duration::from_secs(10);

impl Session {
    pub(super) fn log_ignored(&mut self, now: Time) {
        let (at, before) = self.logged_ignored;
        if self.ignored > before && now >= at + LOG_EVERY {
            let messages = self.ignored - before;
            let others = self.others;
            tracing::warn!(messages, others, "messages with values that nothing can have were ignored");
            self.logged_ignored = (now, self.ignored);
        }
    }

    pub(super) fn log_garbage(&mut self, now: Time) {
        self.links.log_refused(now);
        let bytes = self.links.ignored_bytes();
        if bytes > self.logged.1 && now >= self.logged.0 + LOG_EVERY {
            tracing::warn!(bytes, "bytes that are no MAVLink were ignored on the autopilot's link");
            self.logged = (now, bytes);
        }
    }
}
