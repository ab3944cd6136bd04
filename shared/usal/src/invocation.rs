//! Serving invocations: one typed answer each, repeated requests executed once.
//!
//! A request may carry parameters in its selector:
//!
//! - `from`: who asks, a key segment like a service's name; a claim, not a proof. Without it the request is anonymous, and may
//!   only read.
//! - `version`: the contract's major version that the asker speaks; another one is refused. Without it, it is taken to be ours.
//! - `id`: any text without `;`. The same request of the same asker under the same id is executed once and answered
//!   again from memory. The refusals `busy` and `expired` are about the moment: under the same id it can be asked again.
//! - `timeout_ms`: after which it is not executed any more.
//!
//! A refusal is an error reply of the form `{code, reason}`. Answers come in the format of the request.

use crate::audit::{AuditHook, Audited, Document};
use crate::codec::{self, Format};
use crate::contract::{ANONYMOUS, Description, Empty, Kind, Refusal, check_caller, check_version};
use crate::health::Health;
use crate::session::Session;
use crate::topics::{self, Invocation};
use crate::{Instance, SessionError};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::{HashMap, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::marker::PhantomData;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::mpsc;
use zenoh::Wait;
use zenoh::bytes::{Encoding, ZBytes};
use zenoh::query::{Query, Queryable};
use zenoh::sample::SourceInfo;

/// Requests that may wait for the service.
const QUEUE: usize = 64;
/// Answers remembered for repeated requests.
const REMEMBERED: usize = 256;
/// Answers larger than this are not remembered, bytes (256 of them make 16 MiB).
const REMEMBERED_BYTES: usize = 64 << 10;
/// Repetitions of one request that may wait for its answer.
const WAITING: usize = 8;
/// So much of a bad name is told to who keeps the books, characters.
const CLAIM_MAX: usize = 64;
/// Longest request id, bytes.
const ID_MAX: usize = 128;
/// Deadline of a request that names none, and the longest that it may name.
const TIMEOUT_MAX: Duration = Duration::from_secs(60);
/// Refusal of a request that finds others before it.
const BUSY: &str = "busy";
/// Refusal of a request whose deadline has passed.
const EXPIRED: &str = "expired";

/// Receives the requests of an invocation.
pub struct Server<Q, A> {
    receiver: mpsc::Receiver<Incoming<Q, A>>,
    _queryable: Queryable<()>,
    _session: Session,
}

impl<Q, A: Serialize> Server<Q, A> {
    /// Waits for the next request whose deadline has not passed; `None` when the session is
    /// closed.
    pub async fn recv(&mut self) -> Option<Incoming<Q, A>> {
        loop {
            let incoming = self.receiver.recv().await?;
            if let Some(incoming) = incoming.unless_expired() {
                return Some(incoming);
            }
        }
    }

    /// The next request, if there is one. Does not block.
    pub fn try_recv(&mut self) -> Option<Incoming<Q, A>> {
        loop {
            let incoming = self.receiver.try_recv().ok()?;
            if let Some(incoming) = incoming.unless_expired() {
                return Some(incoming);
            }
        }
    }
}

/// A request that wants its one answer; dropped without one, it is answered as `unanswered`.
pub struct Incoming<Q, A> {
    /// What is asked.
    pub request: Q,
    reply: Replier,
    deadline: Instant,
    _answer: PhantomData<fn(&A)>,
}

impl<Q, A: Serialize> Incoming<Q, A> {
    /// The request's own name: the same for each repetition of it.
    pub fn id(&self) -> Option<&str> {
        self.reply.name.as_ref().map(|name| name.id.as_str())
    }

    /// Who asks: a service's name, or `operator`; `None`: anonymous, of an invocation that only reads.
    pub fn from(&self) -> Option<&str> {
        self.reply.from.as_deref()
    }

    /// Which of the sessions of this name asks, if it says so.
    pub fn instance(&self) -> Option<Instance> {
        Instance::behind(self.reply.query.source_info())
    }

    /// The session that serves it.
    pub fn served_by(&self) -> Instance {
        self.reply.serving.instance
    }

    /// Answers it.
    pub fn answer(mut self, answer: Result<A, Refusal>) {
        self.reply.answer(&answer);
    }

    /// The request and the duty to answer it, apart.
    pub fn split(self) -> (Q, impl FnOnce(Result<A, Refusal>) + Send + use<Q, A>) {
        let mut reply = self.reply;
        (self.request, move |answer| reply.answer(&answer))
    }

    fn unless_expired(self) -> Option<Self> {
        if Instant::now() < self.deadline {
            return Some(self);
        }
        self.answer(Err(refusal(EXPIRED, "its deadline passed before it could be executed; send it again")));
        None
    }
}

pub(crate) fn refusal(code: &str, reason: &str) -> Refusal {
    Refusal { code: code.into(), reason: reason.into() }
}

impl Session {
    /// Serves an invocation.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn serve<Q, A>(&self, invocation: Invocation<Q, A>) -> Result<Server<Q, A>, SessionError>
    where
        Q: DeserializeOwned + Send + 'static,
        A: Serialize + 'static,
    {
        let key = self.key(invocation.service, Kind::Invocation, invocation.name)?.to_string();
        let (sender, receiver) = mpsc::channel(QUEUE);
        let serving = Serving {
            reads_only: invocation.reads_only,
            memory: Arc::default(),
            health: self.inner.health.clone(),
            audit: self.inner.audit.clone(),
            instance: self.instance(),
            source: SourceInfo::new(self.inner.zenoh.id(), 0),
        };
        let wake = self.inner.wake.clone();
        let queryable = self
            .inner
            .zenoh
            .declare_queryable(key)
            .complete(true)
            .callback(move |query| {
                if let Some(reply) = admit(&serving, query) {
                    receive(&sender, reply);
                    wake();
                }
            })
            .wait()
            .map_err(SessionError::network)?;
        Ok(Server { receiver, _queryable: queryable, _session: self.clone() })
    }

    /// Serves `describe` of a service: answer each request with its description.
    ///
    /// # Errors
    /// [`SessionError::Network`] on a closed session.
    pub fn serve_description(
        &self,
        service: &'static str,
    ) -> Result<Server<Empty, Description>, SessionError> {
        self.serve(topics::describe(service))
    }
}

/// Decodes a request and queues it; what cannot be is answered at once.
fn receive<Q: DeserializeOwned, A: Serialize>(sender: &mpsc::Sender<Incoming<Q, A>>, mut reply: Replier) {
    let empty = ZBytes::new();
    let payload = reply.query.payload().unwrap_or(&empty);
    let encoding = reply.query.encoding().unwrap_or(&Encoding::ZENOH_BYTES);
    match codec::decode::<Q>(payload, encoding) {
        Err(reason) => {
            reply.serving.health.undecodable(reply.query.key_expr().as_str(), &reason);
            reply.answer::<A>(&Err(refusal("bad-request", &reason)));
        }
        Ok(request) => {
            let deadline = Instant::now() + timeout(&reply.query);
            let incoming = Incoming { request, reply, deadline, _answer: PhantomData };
            if let Err(full) = sender.try_send(incoming) {
                full.into_inner()
                    .answer(Err(refusal(BUSY, "too many requests are waiting; try again later")));
            }
        }
    }
}

fn timeout(query: &Query) -> Duration {
    let asked = query.parameters().get("timeout_ms").and_then(|ms| ms.parse().ok());
    asked.map_or(TIMEOUT_MAX, Duration::from_millis).min(TIMEOUT_MAX)
}

/// Lets a request through to the service, unless it may not ask or repeats an earlier one.
fn admit(serving: &Serving, query: Query) -> Option<Replier> {
    let from = match caller(&query, serving.reads_only) {
        Ok(from) => from,
        Err(refusal) => {
            let claimed = claimed(&query);
            Replier::new(serving, query, None, claimed).answer::<()>(&Err(refusal));
            return None;
        }
    };
    let name = Name::of(&query, from.as_deref());
    if let Some(name) = &name {
        let mut memory = serving.memory.lock().unwrap_or_else(PoisonError::into_inner);
        match memory.requests.get_mut(name) {
            Some(Request::Running(waiting)) => {
                if waiting.len() < WAITING {
                    waiting.push(query);
                }
                return None;
            }
            Some(Request::Done(reply)) => {
                send(&query, reply, serving);
                return None;
            }
            None => memory.begin(name.clone()),
        }
    }
    Some(Replier::new(serving, query, name, from))
}

/// Who asks; `None`: anonymous, and may do so.
fn caller(query: &Query, reads_only: bool) -> Result<Option<String>, Refusal> {
    let parameters = query.parameters();
    check_version(parameters.get("version"))?;
    Ok(check_caller(parameters.get("from"), reads_only)?.map(str::to_owned))
}

/// The name that a refused request gave, for the books, however bad it is.
fn claimed(query: &Query) -> Option<String> {
    let name = query.parameters().get("from").filter(|name| *name != ANONYMOUS)?;
    Some(name.chars().take(CLAIM_MAX).collect())
}

/// By which a request is known when it is repeated: two clients may well use the same ids.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Name {
    id: String,
    from: Option<String>,
    /// Of what is asked, as it came.
    payload: u64,
}

