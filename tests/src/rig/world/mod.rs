//! What is around a flight: the world of our simulator, or that of an autopilot in a simulation of its own.

mod radio;
mod told;
mod voice;
mod witness;

use crate::binaries::Program;
use anyhow::{Context, bail, ensure};
use autopilot_link::Address;
use radio::Radio;
use sim::Control;
pub use witness::{Flies, Heard};

/// What can be disturbed.
pub enum World {
    /// Our simulator reads what is to happen from its standard input.
    Ours(Program),
    /// Somebody else's autopilot, behind a radio of ours.
    Theirs(Radio),
}

impl World {
    /// That of somebody else's autopilot, and where the agent finds it behind the radio. `conditions`: the arguments that our
    /// simulator would be given.
    ///
    /// # Errors
    /// There is no such address, or it is taken; the conditions can't be understood.
    pub async fn theirs(autopilot: &str, conditions: &[&str]) -> anyhow::Result<(Self, String)> {
        let autopilot: Address = autopilot.parse()?;
        let (controls, seed) = understood(conditions)?;
        let radio = Radio::open(&autopilot, controls, seed).await?;
        let address = format!("tcp:{}", radio.address);
        Ok((World::Theirs(radio), address))
    }

    /// Does something to it, in the words of our simulator's standard input.
    ///
    /// # Errors
    /// It can't be understood, or nobody is there any more who does it.
    pub fn disturb(&mut self, line: &str) -> anyhow::Result<()> {
        match self {
            World::Ours(simulator) => simulator.send_line(line),
            World::Theirs(radio) => radio.tell(line.parse().map_err(anyhow::Error::msg)?),
        }
    }

    /// What somebody else's autopilot says of itself; `None`: nothing yet, or it is our simulator.
    pub fn heard(&self) -> Option<Heard> {
        match self {
            World::Ours(_) => None,
            World::Theirs(radio) => radio.heard(),
        }
    }

    /// Whether it is as it was asked to be.
    ///
    /// # Errors
    /// Its simulation can't be told so.
    pub fn is_as_asked(&self) -> anyhow::Result<bool> {
        match self {
            World::Ours(_) => Ok(true),
            World::Theirs(radio) => radio.is_as_asked(),
        }
    }
}

/// What our simulator's arguments ask for, and the seed of its dice.
fn understood(arguments: &[&str]) -> anyhow::Result<(Vec<Control>, u64)> {
    let (mut controls, mut seed) = (vec![], 1);
    for pair in arguments.chunks(2) {
        let &[name, value] = pair else { bail!("{pair:?} has no value") };
        let name = name.strip_prefix("--").with_context(|| format!("{name} is no argument"))?;
        match name {
            "seed" => seed = value.parse()?,
            _ => controls.push(format!("{name} {value}").parse().map_err(anyhow::Error::msg)?),
        }
    }
    ensure!(!controls.contains(&Control::Stop), "nobody can stop it");
    Ok((controls, seed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_of_every_scenario_are_understood() {
        for scenario in crate::programme::scenarios() {
            let read = understood(scenario.simulator);
            assert_eq!(
                read.as_ref().map(|(controls, _)| controls.is_empty()).ok(),
                Some(scenario.simulator.is_empty()),
                "{read:?}"
            );
        }
        assert_eq!(understood(&["--seed", "7"]).unwrap(), (vec![], 7));
        for bad in [&["--wind"][..], &["wind", "270,5"], &["--fault", "fire"], &["--seed", "x"]] {
            assert!(understood(bad).is_err(), "{bad:?}");
        }
    }
}
