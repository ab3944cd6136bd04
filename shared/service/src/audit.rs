//! The audit trail: what each service was asked, by whom, and what it answered. Published as events beside the service's
//! own contract, by a task of its own.

use crate::clock::Reader;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use usal::contract::Stamped;
use usal::topics::Events;
use usal::{Audited, EventPublisher, Session, SessionError};

/// Answers that may wait for being published.
const QUEUE: usize = 1024;

/// A request with its answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Audit {
    /// Name of the invocation.
    pub invocation: String,
    /// Who asked, if it said so: a claim, not a proof.
    pub caller: Option<String>,
    /// The request's own name.
    pub id: Option<String>,
    /// What was asked; null above 64 KiB.
    pub request: serde_json::Value,
    /// Size of the request, bytes.
    pub request_bytes: u64,
    /// Answered, and not refused.
    pub accepted: bool,
    /// The answer, or the refusal; null above 64 KiB.
    pub answer: serde_json::Value,
    /// Size of the answer, bytes.
    pub answer_bytes: u64,
    /// Answers so far that nobody could be told of, because there were too many at once.
    pub dropped: u64,
}

/// A service's audit trail.
pub const fn audit(service: &'static str) -> Events<Stamped<Audit>> {
    Events::new(service, "audit")
}

/// Publishes the session's answers until aborted. Whoever answers isn't held up.
pub(crate) fn start(
    session: &Session,
    service: &'static str,
    clock: Reader,
) -> Result<JoinHandle<()>, SessionError> {
    let publisher = session.emitter(audit(service))?;
    let (sender, receiver) = mpsc::channel(QUEUE);
    let dropped = Arc::<AtomicU64>::default();
    let lost = dropped.clone();
    session.audit(move |audited| {
        if sender.try_send((clock.now().as_secs_f64(), audited)).is_err() {
            lost.fetch_add(1, Ordering::Relaxed);
        }
    });
    Ok(tokio::spawn(publish(publisher, receiver, dropped)))
}

async fn publish(
    publisher: EventPublisher<Stamped<Audit>>,
    mut receiver: mpsc::Receiver<(f64, Audited)>,
    dropped: Arc<AtomicU64>,
) {
    while let Some((time_s, audited)) = receiver.recv().await {
        let value = Audit {
            request: audited.request.to_json(),
            request_bytes: audited.request.size_bytes as u64,
            answer: audited.answer.to_json(),
            answer_bytes: audited.answer.size_bytes as u64,
            invocation: audited.invocation,
            caller: audited.caller,
            id: audited.id,
            accepted: audited.accepted,
            dropped: dropped.load(Ordering::Relaxed),
        };
        publisher.emit(&Stamped { time_s, validity_s: f64::MAX, value });
    }
}
