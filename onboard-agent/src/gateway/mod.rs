//! Shell around a pure core: the FCS Gateway between the autopilot and everyone else.
//!
//! `core` decides (states, buffer, plausibility, Safe mode), `window` keeps the autopilot's small
//! list topped up, `driver` speaks MAVLink; all three are pure, and `station` is the three
//! together. `link` carries bytes, `publish` and `shell` the contract. Orders go down, reports
//! come up (`order`), and nothing is claimed that the autopilot has not confirmed.

mod config;
pub mod core;
pub mod driver;
mod link;
pub mod order;
mod publish;
mod shell;
mod station;
mod store;
#[cfg(test)]
mod tests;
pub mod window;

pub use config::Config;
pub use link::{Address, AddressError, Link, Stats};
pub use shell::run;
pub use station::Station;
