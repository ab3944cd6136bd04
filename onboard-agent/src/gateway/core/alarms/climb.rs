//! Does the aircraft climb as nothing does without an engine?
//!
//! A gust, a pull-up or a thermal takes a glider up, too: for a while, by what its speed gives, or by little.

use crate::gateway::core::telemetry::{CLIMBING_MPS, FRESH, Telemetry};
use crate::gateway::order::Time;
use aircraft::GRAVITY_MPS2;
use std::time::Duration;

/// An engine takes it up for so long, and by so many metres more than its speed gave.
const LASTS: Duration = Duration::from_secs(10);
const GAINS_M: f64 = 30.0;
/// What the speed may have given where it is not told, metres.
const SPEED_GIVES_M: f64 = 50.0;

/// A climb that goes on.
#[derive(Debug, Clone, Copy, Default)]
pub struct Climb {
    began: Option<Start>,
}

#[derive(Debug, Clone, Copy)]
struct Start {
    at: Time,
    altitude_amsl_m: f64,
    /// The height that its speed was worth then, metres.
    speed_m: Option<f64>,
}

impl Climb {
    /// Looks at what is told now. One report of no climb ends it.
    pub fn take(&mut self, now: Time, t: &Telemetry) {
        let fix = t.fix.filter(|(at, fix)| now.saturating_sub(*at) < FRESH && fix.down_mps < -CLIMBING_MPS);
        self.began = fix.map(|(_, fix)| {
            let here = Start { at: now, altitude_amsl_m: fix.altitude_amsl_m, speed_m: speed_m(now, t) };
            self.began.unwrap_or(here)
        });
    }

    /// It has climbed for so long, and by so much more than its speed gave.
    pub fn shows_an_engine(&self, now: Time, t: &Telemetry) -> bool {
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
