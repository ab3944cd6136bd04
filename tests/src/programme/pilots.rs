//! Somebody else takes the aircraft: a pilot, or the autopilot's own failsafe.

use super::{Scenario, alarmed, expect_whole_mission, in_state, land, of_field, on_leg};
use crate::rig::Rig;
use anyhow::ensure;
use usal::contract::{Command, GatewayState};

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "pilot_takes_over_and_gives_back",
        happens: "the pilot's switch goes to a mode of his own, and half a minute later back",
        expected: "alarm, nobody claims to fly the plan; then the mission from the same place",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(pilot_gives_back(rig)),
    },
    Scenario {
        name: "operator_takes_back",
        happens: "the autopilot returns by itself, as by a failsafe; the operator resumes",
        expected: "alarm, the autopilot's return is left alone; resume takes the mission up again",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(operator_takes_back(rig)),
    },
    Scenario {
        name: "geofence_breached",
        happens: "the aircraft is outside of a fence of the autopilot's own, which returns; the fence is taken away, and the operator resumes",
        expected: "alarm, the autopilot's return is left alone; resume takes the mission up again",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(geofence_breached(rig)),
    },
    Scenario {
        name: "list_replaced",
        happens: "another ground station uploads a mission, and leaves it at that; the operator resumes",
        expected: "alarm, nobody claims to fly the plan; resume brings the mission back aboard, from the same place",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(list_replaced(rig, "upload")),
    },
    Scenario {
        name: "list_replaced_and_flown",
        happens: "another ground station uploads a mission and has it flown; the operator resumes",
        expected: "alarm, nobody claims to fly the plan; resume brings the mission back aboard, from the same place",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(list_replaced(rig, "upload-and-fly")),
    },
];

/// Somebody else leads it after this is done to it, and is left alone.
async fn taken(rig: &mut Rig, disturbance: &str) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    rig.disturb(disturbance)?;
    in_state(rig, GatewayState::Manual, 10.0).await?;
    alarmed(rig, "not-in-command", 10.0).await?;
    let from_s = rig.seen.time_s;
    rig.until("half a minute", 60.0, |_, seen| seen.time_s > from_s + 30.0).await?;
    let state = rig.gateway_status().map(|status| status.state);
    ensure!(state == Some(GatewayState::Manual), "the gateway took it back: {state:?}");
    Ok(())
}

async fn pilot_gives_back(rig: &mut Rig) -> anyhow::Result<()> {
    taken(rig, "mode loiter").await?;
    rig.disturb("mode auto")?;
    in_state(rig, GatewayState::Nav, 10.0).await?;
    land(rig).await?;
    expect_whole_mission(rig)
}

async fn operator_takes_back(rig: &mut Rig) -> anyhow::Result<()> {
    taken(rig, "mode rtl").await?;
    resumed(rig).await
}

async fn resumed(rig: &mut Rig) -> anyhow::Result<()> {
    rig.command(Command::Resume).await?;
    in_state(rig, GatewayState::Nav, 30.0).await?;
    land(rig).await?;
    expect_whole_mission(rig)
}

/// On that leg it is 700 m away and more.
async fn geofence_breached(rig: &mut Rig) -> anyhow::Result<()> {
    taken(rig, "fence 600").await?;
    rig.disturb("fence 0")?;
    resumed(rig).await
}

async fn list_replaced(rig: &mut Rig, upload: &str) -> anyhow::Result<()> {
    // where a leg begins, the gateway writes its own list over what another station puts aboard in that moment
    on_leg(rig, "far").await?;
    let from_s = rig.seen.time_s;
    rig.until("the gateway's own list", 60.0, |_, seen| seen.time_s > from_s + 5.0).await?;
    let around = rig.field.at(600.0, 1000.0);
    taken(rig, &format!("{upload} {:.7},{:.7}", around.lat_deg, around.lon_deg)).await?;
    resumed(rig).await
}
