//! TCP connections that others make to us, one at a time.

use super::connection::Connection;
use super::wire::Wire;
use super::{Event, Peer};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::net::TcpListener;

/// Pause when no connection can be accepted (out of descriptors or the like).
const PAUSE: Duration = Duration::from_millis(100);

/// The socket, and who is connected to it.
pub struct Listen {
    listener: TcpListener,
    client: Option<(Peer, Connection)>,
    clients: u32,
}

impl Listen {
    /// Waits for a client.
    pub fn new(listener: TcpListener) -> Self {
        Self { listener, client: None, clients: 0 }
    }

    /// Our own address.
    pub fn local_address(&self) -> Option<SocketAddr> {
        self.listener.local_addr().ok()
    }

    /// The client.
    pub fn peer(&self) -> Option<Peer> {
        self.client.as_ref().map(|(peer, _)| *peer)
    }

    /// Waits for what happens next.
    pub async fn next(&mut self, into: &mut Vec<u8>) -> Event {
        loop {
            let Some((peer, connection)) = &mut self.client else {
                if let Ok((stream, _)) = self.listener.accept().await {
                    self.clients = self.clients.wrapping_add(1);
                    let peer = Peer(self.clients);
                    self.client = Some((peer, Connection::new(Wire::of(stream))));
                    return Event::Connected(peer);
                }
                tokio::time::sleep(PAUSE).await;
                continue;
            };
            let peer = *peer;
            tokio::select! {
                second = self.listener.accept() => {
                    if let Ok((_, from)) = second {
                        tracing::warn!("{from} turned away: one client a port; it is taken");
                    }
                }
                received = connection.receive(into) => {
                    if received.is_ok() {
                        return Event::Stream(peer);
                    }
                    self.client = None;
                    return Event::Gone(peer);
                }
            }
        }
    }

    /// Puts a frame into the queue. False: the client is gone, or takes nothing in.
    pub fn queue(&mut self, to: Peer, frame: &[u8]) -> bool {
        match &mut self.client {
            Some((peer, connection)) if *peer == to => connection.queue(frame),
            _ => false,
        }
    }

    /// Sends what it can.
    pub fn flush(&mut self) {
        if let Some((_, connection)) = &mut self.client {
            // a connection that is over is found by the next read
            let _ = connection.flush();
        }
    }
}
