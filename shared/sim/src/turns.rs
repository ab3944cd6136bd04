//! When an autopilot reads what its link has brought: once in each turn of its main loop, all that is there by then. Who waits to be
//! asked for each item of a list gets one aboard in a turn; who sends on unasked is not held up.

use std::time::Duration;
use tokio::time::Instant;

/// The turns of a main loop.
#[derive(Debug)]
pub(crate) struct Turns {
    began: Instant,
    period: Duration,
}

impl Turns {
    /// The first turn is now. `None`: what comes is read at once.
    pub(crate) fn new(began: Instant, period: Duration) -> Option<Self> {
        (!period.is_zero()).then_some(Self { began, period })
    }

    /// The first turn after a time.
    pub(crate) fn after(&self, now: Instant) -> Instant {
        let elapsed = now.saturating_duration_since(self.began).as_nanos();
        let turns = elapsed / self.period.as_nanos() + 1;
        self.began + self.period.saturating_mul(u32::try_from(turns).unwrap_or(u32::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_is_read_in_the_turn_after_it() {
        let (began, ms) = (Instant::now(), Duration::from_millis);
        let turns = Turns::new(began, ms(20)).unwrap();
        for (comes, read) in [(0, 20), (1, 20), (19, 20), (20, 40), (405, 420)] {
            assert_eq!(turns.after(began + ms(comes)), began + ms(read), "{comes} ms");
        }
        assert!(Turns::new(began, Duration::ZERO).is_none());
    }

    /// As it was measured: 500 items in 10 s, whoever waits to be asked.
    #[test]
    fn an_item_that_is_sent_when_it_was_asked_for_takes_a_turn() {
        let began = Instant::now();
        let turns = Turns::new(began, Duration::from_millis(20)).unwrap();
        let aboard = (0..500).fold(began, |asked, _| turns.after(asked));
        assert_eq!(aboard - began, Duration::from_secs(10));
    }
}
