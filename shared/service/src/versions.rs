//! Services of another major version are told of in words, once each time they appear.

use crate::Wiring;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinHandle;
use usal::contract::{Empty, OTHER_VERSION};
use usal::{CallError, Session, SessionError, topics};

/// A service describes itself within this time.
const ANSWER_WITHIN: Duration = Duration::from_secs(5);

/// Asks each service that is followed, when it appears, whether it speaks our version; `None`: none is followed.
pub(crate) fn start<I>(
    session: &Session,
    wiring: &Wiring<I>,
) -> Result<Option<JoinHandle<()>>, SessionError> {
    let followed: BTreeSet<&'static str> = wiring.follows.iter().map(|topic| topic.service).collect();
    if followed.is_empty() {
        return Ok(None);
    }
    let (mut presence, session) = (session.presence()?, session.clone());
    Ok(Some(tokio::spawn(async move {
        let mut known = Arc::<BTreeSet<String>>::default();
        while let Some(there) = presence.changed().await {
            for service in followed.iter().filter(|s| there.contains(**s) && !known.contains(**s)) {
                if let Some(reason) = refusal(&session, service).await {
                    tracing::error!("nothing can be had of the service `{service}`: {reason}");
                }
            }
            known = there;
        }
    })))
}

/// Why a service refuses to describe itself to our version. One that doesn't answer may be slow.
async fn refusal(session: &Session, service: &'static str) -> Option<String> {
    match session.call(topics::describe(service), &Empty {}, ANSWER_WITHIN).await {
        Err(CallError::Refused(refusal)) if refusal.code == OTHER_VERSION => Some(refusal.reason),
        Ok(_) | Err(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use usal::contract::check_version;

    #[tokio::test(flavor = "multi_thread")]
    async fn service_of_version_two_refuses_in_words_and_ours_does_not() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let endpoint = format!("tcp/{}", listener.local_addr().unwrap());
        drop(listener);
        let hub = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
        let mut describe = hub.serve_description("gateway").unwrap();
        let gateway = tokio::spawn(async move {
            for checked in [check_version(Some("2")), Ok(())] {
                let incoming = describe.recv().await.unwrap();
                incoming.answer(checked.map(|()| usal::spec::GATEWAY.describe()));
            }
        });
        let client = Session::open(usal::Config::client("uav1", &endpoint).named("storage")).await.unwrap();
        let refused = refusal(&client, "gateway").await;
        assert!(refused.as_ref().is_some_and(|why| why.contains("version 2")), "{refused:?}");
        assert_eq!(refusal(&client, "gateway").await, None);
        gateway.await.unwrap();
    }
}
