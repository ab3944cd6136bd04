//! What time it is: the machine's, or the simulator's.

use std::time::{Duration, Instant};
use usal::Participant;
use usal::contract::ClockTick;

/// Time since the start of the clock; in simulation, simulated time.
pub type Time = Duration;

/// Pace of the machine's clock.
const PACE: Duration = Duration::from_millis(50);

/// A clock that beats.
pub enum Clock {
    /// The machine's.
    Monotonic {
        /// Since then.
        start: Instant,
        /// The next beat.
        next: Instant,
    },
    /// The simulator's: time stands until everybody has acknowledged it.
    Simulated(Box<Lockstep>),
}

/// The simulator's time as it is known here.
pub struct Lockstep {
    participant: Participant,
    /// The tick that is to be acknowledged.
    open: Option<ClockTick>,
    now: Time,
}

impl Clock {
    /// The machine's clock, from now.
    pub fn monotonic() -> Self {
        let start = Instant::now();
        Self::Monotonic { start, next: start }
    }

    /// The simulator's clock.
    pub fn simulated(participant: Participant) -> Self {
        Self::Simulated(Box::new(Lockstep { participant, open: None, now: Time::ZERO }))
    }

    /// Time stands between two beats.
    pub fn is_simulated(&self) -> bool {
        matches!(self, Self::Simulated(_))
    }

    /// The time now.
    pub fn now(&self) -> Time {
        match self {
            Self::Monotonic { start, .. } => start.elapsed(),
            Self::Simulated(lockstep) => lockstep.now,
        }
    }

    /// Waits for the next beat; `None` when the session is closed. May be cancelled.
    pub async fn beat(&mut self) -> Option<Time> {
        match self {
            Self::Monotonic { start, next } => {
                tokio::time::sleep_until((*next).into()).await;
                *next = Instant::now() + PACE;
                Some(start.elapsed())
            }
            Self::Simulated(lockstep) => {
                let tick = lockstep.participant.next().await?;
                lockstep.open = Some(tick);
                // a simulator that sends nonsense stops the clock, nothing else
                let told = Time::try_from_secs_f64(tick.time_s).unwrap_or(lockstep.now);
                lockstep.now = lockstep.now.max(told);
                Some(lockstep.now)
            }
        }
    }

    /// Everything due at the last beat has been done.
    pub fn acknowledge(&mut self) {
        if let Self::Simulated(lockstep) = self
            && let Some(tick) = lockstep.open.take()
        {
            lockstep.participant.acknowledge(tick);
        }
    }
}
