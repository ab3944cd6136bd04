//! What is asked for right after lift-off, or shortly before the touch-down: it waits until the aircraft is clear of the ground.

use super::{FLIGHT_S, Scenario, expect_whole_mission, in_state, land_by_plan, of_field, on_leg};
use crate::rig::{Rig, Seen, id};
use anyhow::ensure;
use std::cell::Cell;
use usal::contract::{Cause, Command, GatewayState};

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "hold_in_climb",
        happens: "the operator holds right after lift-off, and goes on half a minute later",
        expected: "it climbs straight ahead until 40 m, circles, and flies the whole plan",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(hold_in_climb(rig)),
    },
    Scenario {
        name: "emergency_in_climb",
        happens: "the operator declares an emergency right after lift-off",
        expected: "it climbs straight ahead until 40 m, and flies the emergency plan to its landing",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(emergency_in_climb(rig)),
    },
    Scenario {
        name: "hold_in_landing",
        happens: "the operator holds 25 m above the runway, and goes to the final half a minute later",
        expected: "it climbs straight ahead until 40 m, circles, and lands from the final",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(hold_in_landing(rig)),
    },
];

/// Lower nothing but the climb straight ahead is flown, metres; less what two altimeters may differ.
const CLEAR_M: f64 = 35.0;
/// Lower than this it is held in its landing, metres.
const LOW_M: f64 = 25.0;
/// Nobody doubts any more that it has taken off, metres.
const UP_M: f64 = 8.0;
/// A climb straight ahead, in gusts: bank and course, degrees.
const STRAIGHT_DEG: f64 = 20.0;

async fn hold_in_climb(rig: &mut Rig) -> anyhow::Result<()> {
    asked_low(rig, Command::Hold).await?;
    climbs_straight_until(rig, "Hold", |rig, _| {
        rig.gateway_status().is_some_and(|s| s.state == GatewayState::Hold)
    })
    .await?;
    circles(rig).await?;
    rig.command(Command::Resume).await?;
    in_state(rig, GatewayState::Nav, 60.0).await?;
    land_by_plan(rig).await?;
    expect_whole_mission(rig)
}

async fn hold_in_landing(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "final").await?;
    rig.until("low over the runway", FLIGHT_S, |rig, _| height_m(rig).is_some_and(|m| m < LOW_M)).await?;
    rig.command(Command::Hold).await?;
    climbs_straight_until(rig, "Hold", |rig, _| {
        rig.gateway_status().is_some_and(|s| s.state == GatewayState::Hold)
    })
    .await?;
    circles(rig).await?;
    rig.command(Command::GoTo { leg: id("final") }).await?;
    rig.command(Command::Resume).await?;
    in_state(rig, GatewayState::Approach, 240.0).await?;
    land_by_plan(rig).await
}

/// For half a minute.
async fn circles(rig: &mut Rig) -> anyhow::Result<()> {
    let held_at = rig.position().map(|p| p.position);
    let from_s = rig.seen.time_s;
    rig.until("half a minute", 60.0, |_, seen| seen.time_s > from_s + 30.0).await?;
    let away_m = rig.position().zip(held_at).map(|(now, then)| now.position.distance_m(then));
    ensure!(away_m.is_some_and(|m| m < 600.0), "it did not hold: {away_m:?} m away");
    Ok(())
}

async fn emergency_in_climb(rig: &mut Rig) -> anyhow::Result<()> {
    asked_low(rig, Command::Emergency { cause: Cause::Operator, plan: None }).await?;
    climbs_straight_until(rig, "the emergency plan is flown", |rig, seen| {
        seen.entered("home-df") && rig.gateway_status().is_some_and(|s| s.state == GatewayState::Nav)
    })
    .await?;
    land_by_plan(rig).await?;
    ensure!(!rig.seen.entered("round"), "the main plan went on");
    Ok(())
}

fn height_m(rig: &Rig) -> Option<f64> {
    Some(rig.position()?.altitude_amsl_m - rig.field.elevation_m)
}

async fn asked_low(rig: &mut Rig, command: Command) -> anyhow::Result<()> {
    let is_up = |rig: &Rig| height_m(rig).is_some_and(|m| m > UP_M);
    rig.until("a few metres up", 60.0, |rig, _| is_up(rig)).await?;
    rig.command(command).await?;
    let height_m = height_m(rig);
    ensure!(height_m.is_some_and(|m| m < CLEAR_M), "asked too late, {height_m:?} m above the ground");
    Ok(())
}

fn is_straight(rig: &Rig) -> bool {
    rig.attitude().is_some_and(|a| {
        let off_deg = (a.heading_deg - rig.field.heading_deg + 540.0).rem_euclid(360.0) - 180.0;
        a.roll_deg.abs() < STRAIGHT_DEG && off_deg.abs() < STRAIGHT_DEG
    })
}

/// As long as it is low it flies straight ahead, and does not yet what was asked for.
async fn climbs_straight_until(
    rig: &mut Rig,
    what: &str,
    done: impl Fn(&Rig, &Seen) -> bool,
) -> anyhow::Result<()> {
    let turned_at_m = Cell::new(None);
    rig.until(what, 60.0, |rig, seen| {
        let low_m = height_m(rig).filter(|m| *m < CLEAR_M);
        let is_done = done(rig, seen);
        turned_at_m.set(turned_at_m.get().or(low_m.filter(|_| is_done || !is_straight(rig))));
        is_done
    })
    .await?;
    ensure!(turned_at_m.get().is_none(), "it turned at {turned_at_m:?} m above the ground");
    Ok(())
}
