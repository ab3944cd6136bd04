//! Pure: whether anybody who reaches this machine can reach the vehicle. There is no authentication yet: who can connect can command.

use anyhow::bail;
use std::net::IpAddr;

/// What a stranger who can connect may do.
pub const WHAT_A_STRANGER_CAN_DO: &str =
    "read everything, write variables, commit plans, give every command and feed the autopilot";

/// Only programs on this machine come to an endpoint, `tcp/127.0.0.1:7447`.
pub fn is_loopback(endpoint: &str) -> bool {
    let address = endpoint.split_once('/').map_or(endpoint, |(_, address)| address);
    let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
    let host = host.trim_start_matches('[').trim_end_matches(']');
    host == "localhost" || host.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

/// Listening is refused where strangers come, unless that was asked for by name.
///
/// # Errors
/// It was not.
pub fn allow(endpoint: &str, insecure: bool) -> anyhow::Result<()> {
    if !is_loopback(endpoint) && !insecure {
        bail!(
            "--listen {endpoint}: nothing protects it, and whoever can connect can {WHAT_A_STRANGER_CAN_DO}; listen on \
             tcp/127.0.0.1:7447 and tunnel to it (ssh -L, a VPN), or give --insecure in a network of your own"
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_loopback_is_listened_on_without_being_asked_for() {
        for endpoint in ["tcp/127.0.0.1:7447", "tcp/127.9.9.9:1", "tcp/[::1]:7447", "tcp/localhost:7447"] {
            assert!(is_loopback(endpoint) && allow(endpoint, false).is_ok(), "{endpoint}");
        }
        for endpoint in [
            "tcp/0.0.0.0:7447",
            "tcp/[::]:7447",
            "tcp/10.0.0.7:7447",
            "tcp/aircraft.local:7447",
            "tcp/127.0.0.1.evil.net:7447",
            "tcp/:7447",
            "nonsense",
            "",
            "tls/192.168.0.1:7447",
        ] {
            assert!(!is_loopback(endpoint), "{endpoint}");
            let refused = allow(endpoint, false).unwrap_err().to_string();
            assert!(refused.contains("--insecure") && refused.contains("commit plans"), "{refused}");
            assert!(allow(endpoint, true).is_ok());
        }
    }
}