impl Name {
    fn of(query: &Query, from: Option<&str>) -> Option<Self> {
        let id = query.parameters().get("id").filter(|id| id.len() <= ID_MAX)?.to_owned();
        let mut hasher = DefaultHasher::new();
        query.payload().map(ZBytes::to_bytes).hash(&mut hasher);
        Some(Self { id, from: from.map(str::to_owned), payload: hasher.finish() })
    }
}

/// What the requests of one invocation share.
#[derive(Clone)]
struct Serving {
    reads_only: bool,
    memory: Arc<Mutex<Memory>>,
    health: Arc<Health>,
    audit: Arc<OnceLock<AuditHook>>,
    instance: Instance,
    /// The same, as an answer says it.
    source: SourceInfo,
}

/// The duty to answer one request, and those that repeat it.
struct Replier {
    query: Query,
    format: Format,
    name: Option<Name>,
    from: Option<String>,
    serving: Serving,
    answered: bool,
}

impl Replier {
    fn new(serving: &Serving, query: Query, name: Option<Name>, from: Option<String>) -> Self {
        let format = query.encoding().map_or(Format::Cbor, Format::of);
        Self { query, format, name, from, serving: serving.clone(), answered: false }
    }

    fn answer<A: Serialize>(&mut self, answer: &Result<A, Refusal>) {
        self.answered = true;
        let reply = Reply::new(answer, self.format);
        let passing = matches!(answer, Err(refusal) if [BUSY, EXPIRED].contains(&&*refusal.code));
        // before anybody hears the answer: who asks again at once is not answered from what was
        let waiting = self.remember(&reply, passing);
        for query in std::iter::once(&self.query).chain(&waiting) {
            send(query, &reply, &self.serving);
        }
        self.tell(&reply);
    }

