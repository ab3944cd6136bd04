//! Whole flights of the real binaries, in lockstep: time goes on only when the test says so.
#![cfg(test)]

use system_tests::{
    plans::Field,
    rig::{FIELD, Rig, id, number},
};
use usal::contract::{Cause, Command, GatewayState, PlanEvent, VariableValue};

/// Longest flight of the mission, simulated seconds.
const FLIGHT_S: f64 = 3000.0;

async fn airborne(simulator: &[&str]) -> Rig {
    let mut rig = Rig::start(simulator).await.unwrap();
    rig.fly_mission().await.unwrap();
    rig
}

async fn land(rig: &mut Rig) {
    rig.until("landed", FLIGHT_S, |_, seen| seen.landed()).await.unwrap();
    rig.expect_on_runway().unwrap();
}

async fn on_leg(rig: &mut Rig, leg: &str) {
    rig.until(leg, FLIGHT_S, |_, seen| seen.entered(leg)).await.unwrap();
}

fn position(field: Field, ahead_m: f64, right_m: f64) -> VariableValue {
    VariableValue::Position(field.at(ahead_m, right_m))
}

#[tokio::test(flavor = "multi_thread")]
async fn nominal_mission_flies_three_sweeps_and_lands() {
    let mut rig = airborne(&["--wind", "270,5"]).await;
    land(&mut rig).await;
    let legs = rig.seen.legs();
    for leg in ["out", "round", "far", "sweep", "mark", "end", "back", "downwind", "final"] {
        assert!(legs.contains(&leg), "{leg} is missing: {legs:?}");
    }
    assert_eq!(legs.iter().filter(|leg| **leg == "sweep").count(), 3, "{legs:?}");
    assert!(!rig.seen.went_to(GatewayState::SafeHold), "{}", rig.story());
}

#[tokio::test(flavor = "multi_thread")]
async fn variable_change_moves_the_sweep() {
    let mut rig = airborne(&[]).await;
    on_leg(&mut rig, "sweep").await;
    let value = position(FIELD, -800.0, 3000.0);
    rig.command(Command::SetVariable { name: id("spot"), value }).await.unwrap();
    rig.command(Command::SetVariable { name: id("reach"), value: number(300.0) }).await.unwrap();
    let refused = rig.command(Command::SetVariable { name: id("reach"), value: number(1e9) }).await;
    assert!(refused.is_err(), "a value out of bounds was taken");
    let there = FIELD.at(-800.0, 3000.0);
    rig.until("it sweeps there", 400.0, |rig, _| {
        rig.position().is_some_and(|p| p.position.distance_m(there) < 200.0)
    })
    .await
    .unwrap();
    rig.command(Command::SetVariable { name: id("found"), value: VariableValue::Bool(true) }).await.unwrap();
    land(&mut rig).await;
    let sweeps = rig.seen.legs().iter().filter(|leg| **leg == "sweep").count();
    assert_eq!(sweeps, 1, "found ends the loop at the end of its pass: {:?}", rig.seen.legs());
}

