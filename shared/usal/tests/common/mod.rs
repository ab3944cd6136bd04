//! A hub on a free port, clients of it, outside clients that know only Zenoh, and waiting with a
//! deadline.
#![allow(dead_code, reason = "each test uses its own part of it")]

use std::future::Future;
use std::time::Duration;
use usal::{Config, Presence, Session};
use zenoh::bytes::Encoding;

/// Longer than anything takes on a slow machine.
pub const DEADLINE: Duration = Duration::from_secs(30);

pub async fn within<F: Future>(future: F) -> F::Output {
    tokio::time::timeout(DEADLINE, future).await.expect("in time")
}

/// Waits until a condition holds.
pub async fn until(mut condition: impl AsyncFnMut() -> bool) {
    within(async {
        while !condition().await {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    })
    .await;
}

pub async fn until_alive(presence: &mut Presence, service: &str, alive: bool) {
    within(async {
        while presence.is_alive(service) != alive {
            presence.changed().await.unwrap();
        }
    })
    .await;
}

/// An endpoint that nobody listens on.
pub fn free_endpoint() -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    format!("tcp/{}", listener.local_addr().unwrap())
}

/// A client that has found its hub.
pub async fn client(endpoint: &str) -> Session {
    let session = Session::open(Config::client("uav1", endpoint).named("test")).await.unwrap();
    until(async || session.is_connected().await).await;
    session
}

pub struct Net {
    pub hub: Session,
    pub endpoint: String,
}

impl Net {
    pub async fn open() -> Self {
        let endpoint = free_endpoint();
        let hub = Session::open(Config::hub("uav1", &endpoint)).await.unwrap();
        Self { hub, endpoint }
    }

    pub async fn client(&self) -> Session {
        client(&self.endpoint).await
    }
}

/// Somebody else's program: an ordinary Zenoh client.
pub async fn outside_client(endpoint: &str) -> zenoh::Session {
    let mut config = zenoh::Config::default();
    config.insert_json5("mode", r#""client""#).unwrap();
    config.insert_json5("connect/endpoints", &format!("[{endpoint:?}]")).unwrap();
    config.insert_json5("scouting/multicast/enabled", "false").unwrap();
    zenoh::open(config).await.unwrap()
}

pub async fn put(session: &zenoh::Session, name: &str, payload: &[u8], encoding: Encoding) {
    session.put(format!("legwork/uav1/{name}"), payload).encoding(encoding).await.unwrap();
}

/// Asks as an outside client does; the reply as text.
pub async fn ask(
    session: &zenoh::Session,
    service: &str,
    name: &str,
    id: &str,
    payload: &[u8],
    encoding: Encoding,
) -> Result<String, String> {
    let id = if id.is_empty() { String::new() } else { format!("id={id}") };
    let from = if id.contains("from=") { "" } else { ";from=outside" };
    ask_with(session, service, name, &format!("{id}{from}"), payload, encoding).await
}

/// The same, with these parameters of the selector.
pub async fn ask_with(
    session: &zenoh::Session,
    service: &str,
    name: &str,
    parameters: &str,
    payload: &[u8],
    encoding: Encoding,
) -> Result<String, String> {
    let selector = format!("legwork/uav1/{service}/invocation/{name}?{parameters}");
    let replies = session.get(selector).payload(payload).encoding(encoding).await.unwrap();
    let reply = within(replies.recv_async()).await.expect("an answer");
    let text = |bytes: &zenoh::bytes::ZBytes| String::from_utf8_lossy(&bytes.to_bytes()).into_owned();
    match reply.result() {
        Ok(sample) => Ok(text(sample.payload())),
        Err(error) => Err(text(error.payload())),
    }
}
