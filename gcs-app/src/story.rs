//! What a demo tells whoever watches it: written by the flight's thread, read by the window.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

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
pub struct Story(Arc<Mutex<Chapter>>);

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
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn change(&self, change: impl FnOnce(&mut Chapter)) {
        // a chapter is whole whatever happened to who wrote it
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
