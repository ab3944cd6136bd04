//! What an operator, or a service above the plan, changes in flight.

use super::{FLIGHT_S, Scenario, expect_whole_mission, in_state, land_by_plan, of_field, on_leg};
use crate::rig::{Rig, id, number};
use anyhow::ensure;
use usal::contract::{Command, GatewayState, PlanEvent, VariableValue};

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "variable_moves_the_sweep",
        happens: "the place and the size of the scan change while it is flown; a size out of bounds",
        expected: "it sweeps there; the bad value is refused; the loop ends when its condition holds",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(variable_moves_the_sweep(rig)),
    },
    Scenario {
        name: "plan_update_in_flight",
        happens: "a broken plan, then one with a leg ahead moved",
        expected: "the broken one is refused; the other is flown from the present place on",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(plan_update_in_flight(rig)),
    },
    Scenario {
        name: "decision_by_default",
        happens: "nobody decides at an intersection",
        expected: "it is asked, and its default is flown at the deadline",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(decision_by_default(rig)),
    },
    Scenario {
        name: "decision_by_operator",
        happens: "the operator decides before the intersection",
        expected: "the branch is flown",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(decision_by_operator(rig)),
    },
    Scenario {
        name: "hold_and_resume",
        happens: "the operator holds on a leg, and goes on after a minute",
        expected: "it circles, and goes on from the same place",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(hold_and_resume(rig)),
    },
];

/// Of the leg `far`, m/s: not the one that an autopilot flies at by itself.
const FAR_MPS: f64 = 20.0;
/// Share of an airspeed within which gusts and turns leave it the same.
const SAME_SPEED: f64 = 0.08;

async fn variable_moves_the_sweep(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    let there = rig.field.at(-800.0, 3000.0);
    let moved = Command::SetVariable { name: id("spot"), value: VariableValue::Position(there) };
    rig.command(moved).await?;
    rig.command(Command::SetVariable { name: id("reach"), value: number(300.0) }).await?;
    let refused = rig.command(Command::SetVariable { name: id("reach"), value: number(1e9) }).await;
    ensure!(refused.is_err(), "a value out of bounds was taken");
    let is_there = |rig: &Rig| rig.position().is_some_and(|p| p.position.distance_m(there) < 200.0);
    rig.until("it sweeps there", 400.0, |rig, _| is_there(rig)).await?;
    rig.command(Command::SetVariable { name: id("found"), value: VariableValue::Bool(true) }).await?;
    land_by_plan(rig).await?;
    ensure!(rig.seen.passes("sweep") == 1, "found ends the loop at the end of its pass");
    Ok(())
}

async fn plan_update_in_flight(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    let broken = rig.propose("<flightPlan xmlns=\"urn:legwork:flight-plan:1\" name=\"x\"").await;
    ensure!(broken.map_or(true, |report| !report.acceptable), "a broken plan was accepted");
    let report = rig.load(&rig.field.mission(2400.0)).await?;
    ensure!(report.changed == [id("back")], "changed: {:?}", report.changed);
    land_by_plan(rig).await?;
    expect_whole_mission(rig)
}

async fn decision_by_default(rig: &mut Rig) -> anyhow::Result<()> {
    let is_asked = |e: &PlanEvent| matches!(e, PlanEvent::DecisionRequested(asked) if asked.leg == id("ask"));
    let is_taken = |e: &PlanEvent| matches!(e, PlanEvent::DecisionTaken { branch, by, .. } if *branch == id("on") && by == "default");
    rig.until("asked", FLIGHT_S, |_, seen| seen.plan.iter().any(is_asked)).await?;
    rig.until("decided", 120.0, |_, seen| seen.plan.iter().any(is_taken)).await?;
    on_leg(rig, "mark").await?;
    land_by_plan(rig).await
}

async fn decision_by_operator(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.command(Command::Decide { leg: id("ask"), branch: id("look") }).await?;
    on_leg(rig, "close").await?;
    ensure!(!rig.seen.entered("mark"), "the default was flown");
    land_by_plan(rig).await
}

async fn hold_and_resume(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "far").await?;
    flies_at(rig, FAR_MPS).await?;
    rig.command(Command::Hold).await?;
    let held_at = rig.position().map(|p| p.position);
    let from_s = rig.seen.time_s;
    rig.until("a minute", 120.0, |_, seen| seen.time_s > from_s + 60.0).await?;
    let away_m = rig.position().zip(held_at).map(|(now, then)| now.position.distance_m(then));
    ensure!(away_m.is_some_and(|m| m < 600.0), "it did not hold: {away_m:?} m away");
    rig.command(Command::Resume).await?;
    in_state(rig, GatewayState::Nav, 60.0).await?;
    // an autopilot that forgets the airspeed with each change of its mode is told it again
    flies_at(rig, FAR_MPS).await?;
    land_by_plan(rig).await?;
    expect_whole_mission(rig)
}

async fn flies_at(rig: &mut Rig, mps: f64) -> anyhow::Result<()> {
    let is_so = |rig: &Rig| rig.air().is_some_and(|air| (air.airspeed_mps - mps).abs() < SAME_SPEED * mps);
    rig.until(&format!("at {mps} m/s"), 60.0, |rig, _| is_so(rig)).await
}
