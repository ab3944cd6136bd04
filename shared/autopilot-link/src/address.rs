//! Addresses of autopilots.

use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Where the autopilot is to be found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Address {
    /// It sends datagrams to this address of ours (`udp:` or `udpin:`).
    UdpIn(String),
    /// It listens for datagrams there (`udpout:`).
    UdpOut(String),
    /// It listens for a connection there (`tcp:`).
    Tcp(String),
}

/// Why a text is no address.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0:?} is no autopilot address; write udp:HOST:PORT (listen for the autopilot there), udpout:HOST:PORT or tcp:HOST:PORT"
)]
pub struct AddressError(String);

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let wrong = || AddressError(text.to_owned());
        let (scheme, place) = text.split_once(':').ok_or_else(wrong)?;
        let (host, port) = place.rsplit_once(':').ok_or_else(wrong)?;
        if host.is_empty() || port.parse::<u16>().is_err() {
            return Err(wrong());
        }
        match scheme {
            "udp" | "udpin" => Ok(Address::UdpIn(place.to_owned())),
            "udpout" => Ok(Address::UdpOut(place.to_owned())),
            "tcp" => Ok(Address::Tcp(place.to_owned())),
            _ => Err(wrong()),
        }
    }
}

impl std::fmt::Display for Address {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Address::UdpIn(place) => write!(f, "udp:{place}"),
            Address::UdpOut(place) => write!(f, "udpout:{place}"),
            Address::Tcp(place) => write!(f, "tcp:{place}"),
        }
    }
}

impl TryFrom<String> for Address {
    type Error = AddressError;
    fn try_from(text: String) -> Result<Self, AddressError> {
        text.parse()
    }
}

impl From<Address> for String {
    fn from(address: Address) -> String {
        address.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses() {
        let cases = [
            ("udp:127.0.0.1:14550", Some("udp:127.0.0.1:14550")),
            ("udpin:0.0.0.0:14550", Some("udp:0.0.0.0:14550")),
            ("udpout:10.0.0.2:14550", Some("udpout:10.0.0.2:14550")),
            ("tcp:localhost:5760", Some("tcp:localhost:5760")),
            ("tcp:[::1]:5760", Some("tcp:[::1]:5760")),
            ("", None),
            ("tcp", None),
            ("tcp:5760", None),
            ("tcp:host:65536", None),
            ("tcp::5760", None),
            ("serial:/dev/ttyS0:57600", None),
        ];
        for (text, expected) in cases {
            assert_eq!(text.parse::<Address>().ok().map(|a| a.to_string()).as_deref(), expected, "{text}");
        }
    }
}
