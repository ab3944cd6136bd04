//! Asking a service to end.

use tokio::sync::watch;

/// How urgently it is to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Wish {
    Run,
    End,
    EndNow,
}

/// Ends the services that hold its [`Shutdown`], when asked to or when dropped.
#[derive(Debug)]
pub struct Trigger(watch::Sender<Wish>);

/// Told when to end; cheap to clone.
#[derive(Debug, Clone)]
pub struct Shutdown(watch::Receiver<Wish>);

/// A trigger and what it triggers.
pub fn shutdown() -> (Trigger, Shutdown) {
    let (sender, receiver) = watch::channel(Wish::Run);
    (Trigger(sender), Shutdown(receiver))
}

impl Trigger {
    /// Asks them to end. One that may not yet ([`crate::Service::may_end`]) ends as soon as it may.
    pub fn shut_down(&self) {
        self.wish(Wish::End);
    }

    /// Ends them at once.
    pub fn insist(&self) {
        self.wish(Wish::EndNow);
    }

    fn wish(&self, wish: Wish) {
        self.0.send_modify(|before| *before = wish.max(*before));
    }
}

impl Shutdown {
    /// Waits until it is time to end. May be cancelled and called again.
    pub async fn requested(&mut self) {
        self.wished(Wish::End).await;
    }

    /// Waits until it is time to end whatever happens. May be cancelled and called again.
    pub async fn insisted(&mut self) {
        self.wished(Wish::EndNow).await;
    }

    async fn wished(&mut self, least: Wish) {
        // an error means that the trigger was dropped
        let _ = self.0.wait_for(|wish| *wish >= least).await;
    }
}
