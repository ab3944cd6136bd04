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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gateway::driver::{FromLink, Setup};

    /// One frame of each kind of message, as it came.
    fn frames(text: &str) -> impl Iterator<Item = Vec<u8>> {
        let byte = |pair: &[u8]| u8::from_str_radix(str::from_utf8(pair).unwrap(), 16).unwrap();
        text.lines().map(move |line| line.as_bytes().chunks(2).map(byte).collect())
    }

    /// Each second of a real PX4 brought some messages that our dialect does not have, and each ten a warning.
    #[test]
    fn nothing_that_a_healthy_autopilot_sends_is_nonsense() {
        for text in [include_str!("healthy_px4.hex"), include_str!("healthy_arduplane.hex")] {
            let mut session = Session::new(&Setup::default());
            for (n, frame) in frames(text).enumerate() {
                session.receive(0, FromLink::Datagram(&frame));
                while session.process(Time::ZERO, &mut vec![]) {}
                assert_eq!((session.ignored, session.others), (0, 0), "line {}", n + 1);
            }
            assert!(session.peer().is_some());
        }
    }

    #[test]
    fn a_value_that_the_dialect_does_not_have_is_told() {
        let mut session = Session::new(&Setup::default());
        let payload = [0, 0, 0, 0, 1, 250, 0, 0, 3];
        let beat = autopilot_link::frame::encode_payload(session.own(), 0, 0, &payload);
        session.receive(0, FromLink::Datagram(&beat));
        while session.process(Time::ZERO, &mut vec![]) {}
        assert_eq!(session.ignored, 1);
    }
}
