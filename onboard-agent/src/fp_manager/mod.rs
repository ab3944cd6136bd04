//! The FP Manager: flies the plan. Pure parts (`manager`, `orders`, `gateway_events`, `joining`, `feeder`, `gateway_session`, `plan_history`,
//! `aircraft`, `alarms`, `runways`, `timeline`) around the executor, the `journal` by which `restart` goes on after a
//! crash; `service` declares it, and the shell is the journal's disk.

mod aircraft;
mod alarms;
mod background_review;
mod command_review;
mod feeder;
mod foreseeing;
mod gateway_events;
mod gateway_session;
mod joining;
pub mod journal;
mod manager;
mod orders;
mod plan_history;
mod proposals;
mod publish;
mod restart;
mod resuming;
mod runways;
mod service;
mod shell;
#[cfg(test)]
mod tests;
mod timeline;

pub use self::service::{FpManager, Input, Output};
pub use aircraft::Aircraft;
pub use feeder::{BatchResult, Feeder};
pub use manager::{Effect, Manager};
pub use restart::{Restart, restart};
pub use shell::run;

use ::aircraft::Profile;
use flight_plan::{Problem, Program};
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
    /// A telemetry log is played: nothing can be commanded.
    pub replay: bool,
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
            replay: false,
            executor: flight_exec::Config::default(),
        }
    }
}

/// Problems listed in a sentence.
const PROBLEMS_MAX: usize = 20;

/// A document that was accepted before: it is not reviewed again.
fn compile(xml: &[u8], config: &Config) -> Result<Program, Vec<Problem>> {
    flight_plan::compile_document(xml, &config.profile, config.terrain.as_ref())
}

fn listed(problems: &[Problem]) -> String {
    let errors = problems.iter().filter(|p| p.is_error());
    let mut listed: Vec<String> = errors.clone().take(PROBLEMS_MAX).map(ToString::to_string).collect();
    let more = errors.count().saturating_sub(PROBLEMS_MAX);
    if more > 0 {
        listed.push(format!("and {more} more"));
    }
    listed.join("; ")
}
