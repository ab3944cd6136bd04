//! What time it is: the machine's, or the simulator's.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use usal::contract::ClockTick;
use usal::{Conductor, Participant};

/// Time since the start of the clock; in simulation, simulated time.
pub type Time = Duration;

/// Pace of the machine's clock.
const PACE: Duration = Duration::from_millis(50);

/// A clock that beats.
pub(crate) enum Clock {
    /// The machine's.
    Machine(Pace),
    /// The simulator's, followed: time stands until everybody has acknowledged it.
    Follows(Box<Lockstep>),
    /// The simulator's, led: this service says how late it is, and waits for the others.
    Leads(Box<Led>),
}

/// The machine's time.
pub(crate) struct Pace {
    start: Instant,
    /// The next beat.
    next: Instant,
}

/// The simulator's time as it is known here.
pub(crate) struct Lockstep {
    participant: Participant,
    /// The tick that is to be acknowledged.
    open: Option<ClockTick>,
    now: SimulatedNow,
}

/// The simulator's time as it is told from here.
pub(crate) struct Led {
    pub(crate) conductor: Conductor,
    pace: Pace,
    now: SimulatedNow,
}

/// Tells the time to whoever isn't the loop.
#[derive(Clone)]
pub(crate) enum Reader {
    Since(Instant),
    Simulated(SimulatedNow),
}

/// Simulated time, nanoseconds.
#[derive(Clone, Default)]
pub(crate) struct SimulatedNow(Arc<AtomicU64>);

impl SimulatedNow {
    fn get(&self) -> Time {
        Time::from_nanos(self.0.load(Ordering::Relaxed))
    }

    /// Time never goes back: a simulator that was started anew begins at zero.
    fn advance(&self, to: Time) {
        self.0.fetch_max(u64::try_from(to.as_nanos()).unwrap_or(u64::MAX), Ordering::Relaxed);
    }
}

impl Reader {
    pub(crate) fn now(&self) -> Time {
        match self {
            Self::Since(start) => start.elapsed(),
            Self::Simulated(now) => now.get(),
        }
    }
}

impl Pace {
    fn from_now() -> Self {
        let start = Instant::now();
        Self { start, next: start }
    }

    async fn beat(&mut self) {
        tokio::time::sleep_until(self.next.into()).await;
        self.next = Instant::now() + PACE;
    }
}

impl Clock {
    /// The machine's clock, from now.
    pub(crate) fn machine() -> Self {
        Self::Machine(Pace::from_now())
    }

    /// The simulator's clock, as others tell it.
    pub(crate) fn follows(participant: Participant) -> Self {
        Self::Follows(Box::new(Lockstep { participant, open: None, now: SimulatedNow::default() }))
    }

    /// The simulator's clock, told by this service.
    pub(crate) fn leads(conductor: Conductor) -> Self {
        Self::Leads(Box::new(Led { conductor, pace: Pace::from_now(), now: SimulatedNow::default() }))
    }

    /// The time now.
    pub(crate) fn now(&self) -> Time {
        match self {
            Self::Machine(pace) => pace.start.elapsed(),
            Self::Follows(lockstep) => lockstep.now.get(),
            Self::Leads(led) => led.now.get(),
        }
    }

    pub(crate) fn reader(&self) -> Reader {
        match self {
            Self::Machine(pace) => Reader::Since(pace.start),
            Self::Follows(lockstep) => Reader::Simulated(lockstep.now.clone()),
            Self::Leads(led) => Reader::Simulated(led.now.clone()),
        }
    }

    /// Waits for the next beat; `None` when the session is closed. May be cancelled.
    pub(crate) async fn beat(&mut self) -> Option<Time> {
        match self {
            Self::Machine(pace) => pace.beat().await,
            Self::Leads(led) => led.pace.beat().await,
            Self::Follows(lockstep) => {
                let tick = lockstep.participant.next().await?;
                lockstep.open = Some(tick);
                // a simulator that sends nonsense stops the clock, nothing else
                if let Ok(told) = Time::try_from_secs_f64(tick.time_s) {
                    lockstep.now.advance(told);
                }
            }
        }
        Some(self.now())
    }

    /// Everything due at the last beat has been done.
    pub(crate) fn acknowledge(&mut self) {
        if let Self::Follows(lockstep) = self
            && let Some(tick) = lockstep.open.take()
        {
            lockstep.participant.acknowledge(tick);
        }
    }

    /// It is so late now. Gives the time, if it is led from here.
    pub(crate) fn lead(&mut self, to: Time) -> Option<&mut Conductor> {
        let Self::Leads(led) = self else { return None };
        led.now.advance(to);
        Some(&mut led.conductor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use usal::Session;

    #[tokio::test(flavor = "multi_thread")]
    async fn simulator_that_tells_nonsense_or_begins_anew_never_turns_time_back() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let endpoint = format!("tcp/{}", listener.local_addr().unwrap());
        drop(listener);
        let session = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
        let mut conductor = Conductor::new(&session).unwrap();
        let mut clock = Clock::follows(Participant::join(&session, "follower").unwrap());
        let reader = clock.reader();
        let told = [(2.0, 2.0), (f64::NAN, 2.0), (-1.0, 2.0), (f64::INFINITY, 2.0), (1.0, 2.0), (2.5, 2.5)];
        for (told_s, expected_s) in told {
            conductor.start(told_s);
            let beat = tokio::time::timeout(Duration::from_secs(30), clock.beat()).await.unwrap();
            assert_eq!(beat, Some(Duration::from_secs_f64(expected_s)), "{told_s}");
            assert_eq!(reader.now(), clock.now());
            clock.acknowledge();
        }
        assert!(clock.lead(Duration::from_secs(9)).is_none(), "who follows doesn't lead");
        assert_eq!(clock.now(), Duration::from_secs_f64(2.5));
        session.close().await;
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn machines_clock_beats_at_its_pace_and_at_once_first() {
        let mut clock = Clock::machine();
        let begun = Instant::now();
        let first = clock.beat().await.unwrap();
        let second = clock.beat().await.unwrap();
        assert!(second >= first + PACE && begun.elapsed() >= PACE, "{first:?} {second:?}");
    }
}
