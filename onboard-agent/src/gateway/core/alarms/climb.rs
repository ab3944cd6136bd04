//! Does the aircraft climb, or stay up, as nothing does without an engine?
//!
//! A gust, a pull-up or a thermal takes a glider up, too: for a while, by what its speed gives, or by little.

use super::{LOSING_MPS, energy_mps};
use crate::gateway::core::telemetry::{CLIMBING_MPS, FRESH, Telemetry};
use crate::gateway::order::Time;
use aircraft::GRAVITY_MPS2;
use std::time::Duration;

/// An engine takes it up for so long, and by so many metres more than its speed gave.
const LASTS: Duration = Duration::from_secs(10);
const GAINS_M: f64 = 30.0;
/// What it loses of its height it has in speed, and the other way round, for so long.
const STAYS_UP: Duration = Duration::from_secs(30);
/// What the speed may have given where it is not told, metres.
const SPEED_GIVES_M: f64 = 50.0;

/// A climb, or a level flight, that goes on.
#[derive(Debug, Clone, Copy, Default)]
pub struct Climb {
    began: Option<Start>,
    stays_up_since: Option<Time>,
}

#[derive(Debug, Clone, Copy)]
struct Start {
    at: Time,
    altitude_amsl_m: f64,
    /// The height that its speed was worth then, metres.
    speed_m: Option<f64>,
}

impl Climb {
    /// Looks at what is told now. One report of no climb ends it, one of less energy a level flight; standing on the ground is neither.
    pub fn take(&mut self, now: Time, t: &Telemetry) {
        if !t.is_up(now) {
            *self = Self::default();
            return;
        }
        let fix = t.fix.filter(|(at, _)| now.saturating_sub(*at) < FRESH);
        let known_mps = fix.and(speed_m(now, t)).and_then(|_| energy_mps(now, t));
        self.stays_up_since =
            known_mps.filter(|mps| *mps >= LOSING_MPS).map(|_| self.stays_up_since.unwrap_or(now));
        let fix = fix.filter(|(_, fix)| fix.down_mps < -CLIMBING_MPS);
        self.began = fix.map(|(_, fix)| {
            let here = Start { at: now, altitude_amsl_m: fix.altitude_amsl_m, speed_m: speed_m(now, t) };
            self.began.unwrap_or(here)
        });
    }

    /// It has climbed for so long, and by so much more than its speed gave, or has kept height and airspeed for longer.
    pub fn shows_an_engine(&self, now: Time, t: &Telemetry) -> bool {
        self.stays_up_since.is_some_and(|since| now.saturating_sub(since) >= STAYS_UP)
            || self.has_climbed(now, t)
    }

    fn has_climbed(&self, now: Time, t: &Telemetry) -> bool {
        let Some((began, (_, fix))) = self.began.zip(t.fix) else { return false };
        let spent_m = began.speed_m.zip(speed_m(now, t)).map(|(before_m, now_m)| before_m - now_m);
        let gained_m = fix.altitude_amsl_m - began.altitude_amsl_m - spent_m.unwrap_or(SPEED_GIVES_M);
        now.saturating_sub(began.at) >= LASTS && gained_m >= GAINS_M
    }
}

/// The height that the airspeed is worth, if it is told: v² / 2g, metres.
fn speed_m(now: Time, t: &Telemetry) -> Option<f64> {
    let (_, air) = t.air.filter(|(at, _)| now.saturating_sub(*at) < FRESH)?;
    Some(air.airspeed_mps.powi(2) / (2.0 * GRAVITY_MPS2))
}
