//! What is peculiar to each autopilot, quirk by quirk: what is sent to it over a plain link, and what must come back. The same
//! list is tried on the personalities of our simulator by `cargo test`, and on a real autopilot when one is there, so that a
//! personality can't drift from the truth.
#![expect(deprecated, reason = "the autopilots still use much that the dialect calls deprecated")]

mod commands;
mod flight;
mod lists;
mod modes;
mod parameters;
mod readback;
mod station;
mod streams;
mod upload;

use crate::binaries::Program;
use crate::logs::Logs;
use crate::table::Table;
use anyhow::{Context, bail};
use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavAutopilot};
use station::Station;

/// Whose quirk it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Autopilot {
    /// ArduPlane.
    ArduPlane,
    /// PX4, fixed wing.
    Px4,
}

impl Autopilot {
    fn of(heartbeat: &HEARTBEAT_DATA) -> anyhow::Result<Self> {
        match heartbeat.autopilot {
            MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA => Ok(Autopilot::ArduPlane),
            MavAutopilot::MAV_AUTOPILOT_PX4 => Ok(Autopilot::Px4),
            other => bail!("no quirks are known of {other:?}"),
        }
    }

    /// As our simulator calls it.
    pub fn personality(self) -> &'static str {
        match self {
            Autopilot::ArduPlane => "arduplane",
            Autopilot::Px4 => "px4",
        }
    }
}

/// Those of one.
const ARDUPLANE: &[Autopilot] = &[Autopilot::ArduPlane];
const PX4: &[Autopilot] = &[Autopilot::Px4];
const BOTH: &[Autopilot] = &[Autopilot::ArduPlane, Autopilot::Px4];

/// One peculiarity.
pub struct Quirk {
    /// Its name, as a test's.
    pub name: &'static str,
    /// Whose it is.
    pub of: &'static [Autopilot],
    /// What it does.
    pub does: &'static str,
    check: fn(&mut Station) -> anyhow::Result<()>,
    /// It takes off for it, and stays in the air.
    flies: bool,
}

/// All of them, in the order of the table.
pub fn quirks() -> impl Iterator<Item = &'static Quirk> {
    [
        modes::QUIRKS,
        upload::QUIRKS,
        readback::QUIRKS,
        commands::QUIRKS,
        streams::QUIRKS,
        parameters::QUIRKS,
        flight::QUIRKS,
    ]
    .into_iter()
    .flatten()
}

/// The quirks' table in the documents.
pub fn table() -> Table {
    let whose = |quirk: &Quirk| match quirk.of {
        [Autopilot::ArduPlane] => "ArduPlane",
        [Autopilot::Px4] => "PX4",
        _ => "both",
    };
    Table {
        begin: "<!-- the quirks: made by their test -->",
        end: "<!-- end of the quirks -->",
        own: &["Quirk", "Whose", "What it does"],
        untried: "not tried",
        rows: quirks().map(|quirk| (quirk.name, vec![whose(quirk), quirk.does])).collect(),
    }
}

impl Quirk {
    /// Tries it on the autopilot at an address.
    ///
    /// # Errors
    /// What it does instead.
    pub fn check(&self, address: &str) -> anyhow::Result<()> {
        let checked = Station::open(address).and_then(|mut station| {
            if !self.flies {
                station.tidy()?;
            }
            (self.check)(&mut station)
        });
        checked.with_context(|| format!("{}: {}", self.name, self.does))
    }

    /// Tries it on our simulator, which behaves as that autopilot.
    ///
    /// # Errors
    /// What it does instead.
    pub fn simulate(&self, autopilot: Autopilot) -> anyhow::Result<()> {
        let logs = Logs::new()?;
        let speed = if self.flies { "20" } else { "4" };
        let mut arguments =
            vec!["--personality", autopilot.personality(), "--tcp", "127.0.0.1:0", "--speed", speed];
        // a list without a landing is flown, too
        arguments.extend(["--param", "MIS_TKO_LAND_REQ=0"].iter().filter(|_| autopilot == Autopilot::Px4));
        let simulator = Program::start("legwork-sim", &arguments, &logs, "simulator")?;
        let address = simulator.wait_for("listening on tcp ").with_context(|| logs.ends())?;
        self.check(&format!("tcp:{address}"))
    }
}

/// Which autopilot is at an address.
///
/// # Errors
/// None that is known.
pub fn whose(address: &str) -> anyhow::Result<Autopilot> {
    Ok(Station::open(address)?.autopilot)
}
