//! Asking a service to end.

use tokio::sync::watch;

/// Ends the services that hold its [`Shutdown`], when asked to or when dropped.
#[derive(Debug)]
pub struct Trigger(watch::Sender<bool>);

/// Told when to end; cheap to clone.
#[derive(Debug, Clone)]
pub struct Shutdown(watch::Receiver<bool>);

/// A trigger and what it triggers.
pub fn shutdown() -> (Trigger, Shutdown) {
    let (sender, receiver) = watch::channel(false);
    (Trigger(sender), Shutdown(receiver))
}

impl Trigger {
    /// Ends them.
    pub fn shut_down(&self) {
        self.0.send_replace(true);
    }
}

impl Shutdown {
    /// Waits until it is time to end. May be cancelled and called again.
    pub async fn requested(&mut self) {
        // an error means that the trigger was dropped
        let _ = self.0.wait_for(|end| *end).await;
    }
}
