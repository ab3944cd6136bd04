//! Files: complete or absent, checked by hash, fetched in chunks by any number of receivers.
//!
//! The sender answers at the file's key: without parameters with the [`FileManifest`], with
//! `hash=<sha256>;chunk=<number>` with that chunk's bytes. A chunk is asked for by the hash of its
//! file, so chunks of a replaced file never mix with those of the new one: they are refused as
//! `replaced`, and the receiver begins anew. The manifest is also published as variable
//! `file.<name>`, from which receivers learn of a new version.
// manifests and chunks come from the network
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use crate::codec::{self, Format};
use crate::contract::Kind;
use crate::contract::{FileManifest, Refusal};
use crate::instance::anybody;
use crate::invocation::refusal;
use crate::session::Session;
use crate::{SessionError, VariablePublisher, VariableSubscriber};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::task::JoinSet;
use tokio::time::Instant;
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::{ConsolidationMode, Query, Queryable, Reply};
use zenoh::sample::Sample;

/// Largest file, bytes.
pub const FILE_BYTES_MAX: usize = 64 << 20;

/// What we cut files into: two fit into one of the network's batches of 64 KiB.
const CHUNK_BYTES: usize = 32_000;
/// Chunks that others may cut files into; the least bounds their number.
const CHUNK_BYTES_ACCEPTED: Range<usize> = 1024..(256 << 10) + 1;
/// Chunks asked for and not yet there, per download.
const UNDER_WAY: usize = 4;
/// After so long a question counts as lost and is asked again.
const ANSWER_WITHIN: Duration = Duration::from_secs(1);
/// Our patience ends first; only then the network gives up.
const GRACE: Duration = Duration::from_millis(500);
/// Pause before asking again where nobody was reached.
const RETRY: Duration = Duration::from_millis(50);
/// Longest deadline.
const TIMEOUT_MAX: Duration = Duration::from_secs(86_400);

const REPLACED: &str = "replaced";

/// A file that cannot be offered or fetched.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be offered.
    #[error("a file of {0} bytes is too large: at most {FILE_BYTES_MAX} can be offered")]
    TooLarge(usize),
    /// Nobody offers it, or nobody can be reached.
    #[error("nobody offers `{key}`: is the agent running and reachable?")]
    Unreachable {
        /// The file.
        key: String,
    },
    /// The deadline came first.
    #[error(
        "`{key}` is incomplete after {after:?} ({received} of {chunks} chunks): resume the download later"
    )]
    Incomplete {
        /// The file.
        key: String,
        /// The deadline.
        after: Duration,
        /// Chunks that are there.
        received: usize,
        /// Chunks that it has.
        chunks: u32,
    },
    /// The sender refuses.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// What the sender says cannot be right; nothing of it is kept.
    #[error("`{key}` is refused: {reason}; check its sender")]
    Unsound {
        /// The file.
        key: String,
        /// What is wrong.
        reason: String,
    },
    /// The session does not work.
    #[error(transparent)]
    Session(#[from] SessionError),
}

fn manifest_of(bytes: &[u8]) -> Result<FileManifest, FileError> {
    let too_large = || FileError::TooLarge(bytes.len());
    if bytes.len() > FILE_BYTES_MAX {
        return Err(too_large());
    }
    Ok(FileManifest {
        size_bytes: bytes.len() as u64,
        chunk_bytes: u32::try_from(CHUNK_BYTES).map_err(|_| too_large())?,
        chunks: u32::try_from(bytes.len().div_ceil(CHUNK_BYTES)).map_err(|_| too_large())?,
        sha256: sha256(bytes),
    })
}

