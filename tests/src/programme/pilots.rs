//! Somebody else takes the aircraft: a pilot, or the autopilot's own failsafe.

use super::{Scenario, alarmed, expect_whole_mission, in_state, land, on_leg};
use crate::rig::Rig;
use anyhow::ensure;
use usal::contract::{Command, GatewayState};

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "pilot_takes_over_and_gives_back",
        happens: "the pilot's switch goes to a mode of his own, and half a minute later back",
        expected: "alarm, nobody claims to fly the plan; then the mission from the same place",
        simulator: &[],
        fly: |rig| Box::pin(pilot_gives_back(rig)),
    },
    Scenario {
        name: "operator_takes_back",
        happens: "the autopilot returns by itself, as by a failsafe; the operator resumes",
        expected: "alarm, the autopilot's return is left alone; resume takes the mission up again",
        simulator: &[],
        fly: |rig| Box::pin(operator_takes_back(rig)),
    },
];

async fn taken(rig: &mut Rig, mode: &str) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    rig.disturb(&format!("mode {mode}"))?;
    in_state(rig, GatewayState::Manual, 10.0).await?;
    alarmed(rig, "not-in-command", 10.0).await?;
    let from_s = rig.seen.time_s;
    rig.until("half a minute", 60.0, |_, seen| seen.time_s > from_s + 30.0).await?;
    let state = rig.gateway_status().map(|status| status.state);
    ensure!(state == Some(GatewayState::Manual), "the gateway took it back: {state:?}");
    Ok(())
}

async fn pilot_gives_back(rig: &mut Rig) -> anyhow::Result<()> {
    taken(rig, "loiter").await?;
    rig.disturb("mode auto")?;
    in_state(rig, GatewayState::Nav, 10.0).await?;
    land(rig).await?;
    expect_whole_mission(rig)
}

async fn operator_takes_back(rig: &mut Rig) -> anyhow::Result<()> {
    taken(rig, "rtl").await?;
    rig.command(Command::Resume).await?;
    in_state(rig, GatewayState::Nav, 30.0).await?;
    land(rig).await?;
    expect_whole_mission(rig)
}
