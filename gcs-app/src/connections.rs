//! The connections that were made last, and what is typed for another one.

use serde::{Deserialize, Serialize};

/// So many are remembered.
const MOST: usize = 8;
/// What stands for another way to the network than TCP.
const PROTOCOLS: [&str; 2] = ["tcp", "tls"];
/// The port that a gateway listens on unless it was told another.
const PORT: u16 = 7447;

/// A connection, as it is made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Connection {
    /// Where the gateway listens, as `tcp/127.0.0.1:7447`.
    pub endpoint: String,
    /// The vehicle's name.
    pub vehicle: String,
}

/// The connections that were made last, the newest first.
#[derive(Debug, Default, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Connections(Vec<Connection>);

impl Connections {
    /// A connection is made.
    pub fn add(&mut self, endpoint: &str, vehicle: &str) {
        let new = Connection { endpoint: endpoint.into(), vehicle: vehicle.into() };
        self.0.retain(|other| *other != new);
        self.0.insert(0, new);
        self.0.truncate(MOST);
    }

    /// The newest first.
    pub fn list(&self) -> &[Connection] {
        &self.0
    }

    /// Where this vehicle was reached last, or, of no certain one, the last that was.
    pub fn last(&self, vehicle: Option<&str>) -> Option<&Connection> {
        self.0.iter().find(|made| vehicle.is_none_or(|vehicle| made.vehicle == vehicle))
    }
}

/// Where to connect, out of what was typed: `127.0.0.1:7447` means `tcp/127.0.0.1:7447`.
///
/// # Errors
/// What is missing, and what to type.
pub fn endpoint(typed: &str) -> Result<String, String> {
    let typed = typed.trim();
    let (protocol, address) = typed.split_once('/').unwrap_or(("tcp", typed));
    if !PROTOCOLS.contains(&protocol) {
        return Err(format!("`{protocol}` is no way to a gateway: write tcp/ADDRESS:PORT"));
    }
    if address.is_empty() || address.contains(char::is_whitespace) {
        return Err(format!("Type where the gateway listens, as 127.0.0.1:{PORT}"));
    }
    let is_bare_ipv6 = address.matches(':').count() > 1 && !address.contains('[');
    if is_bare_ipv6 {
        return Err(format!("Put the address into brackets and add the port: [{address}]:{PORT}"));
    }
    let Some((host, port)) = address.rsplit_once(':').filter(|(_, port)| !port.ends_with(']')) else {
        return Err(format!("The port is missing: add :{PORT}"));
    };
    if host.is_empty() {
        return Err(format!("The address before the port is missing, as 127.0.0.1:{PORT}"));
    }
    match port.parse::<u16>() {
        Ok(1..) => Ok(format!("{protocol}/{address}")),
        Ok(0) | Err(_) => Err(format!("`{port}` is no port: write a number up to 65535, mostly {PORT}")),
    }
}

/// What is wrong with a vehicle's name, if anything is.
pub fn name_problem(name: &str) -> Option<String> {
    (!usal::contract::is_segment(name))
        .then(|| "The vehicle's name has letters, digits, `-`, `_` and `.` only, and is the agent's".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_typed_is_an_address_or_is_told_what_it_lacks() {
        for (typed, expected) in [
            ("tcp/127.0.0.1:7447", "tcp/127.0.0.1:7447"),
            (" 10.0.0.2:17 ", "tcp/10.0.0.2:17"),
            ("tls/uav.example:7447", "tls/uav.example:7447"),
            ("[::1]:7447", "tcp/[::1]:7447"),
        ] {
            assert_eq!(endpoint(typed).as_deref(), Ok(expected), "{typed}");
        }
        for (typed, expected) in [
            ("127.0.0.1", "add :7447"),
            ("tcp/uav", "add :7447"),
            ("[::1]", "add :7447"),
            ("::1", "[::1]:7447"),
            ("", "Type where"),
            ("tcp/", "Type where"),
            ("a b:1", "Type where"),
            (":7447", "before the port"),
            ("uav:", "is no port"),
            ("uav:0", "is no port"),
            ("uav:70000", "is no port"),
            ("http/uav:80", "tcp/ADDRESS"),
        ] {
            let told = endpoint(typed).unwrap_err();
            assert!(told.contains(expected), "{typed}: {told}");
        }
    }

    #[test]
    fn newest_connections_are_kept_each_once() {
        let mut connections = Connections::default();
        for n in (0..10).chain([5]) {
            connections.add(&format!("tcp/10.0.0.{n}:7447"), &format!("uav{}", n % 2));
        }
        assert_eq!(connections.list().len(), MOST);
        let endpoint = |vehicle| connections.last(vehicle).map(|made| made.endpoint.as_str());
        assert_eq!(endpoint(None), Some("tcp/10.0.0.5:7447"));
        assert_eq!(endpoint(Some("uav0")), Some("tcp/10.0.0.8:7447"));
        assert_eq!(endpoint(Some("other")), None);
    }
}
