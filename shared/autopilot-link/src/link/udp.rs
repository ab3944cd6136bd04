//! Datagrams. The return path belongs to those who were recognised, not to any stranger.

use super::{Event, Peer, Stats};
use socket2::SockRef;
use std::collections::VecDeque;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use tokio::net::{UdpSocket, lookup_host};

/// The largest datagram.
const LARGEST: usize = 65_536;

/// What the system is asked to keep while we do something else: a second of 5,000 messages, each of which it counts as some 800 bytes. It
/// may grant less.
const KEEPS: usize = 4 << 20;

/// So many who were not recognised are remembered.
const UNKNOWN_MAX: usize = 16;

/// Who may be at the other end of datagrams.
#[derive(Debug, Clone, Copy)]
pub enum Partners {
    /// This one, from the start, and nobody else ever.
    Only(SocketAddr),
    /// Whoever is recognised by what he says, until he has not been for too long.
    Recognised {
        /// So many at once.
        most: usize,
        /// Not recognised for so long, another may take the place: whoever goes on talking does not keep it by that.
        silent: Duration,
    },
}

impl Partners {
    /// The one autopilot that spoke first; one that was silent for so long may come back from another address.
    pub const AUTOPILOT: Self = Self::Recognised { most: 1, silent: Duration::from_secs(5) };
}

struct Partner {
    peer: Peer,
    address: SocketAddr,
    /// When he was recognised last.
    heard: Instant,
}

/// Who was not recognised.
struct Unknown {
    address: SocketAddr,
    datagrams: u64,
    bytes: u64,
}

/// A socket and who is at its other end.
pub struct Udp {
    socket: UdpSocket,
    rule: Partners,
    partners: Vec<Partner>,
    /// The latest who were not recognised: one of them may be the autopilot, which has not said yet that it is one.
    unknown: VecDeque<Unknown>,
    /// Peers that there were so far.
    given: u32,
}

impl Udp {
    /// Exchanges datagrams with those that the rule allows.
    pub fn new(socket: UdpSocket, rule: Partners) -> Self {
        keep_more(&socket);
        let mut udp = Self { socket, rule, partners: vec![], unknown: VecDeque::new(), given: 0 };
        if let Partners::Only(address) = rule {
            udp.admit(Instant::now(), address);
        }
        udp
    }

    /// Sends to the address.
    ///
    /// # Errors
    /// If there is no such place, or no socket.
    pub async fn to(to: &str) -> io::Result<Self> {
        let none = || io::Error::new(io::ErrorKind::NotFound, format!("no address for {to}"));
        let address = lookup_host(to).await?.next().ok_or_else(none)?;
        let own = if address.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" };
        Ok(Self::new(UdpSocket::bind(own).await?, Partners::Only(address)))
    }

    /// Our own address.
    pub fn local_address(&self) -> Option<SocketAddr> {
        self.socket.local_addr().ok()
    }

    /// Who is at the other end.
    pub fn peers(&self) -> Vec<Peer> {
        self.partners.iter().map(|p| p.peer).collect()
    }

    /// Waits for a partner's datagram.
    pub async fn next(
        &mut self,
        into: &mut Vec<u8>,
        mut is_partner: impl FnMut(&[u8]) -> bool,
        stats: &mut Stats,
    ) -> Event {
        into.reserve(LARGEST);
        loop {
            into.clear();
            // an error is the echo of a partner that is not there yet: datagrams go on
            let Ok((length, from)) = self.socket.recv_buf_from(into).await else {
                tokio::task::yield_now().await;
                continue;
            };
            if let Some(peer) = self.peer_at(Instant::now(), from, || is_partner(into)) {
                self.was_no_stranger(from, stats);
                return Event::Datagram(peer);
            }
            self.is_unknown(from, length as u64, stats);
        }
    }

