//! What can go wrong, and what to do about it.

use crate::KeyError;
use crate::contract::Refusal;
use std::time::Duration;

/// A session, publisher or subscriber could not be made.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// A name cannot be part of a key.
    #[error(transparent)]
    Key(#[from] KeyError),
    /// The endpoint is not usable.
    #[error(
        "endpoint `{endpoint}`: {reason}; write it as tcp/127.0.0.1:7447 and check that nothing else listens there"
    )]
    Endpoint {
        /// What was given.
        endpoint: String,
        /// What the network said.
        reason: String,
    },
    /// There is no runtime to work on.
    #[error("open a session inside a multi-threaded tokio runtime")]
    Runtime,
    /// The network layer refused; the session is probably closed.
    #[error("the session does not work any more ({0}); open a new one")]
    Network(String),
}

impl SessionError {
    pub(crate) fn network(error: zenoh::Error) -> Self {
        Self::Network(error.to_string())
    }
}

/// An invocation that has no good answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CallError {
    /// Nobody serves it, or nobody can be reached.
    #[error("nobody answers `{name}`: is the agent running and reachable?")]
    Unreachable {
        /// The invocation.
        name: String,
    },
    /// The connection was lost while it was out; it may or may not have been done.
    #[error(
        "the connection was lost before `{name}` was answered: it may have been done; look at the state before trying again"
    )]
    Lost {
        /// The invocation.
        name: String,
    },
    /// It was taken, but no answer came in time; it may or may not have been done.
    #[error("no answer to `{name}` within {after:?}; look at the state before trying again")]
    Timeout {
        /// The invocation.
        name: String,
        /// The deadline.
        after: Duration,
    },
    /// It was refused.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The answer could not be read: probably another version of the contract.
    #[error("the answer to `{name}` cannot be read ({reason}): compare the versions with `describe`")]
    Undecodable {
        /// The invocation.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The session is closed.
    #[error("the session is closed")]
    Closed,
}
