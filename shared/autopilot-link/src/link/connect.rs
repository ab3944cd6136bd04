//! A TCP connection that we make, and make again when it breaks.

use super::connection::Connection;
use super::{Event, Peer};
use std::io;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::task::JoinHandle;

/// Waiting time before the first and between later attempts.
const BACKOFF: (Duration, Duration) = (Duration::from_millis(50), Duration::from_secs(2));
/// An attempt takes no longer.
const CONNECT_WITHIN: Duration = Duration::from_secs(3);
/// The one at the other end.
const PEER: Peer = Peer(1);

enum State {
    /// An attempt that goes on in the background.
    Connecting(JoinHandle<io::Result<TcpStream>>),
    Open(Connection),
}

/// The connection.
pub struct Connect {
    to: String,
    state: State,
    backoff: Duration,
    /// It broke, and that was not reported yet.
    broke: bool,
}

impl Connect {
    /// Begins to connect.
    pub fn to(to: &str) -> Self {
        let state = attempt(to.to_owned(), Duration::ZERO);
        Self { to: to.to_owned(), state, backoff: BACKOFF.0, broke: false }
    }

    /// Who is at the other end, while there is a connection.
    pub fn peer(&self) -> Option<Peer> {
        matches!(self.state, State::Open(_)).then_some(PEER)
    }

    /// Waits for what happens next.
    pub async fn next(&mut self, into: &mut Vec<u8>) -> Event {
        loop {
            if std::mem::take(&mut self.broke) {
                return Event::Gone(PEER);
            }
            match &mut self.state {
                State::Connecting(attempt) => match attempt.await {
                    Ok(Ok(stream)) => return self.connected(stream),
                    Ok(Err(error)) => self.again(&error.to_string()),
                    Err(error) => self.again(&error.to_string()),
                },
                State::Open(connection) => match connection.receive(into).await {
                    Ok(()) => return Event::Stream(PEER),
                    Err(error) => self.broken(&error.to_string()),
                },
            }
        }
    }

    fn connected(&mut self, stream: TcpStream) -> Event {
        tracing::info!(to = self.to, "connected to the autopilot");
        self.backoff = BACKOFF.0;
        self.state = State::Open(Connection::new(stream));
        Event::Connected(PEER)
    }

    fn broken(&mut self, why: &str) {
        self.broke = true;
        self.again(why);
    }

    fn again(&mut self, why: &str) {
        tracing::debug!(to = self.to, why, "no connection to the autopilot; trying again");
        self.state = attempt(self.to.clone(), self.backoff);
        self.backoff = (self.backoff * 2).min(BACKOFF.1);
    }

    /// Puts a frame into the queue. False: not connected.
    pub fn queue(&mut self, to: Peer, frame: &[u8]) -> bool {
        let State::Open(connection) = &mut self.state else { return false };
        if to != PEER {
            return false;
        }
        let room = connection.queue(frame);
        if !room {
            self.broken("it does not take in what is sent");
        }
        room
    }

    /// Sends what it can.
    pub fn flush(&mut self) {
        let State::Open(connection) = &mut self.state else { return };
        if let Err(error) = connection.flush() {
            self.broken(&error.to_string());
        }
    }
}

impl Drop for Connect {
    fn drop(&mut self) {
        if let State::Connecting(attempt) = &self.state {
            attempt.abort();
        }
    }
}

fn attempt(to: String, after: Duration) -> State {
    State::Connecting(tokio::spawn(async move {
        tokio::time::sleep(after).await;
        tokio::time::timeout(CONNECT_WITHIN, TcpStream::connect(&to)).await?
    }))
}