/// Says what is wrong with a manifest from the network, before anything is allocated for it.
fn check(manifest: &FileManifest) -> Result<(), String> {
    let FileManifest { size_bytes, chunk_bytes, chunks, sha256 } = manifest;
    let hex = |b: u8| b.is_ascii_digit() || matches!(b, b'a'..=b'f');
    if *size_bytes > FILE_BYTES_MAX as u64 {
        Err(format!("{size_bytes} bytes are more than {FILE_BYTES_MAX}"))
    } else if !CHUNK_BYTES_ACCEPTED.contains(&(*chunk_bytes as usize)) {
        Err(format!("chunks of {chunk_bytes} bytes are outside of {CHUNK_BYTES_ACCEPTED:?}"))
    } else if u64::from(*chunks) != size_bytes.div_ceil(u64::from(*chunk_bytes)) {
        Err(format!("{chunks} chunks do not make {size_bytes} bytes"))
    } else if sha256.len() != 64 || !sha256.bytes().all(hex) {
        Err("its hash is not 64 lower-case hex digits".into())
    } else {
        Ok(())
    }
}

/// Where a chunk lies in the file, bytes.
fn range(manifest: &FileManifest, chunk: u32) -> Option<Range<usize>> {
    let chunk_bytes = manifest.chunk_bytes as usize;
    let start = (chunk as usize).checked_mul(chunk_bytes)?;
    let end = start.saturating_add(chunk_bytes).min(usize::try_from(manifest.size_bytes).ok()?);
    (chunk < manifest.chunks).then_some(start..end)
}

/// Hex SHA-256 (FIPS 180-4).
fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn announcement(name: &str) -> String {
    format!("file.{name}")
}

struct Offered {
    manifest: FileManifest,
    bytes: Vec<u8>,
}

type Current = Arc<Mutex<Option<Arc<Offered>>>>;

/// Offers a file while it exists.
pub struct FileOffer {
    current: Current,
    announcement: VariablePublisher<FileManifest>,
    _queryable: Queryable<()>,
}

impl FileOffer {
    /// Replaces the file, as it was at `time_s` (source time, seconds). An announcement may be
    /// lost on a congested link; whoever asks for the manifest is always told the present one.
    ///
    /// # Errors
    /// [`FileError::TooLarge`]; what was offered before stays.
    pub fn set(&self, time_s: f64, bytes: Vec<u8>) -> Result<(), FileError> {
        let manifest = manifest_of(&bytes)?;
        let offered = Arc::new(Offered { manifest: manifest.clone(), bytes });
        *self.current.lock().unwrap_or_else(PoisonError::into_inner) = Some(offered);
        self.announcement.set(time_s, f64::MAX, &manifest);
        Ok(())
    }
}

impl Session {
    /// Offers a file, empty-handed until the first [`FileOffer::set`].
    ///
    /// # Errors
    /// [`SessionError`] for names that cannot be part of a key, or on a closed session.
    pub fn offer(&self, service: &str, name: &str) -> Result<FileOffer, SessionError> {
        let key = self.key(service, Kind::File, name)?.to_string();
        let current = Current::default();
        let answers = current.clone();
        let own_key = key.clone();
        let queryable = self
            .inner
            .zenoh
            .declare_queryable(key)
            .complete(true)
            .callback(move |query| {
                let offered = answers.lock().unwrap_or_else(PoisonError::into_inner).clone();
                answer(&query, &own_key, offered.as_deref());
            })
            .wait()
            .map_err(SessionError::network)?;
        let announcement = self.publish_named(service, &announcement(name))?;
        Ok(FileOffer { current, announcement, _queryable: queryable })
    }

    /// Follows a file's manifest, to learn of new versions.
    ///
    /// # Errors
    /// [`SessionError`] for names that cannot be part of a key, or on a closed session.
    pub fn follow_file(
        &self,
        service: &str,
        name: &str,
    ) -> Result<VariableSubscriber<FileManifest>, SessionError> {
        self.follow_named(service, &announcement(name), anybody())
    }

    /// Fetches a file whole within `timeout` (wall-clock).
    ///
    /// # Errors
    /// [`FileError`]; what came in is lost: use [`Session::download`] where links break.
    pub async fn fetch(&self, service: &str, name: &str, timeout: Duration) -> Result<Vec<u8>, FileError> {
        self.download(service, name)?.resume(timeout).await
    }

    /// A download that has not begun; see [`Download::resume`].
    ///
    /// # Errors
    /// [`SessionError::Key`] for names that cannot be part of a key.
    pub fn download(&self, service: &str, name: &str) -> Result<Download, SessionError> {
        let key = self.key(service, Kind::File, name)?;
        let source = Source { session: self.clone(), key: key.to_string() };
        Ok(Download { source, manifest: None, chunks: BTreeMap::new() })
    }
}

