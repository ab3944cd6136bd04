//! The FP Manager: flies the plan. Pure parts (`manager`, `feeder`, `liaison`, `aircraft`, `alarms`,
//! `runways`) around
//! the executor, and the shell that owns session, clock and disk.

mod aircraft;
mod alarms;
mod feeder;
mod liaison;
mod manager;
mod publish;
mod runways;
mod shell;
mod store;

pub use aircraft::Aircraft;
pub use feeder::{Fate, Feeder};
pub use manager::{Effect, Manager};
pub use shell::run;

use ::aircraft::Profile;
use std::path::PathBuf;
use std::sync::Arc;
use terrain::Terrain;

/// What the FP Manager is started with.
#[derive(Clone)]
pub struct Config {
    /// The vehicle's name, part of every key.
    pub vehicle: String,
    /// The gateway's endpoint, `tcp/127.0.0.1:7447`.
    pub connect: String,
    /// The aircraft.
    pub profile: Profile,
    /// The ground: altitudes above it become altitudes above the sea.
    pub terrain: Arc<dyn Terrain>,
    /// A plan (XML) to make the active one at the start, unless one is restored.
    pub plan: Option<String>,
    /// Where plan and place are kept; `None`: nowhere, and a restart begins anew.
    pub state_dir: Option<PathBuf>,
    /// Time is the simulator's (lockstep).
    pub simulated: bool,
    /// How the plan is flown.
    pub executor: flight_exec::Config,
}

impl Config {
    /// The trainer over an unknown ground, without plan or memory, in flight.
    pub fn new(vehicle: &str, connect: &str) -> Self {
        Self {
            vehicle: vehicle.into(),
            connect: connect.into(),
            profile: Profile::default(),
            terrain: Arc::new(terrain::Tiles::new()),
            plan: None,
            state_dir: None,
            simulated: false,
            executor: flight_exec::Config::default(),
        }
    }
}
