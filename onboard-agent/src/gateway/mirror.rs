//! Shell: where the mirror is to be seen, a read-only end for other ground stations' programs.

use crate::exposure::is_loopback;
use anyhow::{Context, bail};
use autopilot_link::{Address, Link};
use tokio::net::TcpListener;

/// Where it is to be seen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Mirror {
    /// Datagrams go to this address, and come from there.
    UdpOut(Address),
    /// One program at a time may connect here.
    TcpListen(String),
}

impl Mirror {
    /// Reads `udpout:HOST:PORT` or `tcp-listen:HOST:PORT`. `insecure`: others than this machine may connect.
    ///
    /// # Errors
    /// It is neither, or strangers could connect.
    pub fn parse(text: &str, insecure: bool) -> anyhow::Result<Self> {
        let wrong =
            || format!("{text:?} is no place for a mirror; write udpout:HOST:PORT or tcp-listen:HOST:PORT");
        if let Some(place) = text.strip_prefix("tcp-listen:") {
            let port = place.rsplit_once(':').and_then(|(_, port)| port.parse::<u16>().ok());
            port.with_context(wrong)?;
            if !is_loopback(place) && !insecure {
                bail!(
                    "{text}: whoever connects sees where the aircraft is; listen on 127.0.0.1, or give --insecure"
                );
            }
            return Ok(Self::TcpListen(place.to_owned()));
        }
        match text.parse() {
            Ok(address @ Address::UdpOut(_)) => Ok(Self::UdpOut(address)),
            _ => bail!(wrong()),
        }
    }

    /// Opens the link to the programs that watch.
    ///
    /// # Errors
    /// The socket can't be had.
    pub async fn open(&self) -> anyhow::Result<Link> {
        Ok(match self {
            Self::UdpOut(address) => Link::open(address).await?,
            Self::TcpListen(at) => {
                let listener = TcpListener::bind(at).await?;
                tracing::info!(at = %listener.local_addr()?, "a mirror for programs that watch");
                Link::listen(listener)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_mirrors() {
        for good in [
            "udpout:127.0.0.1:14551",
            "udpout:10.0.0.2:14550",
            "tcp-listen:127.0.0.1:5790",
            "tcp-listen:[::1]:1",
        ] {
            assert!(Mirror::parse(good, false).is_ok(), "{good}");
        }
        for bad in ["", "udp:127.0.0.1:14550", "tcp:127.0.0.1:1", "tcp-listen:5790", "tcp-listen:127.0.0.1:x"]
        {
            assert!(Mirror::parse(bad, true).is_err(), "{bad}");
        }
        let exposed = Mirror::parse("tcp-listen:0.0.0.0:5790", false).unwrap_err().to_string();
        assert!(exposed.contains("--insecure"), "{exposed}");
        assert!(Mirror::parse("tcp-listen:0.0.0.0:5790", true).is_ok());
    }
}
