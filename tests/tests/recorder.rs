//! A flight of the real binaries beside the programme, in lockstep: time goes on only when the test says so.
#![cfg(test)]

use system_tests::rig::Rig;
use usal::contract::GatewayState;

/// Longest flight of the mission, simulated seconds.
const FLIGHT_S: f64 = 3000.0;

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
    rig.until("far", FLIGHT_S, |_, seen| seen.entered("far")).await.unwrap();
    let before = told.missed;
    let told = rig.recorder_says("more that was missed", |r| r.missed > before + 100).await.unwrap();
    assert_eq!((told.messages, told.file), (0, None), "nothing can have been recorded");
    // somebody repairs it in flight
    std::fs::remove_file(&recordings).unwrap();
    rig.recorder_says("it records", |r| r.failure.is_none() && r.file.is_some()).await.unwrap();
    rig.until("landed", FLIGHT_S, |_, seen| seen.landed()).await.unwrap();
    rig.expect_on_runway().unwrap();
    let told = rig.recorder_says("the rest is recorded", |r| r.messages > 100).await.unwrap();
    assert!(told.missed > before, "what was missed stays counted: {told:?}");
    let file = recordings.join(told.file.unwrap());
    assert!(std::fs::metadata(&file).unwrap().len() > 10_000, "{}", file.display());
    assert!(!rig.seen.went_to(GatewayState::SafeHold), "{}", rig.story());
}
