//! Datagrams. The return path belongs to the autopilot that spoke first, not to any stranger.

use super::Stats;
use crate::gateway::driver::{Decoded, Decoder};
use mavlink::dialects::ardupilotmega::{MavAutopilot, MavMessage};
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use tokio::net::{UdpSocket, lookup_host};

/// An autopilot that was silent for so long may come back from another address.
const UNPIN_AFTER: Duration = Duration::from_secs(5);
/// Largest datagram.
const LARGEST: usize = 65_536;

/// A socket and who is at its other end.
pub struct Udp {
    socket: UdpSocket,
    peer: Option<(SocketAddr, Instant)>,
    /// We chose the peer, so it never changes.
    fixed: bool,
    decoder: Decoder,
    buffer: Vec<u8>,
}

impl Udp {
    /// Waits for an autopilot that sends here.
    pub async fn listen(at: &str) -> io::Result<Self> {
        Ok(Self::with(UdpSocket::bind(at).await?, None))
    }

    /// Sends to an autopilot that listens there.
    pub async fn to(to: &str) -> io::Result<Self> {
        let none = || io::Error::new(io::ErrorKind::NotFound, format!("no address for {to}"));
        let peer = lookup_host(to).await?.next().ok_or_else(none)?;
        let own = if peer.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" };
        Ok(Self::with(UdpSocket::bind(own).await?, Some(peer)))
    }

    fn with(socket: UdpSocket, peer: Option<SocketAddr>) -> Self {
        Self {
            socket,
            peer: peer.map(|p| (p, Instant::now())),
            fixed: peer.is_some(),
            decoder: Decoder::default(),
            buffer: vec![0; LARGEST],
        }
    }

    /// Our own address.
    pub fn local_address(&self) -> Option<SocketAddr> {
        self.socket.local_addr().ok()
    }

    /// Waits for a datagram; its messages, if it is the autopilot's, go to `out`.
    pub async fn receive(&mut self, out: &mut Vec<Decoded>, stats: &mut Stats) {
        let (length, from) = match self.socket.recv_from(&mut self.buffer).await {
            Ok(received) => received,
            Err(error) => {
                // an ICMP "port unreachable" of an autopilot that is not there yet
                tracing::debug!(%error, "autopilot's link");
                return;
            }
        };
        let mut decoded = vec![];
        self.decoder.feed_datagram(self.buffer.get(..length).unwrap_or_default(), &mut decoded);
        stats.garbage += std::mem::take(&mut self.decoder.garbage);
        if decoded.is_empty() {
            return;
        }
        if self.is_peer(from, &decoded) {
            out.append(&mut decoded);
        } else {
            stats.strangers += 1;
        }
    }

    fn is_peer(&mut self, from: SocketAddr, decoded: &[Decoded]) -> bool {
        let now = Instant::now();
        match &mut self.peer {
            Some((peer, heard)) if *peer == from => {
                *heard = now;
                true
            }
            Some((_, heard)) if self.fixed || now.duration_since(*heard) < UNPIN_AFTER => false,
            // only a voice that sounds like an autopilot is given the return path
            _ if decoded.iter().any(|(_, m)| is_autopilot(m)) => {
                tracing::info!(%from, "autopilot's link");
                self.peer = Some((from, now));
                true
            }
            _ => false,
        }
    }

    /// Sends a datagram. False: it could not be sent.
    pub fn send(&mut self, bytes: &[u8]) -> bool {
        self.peer.is_some_and(|(peer, _)| self.socket.try_send_to(bytes, peer).is_ok())
    }
}

fn is_autopilot(message: &MavMessage) -> bool {
    matches!(message, MavMessage::HEARTBEAT(b) if b.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID)
}
