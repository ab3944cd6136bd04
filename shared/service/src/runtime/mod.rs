//! The one loop that owns a service's session, clock, queues and disk.
//!
//! The service is stepped by whatever happens, and at each beat: on the machine's time every 50 ms, in lockstep at each
//! tick. So a service that waits for an instant is at most 50 ms late, and needs no `deadline()`. With 20 beats a second an
//! idle service takes 0.6 % of a core (release build, its network threads included).

mod lockstep;
mod opening;
mod step;

use crate::board::Board;
use crate::clock::Clock;
use crate::folder::Folder;
use crate::statistics::Statistics;
use crate::wiring::Ports;
use crate::{Adapter, Service, Shutdown, Tasks, Time, Wiring};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;
use tokio::sync::Notify;
use tokio::task::{JoinHandle, JoinSet};
use usal::{Announcement, EventPublisher, Senders, Session, Untyped};

/// After so many inputs from the network, the clock is looked at.
const INPUTS_MAX: usize = 256;

/// A service that runs.
pub struct Runtime<S: Service, A> {
    service: S,
    adapter: A,
    session: Session,
    clock: Clock,
    notify: Arc<Notify>,
    wiring: Wiring<S::Input>,
    ports: Ports<S::Input>,
    /// Whom it hears of those who speak as a service.
    senders: Arc<Senders>,
    board: Board,
    emitters: BTreeMap<&'static str, EventPublisher<Untyped>>,
    folder: Folder,
    tasks: Tasks<S::Input>,
    /// Questions to others on their way.
    calls: JoinSet<S::Input>,
    statistics: Statistics,
    /// When the simulated time was led on last, wall-clock.
    led: Instant,
    failed: Option<anyhow::Error>,
    /// It was asked to end.
    ending: bool,
    _books: Books,
    _announcement: Announcement,
}

/// The tasks that keep the books; they end with the service.
struct Books(Vec<JoinHandle<()>>);

impl Drop for Books {
    fn drop(&mut self) {
        self.0.iter().for_each(JoinHandle::abort);
    }
}

/// What comes next.
enum Next<I> {
    Shutdown,
    EndNow,
    Beat(Option<Time>),
    Network,
    Input(I),
}

impl<S: Service, A: Adapter<S>> Runtime<S, A> {
    /// Turns until it is asked to end.
    ///
    /// # Errors
    /// The service has failed, or the session was closed.
    pub async fn turn_until(&mut self, shutdown: &mut Shutdown) -> anyhow::Result<()> {
        if let Some(input) = self.wiring.started.as_ref().map(|started| started()) {
            self.step(input).await;
        }
        loop {
            if let Some(error) = self.failed.take() {
                return Err(error);
            }
            if self.ending && self.service.may_end() {
                return Ok(());
            }
            match self.next(shutdown).await {
                Next::Shutdown => self.end_soon(),
                Next::EndNow => return Ok(()),
                Next::Beat(None) => anyhow::bail!("the network session was closed"),
                Next::Beat(Some(_)) => self.beat().await?,
                Next::Network => self.network().await,
                Next::Input(input) => self.happened(input).await,
            }
        }
    }

    fn end_soon(&mut self) {
        self.ending = true;
        if !self.service.may_end() {
            tracing::warn!("asked to end, the service `{}` stays for as long as it is needed", S::SPEC.name);
        }
    }

    async fn next(&mut self, shutdown: &mut Shutdown) -> Next<S::Input> {
        let held_until = self.tasks.holds_time_until();
        let mut ask = shutdown.clone();
        tokio::select! {
            () = ask.requested(), if !self.ending => Next::Shutdown,
            () = shutdown.insisted() => Next::EndNow,
            beat = next_beat(&mut self.clock, held_until) => Next::Beat(beat),
            () = self.notify.notified() => Next::Network,
            input = self.adapter.next() => Next::Input(input),
            input = self.tasks.next() => Next::Input(input),
            Some(Ok(input)) = self.calls.join_next() => Next::Input(input),
        }
    }

    /// What the network brought.
    async fn network(&mut self) {
        for _ in 0..INPUTS_MAX {
            match self.ports.prompt() {
                // only an adapter's input leads the time
                Some(input) => drop(self.step(input).await),
                None => return,
            }
            self.publish_at_once();
        }
        self.notify.notify_one();
    }

    async fn happened(&mut self, input: S::Input) {
        let mut time = self.step(input).await;
        while let Some(led_to) = time {
            time = self.lead(led_to).await;
        }
        self.publish_at_once();
    }

    /// Everything due at a beat of the clock.
    async fn beat(&mut self) -> anyhow::Result<()> {
        anyhow::ensure!(!self.session.is_closed(), "the network session was closed");
        self.network().await;
        if matches!(self.clock, Clock::Leads(_)) {
            self.wait().await;
        } else {
            self.sample().await;
            self.tick().await;
        }
        if matches!(self.clock, Clock::Follows(_)) {
            self.await_answers().await;
        }
        self.publish();
        self.look_after_folder().await;
        self.statistics.tell_sometimes(S::SPEC.name, || self.session.health());
        self.clock.acknowledge();
        Ok(())
    }

    async fn sample(&mut self) {
        for input in self.ports.sampled() {
            self.step(input).await;
        }
        for (service, count) in self.senders.take_strange() {
            self.statistics.strange += count;
            if let Some(input) = self.wiring.strangers.as_ref().map(|strangers| strangers(service, count)) {
                self.step(input).await;
            }
        }
    }

    async fn tick(&mut self) {
        if let Some(input) = self.wiring.tick.as_ref().map(|tick| tick()) {
            self.step(input).await;
        }
    }

    /// Ends the service: what it still wants is done.
    pub async fn end(&mut self) {
        if let Some(input) = self.wiring.ended.as_ref().map(|ended| ended()) {
            self.step(input).await;
        }
        self.adapter.finish().await;
        self.folder.finish().await;
        self.statistics.tell(S::SPEC.name, self.session.health());
    }
}

/// The next beat; in lockstep, work that is under way is waited for first.
async fn next_beat(clock: &mut Clock, held_until: Option<tokio::time::Instant>) -> Option<Time> {
    if let Some(until) = held_until.filter(|_| matches!(clock, Clock::Follows(_))) {
        tokio::time::sleep_until(until).await;
    }
    clock.beat().await
}
