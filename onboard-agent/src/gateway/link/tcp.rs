//! A TCP connection to the autopilot, made again when it breaks.

use super::Stats;
use crate::gateway::driver::{Decoded, Decoder};
use std::io;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::task::JoinHandle;

/// Waiting time before the first and between later attempts.
const BACKOFF: (Duration, Duration) = (Duration::from_millis(50), Duration::from_secs(2));
/// An attempt takes no longer.
const CONNECT_WITHIN: Duration = Duration::from_secs(3);
/// What an autopilot does not take in is dropped, with the connection, beyond so many bytes.
const MOST_UNSENT: usize = 256 * 1024;
const READ_AT_ONCE: usize = 16 * 1024;

enum State {
    /// An attempt that goes on although nobody looks.
    Connecting(JoinHandle<io::Result<TcpStream>>),
    Open(TcpStream),
}

/// The connection.
pub struct Tcp {
    to: String,
    state: State,
    backoff: Duration,
    decoder: Decoder,
    buffer: Vec<u8>,
    unsent: Vec<u8>,
}

impl Tcp {
    /// Begins to connect.
    pub fn to(to: &str) -> Self {
        Self {
            to: to.to_owned(),
            state: attempt(to.to_owned(), Duration::ZERO),
            backoff: BACKOFF.0,
            decoder: Decoder::default(),
            buffer: vec![0; READ_AT_ONCE],
            unsent: vec![],
        }
    }

    /// Waits for bytes; the messages in them go to `out`.
    pub async fn receive(&mut self, out: &mut Vec<Decoded>, stats: &mut Stats) {
        match &mut self.state {
            State::Connecting(attempt) => match attempt.await {
                Ok(Ok(stream)) => self.connected(stream),
                Ok(Err(error)) => self.again(&error.to_string()),
                Err(error) => self.again(&error.to_string()),
            },
            State::Open(stream) => {
                let read = match stream.readable().await {
                    Ok(()) => stream.try_read(&mut self.buffer),
                    Err(error) => Err(error),
                };
                self.took(read, out, stats);
            }
        }
    }

    fn connected(&mut self, stream: TcpStream) {
        tracing::info!(to = self.to, "connected to the autopilot");
        self.backoff = BACKOFF.0;
        self.decoder = Decoder::default();
        self.unsent.clear();
        self.state = State::Open(stream);
    }

    fn took(&mut self, read: io::Result<usize>, out: &mut Vec<Decoded>, stats: &mut Stats) {
        match read {
            Ok(0) => self.again("closed by the autopilot"),
            Ok(length) => {
                self.decoder.feed(self.buffer.get(..length).unwrap_or_default(), out);
                stats.garbage += std::mem::take(&mut self.decoder.garbage);
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => self.again(&error.to_string()),
        }
    }

    fn again(&mut self, why: &str) {
        tracing::debug!(to = self.to, why, "no connection to the autopilot; trying again");
        self.state = attempt(self.to.clone(), self.backoff);
        self.backoff = (self.backoff * 2).min(BACKOFF.1);
    }

    /// Puts bytes into the queue. False: not connected.
    pub fn queue(&mut self, bytes: &[u8]) -> bool {
        let open = matches!(self.state, State::Open(_));
        if open {
            self.unsent.extend_from_slice(bytes);
        }
        open
    }

    /// Sends what it can.
    pub fn flush(&mut self) {
        let State::Open(stream) = &mut self.state else { return };
        while !self.unsent.is_empty() {
            match stream.try_write(&self.unsent) {
                Ok(length) => {
                    self.unsent.drain(..length);
                }
                Err(error)
                    if error.kind() == io::ErrorKind::WouldBlock && self.unsent.len() < MOST_UNSENT =>
                {
                    return;
                }
                Err(error) => return self.again(&error.to_string()),
            }
        }
    }
}

impl Drop for Tcp {
    fn drop(&mut self) {
        if let State::Connecting(attempt) = &self.state {
            attempt.abort();
        }
    }
}

fn attempt(to: String, after: Duration) -> State {
    State::Connecting(tokio::spawn(async move {
        tokio::time::sleep(after).await;
        let stream = tokio::time::timeout(CONNECT_WITHIN, TcpStream::connect(&to)).await??;
        stream.set_nodelay(true)?;
        Ok(stream)
    }))
}