#[tokio::test(flavor = "multi_thread")]
async fn decision_by_default_at_its_deadline() {
    let mut rig = airborne(&[]).await;
    rig.until("asked", FLIGHT_S, |_, seen| {
        seen.plan.iter().any(|e| matches!(e, PlanEvent::DecisionRequested(r) if r.leg == id("ask")))
    })
    .await
    .unwrap();
    rig.until("decided", 120.0, |_, seen| {
        seen.plan.iter().any(
            |e| matches!(e, PlanEvent::DecisionTaken { branch, by, .. } if *branch == id("on") && by == "default"),
        )
    })
    .await
    .unwrap();
    on_leg(&mut rig, "mark").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn decision_by_operator_is_flown() {
    let mut rig = airborne(&[]).await;
    on_leg(&mut rig, "sweep").await;
    rig.command(Command::Decide { leg: id("ask"), branch: id("look") }).await.unwrap();
    on_leg(&mut rig, "close").await;
    assert!(!rig.seen.entered("mark"));
}

/// Raises an emergency on a leg and expects a certain plan, flown to its end.
async fn emergency(on: &str, cause: Cause, direct: &str) {
    let mut rig = airborne(&[]).await;
    on_leg(&mut rig, on).await;
    rig.command(Command::Emergency { cause, plan: None }).await.unwrap();
    on_leg(&mut rig, direct).await;
    land(&mut rig).await;
    assert!(!rig.seen.entered("back"), "{:?}", rig.seen.legs());
}

#[tokio::test(flavor = "multi_thread")]
async fn emergency_at_leg_level() {
    emergency("far", Cause::Link, "near-home-df").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn emergency_at_stage_level() {
    emergency("sweep", Cause::Energy, "field-df").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn emergency_at_plan_level() {
    emergency("round", Cause::Operator, "home-df").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn fp_manager_killed_and_back_in_time_goes_on_at_its_place() {
    let mut rig = airborne(&[]).await;
    rig.until("second sweep", FLIGHT_S, |_, seen| {
        seen.legs().iter().filter(|leg| **leg == "sweep").count() == 2
    })
    .await
    .unwrap();
    rig.fp_manager.kill().unwrap();
    rig.until("Safe", 60.0, |_, seen| seen.went_to(GatewayState::SafeHold)).await.unwrap();
    rig.restart_fp_manager().unwrap();
    rig.until("back in Nav", 60.0, |rig, _| {
        rig.gateway_status().is_some_and(|s| s.state == GatewayState::Nav)
    })
    .await
    .unwrap();
    land(&mut rig).await;
    let finished = rig.seen.plan.iter().filter(|e| matches!(e, PlanEvent::IterationFinished { .. })).count();
    assert_eq!(finished, 3, "no iteration lost, none doubled: {}", rig.story());
    assert!(!rig.seen.went_to(GatewayState::SafeReturn));
}

#[tokio::test(flavor = "multi_thread")]
async fn fp_manager_gone_for_good_ends_on_the_runway() {
    let mut rig = airborne(&[]).await;
    on_leg(&mut rig, "far").await;
    rig.fp_manager.kill().unwrap();
    let killed_s = rig.seen.time_s;
    rig.until("Safe.Hold", 10.0, |_, seen| seen.went_to(GatewayState::SafeHold)).await.unwrap();
    assert!(rig.seen.time_s - killed_s < 5.0, "T1 is 2 s, it took {:.1} s", rig.seen.time_s - killed_s);
    rig.until("Safe.Return", 60.0, |_, seen| seen.went_to(GatewayState::SafeReturn)).await.unwrap();
    land(&mut rig).await;
    assert!(rig.seen.went_to(GatewayState::SafeLand), "{}", rig.story());
}

#[tokio::test(flavor = "multi_thread")]
async fn ground_station_gone_is_no_matter() {
    let mut rig = airborne(&[]).await;
    on_leg(&mut rig, "out").await;
    rig.leave().await.unwrap();
    rig.come_back().await.unwrap();
    land(&mut rig).await;
    assert!(rig.seen.entered("final"));
}

#[tokio::test(flavor = "multi_thread")]
async fn packet_loss_of_a_fifth_is_flown_through() {
    let mut rig = airborne(&["--fault", "packet-loss=0.2", "--seed", "7"]).await;
    land(&mut rig).await;
    assert_eq!(rig.seen.legs().iter().filter(|leg| **leg == "sweep").count(), 3);
    assert!(!rig.seen.went_to(GatewayState::SafeReturn), "{}", rig.story());
}

#[tokio::test(flavor = "multi_thread")]
async fn plan_update_in_flight_keeps_the_place() {
    let mut rig = airborne(&[]).await;
    on_leg(&mut rig, "sweep").await;
    let bad = rig.propose("<flightPlan xmlns=\"urn:legwork:flight-plan:1\" name=\"x\"").await;
    assert!(bad.map_or(true, |report| !report.acceptable), "a broken plan was accepted");
    let report = rig.load(&FIELD.mission(2400.0)).await.unwrap();
    assert_eq!(report.changed, vec![id("back")], "{report:?}");
    land(&mut rig).await;
    let legs = rig.seen.legs();
    assert_eq!(legs.iter().filter(|leg| **leg == "sweep").count(), 3, "{legs:?}");
    assert_eq!(legs.iter().filter(|leg| **leg == "out").count(), 1, "{legs:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn engine_out_flies_the_alternate_by_itself() {
    let mut rig = airborne(&[]).await;
    on_leg(&mut rig, "downwind").await;
    rig.simulator.as_mut().unwrap().send_line("fault engine-out").unwrap();
    rig.until("an emergency plan", 60.0, |_, seen| {
        seen.plan.iter().any(|e| matches!(e, PlanEvent::EmergencyStarted { cause: Cause::Engine, .. }))
    })
    .await
    .unwrap();
}

/// A file stands where the recordings' folder should be: that is told and counted, and nobody waits for it.
#[tokio::test(flavor = "multi_thread")]
async fn flight_without_room_for_its_recording_is_flown_all_the_same() {
    let state = tempfile::tempdir().unwrap();
    let recordings = state.path().join("recordings");
    std::fs::write(&recordings, b"no folder").unwrap();
    let mut rig = Rig::start(&[]).await.unwrap();
    rig.start_storage(state.path()).unwrap();
    let told = rig.recorder_says("a failure", |r| r.failure.is_some() && r.missed > 0).await.unwrap();
    assert!(told.failure.is_some_and(|why| why.contains("recordings")), "it says which folder");
    rig.fly_mission().await.unwrap();
    on_leg(&mut rig, "far").await;
    let before = told.missed;
    let told = rig.recorder_says("more that was missed", |r| r.missed > before + 100).await.unwrap();
    assert_eq!((told.messages, told.file), (0, None), "nothing can have been recorded");
    // somebody repairs it in flight
    std::fs::remove_file(&recordings).unwrap();
    rig.recorder_says("it records", |r| r.failure.is_none() && r.file.is_some()).await.unwrap();
    land(&mut rig).await;
    let told = rig.recorder_says("the rest is recorded", |r| r.messages > 100).await.unwrap();
    assert!(told.missed > before, "what was missed stays counted: {told:?}");
    let file = recordings.join(told.file.unwrap());
    assert!(std::fs::metadata(&file).unwrap().len() > 10_000, "{}", file.display());
    assert!(!rig.seen.went_to(GatewayState::SafeHold), "{}", rig.story());
}
