//! The sockets. A slow or hostile partner can neither stop its owner nor make it grow: what can't be sent is
//! dropped, whole frames at a time.

mod connect;
mod connection;
mod listen;
mod replay;
mod udp;
mod wire;

use crate::{Address, Outbox};
use connect::{Connect, Far};
use listen::Listen;
use replay::Replay;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use tokio::net::{TcpListener, UdpSocket};
pub use udp::Partners;
use udp::Udp;

/// Strangers are logged at most this often.
const LOG_EVERY: Duration = Duration::from_secs(10);

/// A partner at the other end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Peer(pub u32);

/// What happened on a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// A connection was made: a stream of bytes begins.
    Connected(Peer),
    /// It broke.
    Gone(Peer),
    /// A piece of its stream.
    Stream(Peer),
    /// A datagram: it stands for itself.
    Datagram(Peer),
}

/// What became of what was sent and received.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stats {
    /// Datagrams of strangers.
    pub strangers: u64,
    /// Bytes in them.
    pub stranger_bytes: u64,
    /// Frames that could not be sent.
    pub unsent: u64,
}

enum Kind {
    Udp(Udp),
    Connect(Connect),
    Listen(Listen),
    Replay(Replay),
}

/// A link that carries bytes.
pub struct Link {
    kind: Kind,
    stats: Stats,
    logged: (Instant, u64),
}

impl Link {
    fn new(kind: Kind) -> Self {
        Self { kind, stats: Stats::default(), logged: (Instant::now(), 0) }
    }

    /// To the one autopilot at an address. It need not be there yet.
    ///
    /// # Errors
    /// If the local socket can't be had, or the log can't be read.
    pub async fn open(address: &Address) -> io::Result<Self> {
        Ok(Self::new(match address {
            Address::UdpIn(at) => Kind::Udp(Udp::new(UdpSocket::bind(at).await?, Partners::AUTOPILOT)),
            Address::UdpOut(to) => Kind::Udp(Udp::to(to).await?),
            Address::Tcp(to) => Kind::Connect(Connect::to(Far::Tcp(to.clone()))),
            Address::Tlog(path) => Kind::Replay(Replay::open(path)?),
            Address::Serial(line) => Kind::Connect(Connect::to(Far::Serial(line.clone()))),
        }))
    }

    /// Listens for connections; serves one at a time.
    pub fn listen(listener: TcpListener) -> Self {
        Self::new(Kind::Listen(Listen::new(listener)))
    }

    /// Exchanges datagrams with `partners`.
    pub fn udp(socket: UdpSocket, partners: Partners) -> Self {
        Self::new(Kind::Udp(Udp::new(socket, partners)))
    }

    /// Our own address, for links that have one from the start.
    pub fn local_address(&self) -> Option<SocketAddr> {
        match &self.kind {
            Kind::Udp(udp) => udp.local_address(),
            Kind::Listen(listen) => listen.local_address(),
            Kind::Connect(_) | Kind::Replay(_) => None,
        }
    }

    /// Who is at the other end now.
    pub fn peers(&self) -> Vec<Peer> {
        match &self.kind {
            Kind::Udp(udp) => udp.peers(),
            Kind::Connect(connect) => connect.peer().into_iter().collect(),
            Kind::Listen(listen) => listen.peer().into_iter().collect(),
            // nobody hears what is said to a log
            Kind::Replay(_) => vec![],
        }
    }

    /// Waits for what happens next; bytes that came replace those in `into`. `is_partner` says whether a
    /// datagram makes its sender a partner, or keeps him one. May be dropped and called again at any time.
    pub async fn next(&mut self, into: &mut Vec<u8>, is_partner: impl FnMut(&[u8]) -> bool) -> Event {
        into.clear();
        let event = match &mut self.kind {
            Kind::Udp(udp) => udp.next(into, is_partner, &mut self.stats).await,
            Kind::Connect(connect) => connect.next(into).await,
            Kind::Listen(listen) => listen.next(into).await,
            Kind::Replay(replay) => replay.next(into).await,
        };
        self.log_strangers();
        event
    }

    /// Sends one whole frame, or queues it for [`Self::flush`]. What can't be sent now is lost, as on any
    /// radio link.
    pub fn send(&mut self, to: Peer, frame: &[u8]) {
        let sent = match &mut self.kind {
            Kind::Udp(udp) => udp.send(to, frame),
            Kind::Connect(connect) => connect.queue(to, frame),
            Kind::Listen(listen) => listen.queue(to, frame),
            Kind::Replay(_) => false,
        };
        self.stats.unsent += u64::from(!sent);
    }

    /// Sends what waits.
    pub fn flush(&mut self) {
        match &mut self.kind {
            Kind::Udp(_) | Kind::Replay(_) => {}
            Kind::Connect(connect) => connect.flush(),
            Kind::Listen(listen) => listen.flush(),
        }
    }

    /// Sends the frames that are for the link of this number to everyone at its other end.
    pub fn send_all(&mut self, number: usize, outbox: &Outbox) {
        for peer in self.peers() {
            outbox.frames_over(number).for_each(|frame| self.send(peer, frame));
        }
        self.flush();
    }

    /// What became of what was sent and received so far.
    pub fn stats(&self) -> Stats {
        self.stats
    }

    fn log_strangers(&mut self) {
        let strangers = self.stats.strangers;
        if strangers > self.logged.1 && self.logged.0.elapsed() >= LOG_EVERY {
            tracing::warn!(strangers, "datagrams of strangers were ignored on the autopilot's link");
            self.logged = (Instant::now(), strangers);
        }
    }
}
