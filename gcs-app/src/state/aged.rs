//! A value that knows how old it is.

use usal::contract::Stamped;

/// A value, when it was received, and how long it is valid.
#[derive(Debug, Clone, PartialEq)]
pub struct Aged<T> {
    /// The value.
    pub value: T,
    /// The source's time of it, seconds.
    pub time_s: f64,
    /// Seconds it may be believed.
    pub validity_s: f64,
    /// When it was received, seconds of the window's clock.
    pub received_s: f64,
}

impl<T> Aged<T> {
    /// Telemetry now.
    pub fn new(stamped: Stamped<T>, now_s: f64) -> Self {
        Self {
            value: stamped.value,
            time_s: stamped.time_s,
            validity_s: stamped.validity_s,
            received_s: now_s,
        }
    }
    /// Seconds since it was received.
    pub fn age_s(&self, now_s: f64) -> f64 {
        (now_s - self.received_s).max(0.0)
    }
    /// No longer to be believed. What says it is valid for no sensible time is never believed.
    pub fn is_expired(&self, now_s: f64) -> bool {
        self.validity_s.is_nan() || self.age_s(now_s) > self.validity_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_expires_when_its_validity_is_over() {
        let value = |validity_s| Aged::new(Stamped { time_s: 7.0, validity_s, value: () }, 100.0);
        for (validity, now, expired) in [
            (2.0, 101.9, false),
            (2.0, 102.1, true),
            (f64::NAN, 100.0, true),
            (-1.0, 100.0, true),
            (2.0, 99.0, false),
        ] {
            assert_eq!(value(validity).is_expired(now), expired, "{validity} at {now}");
        }
    }
}
