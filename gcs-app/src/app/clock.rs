//! The time of a frame. Only the app looks at clocks; state and panels get the time as an argument.

use super::App;
use std::time::Duration;

/// Tells the time of day.
pub type TimeOfDay = fn() -> jiff::Timestamp;

/// The time of a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Now {
    /// The window's clock, seconds: ages, messages and animations go by what egui is told.
    pub window_s: f64,
    /// The time of day.
    pub utc: jiff::Timestamp,
}

impl Now {
    /// Until the clock in the bar shows another time, and what is known is older by as much: a clock of seconds, or of minutes.
    pub(super) fn until_next(&self, unit_s: i64) -> Duration {
        let past_ms = self.utc.as_millisecond().rem_euclid(unit_s * 1000);
        Duration::from_millis((unit_s * 1000 - past_ms).unsigned_abs())
    }
}

impl App {
    /// The time of day comes from there from now on; from the system's clock otherwise.
    pub fn tell_time_by(&mut self, time_of_day: TimeOfDay) {
        self.time_of_day = time_of_day;
    }

    pub(super) fn now(&self, ctx: &egui::Context) -> Now {
        Now { window_s: ctx.input(|i| i.time), utc: (self.time_of_day)() }
    }
}
