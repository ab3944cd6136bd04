//! A request, and the duty to answer it.

use serde::Serialize;
use std::fmt;
use tokio::sync::oneshot;
use usal::contract::Refusal;
use usal::{Incoming, Instance};

/// A request that wants its one answer.
#[derive(Debug)]
pub struct Request<Q, A> {
    /// What is asked.
    pub request: Q,
    /// Who asks: a service's or a program's name; `None`: somebody who doesn't say.
    pub caller: Option<String>,
    /// The request's own name: the same for each repetition of it.
    pub id: Option<String>,
    /// Which of the sessions of that name asks, if it says so.
    pub instance: Option<Instance>,
    /// The service's own session.
    pub served_by: Option<Instance>,
    /// Takes the answer.
    pub reply: Reply<A>,
}

/// The duty to answer a request; dropped, it is answered as `unanswered`.
pub struct Reply<A>(Box<dyn FnOnce(Result<A, Refusal>) + Send>);

impl<A> fmt::Debug for Reply<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Reply")
    }
}

impl<A> Reply<A> {
    pub(crate) fn send(self, answer: Result<A, Refusal>) {
        (self.0)(answer);
    }
}

impl<Q, A: Send + 'static> Request<Q, A> {
    /// A request of a test; the answer comes out at the other end.
    pub fn new(request: Q, caller: &str) -> (Self, oneshot::Receiver<Result<A, Refusal>>) {
        let (sender, receiver) = oneshot::channel();
        // a test that doesn't look at the answer doesn't want it
        let reply = Reply(Box::new(move |answer| drop(sender.send(answer))));
        (
            Self { request, caller: Some(caller.into()), id: None, instance: None, served_by: None, reply },
            receiver,
        )
    }
}

impl<Q: 'static, A: Serialize + 'static> From<Incoming<Q, A>> for Request<Q, A> {
    fn from(incoming: Incoming<Q, A>) -> Self {
        let (caller, id) = (incoming.from().map(str::to_owned), incoming.id().map(str::to_owned));
        let (instance, served_by) = (incoming.instance(), Some(incoming.served_by()));
        let (request, reply) = incoming.split();
        Self { request, caller, id, instance, served_by, reply: Reply(Box::new(reply)) }
    }
}
