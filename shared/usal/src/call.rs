//! Calling invocations, without blocking.

use crate::codec::{self, Format};
use crate::contract::{Description, Empty, Kind, Refusal, VERSION};
use crate::session::{Inner, Session};
use crate::topics::{self, Invocation};
use crate::variable::PRIORITY;
use crate::{CallError, Instance, SessionError};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Weak};
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::sync::{mpsc, oneshot};
use tokio::time::Instant;
use zenoh::Wait;
use zenoh::bytes::ZBytes;
use zenoh::qos::CongestionControl;
use zenoh::query::{ConsolidationMode, Reply};
use zenoh::sample::SourceInfo;

/// Pause before a request that reached nobody is tried again.
const RETRY: Duration = Duration::from_millis(50);
/// Share of the deadline that is left for the answer, at most.
const ANSWER_TIME: Duration = Duration::from_millis(50);
/// Part of a call's time that its last attempt needs: with less, a busy machine could not hear
/// that nobody is there, and the caller would have to believe that somebody took the request.
const LAST_ATTEMPT: u32 = 4;
/// Who knows that nobody is there says so at once: a request that was out for longer was with somebody.
const HELD: Duration = Duration::from_secs(1);
/// Our deadline comes first; only then the network gives up.
const GRACE: Duration = Duration::from_millis(500);

/// An answer to come: a future, or polled without blocking by [`Self::try_take`].
#[derive(Debug)]
pub struct PendingCall<A> {
    answer: oneshot::Receiver<Result<A, CallError>>,
}

impl<A> PendingCall<A> {
    /// The answer if it is there; once. Does not block.
    pub fn try_take(&mut self) -> Option<Result<A, CallError>> {
        match self.answer.try_recv() {
            Ok(answer) => Some(answer),
            Err(oneshot::error::TryRecvError::Empty) => None,
            Err(oneshot::error::TryRecvError::Closed) => Some(Err(CallError::Closed)),
        }
    }
}

impl<A> Future for PendingCall<A> {
    type Output = Result<A, CallError>;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        Pin::new(&mut self.answer).poll(context).map(|answer| answer.unwrap_or(Err(CallError::Closed)))
    }
}

impl Session {
    /// Asks a service. The request is on its way when this returns; it is repeated under the same
    /// id while nobody is there to take it, and executed once. The answer, or
    /// [`CallError`], is there within `timeout`.
    pub fn call<Q, A>(&self, invocation: Invocation<Q, A>, request: &Q, timeout: Duration) -> PendingCall<A>
    where
        Q: Serialize,
        A: DeserializeOwned + Send + 'static,
    {
        self.call_named(invocation.service, invocation.name, request, timeout)
    }

    /// As [`Session::call`], for what takes long to be answered: it is given up if nobody has taken it within `delivery`,
    /// and not executed if it was taken later.
    pub fn call_within<Q, A>(
        &self,
        invocation: Invocation<Q, A>,
        request: &Q,
        delivery: Duration,
        timeout: Duration,
    ) -> PendingCall<A>
    where
        Q: Serialize,
        A: DeserializeOwned + Send + 'static,
    {
        let request = self.request(invocation.service, invocation.name, request, timeout);
        self.sent(invocation.name, request.map(|request| request.taken_within(delivery)))
    }

    /// As [`Session::call`], of an invocation that is only known by its names.
    pub fn call_named<Q, A>(
        &self,
        service: &str,
        name: &str,
        request: &Q,
        timeout: Duration,
    ) -> PendingCall<A>
    where
        Q: Serialize,
        A: DeserializeOwned + Send + 'static,
    {
        self.sent(name, self.request(service, name, request, timeout))
    }

    /// Asks a service what it is and can; and which session answers, if it says so: that is the service for whoever asks.
    ///
    /// # Errors
    /// [`CallError`]: there is no good answer within `timeout`.
    pub async fn describe(
        &self,
        service: &'static str,
        timeout: Duration,
    ) -> Result<(Description, Option<Instance>), CallError> {
        let invocation = topics::describe(service);
        let request = self
            .request(service, invocation.name, &Empty {}, timeout)
            .map_err(|reason| CallError::Undecodable { name: invocation.name.to_owned(), reason })?;
        let reply = request.run(request.attempt()).await?;
        let from = reply.result().ok().and_then(|sample| Instance::behind(sample.source_info()));
        Ok((request.read(&reply)?, from))
    }

    fn sent<A>(&self, name: &str, request: Result<Request, String>) -> PendingCall<A>
    where
        A: DeserializeOwned + Send + 'static,
    {
        let (sender, answer) = oneshot::channel();
        match request {
            Err(reason) => {
                let name = name.to_owned();
                // the receiver is in our hands
                let _ = sender.send(Err(CallError::Undecodable { name, reason }));
            }
            Ok(request) => {
                let first = request.attempt();
                let wake = self.inner.wake.clone();
                self.inner.runtime.spawn(async move {
                    // nobody waits any more: no matter
                    let _ = sender.send(request.run(first).await.and_then(|reply| request.read(&reply)));
                    wake();
                });
            }
        }
        PendingCall { answer }
    }

