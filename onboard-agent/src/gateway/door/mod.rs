//! Shell: the port that everybody reaches. Zenoh itself listens inside, where only the vehicle's own services come; here
//! connections are counted, and carried to it as long as they behave.
//!
//! Zenoh's own limits know neither addresses nor a reserve: a hundred idle connections would lock everybody out.

mod batches;
mod guests;
#[cfg(test)]
mod tests;
mod visit;

use crate::inside::Address;
use anyhow::Context;
use guests::{Guests, Id, Input};
use std::collections::HashMap;
use std::future::pending;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{mpsc, watch};
use tokio::task::{AbortHandle, JoinSet};
use tokio::time::Instant;
use visit::Visit;

/// Reports of connections that wait for being taken in; the connections wait with them.
const REPORTS: usize = 64;
/// If no connection can be taken (there are too many files open), the next is tried after this time.
const ACCEPT_AGAIN: Duration = Duration::from_millis(100);
/// After the door was closed the hub has so long for its last words.
const LAST_WORDS: Duration = Duration::from_secs(5);

/// The door. When it is dropped, nobody comes in any more; who is inside hears the hub's last words, and goes with it.
pub struct Door {
    flooded: watch::Receiver<bool>,
}

impl Door {
    /// Listens on `tcp/HOST:PORT` for the hub that listens at `hub`.
    ///
    /// # Errors
    /// The endpoint can't be used.
    pub async fn open(listen: &str, hub: &Address) -> anyhow::Result<Self> {
        let advice = "write it as tcp/127.0.0.1:7447 and check that nothing else listens there";
        let address = listen.strip_prefix("tcp/");
        let address = address.with_context(|| format!("endpoint `{listen}`: not TCP; {advice}"))?;
        let listener = TcpListener::bind(address).await;
        let listener = listener.with_context(|| format!("endpoint `{listen}`: {advice}"))?;
        let (told, flooded) = watch::channel(false);
        tokio::spawn(Keeper::new(listener, hub.clone(), told).keep());
        Ok(Self { flooded })
    }

    /// Whether somebody floods the port, each time when that changes. May be cancelled.
    pub async fn changed(&mut self) -> bool {
        match self.flooded.changed().await {
            Ok(()) => *self.flooded.borrow_and_update(),
            Err(_) => pending().await,
        }
    }
}

/// Who keeps it.
struct Keeper {
    listener: TcpListener,
    hub: Address,
    guests: Guests,
    began: Instant,
    next: Id,
    visits: JoinSet<Id>,
    handles: HashMap<Id, AbortHandle>,
    reports: (mpsc::Sender<Input>, mpsc::Receiver<Input>),
    told: watch::Sender<bool>,
}

impl Keeper {
    fn new(listener: TcpListener, hub: Address, told: watch::Sender<bool>) -> Self {
        Self {
            listener,
            hub,
            guests: Guests::default(),
            began: Instant::now(),
            next: 0,
            visits: JoinSet::new(),
            handles: HashMap::new(),
            reports: mpsc::channel(REPORTS),
            told,
        }
    }

    async fn keep(mut self) {
        loop {
            let due = self.guests.deadline().map(|due| self.began + due);
            let input = tokio::select! {
                came = self.listener.accept() => match came {
                    Ok((client, from)) => Input::Came(self.attend(client), from.ip()),
                    Err(error) => {
                        tracing::warn!(%error, "a connection can't be taken");
                        tokio::time::sleep(ACCEPT_AGAIN).await;
                        Input::Tick
                    }
                },
                Some(report) = self.reports.1.recv() => report,
                Some(ended) = self.visits.join_next() => ended.map_or(Input::Tick, Input::Gone),
                () = until(due) => Input::Tick,
                () = self.told.closed() => return self.close().await,
            };
            self.step(input);
        }
    }

    /// The port is free, and those inside go on until the hub ends, or for a while.
    async fn close(self) {
        let Self { listener, mut visits, reports, .. } = self;
        drop((listener, reports));
        let ended = async { while visits.join_next().await.is_some() {} };
        // who is left is cut off
        let _ = tokio::time::timeout(LAST_WORDS, ended).await;
    }

    fn attend(&mut self, client: TcpStream) -> Id {
        self.next += 1;
        let id = self.next;
        let visit = Visit { id, client, hub: self.hub.clone(), reports: self.reports.0.clone() };
        let handle = self.visits.spawn(async move {
            if let Err(error) = visit.attend().await {
                tracing::debug!(id, %error, "a connection ended");
            }
            id
        });
        self.handles.insert(id, handle);
        id
    }

    fn step(&mut self, input: Input) {
        if let Input::Gone(id) = input {
            self.handles.remove(&id);
        }
        for id in self.guests.step(self.began.elapsed(), input) {
            if let Some(handle) = self.handles.remove(&id) {
                handle.abort();
            }
        }
        let flooded = self.guests.is_flooded();
        if self.told.send_if_modified(|told| std::mem::replace(told, flooded) != flooded) {
            self.log(flooded, input);
        }
    }

    fn log(&self, flooded: bool, input: Input) {
        let turned_away = self.guests.count();
        match input {
            _ if !flooded => tracing::info!(turned_away, "nobody floods the port any more"),
            Input::Came(_, from) => tracing::warn!(turned_away, %from, "somebody floods the port"),
            _ => tracing::warn!(turned_away, "somebody floods the port"),
        }
    }
}

async fn until(due: Option<Instant>) {
    match due {
        Some(due) => tokio::time::sleep_until(due).await,
        None => pending().await,
    }
}
