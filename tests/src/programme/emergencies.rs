//! Emergency plans, by order and by cause.

use super::{FLIGHT_S, Scenario, alarmed, land_by_plan, of_field, on_leg};
use crate::rig::Rig;
use anyhow::ensure;
use usal::contract::{Cause, Command, GatewayState, PlanEvent};

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "emergency_at_leg_level",
        happens: "an emergency on a leg that has a plan of its own",
        expected: "that plan is flown, to its landing",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(ordered(rig, "far", Cause::Link, "near-home-df")),
    },
    Scenario {
        name: "emergency_at_stage_level",
        happens: "an emergency on a stage that has a plan of its own",
        expected: "that plan is flown, to its landing",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(ordered(rig, "sweep", Cause::Energy, "field-df")),
    },
    Scenario {
        name: "emergency_at_plan_level",
        happens: "an emergency where neither leg nor stage has a plan",
        expected: "the plan of the whole flight plan is flown, to its landing",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(ordered(rig, "round", Cause::Operator, "home-df")),
    },
    Scenario {
        name: "engine_lost",
        happens: "the engine stops",
        expected: "alarm, and at once the plan for the cause engine",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(engine_lost(rig, &["engine-out", "engine-suspected"])),
    },
    Scenario {
        name: "engine_lost_unreported",
        happens: "the engine stops, and nothing tells its speed",
        expected: "it is suspected by its sinking; the plan for the cause engine",
        plan: of_field,
        simulator: &["--fault", "no-rpm"],
        fly: |rig| Box::pin(engine_lost(rig, &["engine-suspected"])),
    },
    Scenario {
        name: "iced",
        happens: "ice, or an engine with a part of its power: too little for altitude or speed, until that is told",
        expected: "alarm: it is slow, sinks, is off its altitude, or does not get past a waypoint; and a landing",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(iced(rig)),
    },
    Scenario {
        name: "battery_low",
        happens: "the battery falls below its reserve",
        expected: "alarm, and the plan for the cause energy, to its landing",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(battery_low(rig)),
    },
    Scenario {
        name: "gps_lost",
        happens: "no GPS for half a minute",
        expected: "alarm while it lasts, and a landing",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(gps_lost(rig)),
    },
    Scenario {
        name: "ended_by_force",
        happens: "the flight is ended by force",
        expected: "the engine is off within seconds, it is down, and nobody claims to fly it",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(ended_by_force(rig)),
    },
];

/// From the order to an engine that is off, and until that is seen, seconds.
const OFF_WITHIN_S: f64 = 10.0;

async fn ordered(rig: &mut Rig, on: &str, cause: Cause, direct: &str) -> anyhow::Result<()> {
    on_leg(rig, on).await?;
    rig.command(Command::Emergency { cause, plan: None }).await?;
    on_leg(rig, direct).await?;
    land_by_plan(rig).await?;
    ensure!(!rig.seen.entered("back"), "the main plan went on");
    Ok(())
}

async fn started_for(rig: &mut Rig, of: Cause) -> anyhow::Result<()> {
    let is_it = |e: &PlanEvent| matches!(e, PlanEvent::EmergencyStarted { cause, .. } if *cause == of);
    rig.until("its emergency plan", 90.0, |_, seen| seen.plan.iter().any(is_it)).await
}

/// One of these alarms: an autopilot that reports the engine's speed says more.
async fn engine_lost(rig: &mut Rig, alarms: &[&str]) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    rig.disturb("fault engine-out")?;
    rig.until("an alarm", 60.0, |_, seen| alarms.iter().any(|id| seen.alarmed(id))).await?;
    started_for(rig, Cause::Engine).await?;
    rig.until("down", FLIGHT_S, |rig, _| rig.position().is_some_and(|p| p.on_ground)).await
}

async fn iced(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.disturb("fault ice")?;
    let told = ["slow", "sinks", "off-altitude", "no-further"];
    rig.until("an alarm", 120.0, |_, seen| told.iter().any(|id| seen.alarmed(id))).await?;
    rig.disturb("clear ice")?;
    // where it is taken for an engine that failed, it glides to wherever it gets
    rig.until("landed", FLIGHT_S, |_, seen| seen.landed()).await
}

async fn battery_low(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.disturb("fault low-battery")?;
    alarmed(rig, "energy-low", 60.0).await?;
    started_for(rig, Cause::Energy).await?;
    land_by_plan(rig).await
}

async fn gps_lost(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.disturb("fault gps-loss+30")?;
    alarmed(rig, "gps-lost", 30.0).await?;
    rig.until("it is over", 120.0, |_, seen| seen.calmed("gps-lost")).await?;
    super::land(rig).await
}

/// On its own ground, wherever that is: nothing is steered any more.
async fn ended_by_force(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    rig.terminate().await?;
    super::in_state(rig, GatewayState::Terminate, OFF_WITHIN_S).await?;
    let is_off = |rig: &Rig| rig.gateway_status().is_some_and(|status| !status.armed);
    rig.until("its engine off", OFF_WITHIN_S, |rig, _| is_off(rig)).await?;
    rig.until("down", FLIGHT_S, |rig, _| rig.position().is_some_and(|p| p.on_ground)).await?;
    super::in_state(rig, GatewayState::Terminate, OFF_WITHIN_S).await
}
