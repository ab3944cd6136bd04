//! The executor's own clock, and what is due by it.

use super::Offset;
use serde::{Deserialize, Serialize};

/// A deadline is rounded to nanoseconds: it is not to be missed by one, seconds.
const ROUNDED_S: f64 = 1e-6;

/// Seconds that go on from a snapshot.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Clock {
    now_s: f64,
    started_s: Option<f64>,
    /// Values were written: the path is laid out anew then.
    refresh_due_s: Option<f64>,
    refreshed_s: Option<f64>,
    /// Conditions ahead are read again then.
    review_due_s: f64,
}

impl Clock {
    pub fn now_s(&self) -> f64 {
        self.now_s
    }

    pub fn advance(&mut self, seconds: f64) {
        self.now_s += seconds;
    }

    pub fn is_due(&self, at_s: f64) -> bool {
        at_s <= self.now_s + ROUNDED_S
    }

    /// A flight begins.
    pub fn start(&mut self) {
        self.started_s = Some(self.now_s);
    }

    /// Since the last start, seconds.
    pub fn flight_s(&self) -> f64 {
        self.started_s.map_or(0.0, |started_s| self.now_s - started_s)
    }

    pub fn refresh_due_s(&self) -> Option<f64> {
        self.refresh_due_s
    }

    /// The path has to be laid out anew; not sooner than so many seconds after the last time.
    pub fn ask_for_refresh(&mut self, debounce_s: f64) {
        let earliest_s = self.refreshed_s.map_or(0.0, |last_s| last_s + debounce_s);
        self.refresh_due_s = Some(self.now_s.max(earliest_s));
    }

    /// The path is laid out anew now.
    pub fn refreshed(&mut self) {
        self.refresh_due_s = None;
        self.refreshed_s = Some(self.now_s);
    }

    pub fn review_due_s(&self) -> f64 {
        self.review_due_s
    }

    /// Conditions are read again in so many seconds.
    pub fn review_in(&mut self, seconds: f64) {
        self.review_due_s = self.now_s + seconds;
    }

    pub fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        // instants are compared by their distance from now; conditions that read the time of flight forbid to compare at all
        let Self { now_s: _, started_s: _, refresh_due_s, refreshed_s, review_due_s } = self;
        offset.is_debounced(*refreshed_s, other.refreshed_s)
            && super::both_or_none(refresh_due_s, &other.refresh_due_s, |a, b| offset.instant(*a, *b))
            && offset.instant(*review_due_s, other.review_due_s)
    }
}
