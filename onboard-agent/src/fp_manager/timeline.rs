//! Pure: the executor's time across restarts. It never goes back, and goes on during the restart where the machine's
//! clock allows to know for how long.

use service::Time;

/// From a process' time to the executor's.
///
/// A process counts time from its own start (in simulation from the simulator's). The executor's time is that plus a
/// base, and at least the last one recorded. In flight the base is the time since the machine was started, read once
/// at the process' start: so a restarted process goes on where time is, not where it was. After a restart of the
/// machine (or a simulator) time goes on from the last one recorded.
#[derive(Debug, Clone)]
pub struct Timeline {
    base: Time,
    /// Once the process' clock beats.
    offset: Option<Time>,
}

impl Timeline {
    /// With a base.
    pub fn new(base: Time) -> Self {
        Self { base, offset: None }
    }

    /// The process' clock beats (a simulator's stands at zero before): from now on the executor's time runs with it.
    pub fn begin(&mut self, now: Time, last: Option<Time>) {
        if self.offset.is_none() {
            let begin = (now + self.base).max(last.unwrap_or_default());
            self.offset = Some(begin.saturating_sub(now));
        }
    }

    /// The executor's time.
    pub fn at(&self, now: Time, last: Option<Time>) -> Time {
        let at = now.saturating_add(self.offset.unwrap_or(self.base));
        at.max(last.unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: fn(u64) -> Time = Time::from_secs;

    #[test]
    fn executors_time_never_goes_back_and_runs_with_the_clock() {
        // (what, base, last recorded, first beat, a later time of the process, executor's times then)
        let cases = [
            ("first start in flight", 100, None, 0, 5, (100, 105)),
            ("restarted in flight 3 s after the last record", 203, Some(200), 0, 5, (203, 208)),
            ("machine restarted", 30, Some(200), 0, 5, (200, 205)),
            ("restarted in simulation", 0, Some(200), 201, 205, (201, 205)),
            ("simulator restarted", 0, Some(200), 1, 5, (200, 204)),
        ];
        for (what, base, last, first, later, (then, after)) in cases {
            let last = last.map(S);
            let mut timeline = Timeline::new(S(base));
            timeline.begin(S(first), last);
            assert_eq!(timeline.at(S(first), last), S(then), "{what}");
            assert_eq!(timeline.at(S(later), last), S(after), "{what}");
        }
    }

    #[test]
    fn asked_before_the_clock_beats_it_stands_at_the_last_record() {
        let mut timeline = Timeline::new(S(0));
        assert_eq!(timeline.at(S(0), Some(S(200))), S(200));
        timeline.begin(S(201), Some(S(200)));
        assert_eq!(timeline.at(S(202), Some(S(200))), S(202));
    }
}
