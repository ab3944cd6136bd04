//! The file of the settings. The window's library writes it on a thread, and before it writes again it waits for that thread: a home that
//! hangs would stop the window. So nothing more is to be written until the disk has taken what was.

use crate::jobs::{Taken, Task};
use std::fs::File;
use std::sync::Arc;

/// The file in the folder of the program's own, as the library calls it.
const FILE: &str = "app.ron";

/// What is known of that file.
pub(super) struct Settings {
    /// Waits until the disk has taken what was written.
    sync: Arc<dyn Fn() + Send + Sync>,
    /// `None`: nothing was written.
    written: Option<Task<()>>,
}

impl Settings {
    /// Of this user.
    pub fn new() -> Self {
        let file = eframe::storage_dir("legwork").map(|folder| folder.join(FILE));
        let sync = move || {
            // where there is no file, or one that can't be synced, nothing is waited for
            let _ = file.as_ref().map(|file| File::open(file).and_then(|file| file.sync_all()));
        };
        Self::synced_by(Arc::new(sync))
    }

    /// That wait for the disk like this.
    pub fn synced_by(sync: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self { sync, written: None }
    }

    /// They are being written; `wake` is called when the disk has taken them.
    pub fn write(&mut self, wake: &Arc<dyn Fn() + Send + Sync>) {
        let sync = self.sync.clone();
        self.written = Some(Task::begin(wake.clone(), move || sync()));
    }

    /// The disk has taken all that was written: nobody waits if it is written again.
    pub fn are_taken(&self) -> bool {
        self.written.as_ref().is_none_or(|written| written.take() != Taken::NotYet)
    }
}
