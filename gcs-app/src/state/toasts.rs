//! Short messages that go by themselves: what would be missed, but asks for nothing. Each is in the window's log, too.

use super::{Level, Log};

/// So many are there at a time; with one more the oldest goes.
const MOST: usize = 4;
/// Who says so, in the log.
const WINDOW: &str = "window";

/// A message.
#[derive(Debug, Clone, PartialEq)]
pub struct Toast {
    /// Its number in this window.
    pub id: u64,
    /// How much it matters.
    pub level: Level,
    /// What it says.
    pub text: String,
    /// It tells of the step that led to this version of the document, and offers to undo it.
    pub undoes: Option<u64>,
    /// Until when it is shown, seconds of the window's clock.
    until_s: f64,
}

/// The messages that are shown, the oldest first, and what the window has said so far.
#[derive(Debug, Default)]
pub struct Toasts {
    list: Vec<Toast>,
    last: u64,
    log: Log,
}

impl Toasts {
    /// A message; one that is there already stays longer.
    pub fn add(&mut self, now_s: f64, level: Level, text: impl Into<String>) {
        let text = flight_plan::legible(&text.into()).into_owned();
        self.log.add(now_s, level, WINDOW, &text);
        self.list.retain(|toast| toast.text != text);
        if self.list.len() >= MOST {
            self.list.remove(0);
        }
        self.last += 1;
        self.list.push(Toast { id: self.last, level, text, undoes: None, until_s: now_s + shown_s(level) });
    }

    /// A message of the step that led to this version of the document. It stays as long as a caution: there is something to decide.
    pub fn add_with_undo(&mut self, now_s: f64, text: impl Into<String>, version: u64) {
        self.add(now_s, Level::Info, text);
        if let Some(toast) = self.list.last_mut() {
            (toast.undoes, toast.until_s) = (Some(version), now_s + shown_s(Level::Caution));
        }
    }

    /// Only for the log.
    pub fn note(&mut self, now_s: f64, level: Level, text: &str) {
        self.log.add(now_s, level, WINDOW, text);
    }

    /// What these say is over: they go at once.
    pub fn withdraw(&mut self, is_over: impl Fn(&str) -> bool) {
        self.list.retain(|toast| !is_over(&toast.text));
    }

    /// One is being read: it stays.
    pub fn keep(&mut self, id: u64, now_s: f64) {
        for toast in self.list.iter_mut().filter(|toast| toast.id == id) {
            toast.until_s = now_s + shown_s(toast.level);
        }
    }

    /// One has been read.
    pub fn dismiss(&mut self, id: u64) {
        self.list.retain(|toast| toast.id != id);
    }

    /// Takes away those whose time is over. Returns how long the next one stays, seconds.
    pub fn tend(&mut self, now_s: f64) -> Option<f64> {
        self.list.retain(|toast| toast.until_s > now_s);
        self.list.iter().map(|toast| toast.until_s - now_s).min_by(f64::total_cmp)
    }

    /// Those that are shown, the oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &Toast> {
        self.list.iter()
    }

    /// What the window has said so far.
    pub fn log(&self) -> &Log {
        &self.log
    }
}

/// How long one is shown, seconds.
fn shown_s(level: Level) -> f64 {
    match level {
        Level::Info => 6.0,
        Level::Caution => 12.0,
        Level::Warning => 20.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(toasts: &Toasts) -> Vec<&str> {
        toasts.iter().map(|toast| toast.text.as_str()).collect()
    }

    #[test]
    fn they_go_by_themselves_and_stay_in_the_log() {
        let mut toasts = Toasts::default();
        toasts.add(0.0, Level::Info, "saved");
        toasts.add(1.0, Level::Caution, "lost");
        assert_eq!(toasts.tend(2.0), Some(4.0));
        assert_eq!(texts(&toasts), ["saved", "lost"]);
        assert_eq!(toasts.tend(7.0), Some(6.0));
        assert_eq!(texts(&toasts), ["lost"]);
        assert_eq!(toasts.tend(13.0), None);
        assert_eq!(toasts.log().len(), 2);
    }

    #[test]
    fn one_that_is_read_stays_and_one_that_was_read_goes() {
        let mut toasts = Toasts::default();
        toasts.add(0.0, Level::Info, "a");
        toasts.add(0.0, Level::Info, "b");
        toasts.keep(1, 5.0);
        toasts.tend(7.0);
        assert_eq!(texts(&toasts), ["a"]);
        toasts.dismiss(1);
        assert!(texts(&toasts).is_empty());
    }

    #[test]
    fn what_is_over_is_not_said_any_more() {
        let mut toasts = Toasts::default();
        toasts.add(0.0, Level::Caution, "a: lost");
        toasts.add(0.0, Level::Caution, "b: lost");
        toasts.withdraw(|text| text.starts_with("a: "));
        assert_eq!((texts(&toasts), toasts.log().len()), (vec!["b: lost"], 2));
    }

    #[test]
    fn a_flood_is_bounded_and_a_repetition_is_one() {
        let mut toasts = Toasts::default();
        (0..100).for_each(|n| toasts.add(0.0, Level::Info, format!("{n}")));
        assert_eq!(texts(&toasts), ["96", "97", "98", "99"]);
        toasts.add(1.0, Level::Info, "97");
        assert_eq!(texts(&toasts), ["96", "98", "99", "97"]);
    }
}