    /// Keeps the answer, or forgets the request if the answer is about the moment. Returns the repetitions that wait for it.
    fn remember(&self, reply: &Reply, passing: bool) -> Vec<Query> {
        let Some(name) = &self.name else { return Vec::new() };
        let mut memory = self.serving.memory.lock().unwrap_or_else(PoisonError::into_inner);
        if passing { memory.forget(name) } else { memory.finish(name, reply) }
    }
}

impl Replier {
    /// Tells who keeps the books.
    fn tell(&self, reply: &Reply) {
        let Some(hook) = self.serving.audit.get() else { return };
        let request = self.query.payload().map(ZBytes::to_bytes).unwrap_or_default();
        let invocation = self.query.key_expr().as_str().rsplit('/').next().unwrap_or_default();
        hook(Audited {
            invocation: invocation.to_owned(),
            caller: self.from.clone(),
            id: self.name.as_ref().map(|name| name.id.clone()),
            request: Document::new(self.format, &request),
            accepted: reply.good,
            answer: Document::new(reply.format, &reply.bytes.to_bytes()),
        });
    }
}

impl Drop for Replier {
    fn drop(&mut self) {
        if !self.answered {
            self.answer::<()>(&Err(refusal("unanswered", "the service gave up on it; look at its log")));
        }
    }
}

/// An answer, written.
#[derive(Clone)]
struct Reply {
    good: bool,
    bytes: ZBytes,
    format: Format,
}

impl Reply {
    fn new<A: Serialize>(answer: &Result<A, Refusal>, format: Format) -> Self {
        let encoded = match answer {
            Ok(answer) => codec::encode(answer, format).map(|bytes| (true, bytes)),
            Err(refusal) => codec::encode(refusal, format).map(|bytes| (false, bytes)),
        };
        let (good, bytes) = encoded.unwrap_or_else(|reason| {
            let refusal = refusal("unanswered", &format!("the answer cannot be written: {reason}"));
            (false, codec::encode(&refusal, format).unwrap_or_default())
        });
        Self { good, bytes: bytes.into(), format }
    }
}

fn send(query: &Query, reply: &Reply, serving: &Serving) {
    let encoding = reply.format.encoding();
    let sent = if reply.good {
        let answer = query.reply(query.key_expr().clone(), reply.bytes.clone());
        answer.source_info(serving.source.clone()).encoding(encoding).wait()
    } else {
        query.reply_err(reply.bytes.clone()).encoding(encoding).wait()
    };
    if let Err(e) = sent {
        serving.health.unsent(query.key_expr().as_str(), &e.to_string());
    }
}

/// Requests with an id, so that a repeated one is not executed again; the oldest are forgotten.
#[derive(Default)]
struct Memory {
    requests: HashMap<Name, Request>,
    order: VecDeque<Name>,
}

enum Request {
    Running(Vec<Query>),
    Done(Reply),
}

impl Memory {
    fn begin(&mut self, name: Name) {
        if self.order.len() >= REMEMBERED
            && let Some(oldest) = self.order.pop_front()
        {
            self.requests.remove(&oldest);
        }
        self.order.push_back(name.clone());
        self.requests.insert(name, Request::Running(Vec::new()));
    }

    /// Whoever repeats it asks anew. Returns the repetitions that wait for an answer.
    fn forget(&mut self, name: &Name) -> Vec<Query> {
        self.order.retain(|known| known != name);
        match self.requests.remove(name) {
            Some(Request::Running(waiting)) => waiting,
            Some(Request::Done(_)) | None => Vec::new(),
        }
    }

    /// Remembers an answer and returns the repetitions that wait for it.
    fn finish(&mut self, name: &Name, reply: &Reply) -> Vec<Query> {
        let Some(request) = self.requests.get_mut(name) else { return Vec::new() };
        let kept = if reply.bytes.len() <= REMEMBERED_BYTES {
            reply.clone()
        } else {
            let forgotten = refusal(
                "answer-too-large",
                "it was executed; its answer is too large to be kept: ask for the state",
            );
            Reply::new::<()>(&Err(forgotten), reply.format)
        };
        match std::mem::replace(request, Request::Done(kept)) {
            Request::Running(waiting) => waiting,
            Request::Done(_) => Vec::new(),
        }
    }
}