fn answer(query: &Query, key: &str, offered: Option<&Offered>) {
    let format = query.encoding().map_or(Format::Cbor, Format::of);
    let sent = match asked(query, offered, format) {
        Ok((bytes, encoding)) => query.reply(key, bytes).encoding(encoding).wait(),
        Err(refusal) => {
            let bytes = codec::encode(&refusal, format).unwrap_or_default();
            query.reply_err(bytes).encoding(format.encoding()).wait()
        }
    };
    if let Err(e) = sent {
        tracing::debug!("answering for file {key}: {e}");
    }
}

/// The manifest, or the chunk asked for.
fn asked(query: &Query, offered: Option<&Offered>, format: Format) -> Result<(Vec<u8>, Encoding), Refusal> {
    let offered = offered.ok_or_else(|| refusal("no-file", "there is no such file yet; ask again later"))?;
    let Some(hash) = query.parameters().get("hash") else {
        let bytes = codec::encode(&offered.manifest, format).map_err(|e| refusal("unanswered", &e))?;
        return Ok((bytes, format.encoding()));
    };
    if hash != offered.manifest.sha256 {
        return Err(refusal(REPLACED, "there is another version by now; ask for the manifest again"));
    }
    let number = query.parameters().get("chunk").and_then(|number| number.parse().ok());
    let range = number.and_then(|number| range(&offered.manifest, number));
    let chunk = range.and_then(|range| offered.bytes.get(range));
    let chunk = chunk.ok_or_else(|| refusal("bad-request", "name a chunk that the manifest counts"))?;
    Ok((chunk.to_vec(), Encoding::ZENOH_BYTES))
}

/// Where a file is asked for.
#[derive(Clone)]
struct Source {
    session: Session,
    key: String,
}

impl Source {
    /// Asks, again and again until the deadline; `None` when it has passed. Files wait for
    /// everything else, and what does not fit into the link's queue is dropped and asked for
    /// again: to block could end the connection.
    async fn ask(&self, parameters: &str, deadline: Instant) -> Result<Option<Sample>, FileError> {
        while Instant::now() < deadline {
            let (sender, mut receiver) = mpsc::channel(1);
            self.session
                .inner
                .zenoh
                .get(format!("{}{parameters}", self.key))
                .consolidation(ConsolidationMode::None)
                .congestion_control(CongestionControl::Drop)
                .priority(Priority::Background)
                .timeout(ANSWER_WITHIN + GRACE)
                .callback(move |reply| drop(sender.try_send(reply)))
                .wait()
                .map_err(SessionError::network)?;
            let patience = deadline.min(Instant::now() + ANSWER_WITHIN);
            match tokio::time::timeout_at(patience, receiver.recv()).await {
                Ok(Some(reply)) => return self.read(&reply).map(Some),
                Ok(None) => tokio::time::sleep_until(deadline.min(Instant::now() + RETRY)).await,
                Err(_) => {}
            }
        }
        Ok(None)
    }

    fn read(&self, reply: &Reply) -> Result<Sample, FileError> {
        match reply.result() {
            Ok(sample) => Ok(sample.clone()),
            Err(error) => match codec::decode::<Refusal>(error.payload(), error.encoding()) {
                Ok(refusal) => Err(refusal.into()),
                Err(reason) => Err(self.unsound(reason)),
            },
        }
    }

    async fn manifest(&self, deadline: Instant) -> Result<FileManifest, FileError> {
        let sample = self.ask("", deadline).await?;
        let sample = sample.ok_or_else(|| FileError::Unreachable { key: self.key.clone() })?;
        let manifest: FileManifest =
            codec::decode(sample.payload(), sample.encoding()).map_err(|reason| self.unsound(reason))?;
        check(&manifest).map_err(|reason| self.unsound(reason))?;
        Ok(manifest)
    }

