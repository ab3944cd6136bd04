//! Shell: the thread that owns the disk, and the handle to it. The flight waits for the disk where it must, and
//! never long: a slow disk is a trouble that is reported, not one that is flown into.

use super::storage::Storage;
use super::writer::{Job, Report, Writer};
use anyhow::Context;
use flight_exec::Event;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// The flight waits for the disk so long at most.
const PATIENCE: Duration = Duration::from_millis(500);
/// A proposal waits for its document so long at most.
const DOCUMENT_PATIENCE: Duration = Duration::from_secs(60);
/// More than this does not wait for a disk, bytes.
const WAITING_MAX: usize = 8 << 20;

/// The journal, as the flight sees it.
pub struct JournalHandle {
    queue: Arc<JobQueue>,
    progress: watch::Receiver<Progress>,
    /// Number of the last job given.
    given: u64,
    /// Number of the last state given.
    state: u64,
    /// The disk was too slow, and has not caught up.
    behind: bool,
    /// Whether trouble was reported last.
    reported: bool,
}

#[derive(Debug, Clone, Default)]
struct Progress {
    /// Number of the last job done.
    done: u64,
    /// But for a document.
    writing: bool,
    report: Report,
}

/// Where the thread finds its jobs.
#[derive(Default)]
struct JobQueue {
    slot: Mutex<Slot>,
    changed: Condvar,
}

#[derive(Default)]
struct Slot {
    jobs: Vec<Job>,
    bytes: usize,
    last: u64,
    overrun: bool,
    closed: bool,
}

impl JournalHandle {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start<S: Storage + Send + 'static>(writer: Writer<S>) -> anyhow::Result<Self> {
        let queue = Arc::<JobQueue>::default();
        let report = writer.report(Duration::ZERO);
        let (sender, progress) = watch::channel(Progress { done: 0, writing: false, report });
        let theirs = queue.clone();
        std::thread::Builder::new()
            .name("fp-manager-disk".into())
            .spawn(move || work(writer, &theirs, &sender))
            .context("the thread that writes the journal")?;
        Ok(Self { queue, progress, given: 0, state: 0, behind: false, reported: false })
    }

    /// Has a job done, after those given before.
    pub fn give(&mut self, job: Job) {
        self.given += 1;
        if matches!(job, Job::State(..)) {
            self.state = self.given;
        }
        let mut slot = self.queue.lock();
        slot.last = self.given;
        slot.bytes += job.bytes();
        if slot.bytes > WAITING_MAX {
            slot.jobs.clear();
            slot.overrun = true;
        } else {
            slot.jobs.push(job);
        }
        drop(slot);
        self.queue.changed.notify_one();
    }

    /// Has a proposal's document on the disk, while the flight goes on; the future ends when it is there, when the disk
    /// failed, or when it takes all too long.
    pub fn keep(&mut self, hash: Arc<str>, xml: Vec<u8>) -> impl Future<Output = ()> + Send + use<> {
        self.give(Job::Document { hash, xml });
        let (given, mut progress) = (self.given, self.progress.clone());
        async move {
            let kept = progress.wait_for(|progress| progress.done >= given && !progress.writing);
            if tokio::time::timeout(DOCUMENT_PATIENCE, kept).await.is_err() {
                tracing::warn!("the disk is slow: a proposal's document takes too long to be kept");
            }
        }
    }

    /// Something could not even be given: only a new state helps.
    pub fn lose(&mut self) {
        self.given += 1;
        let mut slot = self.queue.lock();
        slot.last = self.given;
        slot.overrun = true;
        drop(slot);
        self.queue.changed.notify_one();
    }

    /// Waits until everything given is done, but not for long.
    pub async fn done(&mut self) {
        let given = self.given;
        if self.progress.borrow().done >= given {
            self.behind = false;
        } else if !self.behind {
            let done = self.progress.wait_for(|progress| progress.done >= given);
            // a thread that is gone will never be done
            let late = !matches!(tokio::time::timeout(PATIENCE, done).await, Ok(Ok(_)));
            self.behind = late;
            if late {
                tracing::warn!("the disk is slow: what happens takes effect before it is recorded");
            }
        }
    }

    /// A state should be handed in, and none is on its way.
    pub fn wants_state(&self) -> bool {
        let progress = self.progress.borrow();
        progress.report.wants_state && progress.done >= self.state
    }

    /// What has to be reported: that recording stopped, or that it is back.
    pub fn state_event(&mut self) -> Option<Event> {
        let progress = self.progress.borrow();
        let slow =
            || self.behind.then(|| "the disk is slow: check the disk of the state directory".to_owned());
        let trouble = progress.report.trouble.clone().or_else(slow);
        drop(progress);
        match (trouble, std::mem::take(&mut self.reported)) {
            (Some(reason), reported) => {
                self.reported = true;
                (!reported).then_some(Event::NotJournalled { reason })
            }
            (None, reported) => reported.then_some(Event::Journalled),
        }
    }
}

impl Drop for JournalHandle {
    fn drop(&mut self) {
        self.queue.lock().closed = true;
        self.queue.changed.notify_one();
    }
}

impl JobQueue {
    fn lock(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for jobs, or until `wait` is over: those there are, the number of the last, and whether some were lost.
    /// `None` when there will be no more.
    fn take(&self, wait: Option<Duration>) -> Option<(Vec<Job>, u64, bool)> {
        let idle = |slot: &mut Slot| slot.jobs.is_empty() && !slot.overrun && !slot.closed;
        let mut slot = match wait {
            None => self.changed.wait_while(self.lock(), idle).unwrap_or_else(PoisonError::into_inner),
            Some(wait) => {
                let waited = self.changed.wait_timeout_while(self.lock(), wait, idle);
                waited.unwrap_or_else(PoisonError::into_inner).0
            }
        };
        if slot.closed && slot.jobs.is_empty() {
            return None;
        }
        slot.bytes = 0;
        Some((std::mem::take(&mut slot.jobs), slot.last, std::mem::take(&mut slot.overrun)))
    }
}

fn work<S: Storage>(mut writer: Writer<S>, queue: &JobQueue, progress: &watch::Sender<Progress>) {
    let start = Instant::now();
    loop {
        let due = writer.due().map(|due| due.saturating_sub(start.elapsed()));
        let wait = if writer.is_writing() { Some(Duration::ZERO) } else { due };
        let Some((jobs, last, overrun)) = queue.take(wait) else { break };
        let now = start.elapsed();
        if overrun {
            writer.overrun(now);
        }
        writer.perform(now, jobs);
        let report = writer.report(now);
        progress.send_replace(Progress { done: last, writing: writer.is_writing(), report });
        if writer.is_writing() {
            writer.write_piece();
            progress.send_modify(|progress| progress.writing = writer.is_writing());
        }
    }
    writer.finish(start.elapsed());
}
