//! Long work on threads of its own: what is being done, how far it is, and whether it is still wanted.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Work that has lasted so long is shown, seconds: less would be a flicker.
const SHOWN_AFTER_S: f64 = 0.3;
/// Parts that progress is counted in.
const PARTS: u64 = 1000;

#[derive(Debug, Default)]
struct Shared {
    /// Parts that are done, plus one; 0: not known.
    parts: AtomicU32,
    cancelled: AtomicBool,
    ended: AtomicBool,
}

/// How far work is, seen from its thread and from the window. Work that ends before it is dropped has ended.
#[derive(Debug, Clone, Default)]
pub struct Progress(Arc<Shared>);

impl Progress {
    /// So much of all of it is done.
    pub fn set(&self, done: u64, all: u64) {
        let parts = PARTS * done.min(all) / all.max(1);
        self.0.parts.store(u32::try_from(parts).map_or(0, |parts| parts + 1), Ordering::Relaxed);
    }

    /// The share that is done, 0..=1, where it is known.
    pub fn share(&self) -> Option<f32> {
        self.0.parts.load(Ordering::Relaxed).checked_sub(1).map(|parts| parts as f32 / PARTS as f32)
    }

    /// Nobody waits for it any more.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }
}

/// Held by the thread while it works.
#[derive(Debug)]
pub struct Running {
    id: u64,
    progress: Progress,
}

impl Running {
    /// The work's number.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// For the thread to say how far it is.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.progress.0.ended.store(true, Ordering::Relaxed);
    }
}

/// Work that is being done.
#[derive(Debug)]
pub struct Job {
    /// Its number; no two are alike.
    pub id: u64,
    /// For people: what is being done.
    pub label: String,
    /// How far it is.
    pub progress: Progress,
    /// When the window saw it first, seconds of its clock.
    since_s: Option<f64>,
}

impl Job {
    /// Work that nobody sees yet: see [`Jobs::add`].
    pub fn begin(label: String) -> (Self, Running) {
        static LAST: AtomicU64 = AtomicU64::new(0);
        let id = LAST.fetch_add(1, Ordering::Relaxed) + 1;
        let progress = Progress::default();
        (Self { id, label, progress: progress.clone(), since_s: None }, Running { id, progress })
    }
}

/// All work that is being done, the oldest first.
#[derive(Debug, Default)]
pub struct Jobs(Vec<Job>);

impl Jobs {
    /// Work begins; it lasts as long as what this gives is held.
    pub fn begin(&mut self, label: String) -> Running {
        let (job, running) = Job::begin(label);
        self.add(job);
        running
    }

    /// Work that has begun elsewhere.
    pub fn add(&mut self, job: Job) {
        self.0.push(job);
    }

    /// Its result is no longer wanted.
    pub fn cancel(&mut self, id: u64) {
        for job in self.0.iter().filter(|job| job.id == id) {
            job.progress.0.cancelled.store(true, Ordering::Relaxed);
        }
        self.0.retain(|job| job.id != id);
    }

    /// Forgets what has ended. True: something is still being done.
    pub fn tend(&mut self, now_s: f64) -> bool {
        self.0.retain(|job| !job.progress.0.ended.load(Ordering::Relaxed));
        for job in &mut self.0 {
            job.since_s.get_or_insert(now_s);
        }
        !self.0.is_empty()
    }

    /// What has lasted long enough to be shown.
    pub fn lasting(&self, now_s: f64) -> impl Iterator<Item = &Job> {
        self.0.iter().filter(move |job| job.since_s.is_some_and(|since_s| now_s - since_s >= SHOWN_AFTER_S))
    }
}

/// Work on a thread of its own whose result a later frame takes. It is not shown: it mostly ends before anybody would read of it.
#[derive(Debug)]
pub struct Task<T>(Receiver<T>);

/// Wakes the window when it is dropped, also where the program fails.
struct Waker(Arc<dyn Fn() + Send + Sync>);

