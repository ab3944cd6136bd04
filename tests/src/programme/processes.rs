//! Processes of the agent that die, stop, or never come back.

use super::{FLIGHT_S, Scenario, expect_whole_mission, in_state, land, of_field, on_leg};
use crate::rig::{Rig, Seen};
use anyhow::{Context, ensure};
use std::time::Duration;
use usal::contract::{GatewayRequest, GatewayState, PlanEvent};

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
        name: "runways_taken_away",
        happens: "somebody takes the stored runways away in flight; then the FP Manager is killed and does not come back",
        expected: "it is refused; Safe hold, then return and landing on the stored runway",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(runways_taken_away(rig)),
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
        name: "gateway_without_memory",
        happens: "the gateway is killed, and what it had stored is lost",
        expected: "the list aboard is known to be ours, and nothing of it is known; the mission from the same place",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(gateway_without_memory(rig)),
    },
    Scenario {
        name: "both_killed",
        happens: "gateway and FP Manager are killed, and come back at once",
        expected: "both find their place again, and the mission goes on",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(both_killed(rig)),
    },
    Scenario {
        name: "agent_restarted",
        happens: "gateway and FP Manager are killed, and come back when their machine has started anew",
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

/// T1 and 0.2 s, by the gateway's clock.
const HELD_WITHIN_S: f64 = 2.2;
/// That a disk is slow is told within some turns of the FP Manager.
const TOLD_WITHIN_S: f64 = 0.5;
/// The FP Manager has the aircraft again so soon after it or the gateway came back, by the gateway's clock.
const BACK_WITHIN_S: f64 = 2.0;
/// A small computer has started anew after so long; by the machine's clock.
const MACHINE_STARTS_IN: Duration = Duration::from_secs(8);
/// What took its time is looked for this long.
const SEEN_WITHIN_S: f64 = 60.0;

async fn fp_manager_killed(rig: &mut Rig) -> anyhow::Result<()> {
    rig.until("second sweep", FLIGHT_S, |_, seen| seen.passes("sweep") == 2).await?;
    is_recorded(rig).await?;
    rig.fp_manager.kill()?;
    is_held(rig).await?;
    rig.fp_manager_is_there(false).await?;
    rig.restart_fp_manager()?;
    rig.fp_manager_is_there(true).await?;
    in_its_place_again(rig).await
}

async fn fp_manager_frozen(rig: &mut Rig) -> anyhow::Result<()> {
    rig.until("second sweep", FLIGHT_S, |_, seen| seen.passes("sweep") == 2).await?;
    rig.fp_manager.freeze()?;
    is_held(rig).await?;
    let from_s = rig.seen.time_s;
    rig.until("ten seconds", 20.0, |_, seen| seen.time_s > from_s + 10.0).await?;
    rig.thaw_fp_manager().await?;
    in_its_place_again(rig).await
}

/// The FP Manager is gone since now: Safe mode holds within its time.
async fn is_held(rig: &mut Rig) -> anyhow::Result<()> {
    goes_to(rig, GatewayState::SafeHold, HELD_WITHIN_S).await
}

/// From now on the gateway goes to a state within so many seconds, by its own clock.
async fn goes_to(rig: &mut Rig, state: GatewayState, within_s: f64) -> anyhow::Result<()> {
    let from_s = rig.gateway_s().context("the gateway says nothing")?;
    let went_s = |seen: &Seen| seen.went_to_behind(state, from_s);
    rig.until(&format!("{state:?}"), SEEN_WITHIN_S, |_, seen| went_s(seen).is_some()).await?;
    let took_s = went_s(&rig.seen).map_or(f64::INFINITY, |at_s| at_s - from_s);
    ensure!(took_s <= within_s, "{state:?} after {took_s:.2} s");
    Ok(())
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
    goes_to(rig, GatewayState::Nav, BACK_WITHIN_S).await?;
    land(rig).await?;
    let finished = rig.seen.plan.iter().filter(|e| matches!(e, PlanEvent::IterationFinished { .. })).count();
    ensure!(finished == 3, "{finished} passes of the loop, three were planned");
    ensure!(!rig.seen.went_to(GatewayState::SafeReturn), "it gave the mission up");
    expect_whole_mission(rig)
}

async fn fp_manager_gone_for_good(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    rig.fp_manager.kill()?;
    is_held(rig).await?;
    in_state(rig, GatewayState::SafeReturn, 60.0).await?;
    land(rig).await?;
    ensure!(rig.seen.went_to(GatewayState::SafeLand), "it did not land by Safe mode");
    Ok(())
}

async fn runways_taken_away(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    let taken = rig.ask_gateway(GatewayRequest::SetRunways { runways: vec![] }).await;
    ensure!(taken.is_err(), "the aircraft flies, and no runway is left to it");
    fp_manager_gone_for_good(rig).await
}

async fn gateway_killed(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    let flown_out = rig.seen.flown_out();
    let back_s = rig.kill_and_restart_gateway().await?;
    // how long the network takes to tell who is there is no time of the flight
    rig.fp_manager_is_there(true).await?;
    let joined_s = |rig: &Rig| {
        let said = rig.gateway_said()?;
        let is_joined = said.value.state == GatewayState::Nav && said.value.fp_manager.is_some();
        is_joined.then_some(said.time_s)
    };
    rig.until("the FP Manager joins", SEEN_WITHIN_S, |rig, _| joined_s(rig).is_some()).await?;
    let took_s = joined_s(rig).map_or(f64::INFINITY, |at_s| at_s - back_s);
    ensure!(took_s <= BACK_WITHIN_S, "joined after {took_s:.2} s");
    ensure!(rig.seen.flown_out() == flown_out, "its waypoints had all been flown by then");
    goes_on(rig).await?;
    ensure!(!rig.seen.went_to(GatewayState::SafeHold), "its waypoints ran dry");
    Ok(())
}

async fn gateway_without_memory(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.gateway.kill()?;
    rig.fp_manager_is_there(false).await?;
    rig.forget_gateway()?;
    rig.restart_gateway()?;
    rig.fp_manager_is_there(true).await?;
    goes_on(rig).await
}

async fn both_killed(rig: &mut Rig) -> anyhow::Result<()> {
    are_gone_for(rig, Duration::ZERO).await
}

async fn agent_restarted(rig: &mut Rig) -> anyhow::Result<()> {
    are_gone_for(rig, MACHINE_STARTS_IN).await
}

/// The aircraft flies on by the list aboard. In lockstep nobody lets its time go on meanwhile.
async fn are_gone_for(rig: &mut Rig, time: Duration) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    is_recorded(rig).await?;
    rig.gateway.kill()?;
    rig.fp_manager.kill()?;
    if !rig.is_in_lockstep() {
        tokio::time::sleep(time).await;
    }
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
    if !rig.is_in_lockstep() {
        tokio::time::sleep(MACHINE_STARTS_IN).await;
    }
    rig.come_back().await?;
    super::land_by_plan(rig).await?;
    expect_whole_mission(rig)
}
