//! The thread that records: nobody waits for it, and nobody but it waits for the disk.

use super::disk::{Disk, SyncCost};
use recording::{Config, Frame, Input, Level, Limits, Output, Payload, Recorder, Schema, Status};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

/// Frames that may wait for the disk.
const QUEUE: usize = 16 << 10;
/// And their bytes.
const QUEUE_BYTES: usize = 64 << 20;
/// The time of day is looked at so often.
const CLOCK_EVERY: Duration = Duration::from_secs(1);

/// How the recording goes, as seen from outside of the thread.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Progress {
    /// As the recorder sees it.
    pub status: Status,
    /// What syncing costs.
    pub cost: SyncCost,
    /// The files of this run.
    pub files: Vec<PathBuf>,
}

/// Where everybody puts what is to be recorded; cheap to clone. Never blocks: what finds no room is counted.
#[derive(Clone)]
pub struct Inlet {
    sender: SyncSender<Input>,
    shared: Arc<Shared>,
}

struct Shared {
    began: Instant,
    /// Simulated time, nanoseconds; `None`: time is the machine's.
    simulated_ns: Option<AtomicU64>,
    waiting_bytes: AtomicUsize,
    missed: AtomicU64,
    progress: Mutex<Progress>,
}

impl Inlet {
    /// Something was said now.
    pub fn say(&self, key: String, payload: Payload) {
        self.put(Input::Frame(Frame { key, at: self.now(), payload }));
    }

    /// Something was said now that every file has to know.
    pub fn document(&self, key: String, payload: Payload) {
        self.put(Input::Document(Frame { key, at: self.now(), payload }));
    }

    /// The simulator's clock says this; nobody listens where time is the machine's.
    pub fn simulated_time(&self, time: Duration) {
        if let Some(simulated_ns) = &self.shared.simulated_ns {
            simulated_ns.store(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX), Ordering::Relaxed);
        }
    }

    fn now(&self) -> Duration {
        let simulated = self.shared.simulated_ns.as_ref();
        simulated.map_or_else(
            || self.shared.began.elapsed(),
            |ns| Duration::from_nanos(ns.load(Ordering::Relaxed)),
        )
    }

    /// The plan as a drawing (GeoJSON).
    pub fn plan(&self, geojson: String) {
        self.put(Input::Plan(geojson));
    }

    /// A line for the log.
    pub fn line(&self, level: Level, message: String) {
        self.put(Input::Line { level, message });
    }

    /// Frames were lost before they came here.
    pub fn missed(&self, count: u64) {
        self.shared.missed.fetch_add(count, Ordering::Relaxed);
    }

    /// How the recording goes.
    pub fn progress(&self) -> Progress {
        self.shared.progress.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn put(&self, input: Input) {
        let bytes = size(&input);
        let waiting = self.shared.waiting_bytes.fetch_add(bytes, Ordering::Relaxed);
        let no_room = waiting + bytes > QUEUE_BYTES;
        if no_room || self.sender.try_send(input).is_err() {
            self.shared.waiting_bytes.fetch_sub(bytes, Ordering::Relaxed);
            self.missed(1);
        }
    }
}

/// What an input takes of the queue's bytes.
fn size(input: &Input) -> usize {
    match input {
        Input::Frame(frame) | Input::Document(frame) => frame.payload.len(),
        Input::Plan(geojson) => geojson.len(),
        _ => 0,
    }
}

/// The thread; ends the recording when it is closed or dropped.
pub struct Writer {
    inlet: Inlet,
    thread: Option<JoinHandle<()>>,
}

impl Writer {
    /// Begins to record into a folder, which is made if need be.
    ///
    /// # Errors
    /// The thread can't be made.
    pub fn start(
        folder: &Path,
        config: Config,
        limits: Limits,
        schemas: Vec<Schema>,
        simulated: bool,
    ) -> io::Result<Self> {
        let (sender, receiver) = sync_channel(QUEUE);
        let shared = Arc::new(Shared {
            began: Instant::now(),
            simulated_ns: simulated.then(AtomicU64::default),
            waiting_bytes: AtomicUsize::default(),
            missed: AtomicU64::default(),
            progress: Mutex::default(),
        });
        let inlet = Inlet { sender, shared: shared.clone() };
        let hand = Hand {
            recorder: Recorder::new(config),
            disk: Disk::new(folder, limits),
            began: shared.began,
            shared,
            clock_due: Duration::ZERO,
            folder: folder.into(),
        };
        let thread = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || hand.write(&receiver, schemas))?;
        Ok(Self { inlet, thread: Some(thread) })
    }

    /// Where to put what is to be recorded.
    pub fn inlet(&self) -> Inlet {
        self.inlet.clone()
    }

    /// Records what waits, and ends the file; gives how it went.
    pub fn close(mut self) -> Progress {
        self.end();
        self.inlet.progress()
    }

    fn end(&mut self) {
        // there is room sooner or later, or nobody is there any more
        let _ = self.inlet.sender.send(Input::Close);
        if self.thread.take().is_some_and(|thread| thread.join().is_err()) {
            tracing::error!("the recorder's thread has crashed");
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        if self.thread.is_some() {
            self.end();
        }
    }
}

/// What the thread has.
struct Hand {
    recorder: Recorder,
    disk: Disk,
    shared: Arc<Shared>,
    began: Instant,
    clock_due: Duration,
    folder: PathBuf,
}

