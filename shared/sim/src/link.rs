//! The sockets. A slow or hostile partner can neither stop the simulator nor make it grow: what can't
//! be sent is dropped, whole frames at a time.

use crate::config::Link;
use crate::core::{MOST_PEERS, Outgoing, Peer};
use crate::frame::{Decoder, Frame};
use anyhow::Context;
use std::collections::HashMap;
use std::io::ErrorKind;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use tokio::net::{TcpListener, TcpStream, UdpSocket};

/// Unsent bytes kept for a TCP client before frames are dropped.
const MOST_PENDING: usize = 256 * 1024;
/// A UDP partner not heard of for this long is forgotten.
const FORGET_AFTER: Duration = Duration::from_secs(60);

/// What happened on the link.
#[derive(Debug)]
pub(crate) enum LinkEvent {
    /// A partner came.
    Connected(Peer),
    /// A partner left.
    Gone(Peer),
    /// Frames from a partner.
    Frames(Peer, Vec<Frame>),
}

/// A bound socket that is not yet part of a runtime.
pub(crate) enum Bound {
    Tcp(std::net::TcpListener),
    Udp(std::net::UdpSocket, Option<SocketAddr>),
}

impl Bound {
    pub(crate) fn bind(link: Link) -> anyhow::Result<Self> {
        let advice = "choose another port, or 0 for any free one";
        let bound = match link {
            Link::Tcp(addr) => Bound::Tcp(
                std::net::TcpListener::bind(addr)
                    .with_context(|| format!("can't listen on tcp {addr}: {advice}"))?,
            ),
            Link::Udp(addr) => Bound::Udp(
                std::net::UdpSocket::bind(addr)
                    .with_context(|| format!("can't listen on udp {addr}: {advice}"))?,
                None,
            ),
            Link::UdpOut(target) => {
                let any: SocketAddr =
                    if target.is_ipv4() { ([0, 0, 0, 0], 0).into() } else { ([0_u16; 8], 0).into() };
                let local = if target.ip().is_loopback() { SocketAddr::new(target.ip(), 0) } else { any };
                let socket = std::net::UdpSocket::bind(local).context("can't open a udp socket")?;
                Bound::Udp(socket, Some(target))
            }
        };
        match &bound {
            Bound::Tcp(socket) => socket.set_nonblocking(true)?,
            Bound::Udp(socket, _) => socket.set_nonblocking(true)?,
        }
        Ok(bound)
    }

    pub(crate) fn address(&self) -> anyhow::Result<SocketAddr> {
        Ok(match self {
            Bound::Tcp(socket) => socket.local_addr()?,
            Bound::Udp(socket, _) => socket.local_addr()?,
        })
    }

    /// Makes it part of the present runtime.
    pub(crate) fn open(self) -> anyhow::Result<OpenLink> {
        Ok(match self {
            Bound::Tcp(socket) => OpenLink::Tcp(TcpLink {
                listener: TcpListener::from_std(socket)?,
                client: None,
                clients: 0,
                ignored_bytes: 0,
            }),
            Bound::Udp(socket, target) => OpenLink::Udp(UdpLink::new(UdpSocket::from_std(socket)?, target)),
        })
    }
}

/// A link in use.
pub(crate) enum OpenLink {
    Tcp(TcpLink),
    Udp(UdpLink),
}

impl OpenLink {
    /// Partners that are there from the start.
    pub(crate) fn known_peers(&self) -> Vec<Peer> {
        match self {
            OpenLink::Tcp(_) => Vec::new(),
            OpenLink::Udp(link) => link.by_address.values().map(|(peer, _)| *peer).collect(),
        }
    }

    /// The next thing that happens; may be dropped and called again at any time.
    pub(crate) async fn next(&mut self) -> LinkEvent {
        match self {
            OpenLink::Tcp(link) => link.next().await,
            OpenLink::Udp(link) => link.next().await,
        }
    }

    pub(crate) fn send(&mut self, frames: Vec<Outgoing>) {
        match self {
            OpenLink::Tcp(link) => link.send(&frames),
            OpenLink::Udp(link) => link.send(&frames),
        }
    }

    /// Bytes that were no frames.
    pub(crate) fn ignored_bytes(&self) -> u64 {
        match self {
            OpenLink::Tcp(link) => {
                link.ignored_bytes + link.client.as_ref().map_or(0, |c| c.decoder.ignored_bytes)
            }
            OpenLink::Udp(link) => link.decoder.ignored_bytes,
        }
    }
}

pub(crate) struct TcpLink {
    listener: TcpListener,
    client: Option<Client>,
    clients: u32,
    ignored_bytes: u64,
}

struct Client {
    stream: TcpStream,
    peer: Peer,
    decoder: Decoder,
    pending: Vec<u8>,
}

