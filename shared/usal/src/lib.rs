//! Shell: the service contract (keys, types, sessions) over Zenoh; the only crate that knows Zenoh.

pub mod contract;
