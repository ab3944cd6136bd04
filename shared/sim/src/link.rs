//! The simulator's own sockets, before a link is made of them.

use crate::config::Link as Address;
use crate::core::MAX_PEERS;
use anyhow::Context;
use autopilot_link::{Link, Partners};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::net::{TcpListener, UdpSocket};

/// A UDP partner silent for this long is forgotten.
const FORGET_AFTER: Duration = Duration::from_secs(60);

/// A bound socket that is not yet part of a runtime.
pub(crate) enum Bound {
    Tcp(std::net::TcpListener),
    Udp(std::net::UdpSocket, Option<SocketAddr>),
}

impl Bound {
    pub(crate) fn bind(address: Address) -> anyhow::Result<Self> {
        let advice = "choose another port, or 0 for any free one";
        let bound = match address {
            Address::Tcp(addr) => Bound::Tcp(
                std::net::TcpListener::bind(addr)
                    .with_context(|| format!("can't listen on tcp {addr}: {advice}"))?,
            ),
            Address::Udp(addr) => Bound::Udp(
                std::net::UdpSocket::bind(addr)
                    .with_context(|| format!("can't listen on udp {addr}: {advice}"))?,
                None,
            ),
            Address::UdpOut(target) => {
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
    pub(crate) fn open(self) -> anyhow::Result<Link> {
        Ok(match self {
            Bound::Tcp(socket) => Link::listen(TcpListener::from_std(socket)?),
            Bound::Udp(socket, target) => {
                let everybody = Partners::Recognised { most: MAX_PEERS, silent: FORGET_AFTER };
                Link::udp(UdpSocket::from_std(socket)?, target.map_or(everybody, Partners::Only))
            }
        })
    }
}