    /// A chunk of the right length; `None` when the deadline has passed.
    async fn chunk(
        self,
        manifest: Arc<FileManifest>,
        number: u32,
        deadline: Instant,
    ) -> Result<Option<(u32, Vec<u8>)>, FileError> {
        let parameters = format!("?hash={};chunk={number}", manifest.sha256);
        let Some(sample) = self.ask(&parameters, deadline).await? else { return Ok(None) };
        let bytes = sample.payload();
        let wanted = range(&manifest, number).map_or(0, |range| range.len());
        if bytes.len() != wanted {
            return Err(self.unsound(format!("chunk {number} has {} bytes, not {wanted}", bytes.len())));
        }
        // copied: a slice would keep the network's whole buffer
        Ok(Some((number, bytes.to_bytes().into_owned())))
    }

    fn unsound(&self, reason: String) -> FileError {
        FileError::Unsound { key: self.key.clone(), reason }
    }
}

/// A download that keeps the chunks it has, so that it can go on after an outage.
pub struct Download {
    source: Source,
    manifest: Option<Arc<FileManifest>>,
    chunks: BTreeMap<u32, Vec<u8>>,
}

impl Download {
    /// Chunks that are here.
    pub fn received(&self) -> usize {
        self.chunks.len()
    }

    /// Fetches what is missing within `timeout` (wall-clock, at most a day) and returns the file
    /// whole. If it was replaced meanwhile, the new version is fetched. Dropped half-way, or
    /// failed, it can be called again and asks only for what is missing; after a success it
    /// begins anew.
    ///
    /// # Errors
    /// [`FileError`]; of an unsound file nothing is kept.
    pub async fn resume(&mut self, timeout: Duration) -> Result<Vec<u8>, FileError> {
        let timeout = timeout.min(TIMEOUT_MAX);
        let deadline = Instant::now() + timeout;
        loop {
            let manifest = self.begin(deadline).await?;
            match self.gather(&manifest, deadline).await {
                Ok(true) => return self.assemble(&manifest),
                Ok(false) => return Err(self.incomplete(&manifest, timeout)),
                Err(FileError::Refused(refusal)) if refusal.code == REPLACED => {
                    tokio::time::sleep(RETRY).await;
                }
                Err(error) => {
                    if matches!(error, FileError::Unsound { .. }) {
                        self.chunks.clear();
                    }
                    return Err(error);
                }
            }
        }
    }

    /// Asks for the manifest; chunks of another version are let go.
    async fn begin(&mut self, deadline: Instant) -> Result<Arc<FileManifest>, FileError> {
        let manifest = Arc::new(self.source.manifest(deadline).await?);
        if self.manifest.as_ref() != Some(&manifest) {
            self.chunks.clear();
            self.manifest = Some(manifest.clone());
        }
        Ok(manifest)
    }

    /// Whether all chunks are here before the deadline.
    async fn gather(&mut self, manifest: &Arc<FileManifest>, deadline: Instant) -> Result<bool, FileError> {
        let here = &self.chunks;
        let missing: Vec<u32> = (0..manifest.chunks).filter(|n| !here.contains_key(n)).collect();
        let mut missing = missing.into_iter();
        let mut under_way = JoinSet::new();
        loop {
            while under_way.len() < UNDER_WAY
                && let Some(number) = missing.next()
            {
                under_way.spawn(self.source.clone().chunk(manifest.clone(), number, deadline));
            }
            let Some(done) = under_way.join_next().await else { return Ok(true) };
            match done.map_err(|e| SessionError::Network(e.to_string()))?? {
                Some((number, bytes)) => drop(self.chunks.insert(number, bytes)),
                None => return Ok(false),
            }
        }
    }

    fn assemble(&mut self, manifest: &FileManifest) -> Result<Vec<u8>, FileError> {
        let chunks = std::mem::take(&mut self.chunks);
        let bytes = chunks.into_values().collect::<Vec<_>>().concat();
        if sha256(&bytes) != manifest.sha256 {
            return Err(self.source.unsound("its content does not have the hash announced".into()));
        }
        Ok(bytes)
    }

    fn incomplete(&self, manifest: &FileManifest, after: Duration) -> FileError {
        let key = self.source.key.clone();
        FileError::Incomplete { key, after, received: self.received(), chunks: manifest.chunks }
    }
}
