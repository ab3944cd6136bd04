//! Emergency plans, by order and by cause.

use super::{FLIGHT_S, Scenario, alarmed, land_by_plan, of_field, on_leg};
use crate::rig::Rig;
use anyhow::ensure;
use usal::contract::{Cause, Command, PlanEvent};

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
];

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
