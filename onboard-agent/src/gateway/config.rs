//! What the gateway is started with.

use super::driver::{self, Registration};
use aircraft::Profile;
use autopilot_link::Address;
use std::path::PathBuf;
use std::sync::Arc;
use terrain::Terrain;

/// The gateway's configuration.
#[derive(Clone)]
pub struct Config {
    /// The vehicle's name, part of every key.
    pub vehicle: String,
    /// Where the session listens, `tcp/127.0.0.1:7447`.
    pub listen: String,
    /// The autopilot's address.
    pub autopilot: Address,
    /// The autopilot's driver.
    pub driver: Registration,
    /// The aircraft.
    pub profile: Profile,
    /// The ground, if known: waypoints below it are refused, Safe mode flies above it.
    pub terrain: Option<Arc<dyn Terrain>>,
    /// Where runways, Safe parameters and the flight's state are kept; `None`: nowhere.
    pub state_dir: Option<PathBuf>,
    /// Time is the simulator's (lockstep).
    pub simulated: bool,
}

impl Config {
    /// The trainer, without terrain or memory, in flight.
    pub fn new(vehicle: &str, listen: &str, autopilot: Address) -> Self {
        Self {
            vehicle: vehicle.into(),
            listen: listen.into(),
            autopilot,
            driver: driver::DEFAULT,
            profile: Profile::default(),
            terrain: None,
            state_dir: None,
            simulated: false,
        }
    }
}