impl Hand {
    fn write(mut self, inputs: &Receiver<Input>, schemas: Vec<Schema>) {
        schemas.into_iter().for_each(|schema| self.step(Input::Schema(schema)));
        loop {
            self.regular();
            let now = self.began.elapsed();
            let due = self.recorder.deadline().unwrap_or(self.clock_due).min(self.clock_due);
            let input = match inputs.recv_timeout(due.saturating_sub(now)) {
                Ok(input) => input,
                Err(RecvTimeoutError::Timeout) => Input::Wake,
                Err(RecvTimeoutError::Disconnected) => Input::Close,
            };
            self.shared.waiting_bytes.fetch_sub(size(&input), Ordering::Relaxed);
            let is_over = matches!(input, Input::Close);
            self.step(input);
            if is_over {
                return self.report();
            }
        }
    }

    /// What comes round by itself: the time of day, what was missed, how it goes.
    fn regular(&mut self) {
        let now = self.began.elapsed();
        if now < self.clock_due {
            return;
        }
        self.clock_due = now + CLOCK_EVERY;
        let unix = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        self.step(Input::Clock(unix));
        let count = self.shared.missed.swap(0, Ordering::Relaxed);
        if count > 0 {
            self.step(Input::Missed { count, why: "the recorder did not keep up" });
        }
        self.report();
    }

    fn step(&mut self, input: Input) {
        let now = self.began.elapsed();
        let mut out = Vec::new();
        self.recorder.step(now, input, &mut out);
        for output in out {
            match output {
                Output::Tell(report) => tracing::warn!("{report}"),
                output => {
                    let begun = match &output {
                        Output::Begin { name } => Some(self.folder.join(name)),
                        _ => None,
                    };
                    if let Err(error) = self.disk.perform(output) {
                        // nothing behind it is done: the recorder begins anew
                        let is_taken = error.kind() == io::ErrorKind::AlreadyExists;
                        return self.step(Input::Failed { why: error.to_string(), is_taken });
                    }
                    // only now is there something to read
                    self.shared.progress.lock().unwrap_or_else(PoisonError::into_inner).files.extend(begun);
                }
            }
        }
    }

    fn report(&self) {
        let mut progress = self.shared.progress.lock().unwrap_or_else(PoisonError::into_inner);
        (progress.status, progress.cost) = (self.recorder.status(), self.disk.cost);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::scan;
    use std::fs::{self, File};

    const LIMITS: Limits = Limits { quota_bytes: 1 << 30, reserve_bytes: 0 };

    fn start(folder: &Path) -> Writer {
        Writer::start(folder, Config::new("uav1"), LIMITS, Vec::new(), false).unwrap()
    }

    fn say(inlet: &Inlet, number: u64) {
        inlet.say(
            "legwork/uav1/counter/variable/count".into(),
            Payload::Json(format!("{{\"n\":{number}}}").into()),
        );
    }

    fn messages(path: &Path) -> u64 {
        scan(File::open(path).unwrap(), &mut |_| {}).unwrap().messages
    }

    /// Until something holds, a minute at most.
    fn until(what: &str, holds: impl Fn() -> bool) {
        let deadline = Instant::now() + Duration::from_secs(60);
        while !holds() {
            assert!(Instant::now() < deadline, "{what}");
            std::thread::yield_now();
        }
    }

    #[test]
    fn what_is_said_is_on_the_disk_soon_and_all_of_it_at_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let writer = start(folder.path());
        let inlet = writer.inlet();
        (0..100).for_each(|n| say(&inlet, n));
        until("it is on the disk while it is still being recorded", || {
            let files = inlet.progress().files;
            files.first().is_some_and(|file| messages(file) == 100)
        });
        (100..200).for_each(|n| say(&inlet, n));
        let progress = writer.close();
        assert_eq!((progress.status.messages, progress.status.missed), (200, 0));
        assert_eq!(messages(&progress.files[0]), 200);
        assert!(progress.cost.count >= 2, "{:?}", progress.cost);
        say(&inlet, 200);
        assert_eq!(inlet.shared.missed.load(Ordering::Relaxed), 1, "after the end it is counted");
    }

    #[test]
    fn flood_is_counted_and_nobody_waits() {
        let folder = tempfile::tempdir().unwrap();
        let writer = start(folder.path());
        let inlet = writer.inlet();
        let large = Payload::Json(format!("\"{}\"", "x".repeat(8 << 20)).into());
        (0..40).for_each(|_| inlet.say("legwork/uav1/a/variable/b".into(), large.clone()));
        let kept = writer.close().status.messages;
        let lost = inlet.shared.missed.load(Ordering::Relaxed) + inlet.progress().status.missed;
        assert!(kept + lost >= 40, "{kept} recorded, {lost} counted");
    }

    #[test]
    fn folder_that_cannot_be_made_is_told_and_does_no_harm() {
        let outer = tempfile::tempdir().unwrap();
        let inside = outer.path().join("recordings");
        fs::write(&inside, b"a file is no folder").unwrap();
        let writer = start(&inside);
        let inlet = writer.inlet();
        say(&inlet, 0);
        until("the failure is told", || {
            say(&inlet, 1);
            inlet.progress().status.failure.is_some()
        });
        let status = writer.close().status;
        assert!(status.missed > 0 && status.messages == 0, "{status:?}");
    }
}