    fn is_unknown(&mut self, from: SocketAddr, bytes: u64, stats: &mut Stats) {
        stats.strangers += 1;
        stats.stranger_bytes += bytes;
        if let Some(known) = self.unknown.iter_mut().find(|unknown| unknown.address == from) {
            known.datagrams += 1;
            known.bytes += bytes;
            return;
        }
        if self.unknown.len() >= UNKNOWN_MAX {
            self.unknown.pop_front();
        }
        self.unknown.push_back(Unknown { address: from, datagrams: 1, bytes });
    }

    /// What a partner sent before he was recognised, as an autopilot does between two heartbeats, was no stranger's.
    fn was_no_stranger(&mut self, partner: SocketAddr, stats: &mut Stats) {
        let Some(at) = self.unknown.iter().position(|unknown| unknown.address == partner) else { return };
        if let Some(Unknown { datagrams, bytes, .. }) = self.unknown.remove(at) {
            stats.strangers -= datagrams;
            stats.stranger_bytes -= bytes;
        }
    }

    /// The partner at an address; a new one if he is recognised and there is room.
    fn peer_at(&mut self, now: Instant, from: SocketAddr, is_partner: impl FnOnce() -> bool) -> Option<Peer> {
        let known = self.partners.iter_mut().find(|p| p.address == from);
        let Partners::Recognised { most, silent } = self.rule else { return known.map(|p| p.peer) };
        if let Some(partner) = known {
            if is_partner() {
                partner.heard = now;
            }
            return Some(partner.peer);
        }
        let recent = |p: &Partner| now.duration_since(p.heard) < silent;
        if self.partners.iter().filter(|p| recent(p)).count() >= most || !is_partner() {
            return None;
        }
        self.partners.retain(recent);
        tracing::info!(%from, "a partner on the autopilot's link");
        Some(self.admit(now, from))
    }

    fn admit(&mut self, now: Instant, address: SocketAddr) -> Peer {
        self.given = self.given.wrapping_add(1);
        let peer = Peer(self.given);
        self.partners.push(Partner { peer, address, heard: now });
        peer
    }

    /// Sends a datagram. False: it could not be sent.
    pub fn send(&mut self, to: Peer, bytes: &[u8]) -> bool {
        let partner = self.partners.iter().find(|p| p.peer == to);
        // a full buffer or an absent partner loses the datagram, as radio does
        partner.is_some_and(|p| self.socket.try_send_to(bytes, p.address).is_ok())
    }
}

/// By itself a system keeps so little that a moment's flood pushes out what the autopilot says.
fn keep_more(socket: &UdpSocket) {
    let socket = SockRef::from(socket);
    let before = socket.recv_buffer_size().unwrap_or(0);
    // what a system has set to more is not made less
    let asked = if before < KEEPS { socket.set_recv_buffer_size(KEEPS) } else { Ok(()) };
    match asked.and_then(|()| socket.recv_buffer_size()) {
        Ok(granted) => tracing::info!(granted, "bytes of datagrams that wait to be read"),
        Err(error) => tracing::warn!(%error, "the system keeps no more datagrams than by itself"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn more_is_kept_than_by_itself() {
        let socket = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let before = SockRef::from(&socket).recv_buffer_size().unwrap();
        let udp = Udp::new(socket, Partners::AUTOPILOT);
        let after = SockRef::from(&udp.socket).recv_buffer_size().unwrap();
        assert!(after > before || before >= KEEPS, "{before} {after}");
    }

    #[tokio::test]
    async fn who_is_no_longer_recognised_loses_his_place_though_he_goes_on_talking() {
        let socket = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let mut udp = Udp::new(socket, Partners::AUTOPILOT);
        let [one, other] = [1000, 2000].map(|port| SocketAddr::from(([127, 0, 0, 1], port)));
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs(seconds);
        let first = udp.peer_at(at(0), one, || true);
        assert_eq!(udp.peer_at(at(4), one, || true), first);
        assert_eq!(udp.peer_at(at(8), other, || true), None);
        assert_eq!(udp.peer_at(at(8), one, || false), first);
        assert!(udp.peer_at(at(10), other, || true).is_some_and(|second| Some(second) != first));
    }
}
