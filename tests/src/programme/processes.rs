//! Processes of the agent that die, stop, or never come back.

use super::{FLIGHT_S, Scenario, expect_whole_mission, in_state, land, of_field, on_leg};
use crate::rig::Rig;
use anyhow::ensure;
use usal::contract::{GatewayState, PlanEvent};

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "fp_manager_killed",
        happens: "the FP Manager is killed in its second sweep, and comes back",
        expected: "Safe hold within its time, then the mission from the same place; no pass lost or doubled",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(fp_manager_killed(rig)),
    },
    Scenario {
        name: "fp_manager_frozen",
        happens: "the FP Manager is stopped in its second sweep for ten seconds, and goes on",
        expected: "Safe hold within its time, then the mission from the same place; no pass lost or doubled",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(fp_manager_frozen(rig)),
    },
    Scenario {
        name: "fp_manager_gone_for_good",
        happens: "the FP Manager is killed, and never comes back",
        expected: "Safe hold, Safe return, and a landing by the gateway alone",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(fp_manager_gone_for_good(rig)),
    },
    Scenario {
        name: "gateway_killed",
        happens: "the gateway is killed, and comes back",
        expected: "the FP Manager joins it again, and the mission goes on",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(gateway_killed(rig)),
    },
    Scenario {
        name: "agent_restarted",
        happens: "gateway and FP Manager are killed, as by a restart of their machine",
        expected: "both find their place again, and the mission goes on",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(agent_restarted(rig)),
    },
    Scenario {
        name: "ground_station_gone",
        happens: "the ground station leaves without a word, and comes back",
        expected: "the mission is flown as if nothing had been",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(ground_station_gone(rig)),
    },
];

/// T1 and 0.2 s, and until that is seen.
const HELD_WITHIN_S: f64 = 2.5;
/// That a disk is slow is told within some turns of the FP Manager.
const TOLD_WITHIN_S: f64 = 0.5;
/// 2 s, and until that is seen.
const BACK_WITHIN_S: f64 = 2.5;

async fn fp_manager_killed(rig: &mut Rig) -> anyhow::Result<()> {
    rig.until("second sweep", FLIGHT_S, |_, seen| seen.passes("sweep") == 2).await?;
    is_recorded(rig).await?;
    rig.fp_manager.kill()?;
    in_state(rig, GatewayState::SafeHold, HELD_WITHIN_S).await?;
    rig.fp_manager_is_there(false).await?;
    rig.restart_fp_manager()?;
    rig.fp_manager_is_there(true).await?;
    in_its_place_again(rig).await
}

async fn fp_manager_frozen(rig: &mut Rig) -> anyhow::Result<()> {
    rig.until("second sweep", FLIGHT_S, |_, seen| seen.passes("sweep") == 2).await?;
    rig.fp_manager.freeze()?;
    in_state(rig, GatewayState::SafeHold, HELD_WITHIN_S).await?;
    let from_s = rig.seen.time_s;
    rig.until("ten seconds", 20.0, |_, seen| seen.time_s > from_s + 10.0).await?;
    rig.thaw_fp_manager().await?;
    in_its_place_again(rig).await
}

/// What happened so far would survive a kill. On a slow disk it takes effect, and is announced, before it is recorded: what is killed
/// in that moment announces it again.
async fn is_recorded(rig: &mut Rig) -> anyhow::Result<()> {
    let happened_s = rig.seen.time_s;
    let is_told = |now_s: f64| now_s > happened_s + TOLD_WITHIN_S;
    rig.until("recorded", FLIGHT_S, |_, seen| is_told(seen.time_s) && seen.is_recorded()).await
}

/// Nothing of the loop was lost or doubled.
async fn in_its_place_again(rig: &mut Rig) -> anyhow::Result<()> {
    in_state(rig, GatewayState::Nav, BACK_WITHIN_S).await?;
    land(rig).await?;
    let finished = rig.seen.plan.iter().filter(|e| matches!(e, PlanEvent::IterationFinished { .. })).count();
    ensure!(finished == 3, "{finished} passes of the loop, three were planned");
    ensure!(!rig.seen.went_to(GatewayState::SafeReturn), "it gave the mission up");
    expect_whole_mission(rig)
}

async fn fp_manager_gone_for_good(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    rig.fp_manager.kill()?;
    in_state(rig, GatewayState::SafeHold, HELD_WITHIN_S).await?;
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
    is_recorded(rig).await?;
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
