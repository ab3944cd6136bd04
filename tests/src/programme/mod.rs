//! The flight-test programme: what is done to a flight, and what must come of it. The same scenarios are flown on our
//! simulator's personalities by `cargo test`, and on a real autopilot when one is there.

mod accuracy;
mod changes;
mod climb_out;
mod emergencies;
mod examples;
mod judgement;
mod links;
mod missions;
mod pilots;
mod processes;

use crate::plans::Field;
use crate::rig::Rig;
use crate::table::Table;
use anyhow::{Context, ensure};
pub use examples::EXAMPLES;
use std::pin::Pin;
use usal::contract::GatewayState;

/// Longest flight, seconds of the autopilot's time.
const FLIGHT_S: f64 = 8000.0;

/// The rest of a flight.
type Rest<'a> = Pin<Box<dyn Future<Output = anyhow::Result<()>> + 'a>>;

/// One flight of the programme.
pub struct Scenario {
    /// Its name, as a test's.
    pub name: &'static str,
    /// What is done to it.
    pub happens: &'static str,
    /// What must come of it.
    pub expected: &'static str,
    /// The plan that is flown around a field.
    pub plan: fn(Field) -> anyhow::Result<String>,
    /// The conditions, as arguments of our simulator.
    pub simulator: &'static [&'static str],
    fly: for<'a> fn(&'a mut Rig) -> Rest<'a>,
}

impl Scenario {
    /// Flies it on our simulator, which behaves as `personality`; what was seen of the flight if it does not come as it must.
    ///
    /// # Errors
    /// A program does not start, or something comes otherwise than expected.
    pub async fn simulate(&self, personality: &str) -> anyhow::Result<()> {
        let mut arguments = vec!["--personality", personality];
        // a mission without a landing is flown, too
        arguments.extend(["--param", "MIS_TKO_LAND_REQ=0"].iter().filter(|_| personality.starts_with("px4")));
        arguments.extend(self.simulator);
        let mut rig = Rig::start(&arguments).await?;
        self.fly(&mut rig).await
    }

    /// Flies it with what is there.
    ///
    /// # Errors
    /// Something comes otherwise than expected.
    pub async fn fly(&self, rig: &mut Rig) -> anyhow::Result<()> {
        let flown = async {
            rig.fly(&(self.plan)(rig.field)?).await?;
            (self.fly)(rig).await?;
            judgement::judge(rig).await
        };
        let flown = flown.await;
        flown
            .with_context(|| format!("{}\n{}", rig.story(), rig.log_ends()))
            .with_context(|| format!("{}: {}", self.name, self.expected))
    }
}

/// All of them, in the order of the table.
pub const SCENARIOS: &[&[Scenario]] = &[
    missions::SCENARIOS,
    accuracy::SCENARIOS,
    examples::SCENARIOS,
    changes::SCENARIOS,
    climb_out::SCENARIOS,
    emergencies::SCENARIOS,
    processes::SCENARIOS,
    links::SCENARIOS,
    pilots::SCENARIOS,
];

/// All of them, in the order of the table.
pub fn scenarios() -> impl Iterator<Item = &'static Scenario> {
    SCENARIOS.iter().copied().flatten()
}

/// The one of this name.
///
/// # Errors
/// There is none.
pub fn scenario(name: &str) -> anyhow::Result<&'static Scenario> {
    scenarios().find(|scenario| scenario.name == name).with_context(|| format!("no scenario {name}"))
}

/// The mission that most of them fly.
fn of_field(field: Field) -> anyhow::Result<String> {
    Ok(field.mission(1800.0))
}

async fn on_leg(rig: &mut Rig, leg: &str) -> anyhow::Result<()> {
    rig.until(leg, FLIGHT_S, |_, seen| seen.entered(leg)).await
}

async fn in_state(rig: &mut Rig, state: GatewayState, within_s: f64) -> anyhow::Result<()> {
    let is_there = |rig: &Rig| rig.gateway_status().is_some_and(|s| s.state == state);
    rig.until(&format!("{state:?}"), within_s, |rig, _| is_there(rig)).await
}

async fn alarmed(rig: &mut Rig, id: &str, within_s: f64) -> anyhow::Result<()> {
    rig.until(id, within_s, |_, seen| seen.alarmed(id)).await
}

/// It lands on its runway.
async fn land(rig: &mut Rig) -> anyhow::Result<()> {
    rig.until("landed", FLIGHT_S, |_, seen| seen.landed()).await?;
    rig.expect_on_runway()
}

/// It lands by its plan, never by Safe mode.
async fn land_by_plan(rig: &mut Rig) -> anyhow::Result<()> {
    land(rig).await?;
    ensure!(!rig.seen.went_to(GatewayState::SafeHold), "it went to Safe mode");
    Ok(())
}

/// How high an aircraft is at most that floats over its runway, metres: its own idea of its altitude is wrong by some.
const FLOATS_M: f64 = 8.0;
/// So slowly it sinks there at most, m/s.
const FLOATS_MPS: f64 = 0.3;

/// It is down on its runway, or floats just over it.
async fn touch_down(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "final").await?;
    let is_down = |rig: &Rig| {
        let Some(position) = rig.position() else { return false };
        position.altitude_amsl_m < rig.field.elevation_m + FLOATS_M
            && position.velocity_down_mps.abs() < FLOATS_MPS
    };
    rig.until("down", FLIGHT_S, |rig, _| is_down(rig)).await
}

/// It lands by its plan, and the wind falls when it is down: the ground of some simulations holds nothing, and what has landed there is
/// blown away.
async fn land_into_calm(rig: &mut Rig) -> anyhow::Result<()> {
    touch_down(rig).await?;
    rig.disturb("wind 270,0")?;
    land_by_plan(rig).await
}

/// The whole mission was flown, every leg once and each sweep of the loop.
fn expect_whole_mission(rig: &Rig) -> anyhow::Result<()> {
    let legs = rig.seen.legs();
    for leg in ["out", "round", "far", "end", "back", "downwind", "final"] {
        ensure!(legs.contains(&leg), "{leg} is missing: {legs:?}");
    }
    for leg in ["out", "round", "far", "back", "downwind", "final"] {
        ensure!(rig.seen.passes(leg) == 1, "{leg} was flown again: {legs:?}");
    }
    ensure!(rig.seen.passes("sweep") == 3, "three sweeps: {legs:?}");
    Ok(())
}

/// The programme's table in the documents.
pub fn table() -> Table {
    Table {
        begin: "<!-- the table: made by the programme -->",
        end: "<!-- end of the table -->",
        own: &["Scenario", "What happens", "What must come of it"],
        untried: "not flown",
        rows: scenarios()
            .map(|scenario| (scenario.name, vec![scenario.happens, scenario.expected]))
            .collect(),
    }
}
