//! Adaptive retransmission timeout (Jacobson's estimator, RFC 6298; Karn's rule: no sample from
//! anything that was sent twice).

use crate::gateway::order::Time;
use std::time::Duration;

const FIRST: Duration = Duration::from_millis(500);
const SHORTEST: Duration = Duration::from_millis(150);
const LONGEST: Duration = Duration::from_millis(3000);
/// A radio link loses frames by noise more than by congestion: backing off further only wastes time.
const MAX_DOUBLINGS: u32 = 1;
/// No autopilot waits longer than this for what it has asked for, however far it is.
const FARTHEST: Duration = Duration::from_secs(5);
/// Nobody answers in no time, whatever a clock that stands still between two steps says.
const NEAREST: Duration = Duration::from_millis(10);
/// A timeout makes a link suspect for so many exchanges.
const SUSPECT_FOR: u32 = 16;

/// The estimator, and the one timer that goes with it.
#[derive(Debug, Clone, Default)]
pub struct Rto {
    smoothed_s: Option<(f64, f64)>,
    doublings: u32,
    suspect: u32,
    started: Option<Time>,
    /// The way there and back, as it is known by other means.
    trip: Option<Duration>,
}

impl Rto {
    /// A round trip was measured.
    pub fn sample(&mut self, trip: Duration) {
        let t = trip.as_secs_f64();
        self.smoothed_s = Some(match self.smoothed_s {
            None => (t, t / 2.0),
            Some((mean, spread)) => (0.875 * mean + 0.125 * t, 0.75 * spread + 0.25 * (mean - t).abs()),
        });
        self.doublings = 0;
        self.suspect = self.suspect.saturating_sub(1);
    }

    /// How long it is there and back, as the autopilot's answers to questions for its time say. Where that is longer than the timeout
    /// everything is sent twice, and nothing can be measured by it.
    pub fn knows_trip(&mut self, trip: Option<Duration>) {
        self.trip = trip;
    }

    /// About how long it is there and back.
    pub fn trip(&self) -> Duration {
        let measured = self.smoothed_s.and_then(|(mean, _)| Duration::try_from_secs_f64(mean).ok());
        measured.unwrap_or(FIRST / 3).max(self.trip.unwrap_or_default()).clamp(NEAREST, FARTHEST)
    }

    /// How often what is short and matters is sent at once: twice on a link that loses frames.
    pub fn copies(&self) -> usize {
        if self.suspect > 0 { 2 } else { 1 }
    }

    /// The present timeout.
    pub fn timeout(&self) -> Duration {
        let base = match self.smoothed_s {
            None => FIRST,
            Some((mean, spread)) => Duration::try_from_secs_f64(mean + 4.0 * spread).unwrap_or(LONGEST),
        };
        let waits = (base.max(SHORTEST) * (1 << self.doublings.min(MAX_DOUBLINGS))).min(LONGEST);
        let least = self.trip.map_or(Duration::ZERO, |trip| trip + trip / 4 + SHORTEST);
        waits.max(least.min(FARTHEST))
    }

    /// Starts the timer anew.
    pub fn start(&mut self, now: Time) {
        self.started = Some(now);
    }

    /// Something came through: no more backing off.
    pub fn no_doubling(&mut self) {
        self.doublings = 0;
    }

    /// Something came through: no more backing off, and the timer starts anew.
    pub fn progress(&mut self, now: Time) {
        self.no_doubling();
        self.started = Some(now);
    }

    /// When the timer runs out.
    fn deadline(&self) -> Option<Time> {
        self.started.map(|s| s + self.timeout())
    }

    /// It ran out: the timer starts anew with twice the timeout.
    pub fn expired(&mut self, now: Time) -> bool {
        let late = self.deadline().is_some_and(|d| now >= d);
        if late {
            self.doublings += 1;
            self.suspect = SUSPECT_FOR;
            self.started = Some(now);
        }
        late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_timeout_follows_the_round_trips_and_doubles_when_nothing_comes() {
        let ms = Duration::from_millis;
        let mut rto = Rto::default();
        assert_eq!(rto.timeout(), FIRST);
        (0..50).for_each(|_| rto.sample(ms(400)));
        assert!((ms(400)..ms(450)).contains(&rto.timeout()), "{:?}", rto.timeout());
        rto.start(ms(1000));
        assert!(!rto.expired(ms(1300)) && rto.expired(ms(1500)));
        assert!((ms(800)..ms(900)).contains(&rto.timeout()));
        (0..20).for_each(|i| {
            rto.expired(ms(10_000 * (i + 1)));
        });
        assert!(rto.timeout() < ms(900), "{:?}", rto.timeout());
        rto.progress(ms(0));
        assert!(rto.timeout() < ms(450));
        assert_eq!(rto.copies(), 2, "it lost something lately");
        (0..SUSPECT_FOR).for_each(|_| rto.sample(ms(100)));
        assert_eq!(rto.copies(), 1);
    }

    #[test]
    fn nothing_is_sent_again_before_it_can_have_been_answered() {
        let mut rto = Rto::default();
        rto.start(Duration::ZERO);
        rto.knows_trip(Some(Duration::from_secs(2)));
        assert!(!rto.expired(Duration::from_millis(2600)) && rto.expired(Duration::from_millis(2700)));
        assert_eq!(rto.trip(), Duration::from_secs(2));
        rto.knows_trip(Some(Duration::from_secs(60)));
        assert_eq!(rto.timeout(), FARTHEST);
        rto.knows_trip(None);
        assert!(rto.timeout() <= 2 * FIRST);
    }
}
