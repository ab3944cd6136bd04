//! What a connection runs on: a TCP stream or a serial line.

use crate::address::Line;
use std::io::{self, ErrorKind};
use std::time::Duration;
use tokio::net::TcpStream;
use tokio_serial::{ErrorKind as Kind, SerialPortBuilderExt, SerialStream};

/// An attempt to connect takes no longer.
const CONNECT_WITHIN: Duration = Duration::from_secs(3);
/// Unsent bytes that are kept for a TCP stream; one that takes in less is over.
const TCP_ROOM: usize = 256 * 1024;
/// And for a serial line at least: what does not go out within about a second is too old to be sent.
const SERIAL_ROOM: usize = 4096;
const READ_AT_ONCE: usize = 16 * 1024;

/// A stream of bytes to the far end.
pub enum Wire {
    /// A TCP stream.
    Tcp(TcpStream),
    /// A serial line, and its rate in bits a second.
    Serial(SerialStream, u32),
}

impl Wire {
    /// Connects by TCP.
    ///
    /// # Errors
    /// Nobody listens there, or it takes too long.
    pub async fn tcp(to: &str) -> io::Result<Self> {
        Ok(Wire::of(tokio::time::timeout(CONNECT_WITHIN, TcpStream::connect(to)).await??))
    }

    /// Around a TCP stream.
    pub fn of(stream: TcpStream) -> Self {
        // small frames must not wait for each other; if that can't be had, it still works
        let _ = stream.set_nodelay(true);
        Wire::Tcp(stream)
    }

    /// Opens a serial line.
    ///
    /// # Errors
    /// It can't be opened; says why, and what to do.
    pub fn serial(line: &Line) -> io::Result<Self> {
        let opened = tokio_serial::new(&line.device, line.baud).open_native_async();
        opened.map(|stream| Wire::Serial(stream, line.baud)).map_err(|error| explained(&error))
    }

    /// Unsent bytes that may wait.
    pub fn room(&self) -> usize {
        match self {
            Wire::Tcp(_) => TCP_ROOM,
            // ten bits a byte
            Wire::Serial(_, baud) => usize::try_from(baud / 10).unwrap_or(SERIAL_ROOM).max(SERIAL_ROOM),
        }
    }

    /// More than that is waiting: the far end is gone, and not only slow.
    pub fn ends_when_full(&self) -> bool {
        matches!(self, Wire::Tcp(_))
    }

    /// Waits until there is something to read.
    pub async fn readable(&self) -> io::Result<()> {
        match self {
            Wire::Tcp(stream) => stream.readable().await,
            Wire::Serial(stream, _) => stream.readable().await,
        }
    }

    /// Waits until something can be sent.
    pub async fn writable(&self) -> io::Result<()> {
        match self {
            Wire::Tcp(stream) => stream.writable().await,
            Wire::Serial(stream, _) => stream.writable().await,
        }
    }

    /// Appends what is there to read. 0: the far end is gone.
    pub fn try_read(&mut self, into: &mut Vec<u8>) -> io::Result<usize> {
        match self {
            Wire::Tcp(stream) => {
                into.reserve(READ_AT_ONCE);
                stream.try_read_buf(into)
            }
            Wire::Serial(stream, _) => {
                let mut piece = [0; 1024];
                let length = stream.try_read(&mut piece)?;
                into.extend_from_slice(piece.get(..length).unwrap_or_default());
                Ok(length)
            }
        }
    }

    /// Sends the beginning of these bytes; says how many.
    pub fn try_write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Wire::Tcp(stream) => stream.try_write(bytes),
            Wire::Serial(stream, _) => stream.try_write(bytes),
        }
    }
}

/// What is wrong with a serial line, and what to do.
fn explained(error: &tokio_serial::Error) -> io::Error {
    let (kind, advice) = match error.kind() {
        Kind::Io(ErrorKind::NotFound) => (
            ErrorKind::NotFound,
            "there is no such device; plug it in (`ls /dev/serial/by-id` shows what is there)",
        ),
        Kind::Io(ErrorKind::PermissionDenied) => (
            ErrorKind::PermissionDenied,
            "this user may not open it; add the user to group dialout (`sudo usermod -aG dialout USER`) and log in again",
        ),
        Kind::NoDevice => {
            (ErrorKind::ResourceBusy, "another program has it open, or it is gone; end that program")
        }
        _ => return io::Error::other(format!("it can't be used as a serial line: {error}")),
    };
    io::Error::new(kind, advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn why_a_serial_line_cannot_be_opened_is_said_with_what_to_do() {
        for (kind, advice) in [
            (Kind::Io(ErrorKind::PermissionDenied), "group dialout"),
            (Kind::Io(ErrorKind::NotFound), "no such device"),
            (Kind::NoDevice, "another program"),
            (Kind::Unknown, "odd"),
        ] {
            let told = explained(&tokio_serial::Error::new(kind, "odd")).to_string();
            assert!(told.contains(advice), "{told}");
        }
    }
}
