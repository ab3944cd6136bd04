//! What was asked of the gateway and is not answered yet.

use usal::contract::{Empty, FeedAnswer, GatewayRequest, JoinAnswer};
use usal::{CallError, PendingCall};

/// What we asked the gateway.
#[derive(Default)]
pub struct Pending {
    /// To take waypoints.
    pub feed: Option<PendingCall<FeedAnswer>>,
    /// To join.
    pub join: Option<PendingCall<JoinAnswer>>,
    /// Anything else.
    pub request: Option<(GatewayRequest, PendingCall<Empty>)>,
}

/// An answer of the gateway.
pub enum Answered {
    /// To waypoints.
    Feed(Result<FeedAnswer, CallError>),
    /// To joining.
    Join(Result<JoinAnswer, CallError>),
    /// To anything else.
    Request(GatewayRequest, Result<Empty, CallError>),
}

impl Pending {
    /// Nothing was asked.
    pub fn is_empty(&self) -> bool {
        self.feed.is_none() && self.join.is_none() && self.request.is_none()
    }

    /// The next answer; never, if nothing was asked. May be cancelled.
    pub async fn next(&mut self) -> Answered {
        async fn answer<A>(call: Option<&mut PendingCall<A>>) -> Result<A, CallError> {
            match call {
                Some(call) => call.await,
                None => std::future::pending().await,
            }
        }
        let answered = tokio::select! {
            a = answer(self.join.as_mut()) => Answered::Join(a),
            a = answer(self.feed.as_mut()) => Answered::Feed(a),
            a = answer(self.request.as_mut().map(|(_, call)| call)) => {
                let request = self.request.as_ref().map_or(GatewayRequest::Hold, |(r, _)| r.clone());
                Answered::Request(request, a)
            }
        };
        match &answered {
            Answered::Feed(_) => self.feed = None,
            Answered::Join(_) => self.join = None,
            Answered::Request(..) => self.request = None,
        }
        answered
    }
}
