//! One step of the service, and all it leads to.

use super::Runtime;
use crate::clock::Clock;
use crate::{Adapter, Out, Service, Time};
use std::time::Instant;

impl<S: Service, A: Adapter<S>> Runtime<S, A> {
    /// A step of the service, and all it leads to.
    pub(super) async fn step(&mut self, input: S::Input) -> Option<Time> {
        let begun = Instant::now();
        let mut out = Out::new(self.clock.now());
        self.service.step(self.clock.now(), input, &mut out);
        let leads_to = out.leads_to;
        self.carry_out(out).await;
        self.tasks.look();
        self.statistics.step(begun.elapsed());
        leads_to
    }

    async fn carry_out(&mut self, mut out: Out<S::Input, S::Output>) {
        let leaves = out.leaves();
        for (service, session) in std::mem::take(&mut out.hears) {
            self.senders.is_known(service, session);
        }
        if !out.own.is_empty() {
            let outputs = std::mem::take(&mut out.own);
            self.adapter.perform(self.clock.now(), outputs, leaves, &mut self.tasks).await;
        }
        if !(out.events.is_empty() && out.answers.is_empty()) {
            self.board.hurry();
        }
        self.statistics.events += out.events.len() as u64;
        self.statistics.answers += out.answers.len() as u64;
        for emission in &out.events {
            match self.emitters.get(emission.name) {
                Some(emitter) => emission.by(emitter),
                None => tracing::error!("`{}` isn't in the service's declaration", emission.name),
            }
        }
        for question in out.questions {
            self.calls.spawn(question(&self.session));
        }
        for question in out.unasked {
            tokio::spawn(question(&self.session));
        }
        out.work.into_iter().for_each(|work| self.tasks.wait(work));
        if !out.answers.is_empty() {
            // who has its answer sees what it did
            self.publish_at_once();
        }
        self.keep(out.kept, out.wait_for_disk).await;
        out.answers.into_iter().for_each(|answer| answer());
        self.failed = self.failed.take().or(out.failed);
    }

    async fn keep(&mut self, kept: Vec<crate::out::Kept>, wait: bool) {
        for file in kept {
            self.folder.keep(file.name, file.bytes);
        }
        if wait {
            self.folder.settle().await;
        }
    }

    /// Goes on with writing, and tells the service when that fails or succeeds again.
    pub(super) async fn look_after_folder(&mut self) {
        self.folder.work().await;
        if let Some(kept) = self.folder.news()
            && let Some(input) = self.wiring.kept.as_ref().map(|input| input(kept))
        {
            self.step(input).await;
        }
    }

    /// Who follows the simulator's time shows its variables at its beats, so that a flight is the same each time.
    pub(super) fn publish_at_once(&mut self) {
        if !matches!(self.clock, Clock::Follows(_)) {
            self.publish();
        }
    }

    pub(super) fn publish(&mut self) {
        let now = self.clock.now();
        self.board.begin(now);
        self.service.publish(now, &mut self.board);
        self.board.end();
    }
}
