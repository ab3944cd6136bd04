//! A connection that exists, whoever made it.

use super::wire::Wire;
use std::io::{self, ErrorKind};

/// The connection.
pub struct Connection {
    wire: Wire,
    pending: Vec<u8>,
}

impl Connection {
    /// A connection in use.
    pub fn new(wire: Wire) -> Self {
        Self { wire, pending: vec![] }
    }

    /// Waits for bytes, and sends meanwhile what waits. Can be cancelled without loss.
    ///
    /// # Errors
    /// If the connection is over.
    pub async fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        loop {
            let waiting = !self.pending.is_empty();
            tokio::select! {
                ready = self.wire.readable() => {
                    ready?;
                    match self.wire.try_read(into) {
                        Ok(0) => return Err(io::Error::new(ErrorKind::UnexpectedEof, "closed by the other end")),
                        Ok(_) => return Ok(()),
                        Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                        Err(error) => return Err(error),
                    }
                }
                ready = self.wire.writable(), if waiting => {
                    ready?;
                    self.flush()?;
                }
            }
        }
    }

    /// A full queue means that it is over.
    pub fn ends_when_full(&self) -> bool {
        self.wire.ends_when_full()
    }

    /// Puts a frame into the queue. False: the queue is full.
    pub fn queue(&mut self, frame: &[u8]) -> bool {
        let room = self.pending.len() < self.wire.room();
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
            match self.wire.try_write(&self.pending) {
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
