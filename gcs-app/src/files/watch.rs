//! Notices that a file was changed by another program, on a thread of its own.

use super::{FileEvent, Stamp};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// So often the file is looked at.
const PERIOD: Duration = Duration::from_secs(1);

/// A file, and its state as the window knows it.
pub type Watched = (PathBuf, Stamp);

/// Looks at one file.
pub(super) struct Watch {
    orders: Sender<Option<Watched>>,
    /// What it was told last.
    watched: Option<Watched>,
}

impl Watch {
    /// `tell` is called once when the file is no longer as it was. The thread ends with the value.
    pub fn spawn(tell: Arc<dyn Fn(FileEvent) + Send + Sync>) -> Self {
        let (orders, inbox) = channel();
        let work = move || watch(&inbox, tell.as_ref());
        if let Err(error) = std::thread::Builder::new().name("watch".into()).spawn(work) {
            tracing::warn!(%error, "no thread to watch a file");
        }
        Self { orders, watched: None }
    }

    /// Which file it looks at from now on, if any.
    pub fn look_at(&mut self, file: Option<Watched>) {
        if self.watched != file {
            self.watched.clone_from(&file);
            // a thread that could not be started looks at nothing
            let _ = self.orders.send(file);
        }
    }
}

fn watch(inbox: &Receiver<Option<Watched>>, tell: &dyn Fn(FileEvent)) {
    let mut watched = None;
    loop {
        match inbox.recv_timeout(PERIOD) {
            Ok(order) => watched = order,
            Err(RecvTimeoutError::Timeout) => {
                let changed = |(path, stamp): &mut Watched| Stamp::of(path) != Some(*stamp);
                if let Some((path, known)) = watched.take_if(changed) {
                    let stamp = Stamp::of(&path);
                    tell(FileEvent::ChangedOutside { path, known, stamp });
                }
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}
