//! A connection that we make, by TCP or over a serial line, and make again when it breaks.

use super::connection::Connection;
use super::wire::Wire;
use super::{Event, Peer};
use crate::address::Line;
use std::fmt;
use std::io;
use std::time::Duration;
use tokio::task::JoinHandle;

/// Waiting time before the first and between later attempts.
const BACKOFF: (Duration, Duration) = (Duration::from_millis(50), Duration::from_secs(2));
/// The one at the other end.
const PEER: Peer = Peer(1);

/// What is connected to.
#[derive(Debug, Clone)]
pub enum Far {
    /// A place that listens.
    Tcp(String),
    /// A device.
    Serial(Line),
}

impl fmt::Display for Far {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Far::Tcp(to) => f.write_str(to),
            Far::Serial(Line { device, .. }) => f.write_str(device),
        }
    }
}

enum State {
    /// An attempt that goes on in the background.
    Connecting(JoinHandle<io::Result<Wire>>),
    Open(Connection),
}

/// The connection.
pub struct Connect {
    to: Far,
    state: State,
    backoff: Duration,
    /// Why there is no connection, as it was logged.
    told: Option<String>,
    /// It broke, and that was not reported yet.
    broke: bool,
}

impl Connect {
    /// Begins to connect.
    pub fn to(to: Far) -> Self {
        let state = attempt(to.clone(), Duration::ZERO);
        Self { to, state, backoff: BACKOFF.0, told: None, broke: false }
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
                    Ok(Ok(wire)) => return self.connected(wire),
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

    fn connected(&mut self, wire: Wire) -> Event {
        tracing::info!(to = %self.to, "connected to the autopilot");
        self.backoff = BACKOFF.0;
        self.told = None;
        self.state = State::Open(Connection::new(wire));
        Event::Connected(PEER)
    }

    fn broken(&mut self, why: &str) {
        self.broke = true;
        self.again(why);
    }

    fn again(&mut self, why: &str) {
        // the same reason time after time would fill the log
        if self.told.as_deref() != Some(why) {
            tracing::warn!(to = %self.to, "no connection to the autopilot, trying again: {why}");
            self.told = Some(why.to_owned());
        }
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
        if !room && connection.ends_when_full() {
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

fn attempt(to: Far, after: Duration) -> State {
    State::Connecting(tokio::spawn(async move {
        tokio::time::sleep(after).await;
        match &to {
            Far::Tcp(to) => Wire::tcp(to).await,
            Far::Serial(line) => Wire::serial(line),
        }
    }))
}