    fn request<Q: Serialize>(
        &self,
        service: &str,
        name: &str,
        request: &Q,
        timeout: Duration,
    ) -> Result<Request, String> {
        let key = self.key(service, Kind::Invocation, name).map_err(|e| e.to_string())?;
        let payload = codec::encode(request, Format::Cbor)?;
        Ok(Request {
            inner: Arc::downgrade(&self.inner),
            id: self.request_id(),
            name: key.to_string(),
            payload: payload.into(),
            timeout,
            deadline: Instant::now() + timeout,
            delivery: timeout,
        })
    }
}

struct Request {
    inner: Weak<Inner>,
    id: String,
    name: String,
    payload: ZBytes,
    timeout: Duration,
    deadline: Instant,
    /// It has to be taken within this time of its beginning.
    delivery: Duration,
}

/// A request that is out.
struct Attempt {
    reply: mpsc::Receiver<Reply>,
    begun: Instant,
    was_connected: bool,
}

impl Attempt {
    /// It ended without a reply, and not because nobody was there: the connection that it went out on is gone, or somebody had it
    /// for a while.
    fn may_have_been_taken(&self, ended: Instant, inner: &Weak<Inner>) -> bool {
        let is_connected = inner.upgrade().is_some_and(|inner| inner.is_connected());
        self.was_connected && (!is_connected || ended - self.begun > HELD)
    }
}

impl Request {
    fn taken_within(self, delivery: Duration) -> Self {
        Self { delivery: delivery.min(self.timeout), ..self }
    }

    /// Until when it may be taken.
    fn delivery_until(&self) -> Instant {
        self.deadline - (self.timeout - self.delivery)
    }

    /// Sends it once. The channel of the attempt ends without a reply when the network knows that none will come.
    fn attempt(&self) -> Result<Attempt, CallError> {
        let inner = self.inner.upgrade().ok_or(CallError::Closed)?;
        let (sender, reply) = mpsc::channel(1);
        let was_connected = inner.is_connected();
        // what is executed should still be answered in time
        let now = Instant::now();
        let attempt = Attempt { reply, begun: now, was_connected };
        let left = self.deadline.saturating_duration_since(now);
        let taken_within = self.delivery_until().saturating_duration_since(now);
        let execute_within = taken_within - (taken_within / 10).min(ANSWER_TIME);
        let from = inner.name.as_ref().map(|name| format!(";from={name}")).unwrap_or_default();
        inner
            .zenoh
            .get(format!(
                "{}?version={VERSION};id={};timeout_ms={}{from}",
                self.name,
                self.id,
                execute_within.as_millis()
            ))
            .payload(self.payload.clone())
            .source_info(SourceInfo::new(inner.zenoh.id(), 0))
            .encoding(Format::Cbor.encoding())
            .consolidation(ConsolidationMode::None)
            .congestion_control(CongestionControl::Block)
            .priority(PRIORITY)
            .timeout(left + GRACE)
            // one answer is enough; a second service of the same name is not heard
            .callback(move |reply| drop(sender.try_send(reply)))
            .wait()
            .map_err(|e| {
                tracing::debug!("{}", SessionError::network(e));
                CallError::Closed
            })?;
        Ok(attempt)
    }

    /// Sends it until somebody answers.
    async fn run(&self, first: Result<Attempt, CallError>) -> Result<Reply, CallError> {
        let mut attempt = first?;
        let last_attempt = self.delivery_until() - self.delivery / LAST_ATTEMPT;
        let mut lost = false;
        loop {
            match tokio::time::timeout_at(self.deadline, attempt.reply.recv()).await {
                Err(_) => return Err(CallError::Timeout { name: self.name.clone(), after: self.timeout }),
                Ok(Some(reply)) => return Ok(reply),
                Ok(None) => {
                    let ended = Instant::now();
                    // a connection that breaks ends its requests a moment before it is known to be gone
                    tokio::time::sleep(RETRY).await;
                    lost |= attempt.may_have_been_taken(ended, &self.inner);
                    if Instant::now() >= last_attempt {
                        let name = self.name.clone();
                        return Err(if lost {
                            CallError::Lost { name }
                        } else {
                            CallError::Unreachable { name }
                        });
                    }
                    attempt = self.attempt()?;
                }
            }
        }
    }

    fn read<A: DeserializeOwned>(&self, reply: &Reply) -> Result<A, CallError> {
        let read = match reply.result() {
            Ok(sample) => codec::decode(sample.payload(), sample.encoding()).map(Ok),
            Err(error) => codec::decode::<Refusal>(error.payload(), error.encoding()).map(Err),
        };
        match read {
            Ok(answer) => answer.map_err(CallError::Refused),
            Err(reason) => Err(CallError::Undecodable { name: self.name.clone(), reason }),
        }
    }
}
