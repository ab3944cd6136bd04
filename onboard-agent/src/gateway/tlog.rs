//! Shell: what goes over the autopilot's links, as telemetry logs that Mission Planner, MAVProxy and pymavlink read.
//!
//! A thread of its own writes them: nobody waits for the disk, and what finds no room is counted.

use crate::services::storage::{Limits, disk::Disk};
use autopilot_link::frame::Decoder;
use autopilot_link::{Event, tlog};
use recording::Output;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant, SystemTime};

const EXTENSION: &str = ".tlog";
/// Pieces of the links that may wait for the disk, and bytes of all of them.
const QUEUE: usize = 4096;
const WAITING_MAX: usize = 8 << 20;
/// How long the end of the log waits for the disk: a card that hangs must not keep the gateway from ending.
const END_WITHIN: Duration = Duration::from_secs(2);
/// What has come is written, and synced, so often.
const WRITE_EVERY: Duration = Duration::from_secs(1);
/// Or when it is so much, bytes.
const WRITE_AT: usize = 1 << 20;
/// A file is no longer than about this, bytes.
const FILE_BYTES: usize = 64 << 20;
/// What can't be written is tried again after this.
const AGAIN: Duration = Duration::from_secs(10);

/// Where the logs go.
#[derive(Debug, Clone)]
pub struct Config {
    /// Their folder.
    pub folder: PathBuf,
    /// How much may be kept.
    pub limits: Limits,
    /// The vehicle's name, part of theirs.
    pub vehicle: String,
}

/// The log of a gateway; the rest is written when it is dropped.
pub struct Tlog {
    /// What came over each link, cut into frames.
    decoders: Vec<Decoder>,
    queue: Option<SyncSender<Vec<u8>>>,
    /// Bytes that wait for the disk.
    waiting: Arc<AtomicUsize>,
    missed: u64,
    /// Nothing comes over it; it is closed when all is written.
    written: Receiver<()>,
}

impl Tlog {
    /// Begins to write.
    ///
    /// # Errors
    /// No thread can be had.
    pub fn begin(config: Config, links: usize) -> std::io::Result<Self> {
        let (queue, pieces) = sync_channel(QUEUE);
        let (writes, written) = sync_channel(0);
        let waiting = Arc::<AtomicUsize>::default();
        let writer = Writer::new(config, Arc::clone(&waiting));
        std::thread::Builder::new().name("tlog".into()).spawn(move || {
            writer.run(&pieces);
            drop(writes);
        })?;
        let decoders = vec![Decoder::default(); links];
        Ok(Self { decoders, queue: Some(queue), waiting, missed: 0, written })
    }

    /// A link brought something.
    pub fn received(&mut self, link: usize, event: Event, bytes: &[u8]) {
        let Some(decoder) = self.decoders.get_mut(link) else { return };
        match event {
            Event::Connected(_) | Event::Gone(_) => return decoder.restart(),
            Event::Stream(_) => decoder.push(bytes),
            Event::Datagram(_) => decoder.push_datagram(bytes),
        }
        let (time_us, mut records) = (now_us(), vec![]);
        while let Some(frame) = decoder.next_frame() {
            tlog::received(time_us, link, frame.bytes, &mut records);
        }
        self.put(records);
    }

    /// Frames were sent over a link.
    pub fn sent<'a>(&mut self, link: usize, frames: impl Iterator<Item = &'a [u8]>) {
        if link >= self.decoders.len() {
            return;
        }
        let (time_us, mut records) = (now_us(), vec![]);
        frames.for_each(|frame| tlog::sent(time_us, frame, &mut records));
        self.put(records);
    }

    fn put(&mut self, records: Vec<u8>) {
        let Some(queue) = self.queue.as_ref().filter(|_| !records.is_empty()) else { return };
        let length = records.len();
        let fits = self.waiting.load(Ordering::Relaxed) + length <= WAITING_MAX;
        if fits && queue.try_send(records).is_ok() {
            self.waiting.fetch_add(length, Ordering::Relaxed);
        } else {
            self.missed += 1;
            if self.missed.is_power_of_two() {
                tracing::warn!(
                    missed = self.missed,
                    "the telemetry log misses messages: the disk is too slow"
                );
            }
        }
    }
}

impl Drop for Tlog {
    fn drop(&mut self) {
        self.queue = None;
        if self.written.recv_timeout(END_WITHIN) == Err(RecvTimeoutError::Timeout) {
            tracing::warn!("the disk does not take the end of the telemetry log: it is lost");
        }
    }
}

/// Microseconds since 1970, by the machine's clock.
fn now_us() -> u64 {
    u64::try_from(unix().as_micros()).unwrap_or(u64::MAX)
}

fn unix() -> Duration {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default()
}

fn is_tlog(name: &str) -> bool {
    name.len() > EXTENSION.len() && name.ends_with(EXTENSION)
}

/// The thread.
struct Writer {
    vehicle: String,
    disk: Disk,
    waiting: Arc<AtomicUsize>,
    /// Bytes that could not be written since the last that could.
    lost: usize,
    /// Files of this run so far.
    files: u32,
    /// Bytes of the current file; `None`: there is none.
    written: Option<usize>,
    again_at: Instant,
}

