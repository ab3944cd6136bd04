//! Shell: the link to the autopilot. Carries bytes, knows who sent them, finds the frames.

mod tcp;
mod udp;

pub use autopilot_link::{Address, AddressError};

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

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavAutopilot};
    use std::net::UdpSocket;
    use tokio::io::AsyncWriteExt;
    use tokio::net::TcpListener;

    const WITHIN: Duration = Duration::from_secs(20);

    fn heartbeat(system: u32, autopilot: MavAutopilot) -> Vec<u8> {
        let header = MavHeader { system_id: system, component_id: 1, sequence: 0 };
        encode(header, &MavMessage::HEARTBEAT(HEARTBEAT_DATA { autopilot, ..HEARTBEAT_DATA::DEFAULT }))
    }

    fn autopilot(system: u32) -> Vec<u8> {
        heartbeat(system, MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA)
    }

    async fn next_system(link: &mut Link) -> u32 {
        let messages = tokio::time::timeout(WITHIN, link.receive()).await.expect("a message");
        messages[0].0.system_id
    }

    #[tokio::test]
    async fn the_return_path_of_datagrams_belongs_to_the_autopilot_and_strangers_are_counted() {
        let mut link = Link::open(&"udp:127.0.0.1:0".parse().unwrap()).await.unwrap();
        let at = link.local_address().unwrap();
        let [stranger, own] = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
        stranger.send_to(&heartbeat(9, MavAutopilot::MAV_AUTOPILOT_INVALID), at).unwrap();
        stranger.send_to(b"garbage", at).unwrap();
        own.send_to(&autopilot(1), at).unwrap();
        assert_eq!(next_system(&mut link).await, 1);
        stranger.send_to(&autopilot(9), at).unwrap();
        own.send_to(&autopilot(1), at).unwrap();
        assert_eq!(next_system(&mut link).await, 1, "there is only one autopilot");
        let stats = link.stats();
        assert_eq!((stats.messages, stats.garbage, stats.strangers), (2, 7, 2));

        let header = MavHeader { system_id: 1, component_id: 191, sequence: 0 };
        link.send(header, &[MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT)]);
        own.set_read_timeout(Some(WITHIN)).unwrap();
        let mut buffer = [0; 300];
        let (length, _) = own.recv_from(&mut buffer).unwrap();
        assert!(length > 10);
        stranger.set_nonblocking(true).unwrap();
        assert!(stranger.recv_from(&mut buffer).is_err(), "a stranger hears nothing");
    }

    #[tokio::test]
    async fn a_tcp_connection_that_breaks_is_made_again_and_half_a_frame_is_forgotten() {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = format!("tcp:{}", listener.local_addr().unwrap()).parse().unwrap();
        let mut link = Link::open(&address).await.unwrap();
        for system in 1..=3 {
            // the link only moves while somebody waits for its messages
            let serve = async {
                let (mut stream, _) = listener.accept().await.unwrap();
                let frame = autopilot(system);
                stream.write_all(&frame).await.unwrap();
                stream.write_all(&frame[..5]).await.unwrap();
            };
            let (heard, ()) = tokio::join!(next_system(&mut link), serve);
            assert_eq!(heard, system);
        }
        assert_eq!(link.stats().messages, 3);
    }
}
