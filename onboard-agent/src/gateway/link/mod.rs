//! Shell: the link to the autopilot. Carries bytes, knows who sent them, finds the frames.

mod address;
mod tcp;
mod udp;

pub use address::{Address, AddressError};

use super::driver::{Decoded, encode};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::MavMessage;
use std::io;
use std::time::{Duration, Instant};
use tcp::Tcp;
use udp::Udp;

/// Garbage is logged at most this often.
const LOG_EVERY: Duration = Duration::from_secs(10);

/// What came over the link so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stats {
    /// Messages understood.
    pub messages: u64,
    /// Bytes and frames that were not.
    pub garbage: u64,
    /// Datagrams of strangers.
    pub strangers: u64,
    /// Messages that could not be sent.
    pub unsent: u64,
}

enum Kind {
    Udp(Udp),
    Tcp(Tcp),
}

/// A link.
pub struct Link {
    kind: Kind,
    stats: Stats,
    logged: (Instant, u64),
    sequence: u8,
}

impl Link {
    /// Opens a link. A TCP server or a peer need not be there yet.
    ///
    /// # Errors
    /// If the local socket can't be had.
    pub async fn open(address: &Address) -> io::Result<Self> {
        let kind = match address {
            Address::UdpIn(at) => Kind::Udp(Udp::listen(at).await?),
            Address::UdpOut(to) => Kind::Udp(Udp::to(to).await?),
            Address::Tcp(to) => Kind::Tcp(Tcp::to(to)),
        };
        Ok(Self { kind, stats: Stats::default(), logged: (Instant::now(), 0), sequence: 0 })
    }

    /// Where we listen, for links that do.
    pub fn local_address(&self) -> Option<std::net::SocketAddr> {
        match &self.kind {
            Kind::Udp(udp) => udp.local_address(),
            Kind::Tcp(_) => None,
        }
    }

    /// Waits for messages. Can be cancelled without loss.
    pub async fn receive(&mut self) -> Vec<Decoded> {
        let mut out = vec![];
        while out.is_empty() {
            match &mut self.kind {
                Kind::Udp(udp) => udp.receive(&mut out, &mut self.stats).await,
                Kind::Tcp(tcp) => tcp.receive(&mut out, &mut self.stats).await,
            }
            self.log_garbage();
        }
        self.stats.messages += out.len() as u64;
        out
    }

    /// Sends messages; what can't be sent now is lost, as on any radio link.
    pub fn send(&mut self, mut header: MavHeader, messages: &[MavMessage]) {
        for message in messages {
            header.sequence = self.sequence;
            self.sequence = self.sequence.wrapping_add(1);
            let bytes = encode(header, message);
            let sent = match &mut self.kind {
                Kind::Udp(udp) => udp.send(&bytes),
                Kind::Tcp(tcp) => tcp.queue(&bytes),
            };
            self.stats.unsent += u64::from(!sent);
        }
        if let Kind::Tcp(tcp) = &mut self.kind {
            tcp.flush();
        }
    }

    /// What came so far.
    pub fn stats(&self) -> Stats {
        self.stats
    }

    fn log_garbage(&mut self) {
        let bad = self.stats.garbage + self.stats.strangers;
        if bad > self.logged.1 && self.logged.0.elapsed() >= LOG_EVERY {
            tracing::warn!(
                garbage = self.stats.garbage,
                strangers = self.stats.strangers,
                "ignored on the autopilot's link"
            );
            self.logged = (Instant::now(), bad);
        }
    }
}
