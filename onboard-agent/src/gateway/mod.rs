//! Shell around a pure core: the FCS Gateway between the autopilot and everyone else.
//!
//! `core` decides (states, buffer, plausibility, Safe mode) and knows no autopilot; a `driver` knows one kind of
//! autopilot and nothing else; both are pure, and `station` is the two together. The link carries bytes,
//! `publish` and `shell` the contract. Orders go down, reports come up (`order`), and nothing is claimed that
//! the autopilot has not confirmed.

mod config;
pub mod core;
mod door;
pub mod driver;
mod links;
pub mod mirror;
pub mod order;
mod publish;
mod service;
mod shell;
mod station;
#[cfg(test)]
mod tests;
pub mod tlog;

pub(crate) use self::service::from_link;
pub use autopilot_link::{Address, AddressError};
pub use config::Config;
pub use shell::run;
pub use station::Station;
