//! What the gateway is started with.

use super::driver::{self, Registration};
use super::mirror::Mirror;
use super::tlog;
use crate::inside::Address;
use aircraft::Profile;
use autopilot_link::signing::Key;
use std::path::PathBuf;
use std::sync::Arc;
use terrain::Terrain;

/// The gateway's configuration.
#[derive(Clone)]
pub struct Config {
    /// The vehicle's name, part of every key.
    pub vehicle: String,
    /// Where everybody connects, `tcp/127.0.0.1:7447`.
    pub listen: String,
    /// Where the vehicle's own services connect; `None`: at a place that nobody else is told.
    pub inside: Option<Address>,
    /// The links to the autopilot, the one that is preferred first.
    pub autopilots: Vec<autopilot_link::Address>,
    /// The key with which what is sent over them is signed, and what comes has to be; `None`: nothing is signed.
    pub key: Option<Key>,
    /// Where other programs may watch; `None`: nowhere.
    pub mirror: Option<Mirror>,
    /// Where what goes over them is logged; `None`: nowhere.
    pub tlog: Option<tlog::Config>,
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
    /// What is flown is a log that is played.
    pub fn is_replay(&self) -> bool {
        self.autopilots.iter().any(autopilot_link::Address::is_replay)
    }

    /// The trainer, without terrain or memory, in flight.
    pub fn new(vehicle: &str, listen: &str, autopilot: autopilot_link::Address) -> Self {
        Self {
            vehicle: vehicle.into(),
            listen: listen.into(),
            inside: None,
            autopilots: vec![autopilot],
            key: None,
            mirror: None,
            tlog: None,
            driver: driver::DEFAULT,
            profile: Profile::default(),
            terrain: None,
            state_dir: None,
            simulated: false,
        }
    }
}
