//! What a demo tells whoever watches it: written by the flight's thread, read by the window.

use crate::jobs::{Job, Running};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Where the story has come to.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Chapter {
    /// What is happening.
    pub now: String,
    /// What comes next, if anything does.
    pub next: Option<String>,
    /// How it ended, once it has.
    pub end: Option<End>,
}

/// How a demo ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct End {
    /// As planned.
    pub good: bool,
    /// Its report, if there is one.
    pub report: Option<PathBuf>,
}

/// Shared by those who tell it and those who listen.
#[derive(Debug, Clone, Default)]
pub struct Story(Arc<Mutex<Told>>);

#[derive(Debug, Default)]
struct Told {
    chapter: Chapter,
    /// Work that the listener has not heard of yet.
    work: Vec<Job>,
    /// It is to be told once more, from the beginning.
    is_wanted_again: bool,
}

impl Story {
    /// What is happening now, and what comes next.
    pub fn tell(&self, now: &str, next: Option<&str>) {
        self.change(|chapter| (chapter.now, chapter.next) = (now.to_owned(), next.map(str::to_owned)));
    }

    /// It is over.
    pub fn end(&self, now: &str, end: End) {
        self.change(|chapter| *chapter = Chapter { now: now.to_owned(), next: None, end: Some(end) });
    }

    /// Where it has come to.
    pub fn chapter(&self) -> Chapter {
        self.told().chapter.clone()
    }

    /// Who listened wants to see it from the beginning.
    pub fn want_again(&self) {
        self.told().is_wanted_again = true;
    }

    /// Somebody wants to see it from the beginning.
    pub fn is_wanted_again(&self) -> bool {
        self.told().is_wanted_again
    }

    /// Work begins; it lasts as long as what this gives is held, and whoever listens shows it and may cancel it.
    pub fn work(&self, label: &str) -> Running {
        let (job, running) = Job::begin(label.to_owned());
        self.told().work.push(job);
        running
    }

    /// The work that has begun since this was asked last.
    pub fn take_work(&self) -> Vec<Job> {
        std::mem::take(&mut self.told().work)
    }

    fn change(&self, change: impl FnOnce(&mut Chapter)) {
        change(&mut self.told().chapter);
    }

    fn told(&self) -> MutexGuard<'_, Told> {
        // what is told is whole whatever happened to who told it
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
