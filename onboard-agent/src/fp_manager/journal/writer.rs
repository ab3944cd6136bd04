//! Pure but for its storage: does what the flight asks of the journal, and knows when to sync and when to try again.

use super::Saved;
use super::log::Log;
use super::storage::Storage;
use flight_plan::Program;
use service::Time;
use std::io::{self, ErrorKind};
use std::sync::Arc;
use std::time::Duration;

/// What was appended is synced within this time.
const SYNC_WITHIN: Duration = Duration::from_millis(900);
/// Pause before a storage that failed is tried again.
const RETRY: Duration = Duration::from_secs(1);

/// Something to be written.
pub enum Job {
    /// A plan's document, by and by: the jobs after it do not wait for it.
    Document {
        /// Its hash.
        hash: Arc<str>,
        /// What is written.
        xml: Vec<u8>,
    },
    /// A plan's document, before the turn that names it.
    Plan(Arc<Program>),
    /// A turn.
    Turn {
        /// Its entries, encoded.
        payload: Vec<u8>,
        /// It is about to take effect outside.
        sync: bool,
    },
    /// The whole state, and the plans it names.
    State(Box<Saved>, Vec<Arc<Program>>),
}

impl Job {
    /// About so many bytes are kept in memory for it alone.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Turn { payload, .. } => payload.len(),
            // there is one document at a time, that of the proposal being reviewed
            Self::Document { .. } | Self::Plan(_) | Self::State(..) => 4096,
        }
    }
}

/// How it stands.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report {
    /// Why what happens is not recorded, and what to do; `None`: it is.
    pub trouble: Option<String>,
    /// A state should be handed in.
    pub wants_state: bool,
}

/// Keeps a log.
pub struct Writer<S> {
    log: Log<S>,
    trouble: Option<String>,
    dirty_since: Option<Time>,
    not_before: Time,
}

impl<S: Storage> Writer<S> {
    /// Of a log that has no state yet; `trouble`: it could not be read.
    pub fn new(log: Log<S>, trouble: Option<&io::Error>) -> Self {
        Self { log, trouble: trouble.map(advice), dirty_since: None, not_before: Time::ZERO }
    }

    /// Does the jobs in order, and whatever else is due.
    pub fn perform(&mut self, now: Time, jobs: Vec<Job>) {
        let mut sync = false;
        for job in jobs {
            sync |= matches!(job, Job::Turn { sync: true, .. });
            if let Err(error) = self.perform_one(now, job) {
                self.failed(now, &error);
            }
        }
        if self.log.is_dirty() {
            let since = *self.dirty_since.get_or_insert(now);
            sync |= now >= since + SYNC_WITHIN;
        }
        if sync {
            self.sync(now);
        }
    }

    /// Writes the next piece of a document.
    pub fn write_piece(&mut self) {
        if let Err(error) = self.log.write_piece() {
            tracing::warn!("a proposal's document can't be kept beforehand: {error}");
        }
    }

    /// A document is being written: [`Self::write_piece`] has to be called, whenever there are no jobs.
    pub fn is_writing(&self) -> bool {
        self.log.is_writing()
    }

    fn sync(&mut self, now: Time) {
        self.dirty_since = None;
        if let Err(error) = self.log.sync() {
            self.failed(now, &error);
        }
    }

    /// Nothing more will come.
    pub fn finish(&mut self, now: Time) {
        self.sync(now);
    }

    fn perform_one(&mut self, now: Time, job: Job) -> io::Result<()> {
        match job {
            Job::Document { hash, xml } => {
                self.log.keep_document(&hash, xml);
                Ok(())
            }
            Job::Plan(program) => self.log.keep_plan(&program),
            Job::Turn { payload, .. } => self.log.append(&payload),
            Job::State(saved, programs) => {
                self.not_before = now + RETRY;
                self.log.begin(&saved, &programs)?;
                self.dirty_since = None;
                if self.trouble.take().is_some() {
                    tracing::info!("the flight is recorded again");
                }
                Ok(())
            }
        }
    }

    /// Turns were lost on the way here: only a new state helps.
    pub fn overrun(&mut self, now: Time) {
        self.log.stop();
        self.failed(now, &io::Error::new(ErrorKind::TimedOut, "the disk does not keep up"));
    }

    fn failed(&mut self, now: Time, error: &io::Error) {
        self.not_before = now + RETRY;
        let advice = advice(error);
        if self.log.is_recording() {
            tracing::warn!("no new segment of the journal could be begun, the old one goes on: {advice}");
        } else if self.trouble.as_ref() != Some(&advice) {
            tracing::error!("what happens is not recorded; the flight goes on: {advice}");
            self.trouble = Some(advice);
        }
    }

    /// When [`Self::perform`] has to be called, if there are no jobs before.
    pub fn due(&self) -> Option<Time> {
        self.dirty_since.map(|since| since + SYNC_WITHIN)
    }

    /// How it stands.
    pub fn report(&self, now: Time) -> Report {
        let wants_state = self.log.wants_state() && now >= self.not_before;
        Report { trouble: self.trouble.clone(), wants_state }
    }

    /// The log, for tests.
    #[cfg(test)]
    pub fn log(&mut self) -> &mut Log<S> {
        &mut self.log
    }
}

/// What happened, and what to do about it.
fn advice(error: &io::Error) -> String {
    let advice = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "free some space on the disk of the state directory"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "make the state directory writable for the agent"
        }
        _ => "check the disk of the state directory",
    };
    format!("{error}: {advice}")
}
