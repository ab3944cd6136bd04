//! A telemetry log that is played as if the autopilot spoke. Nothing can be sent to it.

use super::{Event, Peer};
use crate::tlog::Reader;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::time::Duration;
use tokio::time::Instant;

/// Read at once, bytes.
const PIECE: usize = 64 * 1024;
/// A longer silence in the log is as long as this.
const SILENCE: Duration = Duration::from_secs(10);
/// Whose frames they are.
const PEER: Peer = Peer(1);

/// The log, and how far it was played.
pub struct Replay {
    file: File,
    reader: Reader,
    /// The next frame, and when it is due.
    next: Option<(Instant, Vec<u8>)>,
    /// When the last one was due, and its time in the log, microseconds.
    last: Option<(Instant, u64)>,
    over: bool,
}

impl Replay {
    /// Opens a log.
    ///
    /// # Errors
    /// It can't be opened.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        Ok(Self { file, reader: Reader::default(), next: None, last: None, over: false })
    }

    /// Waits until the next frame is due; for ever after the last.
    pub async fn next(&mut self, into: &mut Vec<u8>) -> Event {
        if self.next.is_none() {
            self.next = self.read();
        }
        let Some((due, _)) = &self.next else { return std::future::pending().await };
        tokio::time::sleep_until(*due).await;
        if let Some((_, frame)) = self.next.take() {
            into.extend_from_slice(&frame);
        }
        Event::Datagram(PEER)
    }

    fn read(&mut self) -> Option<(Instant, Vec<u8>)> {
        loop {
            if let Some(record) = self.reader.next_record() {
                let due = match self.last {
                    None => Instant::now(),
                    Some((due, time_us)) => {
                        due + Duration::from_micros(record.time_us.saturating_sub(time_us)).min(SILENCE)
                    }
                };
                self.last = Some((due, record.time_us));
                return Some((due, record.frame.to_vec()));
            }
            if self.over || !self.read_piece() {
                return None;
            }
        }
    }

    /// False: there is no more.
    fn read_piece(&mut self) -> bool {
        let mut piece = vec![0; PIECE];
        match self.file.read(&mut piece) {
            Ok(length) if length > 0 => {
                self.reader.push(piece.get(..length).unwrap_or_default());
                return true;
            }
            Ok(_) => tracing::info!(ignored_bytes = self.reader.ignored_bytes, "the replay is over"),
            Err(error) => tracing::warn!("the replay ends early: {error}"),
        }
        self.over = true;
        false
    }
}
