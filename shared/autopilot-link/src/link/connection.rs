//! A TCP connection that exists, whoever made it.

use std::io::{self, ErrorKind};
use tokio::net::TcpStream;

/// Unsent bytes that are kept before whole frames are dropped.
const MAX_PENDING: usize = 256 * 1024;
const READ_AT_ONCE: usize = 16 * 1024;

/// The connection.
pub struct Connection {
    stream: TcpStream,
    pending: Vec<u8>,
}

impl Connection {
    /// A connection in use.
    pub fn new(stream: TcpStream) -> Self {
        // small frames must not wait for each other; if that can't be had, it still works
        let _ = stream.set_nodelay(true);
        Self { stream, pending: vec![] }
    }

    /// Waits for bytes, and sends meanwhile what waits. Can be cancelled without loss.
    ///
    /// # Errors
    /// If the connection is over.
    pub async fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        into.reserve(READ_AT_ONCE);
        loop {
            let waiting = !self.pending.is_empty();
            tokio::select! {
                ready = self.stream.readable() => {
                    ready?;
                    match self.stream.try_read_buf(into) {
                        Ok(0) => return Err(io::Error::new(ErrorKind::UnexpectedEof, "closed by the other end")),
                        Ok(_) => return Ok(()),
                        Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                        Err(error) => return Err(error),
                    }
                }
                ready = self.stream.writable(), if waiting => {
                    ready?;
                    self.flush()?;
                }
            }
        }
    }

    /// Puts a frame into the queue. False: the queue is full.
    pub fn queue(&mut self, frame: &[u8]) -> bool {
        let room = self.pending.len() < MAX_PENDING;
        if room {
            self.pending.extend_from_slice(frame);
        }
        room
    }

    /// Sends what it can.
    ///
    /// # Errors
    /// If the connection is over.
    pub fn flush(&mut self) -> io::Result<()> {
        while !self.pending.is_empty() {
            match self.stream.try_write(&self.pending) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(length) => {
                    self.pending.drain(..length);
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}