impl TcpLink {
    async fn next(&mut self) -> LinkEvent {
        loop {
            let Some(client) = &mut self.client else {
                if let Ok((stream, _)) = self.listener.accept().await {
                    return self.admit(stream);
                }
                // out of descriptors or the like: don't spin
                tokio::time::sleep(Duration::from_millis(100)).await;
                continue;
            };
            let wants_to_write = !client.pending.is_empty();
            tokio::select! {
                second = self.listener.accept() => {
                    if let Ok((_, from)) = second {
                        tracing::warn!("{from} turned away: one client a port; it is taken");
                    }
                }
                _ = client.stream.readable() => match client.read() {
                    Some(frames) if frames.is_empty() => {}
                    Some(frames) => return LinkEvent::Frames(client.peer, frames),
                    None => return self.dismiss(),
                },
                _ = client.stream.writable(), if wants_to_write => client.flush(),
            }
        }
    }

    fn admit(&mut self, stream: TcpStream) -> LinkEvent {
        // small frames must not wait for each other; if that can't be had, it still works
        let _ = stream.set_nodelay(true);
        self.clients = self.clients.wrapping_add(1);
        let peer = Peer(self.clients);
        self.client = Some(Client { stream, peer, decoder: Decoder::default(), pending: Vec::new() });
        LinkEvent::Connected(peer)
    }

    fn dismiss(&mut self) -> LinkEvent {
        let gone = self.client.take();
        self.ignored_bytes += gone.as_ref().map_or(0, |c| c.decoder.ignored_bytes);
        LinkEvent::Gone(gone.map_or(Peer(self.clients), |c| c.peer))
    }

    fn send(&mut self, frames: &[Outgoing]) {
        let Some(client) = &mut self.client else { return };
        for frame in frames.iter().filter(|f| f.to == client.peer) {
            if client.pending.len() < MOST_PENDING {
                client.pending.extend_from_slice(&frame.bytes);
            }
        }
        client.flush();
    }
}

impl Client {
    /// Frames read; `None`: the connection is over.
    fn read(&mut self) -> Option<Vec<Frame>> {
        let mut buffer = [0_u8; 4096];
        let mut frames = Vec::new();
        match self.stream.try_read(&mut buffer) {
            Ok(0) => return None,
            Ok(length) => self.decoder.push(&buffer[..length], |f| frames.push(f)),
            Err(e) if e.kind() == ErrorKind::WouldBlock => {}
            Err(_) => return None,
        }
        Some(frames)
    }

    fn flush(&mut self) {
        while !self.pending.is_empty() {
            match self.stream.try_write(&self.pending) {
                Ok(0) | Err(_) => break,
                Ok(length) => {
                    self.pending.drain(..length);
                }
            }
        }
    }
}

pub(crate) struct UdpLink {
    socket: UdpSocket,
    /// Sends to this one and listens to nobody else.
    only: Option<SocketAddr>,
    by_address: HashMap<SocketAddr, (Peer, Instant)>,
    decoder: Decoder,
    clients: u32,
}

impl UdpLink {
    fn new(socket: UdpSocket, only: Option<SocketAddr>) -> Self {
        let by_address = only.map(|addr| (addr, (Peer(1), Instant::now()))).into_iter().collect();
        Self { socket, only, by_address, decoder: Decoder::default(), clients: 1 }
    }

    async fn next(&mut self) -> LinkEvent {
        let mut buffer = [0_u8; 2048];
        loop {
            // an error is the echo of a partner that is not there: UDP goes on
            let Ok((length, from)) = self.socket.recv_from(&mut buffer).await else {
                tokio::task::yield_now().await;
                continue;
            };
            let mut frames = Vec::new();
            self.decoder.datagram(&buffer[..length], |f| frames.push(f));
            if frames.is_empty() || self.only.is_some_and(|addr| addr != from) {
                continue;
            }
            if let Some(peer) = self.peer_at(from) {
                return LinkEvent::Frames(peer, frames);
            }
        }
    }

    /// The partner at an address; a new one if there is room.
    fn peer_at(&mut self, from: SocketAddr) -> Option<Peer> {
        let now = Instant::now();
        if let Some((peer, heard)) = self.by_address.get_mut(&from) {
            *heard = now;
            return Some(*peer);
        }
        self.by_address.retain(|_, (_, heard)| now.duration_since(*heard) < FORGET_AFTER);
        if self.by_address.len() >= MOST_PEERS {
            return None;
        }
        self.clients = self.clients.wrapping_add(1);
        let peer = Peer(self.clients);
        self.by_address.insert(from, (peer, now));
        Some(peer)
    }

    fn send(&mut self, frames: &[Outgoing]) {
        for frame in frames {
            let to = self.by_address.iter().find(|(_, (peer, _))| *peer == frame.to);
            if let Some((address, _)) = to {
                // a full buffer or an absent partner loses the datagram, as radio does
                let _ = self.socket.try_send_to(&frame.bytes, *address);
            }
        }
    }
}
