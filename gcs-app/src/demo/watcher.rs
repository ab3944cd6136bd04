//! Whoever watches the flight in a window, as the flight sees them.

use crate::story::Story;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;

const NOBODY: u8 = 0;
const WATCHING: u8 = 1;
const LEFT: u8 = 2;
/// A closed window is noticed within this time, wall-clock.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Shared by the window's thread and the flight's.
#[derive(Debug)]
pub struct Watcher {
    state: AtomicU8,
    /// What the window tells them.
    pub story: Story,
}

impl Watcher {
    fn new(state: u8) -> Self {
        Self { state: AtomicU8::new(state), story: Story::default() }
    }

    /// A flight without a window.
    pub fn nobody() -> Self {
        Self::new(NOBODY)
    }

    /// A flight beside a window.
    pub fn someone() -> Self {
        Self::new(WATCHING)
    }

    /// The window could not be opened.
    pub fn give_up(&self) {
        self.state.store(NOBODY, Ordering::Relaxed);
    }

    /// The window was closed.
    pub fn leave(&self) {
        self.state.store(LEFT, Ordering::Relaxed);
    }

    /// A window is open: who sits before it may hold the aircraft as long as they like.
    pub fn is_watching(&self) -> bool {
        self.state.load(Ordering::Relaxed) == WATCHING
    }

    /// There was a window, and it was closed.
    pub fn has_left(&self) -> bool {
        self.state.load(Ordering::Relaxed) == LEFT
    }

    /// Waits until the window is closed; at once where there is none.
    pub async fn gone(&self) {
        while self.is_watching() {
            tokio::time::sleep(LOOK_EVERY).await;
        }
    }
}
