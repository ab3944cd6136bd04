//! Whether the airspeed still grows.

use crate::gateway::order::Time;

/// Time constants of the two means that are held against each other, seconds: gusts pass, an acceleration stays.
const FAST_S: f64 = 1.0;
const SLOW_S: f64 = 4.0;

/// The airspeed, smoothed twice.
#[derive(Debug, Clone, Copy, Default)]
pub struct Trend {
    at: Option<Time>,
    fast_mps: f64,
    slow_mps: f64,
}

impl Trend {
    /// It was measured, m/s.
    pub fn take(&mut self, now: Time, mps: f64) {
        let Some(before) = self.at.replace(now) else {
            (self.fast_mps, self.slow_mps) = (mps, mps);
            return;
        };
        let passed_s = now.saturating_sub(before).as_secs_f64();
        self.fast_mps += (mps - self.fast_mps) * (1.0 - (-passed_s / FAST_S).exp());
        self.slow_mps += (mps - self.slow_mps) * (1.0 - (-passed_s / SLOW_S).exp());
    }

    /// How fast it has grown over the last seconds, m/s².
    pub fn gains_mps2(&self) -> f64 {
        (self.fast_mps - self.slow_mps) / (SLOW_S - FAST_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// What it gains after 15 s of this airspeed, m/s by s, five times a second.
    fn gains(mps: impl Fn(f64) -> f64) -> f64 {
        let mut trend = Trend::default();
        for tick in 0..75 {
            let s = f64::from(tick) / 5.0;
            trend.take(Duration::from_secs_f64(s), mps(s));
        }
        trend.gains_mps2()
    }

    #[test]
    fn an_acceleration_is_seen_and_gusts_are_not() {
        assert_eq!(gains(|_| 25.0), 0.0);
        assert!((0.45..0.55).contains(&gains(|s| 25.0 + 0.5 * s)), "{}", gains(|s| 25.0 + 0.5 * s));
        assert!(gains(|s| 40.0 - s) < -0.9);
        for phase in 0..20 {
            let gusts = gains(|s| 15.0 + (4.0 * s + f64::from(phase)).sin());
            assert!(gusts.abs() < 0.1, "{gusts}");
        }
    }
}
