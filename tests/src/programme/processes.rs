//! Processes of the agent that die, stop, or never come back.

use super::{FLIGHT_S, Scenario, expect_whole_mission, in_state, land, on_leg};
use crate::rig::Rig;
use anyhow::ensure;
use usal::contract::{GatewayState, PlanEvent};

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "fp_manager_killed",
        happens: "the FP Manager is killed in its second sweep, and comes back",
        expected: "Safe hold within its time, then the mission from the same place; no pass lost or doubled",
        simulator: &[],
        fly: |rig| Box::pin(fp_manager_killed(rig)),
    },
    Scenario {
        name: "fp_manager_gone_for_good",
        happens: "the FP Manager is killed, and never comes back",
        expected: "Safe hold, Safe return, and a landing by the gateway alone",
        simulator: &[],
        fly: |rig| Box::pin(fp_manager_gone_for_good(rig)),
    },
    Scenario {
        name: "gateway_killed",
        happens: "the gateway is killed, and comes back",
        expected: "the FP Manager joins it again, and the mission goes on",
        simulator: &[],
        fly: |rig| Box::pin(gateway_killed(rig)),
    },
    Scenario {
        name: "agent_restarted",
        happens: "gateway and FP Manager are killed, as by a restart of their machine",
        expected: "both find their place again, and the mission goes on",
        simulator: &[],
        fly: |rig| Box::pin(agent_restarted(rig)),
    },
    Scenario {
        name: "ground_station_gone",
        happens: "the ground station leaves without a word, and comes back",
        expected: "the mission is flown as if nothing had been",
        simulator: &[],
        fly: |rig| Box::pin(ground_station_gone(rig)),
    },
];

async fn fp_manager_killed(rig: &mut Rig) -> anyhow::Result<()> {
    rig.until("second sweep", FLIGHT_S, |_, seen| seen.passes("sweep") == 2).await?;
    rig.fp_manager.kill()?;
    in_state(rig, GatewayState::SafeHold, 60.0).await?;
    rig.restart_fp_manager()?;
    in_state(rig, GatewayState::Nav, 60.0).await?;
    land(rig).await?;
    let finished = rig.seen.plan.iter().filter(|e| matches!(e, PlanEvent::IterationFinished { .. })).count();
    ensure!(finished == 3, "{finished} passes of the loop, three were planned");
    ensure!(!rig.seen.went_to(GatewayState::SafeReturn), "it gave the mission up");
    Ok(())
}

async fn fp_manager_gone_for_good(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    rig.fp_manager.kill()?;
    let killed_s = rig.seen.time_s;
    in_state(rig, GatewayState::SafeHold, 10.0).await?;
    let took_s = rig.seen.time_s - killed_s;
    ensure!(took_s < 5.0, "Safe hold came after {took_s:.1} s");
    in_state(rig, GatewayState::SafeReturn, 60.0).await?;
    land(rig).await?;
    ensure!(rig.seen.went_to(GatewayState::SafeLand), "it did not land by Safe mode");
    Ok(())
}

async fn gateway_killed(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.gateway.kill()?;
    rig.restart_gateway()?;
    goes_on(rig).await
}

async fn agent_restarted(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.gateway.kill()?;
    rig.fp_manager.kill()?;
    rig.restart_gateway()?;
    rig.restart_fp_manager()?;
    goes_on(rig).await
}

async fn goes_on(rig: &mut Rig) -> anyhow::Result<()> {
    in_state(rig, GatewayState::Nav, 60.0).await?;
    land(rig).await?;
    ensure!(!rig.seen.went_to(GatewayState::SafeReturn), "it gave the mission up");
    for leg in ["back", "downwind", "final"] {
        ensure!(rig.seen.passes(leg) == 1, "{leg} was flown {} times", rig.seen.passes(leg));
    }
    ensure!(rig.seen.passes("sweep") == 3, "three sweeps, not {}", rig.seen.passes("sweep"));
    Ok(())
}

async fn ground_station_gone(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "out").await?;
    rig.leave().await?;
    rig.come_back().await?;
    super::land_by_plan(rig).await?;
    expect_whole_mission(rig)
}
