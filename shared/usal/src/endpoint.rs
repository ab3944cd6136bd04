//! What an endpoint looks like.

/// An endpoint such as a session can listen on or connect to: `tcp/HOST:PORT`, or `unixsock-stream/PATH` on Unix.
///
/// # Errors
/// It is none; the sentence says what is wrong with it.
pub fn check_endpoint(endpoint: &str) -> Result<(), String> {
    let advice = "write tcp/HOST:PORT, as tcp/127.0.0.1:7447";
    match endpoint.split_once('/') {
        Some(("tcp" | "tls", address)) => {
            // behind these signs stands what Zenoh adds, as the interface
            let address = address.split(['?', '#']).next().unwrap_or(address);
            let port = address.rsplit_once(':').filter(|(host, _)| !host.is_empty()).map(|(_, port)| port);
            let port = port.ok_or_else(|| format!("it has no host or no port; {advice}"))?;
            port.parse::<u16>().map(drop).map_err(|_| format!("`{port}` is no port; {advice}"))
        }
        Some(("unixsock-stream", path)) if cfg!(unix) && !path.is_empty() => Ok(()),
        _ => Err(format!("it is no endpoint; {advice}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_can_listen_on_is_told() {
        for good in
            ["tcp/127.0.0.1:7447", "tcp/[::1]:0", "tcp/aircraft.local:65535", "tcp/10.0.0.7:7447#iface=eth0"]
        {
            assert_eq!(check_endpoint(good), Ok(()), "{good}");
        }
        for bad in
            ["", "foo", "tcp/", "tcp/:7447", "tcp/127.0.0.1", "tcp/127.0.0.1:70000", "tcp/h:-1", "http/h:1"]
        {
            assert!(check_endpoint(bad).unwrap_err().contains("tcp/HOST:PORT"), "{bad}");
        }
    }
}