impl Writer {
    fn new(Config { folder, limits, vehicle }: Config, waiting: Arc<AtomicUsize>) -> Self {
        let disk = Disk::of(&folder, limits, is_tlog);
        Self { vehicle, disk, waiting, lost: 0, files: 0, written: None, again_at: Instant::now() }
    }

    fn run(mut self, pieces: &Receiver<Vec<u8>>) {
        let mut waiting = Vec::new();
        loop {
            let due = Instant::now() + WRITE_EVERY;
            let open = loop {
                match pieces.recv_timeout(due.saturating_duration_since(Instant::now())) {
                    Ok(piece) => {
                        self.waiting.fetch_sub(piece.len(), Ordering::Relaxed);
                        waiting.extend_from_slice(&piece);
                    }
                    Err(RecvTimeoutError::Timeout) => break true,
                    Err(RecvTimeoutError::Disconnected) => break false,
                }
                if waiting.len() >= WRITE_AT {
                    break true;
                }
            };
            self.write(std::mem::take(&mut waiting));
            if !open {
                let _ = self.disk.perform(Output::Finish);
                return;
            }
        }
    }

    fn write(&mut self, bytes: Vec<u8>) {
        if bytes.is_empty() {
            return;
        }
        let length = bytes.len();
        if Instant::now() < self.again_at {
            self.lost += length;
            return;
        }
        match self.try_write(bytes) {
            Ok(()) if self.lost > 0 => {
                tracing::warn!(lost = self.lost, "the telemetry log is written again; bytes are missing");
                self.lost = 0;
            }
            Ok(()) => {}
            Err(error) => {
                self.lost += length;
                tracing::warn!(
                    lost = self.lost,
                    "the telemetry log can't be written, what comes is tried again in {} s: {error}",
                    AGAIN.as_secs()
                );
                (self.written, self.again_at) = (None, Instant::now() + AGAIN);
            }
        }
    }

    fn try_write(&mut self, bytes: Vec<u8>) -> std::io::Result<()> {
        if self.written.is_none_or(|written| written + bytes.len() > FILE_BYTES) {
            self.disk.perform(Output::Finish)?;
            self.files = self.files.wrapping_add(1);
            let name = format!("{}{EXTENSION}", recording::stem(&self.vehicle, unix(), self.files));
            self.disk.perform(Output::Begin { name })?;
            self.written = Some(0);
        }
        let length = bytes.len();
        self.disk.perform(Output::Append { bytes })?;
        self.written = self.written.map(|written| written + length);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use autopilot_link::Peer;
    use autopilot_link::frame::{Sender, encode_payload};

    const LIMITS: Limits = Limits { quota_bytes: 100 << 20, reserve_bytes: 0 };

    /// A heartbeat.
    fn frame(sequence: u8) -> Vec<u8> {
        encode_payload(Sender { system: 1, component: 1 }, sequence, 0, &[1; 9])
    }

    /// The logs in a folder, one after the other.
    fn written(folder: &std::path::Path) -> Vec<Vec<u8>> {
        let mut names: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        names.sort();
        assert!(names.iter().all(|name| is_tlog(name.to_str().unwrap())), "{names:?}");
        names.iter().map(|name| std::fs::read(name).unwrap()).collect()
    }

    #[test]
    fn what_came_and_what_was_sent_is_in_the_log_frame_by_frame() {
        let folder = tempfile::tempdir().unwrap();
        let config = Config { folder: folder.path().join("tlogs"), limits: LIMITS, vehicle: "uav1".into() };
        let mut log = Tlog::begin(config, 1).unwrap();
        let stream = [frame(1), vec![0, 1, 2], frame(2)].concat();
        let (first, second) = stream.split_at(11);
        log.received(0, Event::Stream(Peer(1)), first);
        log.received(0, Event::Stream(Peer(1)), second);
        log.sent(0, [&frame(3)[..]].into_iter());
        log.sent(1, [&frame(4)[..]].into_iter());
        drop(log);
        let [bytes] = &written(&folder.path().join("tlogs"))[..] else { panic!("one file") };
        let (mut reader, mut found) = (tlog::Reader::default(), vec![]);
        reader.push(bytes);
        while let Some(record) = reader.next_record() {
            assert!(record.time_us > 1_700_000_000_000_000, "{record:?}");
            found.push((record.time_us & 3, record.frame.to_vec()));
        }
        assert_eq!(found, [(0, frame(1)), (0, frame(2)), (3, frame(3))]);
    }

    #[test]
    fn oldest_logs_go_when_the_quota_is_used_up() {
        let folder = tempfile::tempdir().unwrap();
        let config = Config { folder: folder.path().into(), limits: LIMITS, vehicle: "uav1".into() };
        let mut writer = Writer::new(config, Arc::default());
        (0..200).for_each(|_| writer.write(vec![7; 1 << 20]));
        let sizes: Vec<usize> = written(folder.path()).iter().map(Vec::len).collect();
        assert!(sizes.iter().all(|size| *size <= FILE_BYTES), "{sizes:?}");
        assert!(sizes.iter().sum::<usize>() <= 100 << 20 && writer.files == 4, "{sizes:?}");
    }
}