impl Drop for Waker {
    fn drop(&mut self) {
        (self.0)();
    }
}

/// How far a task is.
#[derive(Debug, PartialEq, Eq)]
pub enum Taken<T> {
    /// It goes on.
    NotYet,
    /// Its result.
    Done(T),
    /// It came to none: there was no thread for it, or the program failed at it.
    Failed,
}

impl<T: Send + 'static> Task<T> {
    /// Begins it; `wake` is called when it has ended, with a result or without.
    pub fn begin(wake: Arc<dyn Fn() + Send + Sync>, work: impl FnOnce() -> T + Send + 'static) -> Self {
        let (outbox, inbox) = channel();
        let waker = Waker(wake);
        let work = move || {
            // before its outbox, which is dropped first: who is woken finds what came of it, or that nothing did
            let _waker = waker;
            let results = outbox;
            // nobody may want it any more
            let _ = results.send(work());
        };
        let started = std::thread::Builder::new().name("task".into()).spawn(work);
        started.inspect_err(|error| tracing::warn!(%error, "no thread for a task")).ok();
        Self(inbox)
    }

    /// Its result, once.
    pub fn take(&self) -> Taken<T> {
        match self.0.try_recv() {
            Ok(result) => Taken::Done(result),
            Err(TryRecvError::Empty) => Taken::NotYet,
            Err(TryRecvError::Disconnected) => Taken::Failed,
        }
    }
}

/// Frees on another thread what is so large that freeing it takes longer than a frame has.
pub fn discard(what: impl Send + 'static) {
    let started = std::thread::Builder::new().name("discard".into()).spawn(move || drop(what));
    started.inspect_err(|error| tracing::warn!(%error, "no thread to free memory on")).ok();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(jobs: &Jobs, now_s: f64) -> Vec<&str> {
        jobs.lasting(now_s).map(|job| job.label.as_str()).collect()
    }

    #[test]
    fn work_is_shown_while_it_lasts_and_not_for_a_moment() {
        let mut jobs = Jobs::default();
        let running = jobs.begin("Reading a.kml".into());
        assert!(jobs.tend(10.0) && shown(&jobs, 10.1).is_empty());
        assert_eq!(shown(&jobs, 10.5), ["Reading a.kml"]);
        drop(running);
        assert!(!jobs.tend(11.0) && shown(&jobs, 11.0).is_empty());
    }

    #[test]
    fn cancelled_work_learns_it() {
        let mut jobs = Jobs::default();
        let (first, second) = (jobs.begin("a".into()), jobs.begin("b".into()));
        jobs.tend(0.0);
        jobs.cancel(first.id());
        assert!(first.progress().is_cancelled() && !second.progress().is_cancelled());
        assert_eq!(shown(&jobs, 1.0), ["b"]);
    }

    #[test]
    fn a_task_gives_its_result_or_says_that_there_is_none() {
        for fails in [false, true] {
            let (open, gate) = channel::<()>();
            let (wake, woken) = channel();
            let wake: Arc<dyn Fn() + Send + Sync> = Arc::new(move || wake.send(()).unwrap_or_default());
            let task = Task::begin(wake, move || {
                gate.recv().unwrap();
                if fails {
                    // as a panic, but without a word
                    std::panic::resume_unwind(Box::new("a fault of the program"));
                }
                7
            });
            assert_eq!(task.take(), Taken::NotYet);
            open.send(()).unwrap();
            woken.recv().expect("who waits for it is woken, also where there is no result");
            assert_eq!(task.take(), if fails { Taken::Failed } else { Taken::Done(7) });
        }
    }

    #[test]
    fn progress_is_a_share_or_not_known() {
        let progress = Progress::default();
        assert_eq!(progress.share(), None);
        for (done, all, share) in [(0, 10, 0.0), (5, 10, 0.5), (20, 10, 1.0), (0, 0, 0.0)] {
            progress.set(done, all);
            assert_eq!(progress.share(), Some(share), "{done} of {all}");
        }
    }
}
