//! SIGKILLs of the real FP Manager at random instants of a whole flight, in lockstep: it comes back to its place, and nothing
//! is flown twice.
#![cfg(test)]

use std::collections::BTreeMap;
use std::time::Instant;
use system_tests::rig::Rig;
use usal::contract::{GatewayState, PlanEvent};

const KILLS: usize = 6;
/// Longest flight of the mission, simulated seconds.
const FLIGHT_S: f64 = 3000.0;

/// A small generator of random numbers (SplitMix64).
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % end
    }
}

/// Lets it fly for a random time, kills it at a random instant of the wall clock, and brings it back while time stands.
async fn kill_and_bring_back(rig: &mut Rig, random: &mut Random) {
    let dies_s = rig.seen.time_s + 5.0 + random.below(60) as f64;
    rig.until("time to die", 200.0, |_, seen| seen.time_s >= dies_s).await.unwrap();
    // the tick it dies in has been acknowledged: it is somewhere on its way through the next
    (0..random.below(2_000_000)).for_each(|_| std::hint::spin_loop());
    rig.fp_manager.kill().unwrap();
    rig.fp_manager_is_there(false).await.unwrap();
    let started = Instant::now();
    rig.restart_fp_manager().unwrap();
    rig.fp_manager_is_there(true).await.unwrap();
    println!("killed at {:.1} s of the flight, there again after {:?}", rig.seen.time_s, started.elapsed());
    rig.until("the plan is flown again", 60.0, |rig, seen| {
        seen.time_s > dies_s + 3.0 && rig.gateway_status().is_some_and(|s| s.state == GatewayState::Nav)
    })
    .await
    .unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn killed_at_random_instants_it_flies_the_mission_as_if_nothing_had_been() {
    let seed = std::env::var("LEGWORK_SEED").ok().and_then(|s| s.parse().ok());
    let seed = seed.unwrap_or_else(|| u64::from(std::process::id()));
    println!("LEGWORK_SEED={seed}");
    let mut random = Random(seed);
    let mut rig = Rig::start(&["--wind", "270,5"]).await.unwrap();
    rig.fly_mission().await.unwrap();
    for _ in 0..KILLS {
        kill_and_bring_back(&mut rig, &mut random).await;
    }
    rig.until("landed", FLIGHT_S, |_, seen| seen.landed()).await.unwrap();
    rig.expect_on_runway().unwrap();
    let mut passes = BTreeMap::new();
    for event in &rig.seen.plan {
        if let PlanEvent::IterationFinished { leg, finished, .. } = event {
            *passes.entry((leg.to_string(), *finished)).or_insert(0) += 1;
        }
    }
    assert!(passes.values().all(|times| *times == 1), "a pass was told twice: {passes:?}");
    let legs = rig.seen.legs();
    for leg in ["out", "round", "far", "back", "downwind", "final"] {
        assert!(legs.iter().filter(|l| **l == leg).count() <= 1, "{leg} twice: {legs:?}");
    }
    let sweeps = legs.iter().filter(|leg| **leg == "sweep").count();
    assert!(sweeps <= 3, "an iteration was doubled: {legs:?}");
    assert!(!rig.seen.went_to(GatewayState::SafeReturn), "{}", rig.story());
}
