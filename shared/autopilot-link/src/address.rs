//! Addresses of autopilots.

use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

/// Rates that a serial line may have, bits a second.
const BAUD: RangeInclusive<u32> = 50..=4_000_000;

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
    /// It is on a serial line (`serial:`).
    Serial(Line),
    /// It spoke once, and a telemetry log of that is played (`tlog:`). Nothing can be sent.
    Tlog(PathBuf),
}

impl Address {
    /// A log is played, and nobody is at the other end.
    pub fn is_replay(&self) -> bool {
        matches!(self, Address::Tlog(_))
    }
}

/// A serial line: 8 bits, no parity, one stop bit, no flow control.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// The device, as `/dev/ttyUSB0`.
    pub device: String,
    /// Bits a second.
    pub baud: u32,
}

/// Why a text is no address.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0:?} is no autopilot address; write udp:HOST:PORT (listen for the autopilot there), udpout:HOST:PORT, tcp:HOST:PORT, \
     serial:DEVICE:BAUD, as serial:/dev/ttyUSB0:57600, or tlog:FILE to play a telemetry log"
)]
pub struct AddressError(String);

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let wrong = || AddressError(text.to_owned());
        let (scheme, place) = text.split_once(':').ok_or_else(wrong)?;
        if scheme == "tlog" && !place.is_empty() {
            return Ok(Address::Tlog(place.into()));
        }
        let (host, port) = place.rsplit_once(':').ok_or_else(wrong)?;
        if host.is_empty() {
            return Err(wrong());
        }
        if scheme == "serial" {
            let baud = port.parse().ok().filter(|baud| BAUD.contains(baud)).ok_or_else(wrong)?;
            return Ok(Address::Serial(Line { device: host.to_owned(), baud }));
        }
        if port.parse::<u16>().is_err() {
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
            Address::Tlog(path) => write!(f, "tlog:{}", path.display()),
            Address::Serial(Line { device, baud }) => write!(f, "serial:{device}:{baud}"),
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
            ("serial:/dev/ttyUSB0:57600", Some("serial:/dev/ttyUSB0:57600")),
            ("serial:COM3:115200", Some("serial:COM3:115200")),
            (
                "serial:/dev/serial/by-path/usb-0:1:1.0:921600",
                Some("serial:/dev/serial/by-path/usb-0:1:1.0:921600"),
            ),
            ("tlog:C:\\flights\\1.tlog", Some("tlog:C:\\flights\\1.tlog")),
            ("tlog:", None),
            ("serial:/dev/ttyUSB0", None),
            ("serial:/dev/ttyUSB0:0", None),
            ("serial:/dev/ttyUSB0:fast", None),
            ("serial::57600", None),
        ];
        for (text, expected) in cases {
            assert_eq!(text.parse::<Address>().ok().map(|a| a.to_string()).as_deref(), expected, "{text}");
        }
    }
}
