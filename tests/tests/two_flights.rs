//! A plan of two flights, flown by the real binaries in lockstep: it lands, waits on the ground, is started again, and flies on.
#![cfg(test)]

use system_tests::rig::{FIELD, Rig};
use usal::contract::{Command, GatewayEvent, GatewayState, Phase};

/// Longest flight of the mission, simulated seconds.
const FLIGHT_S: f64 = 3000.0;
/// So long somebody changes the battery: longer than any alarm waits before it is raised.
const STANDS_S: f64 = 60.0;

fn phase(rig: &Rig) -> Option<Phase> {
    Some(rig.plan_status()?.phase)
}

fn state(rig: &Rig) -> Option<GatewayState> {
    Some(rig.gateway_status()?.state)
}

/// Loads the plan and flies to its first landing; comes back when the aircraft stands and waits for the next start.
async fn land_between(simulator: &[&str], plan: String) -> Rig {
    let mut rig = Rig::start(simulator).await.unwrap();
    rig.fly(&plan).await.unwrap();
    let waits = |rig: &Rig| phase(rig) == Some(Phase::Grounded) && state(rig) == Some(GatewayState::Stop);
    rig.until("it waits on the ground", FLIGHT_S, |rig, _| waits(rig)).await.unwrap();
    rig.expect_on_runway().unwrap();
    assert_eq!(rig.seen.legs(), ["to", "out", "far", "final", "land"], "{}", rig.story());
    rig
}

async fn stand(rig: &mut Rig, duration_s: f64) {
    let until_s = rig.seen.time_s + duration_s;
    rig.until("time passes", 2.0 * duration_s, |_, seen| seen.time_s >= until_s).await.unwrap();
}

/// Time passes on the ground: nothing is fed, nothing moves, and no alarm says that something ought to.
async fn wait_on_the_ground(rig: &mut Rig) {
    let (events, place) = (rig.seen.gateway.len(), rig.plan_status().unwrap().place);
    stand(rig, STANDS_S).await;
    let raised: Vec<_> = rig.seen.gateway.iter().skip(events).collect();
    let alarm = |e: &&&GatewayEvent| matches!(e, GatewayEvent::AlarmRaised(_));
    assert_eq!(raised.iter().find(alarm), None, "an alarm while it waits");
    let status = rig.plan_status().unwrap();
    assert_eq!((status.phase, status.outstanding, status.place), (Phase::Grounded, 0, place));
    assert_eq!(state(rig), Some(GatewayState::Stop), "{}", rig.story());
}

/// The FP Manager dies on the ground, and is brought back when that has been noticed.
async fn kill_and_bring_back(rig: &mut Rig) {
    let place = rig.plan_status().unwrap().place.expect("the next take-off");
    assert_eq!(place.leg.as_str(), "to2");
    rig.fp_manager.kill().unwrap();
    rig.fp_manager_is_there(false).await.unwrap();
    stand(rig, 20.0).await;
    assert!(!rig.seen.went_to(GatewayState::SafeHold), "it stands: {}", rig.story());
    rig.restart_fp_manager().unwrap();
    rig.fp_manager_is_there(true).await.unwrap();
    stand(rig, 3.0).await;
    let status = rig.plan_status().unwrap();
    assert_eq!((status.phase, status.place), (Phase::Grounded, Some(place)), "{}", rig.story());
}

/// From the start of the second flight to its landing, which ends the plan.
async fn fly_second(rig: &mut Rig) {
    rig.command(Command::Start).await.unwrap();
    rig.until("airborne again", 120.0, |rig, _| rig.position().is_some_and(|p| !p.on_ground)).await.unwrap();
    let ended = |rig: &Rig| phase(rig) == Some(Phase::Finished) && state(rig) == Some(GatewayState::Stop);
    rig.until("it ends", FLIGHT_S, |rig, _| ended(rig)).await.unwrap();
    rig.expect_on_runway().unwrap();
    let legs = rig.seen.legs();
    let second: Vec<&str> = legs.iter().copied().skip_while(|leg| *leg != "to2").collect();
    assert_eq!(second, ["to2", "out2", "far2", "final2", "land2"], "{}", rig.story());
    assert_eq!(
        legs.iter().filter(|leg| **leg == "to").count(),
        1,
        "the first flight is flown once: {legs:?}"
    );
    assert!(!rig.seen.went_to(GatewayState::SafeHold), "{}", rig.story());
}

async fn flies_two_flights(simulator: &[&str]) {
    let mut rig = land_between(simulator, FIELD.two_flights(FIELD)).await;
    wait_on_the_ground(&mut rig).await;
    kill_and_bring_back(&mut rig).await;
    fly_second(&mut rig).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn arduplane_waits_on_the_ground_and_flies_the_second_flight() {
    flies_two_flights(&["--wind", "270,5"]).await;
}

#[cfg_attr(debug_assertions, ignore = "flown with --release")]
#[tokio::test(flavor = "multi_thread")]
async fn px4_waits_on_the_ground_and_flies_the_second_flight() {
    flies_two_flights(&["--personality", "px4", "--param", "MIS_TKO_LAND_REQ=0"]).await;
}
