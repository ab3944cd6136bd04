//! The demo's line of progress.

use crate::report::assemble;
use flight_exec::PlacePointer;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A bar that shows how much of the previewed time has been flown, where, and how fast.
pub struct Progress {
    bar: ProgressBar,
    total_s: f64,
}

impl Progress {
    /// A bar up to the previewed duration.
    pub fn new(total_s: f64) -> Self {
        let bar = ProgressBar::new(total_s.max(1.0) as u64);
        let style = "{spinner:.magenta} [{bar:38.magenta/dim}] {percent:>3} %  {msg}";
        // the template is a constant: it is good or the tests fail
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("━━╌"));
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        Self { bar, total_s }
    }

    /// What is being waited for, before the flight.
    pub fn say(&self, text: &str) {
        self.bar.set_message(text.to_owned());
    }

    /// The flight at a time.
    pub fn show(&self, time_s: f64, wall_s: f64, place: Option<&PlacePointer>) {
        self.bar.set_position(time_s.clamp(0.0, self.total_s) as u64);
        let leg = place.map_or("…".to_owned(), |p| assemble::key(p).to_string());
        let minutes = (time_s / 60.0) as u64;
        let seconds = time_s as u64 % 60;
        let pace = time_s / wall_s.max(0.1);
        self.bar.set_message(format!("{minutes}:{seconds:02} flown, {pace:.0} × real time, {leg}"));
    }

    /// A line above the bar.
    pub fn tell(&self, line: &str) {
        if self.bar.is_hidden() {
            complain!("{line}");
        } else {
            self.bar.println(line);
        }
    }

    /// Takes the bar away.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_good() {
        assert!(
            ProgressStyle::with_template("{spinner:.magenta} [{bar:38.magenta/dim}] {percent:>3} %  {msg}")
                .is_ok()
        );
        Progress::new(0.0).show(-1.0, 0.0, None);
    }
}
